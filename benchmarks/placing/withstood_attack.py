"""Random placements against the bound of what is withstood, judged by linear programs of its own.

    python benchmarks/placing/withstood_attack.py [--only "letter L"]
    python benchmarks/placing/withstood_attack.py --table

A gap of 2 % is asked for; every other placement is drawn near the chosen one. A row is kept when it is done.
Forces f at the fingers balance the load, and f - s (v + omega x p), one motion of the body for all, the load
and s times a deviation; all within cones, and within a polygon around the circle of the limit, or in it.
Nothing of it is part of the search.
"""

import argparse
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
from scipy.optimize import linprog

import regrasp as rg
from fifty_outlines import outlines
from kept_rows import keep, rows_in, short

LIMIT, WEIGHT = 3.0, np.array([0.0, -1.0, 0.0])
ROUGH, FINE = 24, 480  # sides of polygons around a circle
RESULTS = Path(__file__).parents[1] / "results" / "withstood_attack.json"
MORE = {
    "triangle": rg.Outline([[0, 0], [2, 0], [0.5, 1.5]]),
    "square": rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]]),
    "needle": rg.Outline([[0, 0], [5, 0], [5, 0.01], [0, 0.01]]),
    "bracket of 6 edges": rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]),
}
CASES = [(name, 2, 0.4) for name in ("letter L", "gear of 8", "letter S", "gear of 12", "letter T")]
CASES += [(name, 2, 0.4) for name in ("polygon 0", "egg", "bracket")]
CASES += [(name, 3, 0.4) for name in ("triangle", "square", "needle", "bracket")]
CASES += [("triangle", 2, 1.5), ("triangle", 3, 1.5), ("bracket of 6 edges", 3, 0.5)]
COUNTS = {2: 600, 3: 300}


def withstood(
    p: np.ndarray, n: np.ndarray, mu: float, deviations: np.ndarray, sides: int, inner: bool
) -> float:
    """What a placement withstands at most (at least, ``inner``); -1 for one that does not hold."""
    k = len(p)
    to_wrench = np.zeros((3, 2 * k))
    to_wrench[0, 0::2] = to_wrench[1, 1::2] = 1.0
    to_wrench[2, 0::2], to_wrench[2, 1::2] = -p[:, 1], p[:, 0]
    motions = np.linalg.lstsq(to_wrench @ to_wrench.T, -deviations.T, rcond=None)[0]
    if np.abs(to_wrench @ to_wrench.T @ motions + deviations.T).max() > 1e-9:
        return -1.0
    changes = (to_wrench.T @ motions).T
    angle = 2 * np.pi * np.arange(sides) / sides
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    t = np.column_stack([-n[:, 1], n[:, 0]])
    rows, limits = [], []
    for i in range(k):
        few = np.vstack([t[i] - mu * n[i], -t[i] - mu * n[i], rim])
        wide = np.zeros((len(few), 2 * k))
        wide[:, 2 * i : 2 * i + 2] = few
        rows.append(wide)
        limits.append(
            np.append([0.0, 0.0], np.full(sides, LIMIT * (np.cos(np.pi / sides) if inner else 1.0)))
        )
    one, limit = np.vstack(rows), np.concatenate(limits)
    every = np.vstack([np.column_stack([one, one @ r]) for r in (np.zeros(2 * k), *changes)])
    found = linprog(
        np.append(np.zeros(2 * k), -1.0), A_ub=every, b_ub=np.tile(limit, len(changes) + 1),
        A_eq=np.column_stack([to_wrench, np.zeros(3)]), b_eq=-WEIGHT,
        bounds=[(None, None)] * (2 * k) + [(0, None)], method="highs",
    )  # fmt: skip
    return float(-found.fun) if found.status == 0 else -1.0


def asked(shape: rg.Outline) -> tuple[rg.LoadSet, np.ndarray]:
    """The deviations of the benchmark of what is withstood."""
    reach = float(np.abs(shape.polygon()).max())
    rows = np.array([[0.3, 0, 0], [-0.3, 0, 0], [0, 0, 0.1 * reach], [0, 0, -0.1 * reach]])
    return rg.LoadSet.hull([rg.Wrench.from_vector(row) for row in rows]), rows


def row(shape: rg.Outline, fingers: int, mu: float, count: int) -> dict[str, Any]:
    """The value, the bound, what the programs say of the chosen places, and the best of random ones."""
    disturbance, deviations = asked(shape)
    start, used = perf_counter(), process_time()
    chosen = rg.choose_grasp(
        shape, fingers, rg.Wrench([0, -1]), objective="wrench", friction=mu, max_force=LIMIT,
        disturbance=disturbance, tolerance=0.02,
    )  # fmt: skip
    took, used = perf_counter() - start, process_time() - used
    p, n = chosen.grasp.positions, chosen.grasp.normals
    low, high = (withstood(p, n, mu, deviations, FINE, inner) for inner in (True, False))
    rng = np.random.default_rng(fingers)
    around = np.array([shape.nearest(c.position + shape.centre_of_mass) for c in chosen.grasp])
    best, better, held = -1.0, 0, 0
    for i in range(count):
        s = rng.uniform(0, shape.length, fingers)
        if i % 2:
            s = around + shape.length * 10 ** rng.uniform(-5, -1) * rng.normal(size=fingers)
        few = [shape.contact_at(float(at), friction=mu) for at in s % shape.length]
        p, n = np.array([c.position for c in few]), np.array([c.normal for c in few])
        value = withstood(p, n, mu, deviations, ROUGH, False)
        held += value >= 0
        if value > chosen.value:
            value = withstood(p, n, mu, deviations, FINE, True)
        best = max(best, value)
        better += value > chosen.bound
    return {
        "value": chosen.value, "programs": [low, high], "bound": chosen.bound, "gap": chosen.gap,
        "seconds": took, "processor": used, "verified": rg.verify(chosen).ok, "random": count, "held": held,
        "best": best, "better": better,
    }  # fmt: skip


def table(kept: dict[str, Any]) -> str:
    """A line for each task."""
    lines = [
        "| outline | fingers | friction | value | by linear programs | bound | gap | processor | verified | "
        "placements | that hold | best | better than the bound |",
        "|---|--:|--:|--:|---|--:|--:|--:|---|--:|--:|--:|--:|",
    ]
    for key, r in kept.items():
        low, high = r["programs"]
        proven = "yes" if r["verified"] else "**no**"
        lines.append(
            f"| {' | '.join(key.split('; '))} | {r['value']:.5f} | {low:.5f} to {high:.5f} | "
            f"{r['bound']:.5f} | {r['gap']:.3f} | {r['processor']:.1f} s | {proven} | {r['random']} | "
            f"{r['held']} | {r['best']:.5f} | {r['better']} |"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("-o", "--output", type=Path, default=RESULTS)
    given = parser.parse_args()
    kept = rows_in(given.output)
    if given.table:
        print(table(kept))
        return
    shapes = dict(outlines()) | MORE
    for name, fingers, mu in CASES:
        key = f"{name}; {fingers}; {mu}"
        if key in kept or given.only not in key:
            continue
        found = row(shapes[name], fingers, mu, COUNTS[fingers])
        keep(given.output, kept, key, short(found))


if __name__ == "__main__":
    main()
