"""Constraints on chosen grasps against all pairs of 60 points and triples of 24 that keep them.

    python benchmarks/placing/brute_constraints.py [--tasks 100] [--first 0] [--cap 10] [--seconds 300]
    python benchmarks/placing/brute_constraints.py --table

Random polygons, loads, frictions and objectives, each with one constraint or two of ``max_force``,
``min_normal``, ``keep``, ``removable``, ``min_distance``, ``from_corners``, ``arcs`` and ``tip_radius``.
Which samples keep them is decided here; forces with least normals come from linear programs, all others from
``choose_states``. A row is kept when it is done, so that a run goes on where it was ended.
"""

import argparse
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

import regrasp as rg
from brute_force import LIMIT
from fifty_outlines import polygon
from kept_rows import keep, rows_in, short
from placement_outlines import within
from sampled_places import LARGEST, Places, Task, best, least, norms, points_of

Array = np.ndarray
NORMS = ("sum_normal", "peak_normal", "peak", "effort")
LEVELS = ("friction_use", "angle", "force", "answered")
GEOMETRIC = ("min_distance", "from_corners", "arcs", "tip_radius")
OTHERS = ("max_force", "min_normal", "keep", "removable")
POINTS = {2: 60, 3: 24}
ROUNDING = 1e-6
ENOUGH = 500.0  # times the loads, forces of those that stay: half of what is allowed
RESULTS = Path(__file__).parents[1] / "results" / "brute_constraints.json"


