"""Fingers on fifty outlines: is the gap reached, does the proof stand, is a random placement better?

    python benchmarks/placing/placement_outlines.py [--count 50] [--objectives peak force] [--fingers 2]
                                                  [--cap 40] [--most 200000] [--seconds 200] [-o FILE]
                                                  [--again]
    python benchmarks/placing/placement_outlines.py --attack 1000000
    python benchmarks/placing/placement_outlines.py --table

Twelve loads: unit forces in six directions, beside the centre of mass by a twentieth of the reach, to either
side; for ``answered`` twelve such deviations of a tenth of the weight. Friction 0.4, forces of at most 4 N
where a limit is needed, corners allowed, a gap of 1e-4 asked for, within ``--cap`` seconds of processor
time. Proofs are written, read and verified. A row is kept when it is done, so that a run goes on where it was
ended; ``--again`` makes rows anew, with the attack on them where value and bound are what they were;
``--attack`` goes over rows that are kept, with so many random placements each (``random_attack``), and
``--table`` prints them. Times are of the clock and of a processor.
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

import regrasp as rg
from fifty_outlines import outlines
from kept_rows import keep, rows_in
from random_attack import attack

OBJECTIVES = ("sum_normal", "peak_normal", "peak", "friction_use", "force", "answered")
LIMITED = ("friction_use", "force", "answered")
FRICTION, LIMIT, TOLERANCE, BESIDE = 0.4, 4.0, 1e-4, 0.05
OF_ATTACKS = ("random", "near", "better", "around", "attack_seconds")
RESULTS = Path(__file__).parents[1] / "results" / "outlines.json"


def loads(outline: rg.Outline) -> np.ndarray:
    """(12, 3) about the centre of mass."""
    around = outline.points(outline.sample(200))
    beside = BESIDE * float(np.linalg.norm(around, axis=1).max())
    angle = np.repeat(np.arange(6) * np.pi / 3, 2)
    return np.column_stack([np.cos(angle), np.sin(angle), beside * np.tile([1.0, -1.0], 6)])


def asked(outline: rg.Outline, objective: str) -> dict[str, Any]:
    each = [rg.Wrench.from_vector(w) for w in loads(outline)]
    more: dict[str, Any] = {"max_force": LIMIT} if objective in LIMITED else {}
    if objective == "answered":
        more["disturbance"] = rg.LoadSet.hull([rg.Wrench.from_vector(0.1 * w.vector) for w in each])
        return {"load": rg.Wrench([0, -1])} | more
    return {"load": rg.LoadSet.hull(each)} | more


def within(cap: float) -> tuple[Callable[[], bool], Callable[..., None]]:
    """Whether a search was ended, and a progress that ends it once, after ``cap`` s of processor time."""
    used, ended = process_time(), False

    def progress(*_: float) -> None:
        nonlocal ended
        if not ended and process_time() - used > cap:
            ended = True
            raise KeyboardInterrupt

    return lambda: ended, progress


def row(
    outline: rg.Outline, objective: str, fingers: int, cap: float, most: int | None = None
) -> dict[str, Any]:
    """How a search of at most ``cap`` seconds of processor time went, and what ``verify`` says."""
    begin, used, (ended, progress) = perf_counter(), process_time(), within(cap)
    more = asked(outline, objective) | ({} if most is None else {"most_boxes": most})
    try:
        chosen = rg.choose_grasp(
            outline, fingers, friction=FRICTION, objective=objective, tolerance=TOLERANCE, from_corners=0.0,
            progress=progress, **more,
        )  # fmt: skip
    except rg.Infeasible as refusal:
        seconds, proof = perf_counter() - begin, refusal.certificate
        proven = proof is not None and "not proven" not in str(refusal) and rg.verify(proof).ok
        return {"refused": proven, "seconds": seconds, "random": 0, "better": 0}
    except KeyboardInterrupt:
        if not ended():
            raise
        return {"refused": False, "seconds": perf_counter() - begin, "random": 0, "better": 0}
    seconds, processor = perf_counter() - begin, process_time() - used
    read = rg.ChosenGrasp.from_dict(json.loads(json.dumps(chosen.to_dict())))
    begin, used = perf_counter(), process_time()
    verdict = rg.verify(read)
    return {
        "value": chosen.value, "bound": chosen.bound, "gap": chosen.gap, "seconds": seconds,
        "processor": processor, "boxes": chosen.certificate.leaves, "verified": verdict.ok,
        "verify_seconds": perf_counter() - begin, "verify_processor": process_time() - used,
        "places": [round(s, 9) for s in chosen.places.tolist()], "random": 0, "near": 0, "better": 0,
    }  # fmt: skip


def attacked(
    outline: rg.Outline, objective: str, fingers: int, kept: dict[str, Any], count: int
) -> dict[str, Any]:
    """How near random placements come to the value of a row, and whether one is better than its bound."""
    levels: list[float | None] = [None, None]
    if "value" in kept:
        more = objective in ("force", "answered")
        levels = [kept["value"] * (0.9 if more else 1.1), kept["bound"]]
    limit = LIMIT if objective in LIMITED else np.inf
    begin = perf_counter()
    found = attack(
        outline, fingers, FRICTION, loads(outline), objective, levels[0], levels[1], limit, count,
        np.array(kept.get("places", [])),
    )  # fmt: skip
    return found | {"attack_seconds": perf_counter() - begin}


def table(kept: dict[str, Any]) -> str:
    """A line for each objective and number of fingers."""
    lines = [
        "| objective, fingers | outlines | gap 1e-4 reached | refused with proof | processor, median [s] | "
        "largest [s] | boxes, median | `verify`, median [s] | verified | random placements | "
        "outlines where one within a tenth is seen, of all, around the best | better |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for fingers in (2, 3):
        for objective in OBJECTIVES:
            rows = [r for key, r in kept.items() if key.startswith(f"{objective}, {fingers} fingers, ")]
            if not rows:
                continue
            found = [r for r in rows if "gap" in r]
            seconds = [r["processor"] for r in found] or [np.nan]
            proven = sum(r.get("refused", False) for r in rows)
            middle = [
                f"{np.median([r[k] for r in found]):.3g}" if found else ""
                for k in ("boxes", "verify_processor")
            ]
            seen = [sum(r.get(kind, 0) > 0 for r in rows) for kind in ("near", "around")]
            lines.append(
                f"| `{objective}`, {fingers} | {len(rows)} | {sum(r['gap'] <= TOLERANCE for r in found)} of "
                f"{len(found)} | {proven} of {len(rows) - len(found)} | {np.median(seconds):.2f} | "
                f"{max(seconds):.1f} | {middle[0]} | {middle[1]} | {sum(r['verified'] for r in found)} of "
                f"{len(found)} | {sum(r['random'] for r in rows):,} | "
                f"{seen[0]}, {seen[1]} | {sum(r['better'] for r in rows)} |"
            )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--objectives", nargs="+", default=OBJECTIVES, choices=OBJECTIVES)
    parser.add_argument("--fingers", nargs="+", type=int, default=(2, 3))
    parser.add_argument("--cap", type=float, default=40.0, help="of a search, of processor time [s]")
    parser.add_argument("--most", type=int, help="boxes of a search; as choose_grasp has it if not given")
    parser.add_argument("--attack", type=int, default=0, metavar="RANDOM", help="kept rows, by so many each")
    parser.add_argument("--seconds", type=float, default=np.inf, help="after which no other row is begun")
    parser.add_argument("--again", action="store_true", help="rows that are kept, too")
    parser.add_argument("--table", action="store_true")
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(__file__).parents[1] / "results" / "outlines.json"
    )
    given = parser.parse_args()
    kept = rows_in(given.output)
    if given.table:
        print(table(kept))
        return
    begin, shapes = perf_counter(), list(outlines())[: given.count]

    for fingers in given.fingers:
        for objective in given.objectives:
            for name, outline in shapes:
                key = f"{objective}, {fingers} fingers, {name}"
                if perf_counter() - begin > given.seconds:
                    return
                if not given.attack and (given.again or key not in kept):
                    made, before = row(outline, objective, fingers, given.cap, given.most), kept.get(key, {})
                    if all(made.get(k) == before.get(k) for k in ("value", "bound")):
                        made |= {k: before[k] for k in OF_ATTACKS if k in before}
                    keep(given.output, kept, key, made)
                elif given.attack and kept.get(key, {"random": np.inf})["random"] < given.attack:
                    more = attacked(outline, objective, fingers, kept[key], given.attack)
                    keep(given.output, kept, key, kept[key] | more)


if __name__ == "__main__":
    main()
