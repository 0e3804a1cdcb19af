"""Where to put fingers: the certified search beside random search, sampled points, multi-start and HiGHS.

    python benchmarks/truth/placement.py [--quick] [-o results/placement.json]

The least sum of normal forces, friction 0.4, under twelve directions of a unit force; outlines of about 50
edges. Rivals judge placements by the search's own compiled norm, so that only the search differs. They prove
nothing but the integer program, and that among its points only.
"""

import argparse
import json
from collections.abc import Callable
from itertools import combinations
from math import inf
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp, minimize

import regrasp as rg
from regrasp.planning.placement.laws import LAWS
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.search import Search

FRICTION = 0.4
LOADS = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t)]) for t in np.arange(12) * np.pi / 6)
Found = tuple[float, float]
"""Value and seconds."""


def gear() -> rg.Outline:
    angle = np.arange(48) * 2 * np.pi / 48
    radius = np.where(np.arange(48) % 4 < 2, 1.0, 0.8)
    return rg.Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def pebble(seed: int = 3, count: int = 50) -> rg.Outline:
    rng = np.random.default_rng(seed)
    angle, radius = np.sort(rng.uniform(0, 2 * np.pi, count)), rng.uniform(0.8, 1.2, count)
    return rg.Outline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def judge(outline: rg.Outline, fingers: int) -> Callable[[np.ndarray], float]:
    """The norm of a placement by arc lengths, as a fraction of the outline's length."""
    sides = sides_of(outline, 0.0)
    assert LOADS.vertices is not None
    search = Search(sides, fingers, FRICTION, LOADS.vertices, LAWS["sum_normal"], 0.0, 0.0)

    def norm(share: np.ndarray) -> float:
        s = (share % 1.0) * outline.length
        edge = np.clip(np.searchsorted(sides.starts, s, side="right") - 1, 0, len(sides.starts) - 1)
        return search.norm_at(edge, edge + np.clip((s - sides.starts[edge]) / sides.lengths[edge], 0, 1))

    return norm


def certified(outline: rg.Outline, fingers: int, rounds: int) -> dict[str, Any]:
    rg.choose_grasp(outline, fingers, LOADS, friction=FRICTION, from_corners=0.0)
    times = []
    for _ in range(rounds):
        begin = perf_counter()
        chosen = rg.choose_grasp(outline, fingers, LOADS, friction=FRICTION, from_corners=0.0)
        times.append(perf_counter() - begin)
    seen: list[tuple[float, float, float]] = []
    begin = perf_counter()
    rg.choose_grasp(
        outline, fingers, LOADS, friction=FRICTION, from_corners=0.0,
        progress=lambda low, high: seen.append((perf_counter() - begin, low, high)),
    )  # fmt: skip
    begin = perf_counter()
    ok = rg.verify(chosen).ok
    return {
        "seconds": float(np.median(times)), "value": chosen.value, "bound": chosen.bound, "gap": chosen.gap,
        "boxes": chosen.certificate.leaves, "verified": ok, "verify_seconds": perf_counter() - begin,
        "over_time": seen,
    }  # fmt: skip


def random_search(norm: Callable[[np.ndarray], float], fingers: int, seconds: float) -> Found:
    rng, best, begin = np.random.default_rng(0), inf, perf_counter()
    while perf_counter() - begin < seconds:
        best = min(best, norm(rng.random(fingers)))
    return best, perf_counter() - begin


def all_of_sampled(norm: Callable[[np.ndarray], float], fingers: int, points: int) -> Found:
    shares, begin = (np.arange(points) + 0.5) / points, perf_counter()
    return min(norm(np.array(few)) for few in combinations(shares, fingers)), perf_counter() - begin


def multi_start(norm: Callable[[np.ndarray], float], fingers: int, seconds: float) -> Found:
    rng, best, begin = np.random.default_rng(0), inf, perf_counter()
    while perf_counter() - begin < seconds:
        start = rng.random(fingers)
        if norm(start) < 1e3:
            options = {"maxfev": 300, "xatol": 1e-6, "fatol": 1e-7}
            best = min(best, minimize(norm, start, method="Nelder-Mead", options=options).fun)
    return best, perf_counter() - begin


