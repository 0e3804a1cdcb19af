"""Where to put fingers: the certified search beside random search, sampled points, multi-start and HiGHS.

    python benchmarks/truth/placement.py [--quick] [-o results/placement.json]

The least sum of normal forces, friction 0.4, under twelve directions of a unit force; outlines of about 50
edges. Rivals judge placements by the search's own compiled norm, so that only the search differs. They prove
nothing but the integer program, and that among its points only. Each goes on until it is as good as was asked
of the certified search, within 0.1 % of its bound, or for as long as it may; programs and points double.

First calls are of processes of their own: one that finds no machine code and compiles, and one that finds it.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp, minimize

import regrasp as rg
from regrasp.planning.placement.laws import LAWS
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.search import Search

FRICTION = 0.4
LOADS = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t)]) for t in np.arange(12) * np.pi / 6)
GAP = 1e-3
MOST_POINTS, FIRST_POINTS = 960, 30
Found = dict[str, Any]
"""Value, seconds until it was as good as asked or gave up, whether it was; points, of those who take some."""


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
        begin, worked = perf_counter(), process_time()
        chosen = rg.choose_grasp(outline, fingers, LOADS, friction=FRICTION, from_corners=0.0)
        times.append((perf_counter() - begin, process_time() - worked))
    passed, worked = np.median(times, axis=0).tolist()
    seen: list[tuple[float, float, float]] = []
    begin = perf_counter()
    rg.choose_grasp(
        outline, fingers, LOADS, friction=FRICTION, from_corners=0.0,
        progress=lambda low, high: seen.append((perf_counter() - begin, low, high)),
    )  # fmt: skip
    begin = perf_counter()
    ok = rg.verify(chosen).ok
    return {
        "seconds": passed, "processor": worked, "value": chosen.value, "bound": chosen.bound,
        "gap": chosen.gap, "boxes": chosen.certificate.leaves, "verified": ok,
        "verify_seconds": perf_counter() - begin, "over_time": seen,
    }  # fmt: skip


def found_within(values: Iterator[float], wanted: float, seconds: float) -> Found:
    """The best of values one after the other, until one is as good as wanted or time is over."""
    best, begin, over_time = inf, perf_counter(), []
    for value in values:
        passed = perf_counter() - begin
        if value < best:
            best = value
            over_time.append((passed, best))
        if best <= wanted or passed > seconds:
            break
    passed = perf_counter() - begin
    return {"value": best, "seconds": passed, "reached": best <= wanted, "over_time": over_time}


def at_random(norm: Callable[[np.ndarray], float], fingers: int) -> Iterator[float]:
    rng = np.random.default_rng(0)
    while True:
        yield norm(rng.random(fingers))


def from_many_starts(norm: Callable[[np.ndarray], float], fingers: int) -> Iterator[float]:
    rng, options = np.random.default_rng(0), {"maxfev": 300, "xatol": 1e-6, "fatol": 1e-7}
    while True:
        start = rng.random(fingers)
        if norm(start) < 1e3:
            yield float(minimize(norm, start, method="Nelder-Mead", options=options).fun)


def on_more_points(of_points: Callable[[int, float], float], wanted: float, seconds: float) -> Found:
    """The best on evenly spread points, which double until it is as good as wanted or time is over."""
    best, begin, points, done, over_time = inf, perf_counter(), FIRST_POINTS, 0, []
    while best > wanted and points <= MOST_POINTS and (left := seconds - (perf_counter() - begin)) > 0:
        found = of_points(points, left)
        if found < inf:
            best, done = min(best, found), points
            over_time.append((perf_counter() - begin, best))
        points *= 2
    return {
        "value": best, "seconds": perf_counter() - begin, "reached": best <= wanted, "points": done,
        "over_time": over_time,
    }  # fmt: skip


def all_of_sampled(norm: Callable[[np.ndarray], float], fingers: int, points: int, seconds: float) -> float:
    """Infinite where time was over before all of them were looked at."""
    shares, best, begin = (np.arange(points) + 0.5) / points, inf, perf_counter()
    for few in combinations(shares, fingers):
        best = min(best, norm(np.array(few)))
        if perf_counter() - begin > seconds:
            return inf
    return best


def integer_program(outline: rg.Outline, fingers: int, points: int, seconds: float) -> float:
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
    found = milp(
        cost, constraints=LinearConstraint(np.vstack(rows), np.concatenate(low), np.concatenate(high)),
        integrality=integrality, bounds=Bounds(np.zeros(size), upper), options={"time_limit": seconds},
    )  # fmt: skip
    return inf if found.x is None else float(found.fun)


FIRST = """
import sys
from time import process_time
sys.path.insert(0, {folder!r})
import placement, regrasp
outline, times = placement.{shape}(), []
for _ in range(2):
    begin = process_time()
    regrasp.choose_grasp(outline, {fingers}, placement.LOADS, friction=placement.FRICTION, from_corners=0.0)
    times.append(process_time() - begin)
