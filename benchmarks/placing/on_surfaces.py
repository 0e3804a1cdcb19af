"""Fingers on meshes: the certified search beside its rivals, and random placements that attack what it says.

    python benchmarks/placing/on_surfaces.py [--only bracket] [--attacks 100000] [--seconds 10]
    python benchmarks/placing/on_surfaces.py --only pebble --attacks 3000  # alone, for what its memory is
    python benchmarks/placing/on_surfaces.py --table

Rivals and attacks judge placements by the search's own compiled norm; an attack that seems to beat the bound
is judged again by a cone program (cvxpy), and counts if that says so, too. The integer program (HiGHS) sees
inner pyramids of eight facets. With --write the rows are kept in benchmarks/results, beside those of others.
"""

import argparse
import json
import sys
from collections.abc import Callable
from itertools import combinations
from math import inf
from pathlib import Path
from resource import RUSAGE_SELF, getrusage
from time import perf_counter, process_time
from typing import Any

import cvxpy as cp
import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp, minimize

import regrasp as rg
from regrasp.closed_form.compiled.patches.patch_search import spare
from regrasp.closed_form.compiled.patches.patch_slide import slide
from regrasp.mesh import parts
from regrasp.planning.placement.laws import LAWS

sys.path.append(str(Path(__file__).parents[2] / "tests" / "given"))
from solids import pebble

BRACKET, BOX, PEBBLE = parts.bracket(), rg.Mesh.box(0.04, 0.03, 0.05), pebble(158)
SIX = [[0, 0, -1.8, 0, 0, 0]] + [[x, y, -1.8, 0, 0, 0] for x, y in ((0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5))]
SIX = np.array([*SIX, [0, 0, -1.8, 0.005, 0, 0]])
THREE = np.array([[0, 0, -2, 0, 0, 0], [1.5, 0, -1, 0, 0, 0], [0, -1, -1, 0, 0.01, 0]])
CASES = [
    ("bracket, 6 loads", BRACKET, SIX, 0.6, k, o) for k in (3, 4) for o in ("peak", "sum_normal", "effort")
]
CASES += [("bracket, 6 loads", BRACKET, SIX, 0.6, 3, "peak_normal")]
CASES += [("box, 3 loads", BOX, THREE, 0.5, 3, o) for o in ("peak", "sum_normal")]
CASES += [("pebble of 49,612 faces, 6 loads", PEBBLE, SIX, 0.6, 3, "peak")]
RESULTS = Path(__file__).parents[1] / "results" / "placement_in_space.json"
Judge = Callable[[np.ndarray], float]