class Drawn:
    """A random task: what is asked of the search, and the same for samples."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.outline = polygon(rng, int(rng.integers(4, 13)))
        self.fingers = int(rng.integers(2, 4))
        self.mu = float(rng.choice([0.2, 0.4, 0.7]))
        of_norms = seed % 3 > 0
        self.objective = str(rng.choice(NORMS if of_norms else LEVELS))
        reach = float(np.linalg.norm(self.outline.polygon(), axis=1).max())
        self.reach = reach
        loads = np.column_stack(
            [rng.uniform(-0.5, 0.5, 3), np.full(3, -1.0), rng.uniform(-0.2, 0.2, 3) * reach]
        )
        self.loads = loads[: int(rng.integers(1, 4))]
        self.deviations: Array | None = None
        limit = np.inf if of_norms else LIMIT
        self.asked: dict[str, Any] = {} if of_norms else {"max_force": limit}
        if self.objective == "answered":
            self.loads = self.loads[:1]
            self.deviations = np.array([[0.3, 0, 0], [-0.3, 0, 0], [0, 0, 0.1 * reach], [0, 0, -0.1 * reach]])
            self.asked["disturbance"] = rg.LoadSet.hull(map(rg.Wrench.from_vector, self.deviations))
        names = [*GEOMETRIC, *(OTHERS if of_norms else ())]
        if self.fingers == 2 and of_norms:
            names.remove("removable")
        self.names = sorted(rng.choice(names, 1 + int(rng.random() < 0.3), replace=False))
        self.corners, self.arcs, self.radius, self.apart, self.min_normal = 0.0, None, 0.0, 0.0, 0.0
        self.far, length = np.inf, self.outline.length
        for name in self.names:
            if name == "max_force":
                limit = self.asked[name] = float(rng.uniform(0.6, 2.0))
            elif name == "min_normal":
                self.min_normal = self.asked[name] = float(rng.uniform(0.1, 0.5))
            elif name == "keep":
                self.far = float(rng.uniform(0.8, 1.6)) * reach
                self.asked[name] = self.near
            elif name == "removable":
                self.asked[name] = True
            elif name == "min_distance":
                self.apart = self.asked[name] = float(rng.uniform(0.3, 1.2)) * reach
            elif name == "from_corners":
                sides = np.hypot(*(np.roll(self.outline.polygon(), -1, axis=0) - self.outline.polygon()).T)
                self.corners = float(rng.uniform(0.1, 0.4) * sides.min())
            elif name == "arcs":
                ends = np.sort(rng.uniform(0, length, 4))
                self.arcs = ends.reshape(2, 2)
                self.asked[name] = self.arcs.tolist()
            elif name == "tip_radius":
                self.radius = self.asked[name] = float(rng.uniform(0.02, 0.3)) * reach
        self.asked["from_corners"] = self.corners
        self.task = Task(self.objective, self.mu, self.loads, limit, self.deviations)

    def near(self, first: Array, second: Array, _angle: float) -> Array:
        """What ``keep`` is: (m,) which are near."""
        return np.hypot(*(first - second).T) <= self.far

    def chosen(self, progress: Any) -> rg.ChosenGrasp:
        """What the search makes of it."""
        loads = rg.LoadSet.hull(map(rg.Wrench.from_vector, self.loads))
        load = rg.Wrench.from_vector(self.loads[0]) if len(self.loads) == 1 else loads
        return rg.choose_grasp(
            self.outline, self.fingers, load, friction=self.mu, objective=self.objective, progress=progress,
            **self.asked,
        )  # fmt: skip

    def allowed(self, points: Array, normals: Array, s: Array, slack: float) -> Array:
        """(m,) places where a finger may be."""
        ring = self.outline.polygon()
        along = np.roll(ring, -1, axis=0) - ring
        length = np.hypot(*along.T)
        start = np.cumsum(length) - length
        away = np.abs(s[:, None] - start)
        good = np.minimum(away, length.sum() - away).min(axis=1) >= self.corners - slack
        if self.arcs is not None:
            good &= ((s[:, None] >= self.arcs[:, 0] - slack) & (s[:, None] <= self.arcs[:, 1] + slack)).any(
                axis=1
            )
        middle = points - self.radius * normals  # of a round tip
        to = middle[:, None] - ring
        share = np.clip((to * along).sum(axis=2) / length**2, 0, 1)
        nearest = np.hypot(*(to - share[..., None] * along).transpose(2, 0, 1)).min(axis=1)
        result: Array = good & (nearest >= self.radius - slack)
        return result

    def together(self, places: Places, slack: float) -> Array:
        """(m,) placements whose fingers are neither too near nor too far."""
        good = np.ones(len(places.positions), bool)
        for a, b in combinations(range(self.fingers), 2):
            away = np.hypot(*(places.positions[:, a] - places.positions[:, b]).T)
            good &= (away >= max(self.apart, 1e-6 * self.reach) - slack) & (away <= self.far + slack)
        return good

    def one_can_leave(self, p: Array, n: Array, times: float) -> bool:
        """Whether the others hold all loads by forces within the limit, or within so many times the loads."""
        limit = min(self.task.limit, times * float(np.abs(self.loads).max()))
        task = self.task._replace(objective="peak", limit=limit)
        rest = [[i for i in range(self.fingers) if i != gone] for gone in range(self.fingers)]
        return bool((norms(Places(p[rest], n[rest]), task, whole=True) < np.inf).any())

    def value(self, p: Array, n: Array) -> float:
        """Of one placement, with least normals; infinite for none."""
        return max(
            least(p, n, self.mu, load, self.objective, self.task.limit, self.min_normal)
            for load in self.loads
        )


def sampled(drawn: Drawn) -> tuple[float, bool]:
    """The best of the samples that keep everything, and whether some do."""
    points, normals = points_of(drawn.outline, POINTS[drawn.fingers])
    s = (np.arange(len(points)) + 0.5) / len(points) * drawn.outline.length
    there = np.flatnonzero(drawn.allowed(points, normals, s, 1e-12))
    few = np.array(list(combinations(there, drawn.fingers)), dtype=int).reshape(-1, drawn.fingers)
    places = Places(points[few], normals[few])
    places = places.some(np.flatnonzero(drawn.together(places, 0.0)))
    if drawn.objective not in NORMS or not len(places.positions):
        return best(places, drawn.task) if len(places.positions) else (0.0, False)
    values = norms(places, drawn.task, whole=True)
    found = np.inf
    for i in np.argsort(values, kind="stable"):
        if values[i] >= found:
            break
        p, n = places.positions[i], places.normals[i]
        if "removable" in drawn.names and not drawn.one_can_leave(p, n, ENOUGH):
            continue
        found = min(found, drawn.value(p, n) if drawn.min_normal else float(values[i]))
    return found, bool(found < np.inf)


def row(seed: int, cap: float) -> dict[str, Any]:
    """A task, its samples and what the search says."""
    drawn = Drawn(seed)
    best_one, held = sampled(drawn)
    sign = -1 if drawn.objective in LARGEST else 1
    result: dict[str, Any] = {"what": f"{drawn.objective}, {drawn.fingers}: {', '.join(drawn.names)}"}
    result |= {"held": held, "best": best_one if held else None}
    begin = perf_counter()
    ended, progress = within(cap)
    try:
        chosen = drawn.chosen(progress)
    except (rg.Infeasible, KeyboardInterrupt, rg.InvalidInput) as refusal:
        if isinstance(refusal, KeyboardInterrupt) and not ended():
            raise
        lies = ["refused"] * held
        return result | {"refusal": str(refusal)[:80], "lies": lies, "seconds": perf_counter() - begin}
    result |= {
        "value": chosen.value,
        "bound": chosen.bound,
        "gap": chosen.gap,
        "seconds": perf_counter() - begin,
    }
    return result | {"lies": list(_lies(drawn, chosen, sign * best_one if held else np.inf, sign))}


def _lies(drawn: Drawn, chosen: rg.ChosenGrasp, sampled_one: float, sign: int) -> Iterator[str]:
    value, bound = sign * chosen.value, sign * chosen.bound
    size = max(abs(value), 1e-3)
    if sampled_one < bound - ROUNDING * size:
        yield "bound beaten"
    if not rg.verify(chosen).ok:
        yield "not verified"
    p, n = chosen.grasp.positions, chosen.grasp.normals
    slack = 1e-9 * drawn.reach
    if (
        not drawn.allowed(p, n, chosen.places, 10 * slack).all()
        or not drawn.together(Places(p[None], n[None]), slack).all()
    ):
        yield "constraint not kept"
    if "removable" in drawn.names and not drawn.one_can_leave(p, n, 2.1 * ENOUGH):
        yield "no finger can leave"
    for state in chosen.states:
        f = state.forces
        if (
            np.hypot(*f.T).max() > drawn.task.limit * (1 + 1e-8)
            or (f * n).sum(axis=1).min() < drawn.min_normal - 1e-8
        ):
            yield "limit not kept"
    again = (
        drawn.value(p, n)
        if drawn.objective in NORMS
        else best(Places(p[None], n[None]), drawn.task)[0] * sign
    )
    if abs(again - value) > ROUNDING * max(size, 0.1):
        yield "not what it says"


def table(kept: dict[str, Any]) -> str:
    """A line for each constraint."""
    lines = [
        "| constraint | tasks | some sample keeps it | answered | refused | though a sample holds | "
        "best sample is better by over 0.1 %, 1 % | by most [%] | refining buys, median [%] | lies |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for name in (*OTHERS, *GEOMETRIC):
        rows = [r for r in kept.values() if name in r["what"]]
        found = [r for r in rows if "value" in r and r["held"]]
        if not found:
            continue
        gains = np.array([gained(r) for r in found])
        wrong = [sum("refused" in r["lies"] for r in rows), sum(len(r["lies"]) for r in rows)]
        lines.append(
            f"| `{name}` | {len(rows)} | {sum(r['held'] for r in rows)} | "
            f"{sum('value' in r for r in rows)} | {sum('value' not in r for r in rows)} | {wrong[0]} | "
            f"{(gains < -0.1).sum()}, {(gains < -1).sum()} | {max(0.0, -gains.min()):.2f} | "
            f"{np.median(gains):.2f} | {wrong[1]} |"
        )
    return "\n".join(lines)


def gained(found: dict[str, Any]) -> float:
    """By how much the value is better than the best sample [%]."""
    sign = -1 if found["what"].split(",")[0] in LARGEST else 1
    return float(100 * sign * (found["best"] - found["value"]) / max(abs(found["value"]), 1e-3))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--cap", type=float, default=10.0, help="of a search, of processor time [s]")
    parser.add_argument("--seconds", type=float, default=np.inf, help="after which no other row is begun")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("-o", "--output", type=Path, default=RESULTS)
    given = parser.parse_args()
    kept = rows_in(given.output)
    if given.table:
        print(table(kept))
        return
    begin = perf_counter()
    for seed in range(given.first, given.first + given.tasks):
        if str(seed) in kept or perf_counter() - begin > given.seconds:
            continue
        found = row(seed, given.cap)
        keep(given.output, kept, str(seed), short(found))


if __name__ == "__main__":
    main()
