"""Verdicts near the edge of what a grasp holds: states inside, proofs outside, and what is neither.

    python benchmarks/truth/edges.py 10000 -o DIR    grasps, each under 18 loads; the same line goes on
    python benchmarks/truth/edges.py --table -o DIR  the table of what DIR holds
    python benchmarks/truth/edges.py 10000 --only 1e-8 1e-9 -o DIR    these distances alone, the same loads

Grasps are made with their edge (``boundary``), so that the place of every load follows from the construction.
In the plane without limits it is decided again by membership in rational arithmetic, and certificates and
states are judged so everywhere (``exact_judge``).
"""

import argparse
from functools import partial
from math import inf
from pathlib import Path

import numpy as np

import regrasp as rg
from boundary import KINDS, boundary
from chunks import Judged, gathered, run
from exact_judge import is_escape, is_held, state_faults

CHUNK = 50
OBJECTIVES = ("effort", "angle", "peak", "force", "friction_use", "peak_normal")
DISTANCES = tuple(10.0**-e for e in range(1, 10))
ROUNDING = 1e-12
"""The construction is exact to rounding: a verdict may change with as much of the friction."""


def verdicts(seed: int, only: tuple[float, ...] = DISTANCES) -> list[tuple[int, float, str]]:
    """(dimension, distance beyond the edge, outcome) of a grasp under all loads; inside it is negative."""
    rng = np.random.default_rng(seed)
    d = int(rng.integers(2, 4))
    kind = str(rng.choice([k for k in KINDS if d == 3 or k != "box turns"]))
    at = boundary(rng, d, kind)
    grasp = rg.Grasp(
        rg.Contact(r, n, float(mu), max_force=None if limit == inf else float(limit))
        for r, n, mu, limit in zip(at.positions, at.normals, at.frictions, at.limits, strict=True)
    )
    found = []
    for distance in DISTANCES:
        for side in (1, -1):
            load = at.load(side * distance)
            objective = str(rng.choice(OBJECTIVES))
            if distance not in only:
                continue
            found.append((d, side * distance, outcome(at, grasp, load, side < 0, objective)))
    return found


def outcome(at: object, grasp: rg.Grasp, load: np.ndarray, inside: bool, objective: str) -> str:
    """The word for a verdict."""
    data = grasp.positions, grasp.normals, grasp.frictions
    if (
        grasp.dimension == 2
        and (grasp.max_forces == inf).all()
        and is_held(*data, load) != inside
        and is_held(*data[:2], grasp.frictions * (1 + (ROUNDING if inside else -ROUNDING)), load) != inside
    ):
        return "the construction is wrong"
    try:
        state = rg.choose_state(grasp, rg.Wrench.from_vector(load), objective)
    except rg.Infeasible as reason:
        twist = reason.certificate
        if twist is None:
            return "at its limit" if "at its limit" in reason.reason else "plain refusal"
        if inside or not is_escape(*data, np.array(twist.limits), load, twist.twist):
            return "wrong: false proof"
        return "proven"
    except rg.SolverFailed:
        return "solver failed"
    except Exception as error:
        return f"exception: {type(error).__name__}: {error!s:.80}"
    faults = state_faults(*data, grasp.max_forces, load, state.forces)
    return f"wrong: {faults[0]}" if faults else "held"


def judged(seed: int, only: tuple[float, ...] = DISTANCES) -> Judged:
    """What is counted of a grasp."""
    for d, distance, word in verdicts(seed, only):
        plain = word.split(":")[0]
        fault = None if plain in ("held", "proven", "at its limit") else [seed, distance, word]
        yield f"{d}|{distance:g}|{plain}", fault


def table(folder: Path) -> str:
    """Counts by dimension and distance, in Markdown."""
    counts, _, grasps = gathered(folder)
    words = sorted({key.split("|")[2] for key in counts})
    lines = [
        f"{grasps:,} grasps",
        "",
        "| | beyond the edge by | " + " | ".join(words) + " |",
        "|---|--:|" + "--:|" * len(words),
    ]
    for d, where in ((2, "plane"), (3, "space")):
        for distance in (*DISTANCES, *(-x for x in reversed(DISTANCES))):
            row = [f"{counts[f'{d}|{distance:g}|{word}']:,}" for word in words]
            lines.append(f"| {where} | {distance:g} | " + " | ".join(row) + " |")
    return "\n".join(lines)


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("count", type=int, nargs="?", default=0)
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).parents[1] / "results" / "edges")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--only", type=float, nargs="+", choices=DISTANCES, default=DISTANCES)
    options = parser.parse_args()
    if not options.table:
        run(options.count, CHUNK, options.output, partial(judged, only=tuple(options.only)))
    print(table(options.output))


if __name__ == "__main__":
    main()