print(times)
"""


def first_calls(shape: str, fingers: int) -> dict[str, Any]:
    """Processor time of the first two calls of a process: without machine code at hand, and with [s]."""
    code = FIRST.format(folder=str(Path(__file__).parent), shape=shape, fingers=fingers)
    with TemporaryDirectory() as folder:
        kept = {**os.environ, "NUMBA_CACHE_DIR": folder}
        runs = [
            subprocess.run([sys.executable, "-c", code], env=kept, check=True, capture_output=True)
            for _ in "ab"
        ]
    cold, warm = (json.loads(run.stdout.decode().splitlines()[-1]) for run in runs)
    return {"compiles": cold[0], "machine code at hand": warm[0], "second": warm[1]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("-o", "--output", type=Path, default=None)
    given = parser.parse_args()
    patience, rounds = (0.3, 1) if given.quick else (30.0, 5)
    report: dict[str, Any] = {}
    for shape, name, outline in (
        ("gear", "gear of 48 edges", gear()),
        ("pebble", "pebble of 50 edges", pebble()),
    ):
        for fingers in (2, 3):
            norm, found = judge(outline, fingers), certified(outline, fingers, rounds)
            wanted = found["bound"] * (1 + GAP)
            rows: dict[str, Any] = {"certified": found, "first calls": first_calls(shape, fingers)}
            rows["random search"] = found_within(at_random(norm, fingers), wanted, patience)
            sampled = partial(all_of_sampled, norm, fingers)
            rows["all of some points"] = on_more_points(sampled, wanted, patience)
            rows["multi-start Nelder-Mead"] = found_within(from_many_starts(norm, fingers), wanted, patience)
            programs = partial(integer_program, outline, fingers)
            rows["integer program"] = on_more_points(programs, wanted, patience)
            report[f"{name}, {fingers} fingers"] = rows
            best = found["value"]
            print(f"{name}, {fingers} fingers: {best:.6f} in {found['seconds']:.3f} s,", end=" ")
            print(f"{found['processor']:.3f} s of processor time,", end=" ")
            print(f"gap {found['gap']:.1e}, {found['boxes']} boxes", end=", ")
            print(f"verified {found['verified']} in {found['verify_seconds']:.2f} s")
            print("    first calls [s]:", {k: round(v, 3) for k, v in rows["first calls"].items()})
            for rival, result in list(rows.items())[2:]:
                about = f", {result['points']} points" if "points" in result else ""
                print(f"    {rival:30} {result['value']:.6f} ({result['value'] / best - 1:+.2%}) in", end=" ")
                print(
                    f"{result['seconds']:.2f} s{about}{', as good' if result['reached'] else ''}", flush=True
                )
    if given.output is not None:
        given.output.parent.mkdir(parents=True, exist_ok=True)
        given.output.write_text(json.dumps(report, indent=1, allow_nan=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
