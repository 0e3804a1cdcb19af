"""The next best regrasp is the best without the moves that have no way: against exhaustive search."""

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from exhaustive import least_cost
from regrasp.motions import ShutIn
from regrasp.motions.stands import stops
from regrasp.planning.regrasps.problem import RegraspProblem

pytestmark = pytest.mark.oracle

AIR = {"motions": True, "tip_radius": 1e-6, "clearance": 1e-6, "attempts": 1000}
SHARES = {2: (0.1, 0.5, 0.95), 3: (0.1, 0.3, 0.2)}
Move = tuple[str, str, frozenset[str]]


def moves(plan: rg.RegraspPlan) -> list[Move]:
    """From where to where a finger goes, and who holds meanwhile."""
    found = []
    for before, after in pairwise(stops(plan, plan.steps)):
        for (origin, _), (target, _) in zip(before, after, strict=True):
            if origin != target:
                held = frozenset(
                    a for (a, on), (b, and_on) in zip(before, after, strict=True) if a == b and on
                )
                found.append((origin, target, held))
    return found


def shut(origin: str, target: str, held: frozenset[str]) -> ShutIn:
    nowhere = np.array([np.inf])  # at neither end
    return ShutIn(0, 0, target, nowhere, origin, target, tuple(sorted(held)), alone=False)


def problem_in(dimension: int, rng: np.random.Generator) -> tuple[Any, rg.Grasp, rg.Grasp, rg.Wrench, dict]:
    if dimension == 2:
        shape: Any = rg.Outline.ellipse(0.04, 0.03)
        start, goal = (
            rg.Grasp(shape.contact_at(x * shape.length, friction=1.5) for x in rng.uniform(size=3))
            for _ in range(2)
        )
        return shape, start, goal, rg.Wrench([0, -1.0]), {"candidates": 3}
    shape = rg.Mesh.box(0.08, 0.06, 0.05)
    start, goal = (rg.Grasp(shape.contacts(4, friction=0.9, seed=int(rng.integers(1000)))) for _ in range(2))
    return shape, start, goal, rg.Wrench([0, 0, -1.0]), {"candidates": 2}


@pytest.mark.parametrize(("dimension", "count"), [(2, 24), (3, 9)])
def test_the_best_that_has_ways_is_taken(dimension: int, count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(10 + dimension)
    seen = {"best": 0, "next": 0, "none": 0}
    for k in range(count):
        shape, start, goal, load, more = problem_in(dimension, rng)
        options = {"friction": 0.8, "orientations": 3, "min_normal": 0, "min_distance": 3e-6, **more}
        problem = RegraspProblem(shape, start, goal, load, **options)
        names = [str(c.name) for c in problem.contacts]
        closed: dict[Any, bool] = {}

        def goes(a: int, b: int, held: Any, share=SHARES[dimension][k % 3], closed=closed) -> bool:
            return not closed.setdefault((frozenset((a, b)), frozenset(held)), bool(rng.uniform() < share))

        def with_ways(plan: Any, *_: Any, goes=goes, names=names, **__: Any) -> Any:
            for origin, target, held in moves(plan):
                if not goes(names.index(origin), names.index(target), map(names.index, held)):
                    raise rg.Infeasible("no way", shut(origin, target, held))
            return SimpleNamespace(plan=plan)

        monkeypatch.setattr("regrasp.motions.plan.plan_motions", with_ways)
        try:
            best = rg.plan_regrasp(shape, start, goal, load, **options)
        except rg.Infeasible:
            continue
        ends = problem.graph, problem.places[0], problem.places[1], problem.places[2], problem.largest_turn
        fewest = least_cost(*ends, goes=goes)
        if fewest is None:
            with pytest.raises(rg.Infeasible, match="none has ways; without such moves no sequence of holds"):
                rg.plan_regrasp(shape, start, goal, load, **AIR, **options)
            seen["none"] += 1
            continue
        found: Any = rg.plan_regrasp(shape, start, goal, load, **AIR, **options).plan
        assert len(found.moves) == fewest
        if dimension == 2:  # in space holds are judged in inner pyramids, plans in whole cones
            assert least_cost(*ends, goes=goes, threshold=found.margin - 2e-6) == fewest
        wider = least_cost(*ends, goes=goes, threshold=found.margin + 2e-6)
        assert wider is None or wider > fewest
        seen["best" if best == found else "next"] += 1
    assert min(seen["best"], seen["next"]) >= 1, seen
    assert seen["none"] >= 1 or dimension == 3