class Surface:
    """Points of a mesh, at random or evenly."""

    def __init__(self, mesh: rg.Mesh) -> None:
        points, faces = mesh.surface()
        self.corners = points[faces]
        cross = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        self.areas = np.linalg.norm(cross, axis=1)
        self.normals = -cross / self.areas[:, None]
        self.share = self.areas / self.areas.sum()
        self.size = float(np.linalg.norm(points, axis=1).max())

    def random(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """(count, 6) points and inward normals."""
        on = rng.choice(len(self.share), count, p=self.share)
        weights = rng.dirichlet(np.ones(3), count)
        return np.hstack([np.einsum("ij,ijk->ik", weights, self.corners[on]), self.normals[on]])

    def onto(self, point: np.ndarray, start: np.ndarray) -> np.ndarray:
        """A point of the plane of a face, within the face nearest to it."""
        flat = np.abs((self.corners[:, 0] - start[:3]) @ start[3:]) < 1e-9 * self.size
        flat &= np.linalg.norm(self.normals - start[3:], axis=1) < 1e-9
        best = min((np.linalg.norm(_foot(c, point) - point), i) for i, c in enumerate(self.corners[flat]))[1]
        return np.append(_foot(self.corners[flat][best], point), start[3:])


def _foot(corners: np.ndarray, p: np.ndarray) -> np.ndarray:
    a, b, c = corners
    w = np.linalg.lstsq(np.column_stack([b - a, c - a]), p - a, rcond=None)[0]
    if w.min() >= 0 and w.sum() <= 1:
        return a + w[0] * (b - a) + w[1] * (c - a)
    feet = []
    for u, v in ((a, b), (b, c), (c, a)):
        t = np.clip((p - u) @ (v - u) / ((v - u) @ (v - u)), 0, 1)
        feet.append(u + t * (v - u))
    return min(feet, key=lambda q: float(np.linalg.norm(q - p)))


def judge_of(surface: Surface, loads: np.ndarray, friction: float, objective: str, fingers: int) -> Judge:
    """The norm that fingers at spots (k, 6) need for the worst load, infinite where they hold none."""
    unit = np.repeat([1.0, surface.size], 3)
    top = np.abs(loads / unit).max()
    wanted, memory = np.ascontiguousarray(-loads / unit / top), spare(fingers)
    law = (friction, *LAWS[objective].codes(), 1e-6)
    power = LAWS[objective].power

    def value(spots: np.ndarray) -> float:
        scaled = np.ascontiguousarray(spots / surface.size)
        scaled[:, 3:] = spots[:, 3:]
        found = slide(
            scaled, 0, wanted, law, 1e-6, 0.0, 1.0, scaled, inf, scaled.copy(), np.zeros((2, 3)),
            np.zeros_like(wanted), memory,
        )  # fmt: skip
        return float((found * top) ** power) if found < 1e3 else inf

    return value


def by_cones(surface: Surface, loads: np.ndarray, friction: float, objective: str) -> Judge:
    """The same by a cone program for each load."""

    def least(spots: np.ndarray, load: np.ndarray) -> float:
        f = cp.Variable((len(spots), 3))
        along = cp.sum(cp.multiply(f, spots[:, 3:]), axis=1)
        across = f - cp.multiply(cp.reshape(along, (len(spots), 1), order="C"), spots[:, 3:])
        moments = [np.cross(p, np.eye(3)).T for p in spots[:, :3]]  # r x f
        turned = sum(m @ row for m, row in zip(moments, f, strict=True)) / surface.size
        wanted = -load / np.repeat([1.0, surface.size], 3)
        cost = {
            "peak": cp.max(cp.norm(f, axis=1)), "sum_normal": cp.sum(along), "peak_normal": cp.max(along),
            "effort": cp.sum_squares(f),
        }  # fmt: skip
        rules = [
            cp.norm(across, axis=1) <= friction * along,
            cp.hstack([cp.sum(f, axis=0), turned]) == wanted,
        ]
        return float(cp.Problem(cp.Minimize(cost[objective]), rules).solve(solver=cp.CLARABEL))

    return lambda spots: max(least(spots, load) for load in loads)


def attack(
    surface: Surface, judge: Judge, again: Judge, fingers: int, count: int, bound: float
) -> tuple[float, int]:
    """The best of random placements, a tenth of them near the best so far, and how many beat the bound."""
    rng, best, at, beaten = np.random.default_rng(5), inf, None, 0
    for number in range(count):
        spots = surface.random(rng, fingers)
        if at is not None and number % 10 == 0:
            step = surface.size * 10.0 ** rng.uniform(-4, -0.5)
            kept = rng.random(fingers) < 0.5
            near = [surface.onto(s[:3] + step * rng.normal(size=3), s) for s in at]
            spots = np.where(kept[:, None], at, np.array(near))
        value = judge(spots)
        if value < bound * (1 - 1e-6) and again(spots) < bound * (1 - 1e-6):
            beaten += 1
        if value < best:
            best, at = value, spots
    return best, beaten


def random_search(surface: Surface, judge: Judge, fingers: int, seconds: float) -> float:
    rng, best, begin = np.random.default_rng(0), inf, perf_counter()
    while perf_counter() - begin < seconds:
        best = min(best, judge(surface.random(rng, fingers)))
    return best


def all_of_sampled(surface: Surface, judge: Judge, fingers: int, points: int, seconds: float) -> float:
    spots, best, begin = surface.random(np.random.default_rng(1), points), inf, perf_counter()
    for few in combinations(range(points), fingers):
        best = min(best, judge(spots[list(few)]))
        if perf_counter() - begin > seconds:
            break
    return best


def multi_start(surface: Surface, judge: Judge, fingers: int, seconds: float) -> float:
    rng, best, begin = np.random.default_rng(0), inf, perf_counter()
    while perf_counter() - begin < seconds:
        start = surface.random(rng, fingers)
        if judge(start) == inf:
            continue

        def moved(x: np.ndarray, start: np.ndarray = start) -> float:
            spots = [
                surface.onto(s[:3] + surface.size * d, s)
                for s, d in zip(start, x.reshape(-1, 3), strict=True)
            ]
            return min(judge(np.array(spots)), 1e6)

        found = minimize(moved, np.zeros(3 * fingers), method="Nelder-Mead", options={"maxfev": 300})
        best = min(best, found.fun)
    return best


def integer_program(
    surface: Surface, loads: np.ndarray, friction: float, fingers: int, points: int, seconds: float, law: str
) -> float:
    """Which of some points, and forces for each load, by HiGHS: least peak or sum of normal forces."""
    spots = surface.random(np.random.default_rng(1), points)
    turns = np.arange(8) * np.pi / 4
    G = []
    for p, n in zip(spots[:, :3], spots[:, 3:], strict=True):
        u = np.cross(n, np.eye(3)[np.argmin(abs(n))])
        u /= np.linalg.norm(u)
        for t in turns:
            f = n + friction * (np.cos(t) * u + np.sin(t) * np.cross(n, u))
            G.append([*f, *np.cross(p, f)])
    matrix, width, m = np.array(G).T, 8 * points, len(loads)
    size = 1 + points + m * width
    unit = np.repeat([1.0, surface.size], 3)
    rows = [np.concatenate([[0.0], np.ones(points), np.zeros(m * width)])[None]]
    low, high = [np.array([0.0])], [np.array([float(fingers)])]
    length = 1.0 if law == "sum_normal" else np.hypot(1, friction)
    for k, load in enumerate(loads):
        at = slice(1 + points + k * width, 1 + points + (k + 1) * width)
        balance, switch = np.zeros((6, size)), np.zeros((points, size))
        balance[:, at] = matrix / unit[:, None]
        each = np.kron(np.eye(points), np.ones(8))
        switch[:, at], switch[:, 1 : 1 + points] = each, -10.0 * np.eye(points)
        least = np.zeros((1 if law == "sum_normal" else points, size))
        least[:, at], least[:, 0] = (each.sum(axis=0) if law == "sum_normal" else each * length), -1
        rows += [balance, switch, least]
        low += [-load / unit, np.full(points, -inf), np.full(len(least), -inf)]
        high += [-load / unit, np.zeros(points), np.zeros(len(least))]
    upper, kinds, cost = np.full(size, inf), np.zeros(size), np.zeros(size)
    upper[1 : 1 + points], kinds[1 : 1 + points], cost[0] = 1, 1, 1
    found = milp(
        cost, constraints=LinearConstraint(np.vstack(rows), np.concatenate(low), np.concatenate(high)),
        integrality=kinds, bounds=Bounds(np.zeros(size), upper), options={"time_limit": seconds},
    )  # fmt: skip
    return inf if found.x is None else float(found.fun)


def table(kept: dict[str, dict[str, Any]]) -> str:
    """A line for each case, of rows that are kept; rivals by how much they are worse than the value."""
    rivals = ("random", "all of 60 points", "multi-start", "integer program, 20 points")
    names = ["mesh, fingers, objective", "value", "clock", "of a processor", "gap", "boxes", "`verify`"]
    names += ["attacks", "best attack", "below the bound", *rivals]
    lines = [f"| {' | '.join(names)} |", f"|---{'|--:' * (len(names) - 1)}|"]
    for key, row in kept.items():
        used = f"{row['processor_seconds']:.1f} s" if "processor_seconds" in row else ""
        worse = [row["rivals"].get(rival) for rival in rivals]
        shown = ["" if w is None else f"{w / row['value'] - 1:+.1%}" for w in worse]
        lines.append(
            f"| {key} | {row['value']:.5g} | {row['seconds']:.1f} s | {used} | {row['gap']:.2%} | "
            f"{row['boxes']:,} | {row['verify_seconds']:.1f} s | {row['attacks']:,} | "
            f"{row['best_attack'] / row['value'] - 1:+.2%} | {row['below_bound']} | {' | '.join(shown)} |"
        )
    return "\n".join(lines)


def main() -> None:
    """A row of the table for each case."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--attacks", type=int, default=100_000)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--table", action="store_true")
    given, rows = parser.parse_args(), {}
    if given.table:
        print(table(json.loads(RESULTS.read_text())))
        return
    rg.choose_grasp(BOX, 3, rg.Wrench([0, 0, -1]), friction=0.5, tolerance=0.5)
    for name, mesh, loads, friction, fingers, objective in CASES:
        if given.only not in f"{name}, {fingers} fingers, {objective}":
            continue
        begin, worked = perf_counter(), process_time()
        asked = rg.LoadSet.hull(rg.Wrench.from_vector(w) for w in loads)
        chosen = rg.choose_grasp(
            mesh, fingers, asked, friction=friction, objective=objective, tolerance=0.01, from_corners=0.0,
            most_boxes=None if mesh is PEBBLE else 400_000,
        )  # fmt: skip
        took, worked, begin = perf_counter() - begin, process_time() - worked, perf_counter()
        memory = getrusage(RUSAGE_SELF).ru_maxrss / 1024
        verdict = rg.verify(chosen)
        checked = perf_counter() - begin
        with_verify = getrusage(RUSAGE_SELF).ru_maxrss / 1024
        surface = Surface(mesh)
        judge = judge_of(surface, loads, friction, objective, fingers)
        again = by_cones(surface, loads, friction, objective)
        best, beaten = attack(surface, judge, again, fingers, given.attacks, chosen.bound)
        rivals = {
            "random": random_search(surface, judge, fingers, given.seconds),
            "all of 60 points": all_of_sampled(surface, judge, fingers, 60, 3 * given.seconds),
            "multi-start": multi_start(surface, judge, fingers, given.seconds),
        }
        if objective in ("peak", "sum_normal"):
            rivals["integer program, 20 points"] = integer_program(
                surface, loads, friction, fingers, 20, 3 * given.seconds, objective
            )
        value = chosen.value
        rows[f"{name}, {fingers} fingers, {objective}"] = {
            "seconds": took, "processor_seconds": worked,
            "value": value, "bound": chosen.bound, "gap": chosen.gap,
            "boxes": len(chosen.certificate.boxes), "verified": verdict.ok, "verify_seconds": checked,
            "peak_memory_mb": memory, "with_verify_mb": with_verify,
            "attacks": given.attacks, "best_attack": best, "below_bound": beaten, "rivals": rivals,
        }  # fmt: skip
        shown = ", ".join(f"{rival} {found / value - 1:+.1%}" for rival, found in rivals.items())
        print(f"{name}, {fingers} fingers, {objective}: {value:.5g}, gap {chosen.gap:.2%},")
        print(f"  in {took:.2f} s, {worked:.2f} s of processor, at most {memory:.0f} MB,")
        print(f"  {len(chosen.certificate.boxes)} boxes, verified {verdict.ok} in {checked:.2f} s")
        print(
            f"  {given.attacks} attacks: best {best / value - 1:+.2%}, {beaten} below the bound; {shown}",
            flush=True,
        )
        if given.write:
            kept = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
            RESULTS.write_text(json.dumps(kept | rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