def integer_program(outline: rg.Outline, fingers: int, points: int, seconds: float) -> Found:
    """Which of some points, z, and forces for each load, by HiGHS: minimise t >= sum of normals, f <= M z."""
    contacts = [outline.contact_at(s, friction=FRICTION) for s in outline.sample(points, clearance=1e-6)]
    n, G = len(contacts), []
    for c in contacts:
        for side in (-FRICTION, FRICTION):
            f = c.normal + side * np.array([-c.normal[1], c.normal[0]])
            G.append([*f, c.position[0] * f[1] - c.position[1] * f[0]])
    loads, matrix, big = LOADS.vertices, np.array(G).T, 10.0
    assert loads is not None
    m, width = len(loads), 2 * n
    size = 1 + n + m * width
    cost = np.zeros(size)
    cost[0] = 1
    rows, low, high = [], [], []
    pick = np.zeros((1, size))
    pick[0, 1 : 1 + n] = 1
    rows, low, high = [pick], [np.array([0.0])], [np.array([float(fingers)])]
    for k, load in enumerate(loads):
        at = slice(1 + n + k * width, 1 + n + (k + 1) * width)
        balance, total, switch = np.zeros((3, size)), np.zeros((1, size)), np.zeros((n, size))
        balance[:, at] = matrix
        total[0, at], total[0, 0] = 1, -1
        switch[:, at] = np.kron(np.eye(n), [1.0, 1.0])
        switch[:, 1 : 1 + n] = -big * np.eye(n)
        rows += [balance, total, switch]
        low += [-load, np.array([-np.inf]), np.full(n, -np.inf)]
        high += [-load, np.zeros(1), np.zeros(n)]
    upper = np.full(size, np.inf)
    upper[1 : 1 + n] = 1
    integrality = np.zeros(size)
    integrality[1 : 1 + n] = 1
    begin = perf_counter()
    found = milp(
        cost, constraints=LinearConstraint(np.vstack(rows), np.concatenate(low), np.concatenate(high)),
        integrality=integrality, bounds=Bounds(np.zeros(size), upper), options={"time_limit": seconds},
    )  # fmt: skip
    return (inf if found.x is None else float(found.fun)), perf_counter() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("-o", "--output", type=Path, default=None)
    given = parser.parse_args()
    patience, points, rounds = (0.3, 12, 1) if given.quick else (10.0, 60, 5)
    report: dict[str, Any] = {}
    for name, outline in (("gear of 48 edges", gear()), ("pebble of 50 edges", pebble())):
        for fingers in (2, 3):
            norm = judge(outline, fingers)
            rows: dict[str, Any] = {"certified": certified(outline, fingers, rounds)}
            rows["random search"] = random_search(norm, fingers, patience)
            rows[f"all of {points} points"] = all_of_sampled(norm, fingers, points)
            rows["multi-start Nelder-Mead"] = multi_start(norm, fingers, patience)
            rows[f"integer program, {points // 2} points"] = integer_program(
                outline, fingers, points // 2, 3 * patience
            )
            report[f"{name}, {fingers} fingers"] = rows
            best = rows["certified"]["value"]
            print(f"{name}, {fingers} fingers: {best:.6f} in {rows['certified']['seconds']:.3f} s,", end=" ")
            print(f"gap {rows['certified']['gap']:.1e}, {rows['certified']['boxes']} boxes", end=", ")
            print(f"verified {rows['certified']['verified']} in {rows['certified']['verify_seconds']:.2f} s")
            for rival, found in rows.items():
                if rival != "certified":
                    print(f"    {rival:30} {found[0]:.6f} ({found[0] / best - 1:+.2%}) in {found[1]:.2f} s")
    if given.output is not None:
        given.output.parent.mkdir(parents=True, exist_ok=True)
        given.output.write_text(json.dumps(report, indent=1, allow_nan=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
