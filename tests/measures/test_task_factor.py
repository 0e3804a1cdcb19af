"""How far sets of loads may be scaled, against linear programs and the facets of what is balanced."""

from math import inf

import numpy as np
import pytest
from scipy.optimize import linprog

import regrasp as rg
from cones import edges

pytestmark = pytest.mark.oracle


def test_task_factor() -> None:
    """The largest k for which every corner of a hull is held, by a program over all k at once for each."""
    grasp = rg.Grasp(
        [rg.Contact([2, 0.21], [-0.95, -0.31], 0.3), rg.Contact([-0.52, 2.9], [0.51, -0.86], 0.5)]
    )
    held = rg.Wrench.from_vector(-edges(grasp) @ np.array([1.0, 1.3, 0.9, 1.1]))
    corners = [
        held + rg.Wrench([0.1, 0.2], 0.1),
        held + rg.Wrench([-0.2, 0.1]),
        held - rg.Wrench([0.1, 0.1], 0.2),
    ]
    loads = rg.LoadSet.hull(corners, center=held)
    table = rg.quality(grasp, loads=loads)
    e = edges(grasp)
    expected = inf
    for corner in corners:
        away = (corner - held).vector
        found = linprog([0] * 4 + [-1], A_eq=np.c_[e, away], b_eq=-held.vector)
        expected = min(expected, inf if found.status == 3 else -found.fun)
    assert 0 < expected < inf
    assert table["task_factor"].value == pytest.approx(expected, rel=1e-6)
    lower, upper = table["task_factor"].bounds
    assert lower <= expected * (1 + 1e-9)
    assert upper >= expected * (1 - 1e-9)
    lifted = rg.Grasp([rg.Contact([0, 1], [0, -1], 0.1), rg.Contact([0.1, 1], [0, -1], 0.1)])
    away = rg.LoadSet.hull([rg.Wrench([0, -1]), rg.Wrench([1, -1])])
    assert rg.quality(lifted, loads=away)["task_factor"].value == 0
    with pytest.raises(rg.InvalidInput, match="LoadSet of the grasp's dimension"):
        rg.quality(grasp, loads=rg.Wrench([0, -1]))


@pytest.mark.parametrize("kind", ["ball", "line", "tilted"])
def test_task_factor_of_round_sets(kind: str) -> None:
    """No member of the set scaled by the lower bound is dropped, some of it scaled by the upper one is."""
    grasp, weight = rg.Grasp(rg.Contact([x, -1], [0, 1], 0.6) for x in (-1.0, 1.2)), rg.Wrench([0, -3], 0.2)
    loads = {
        "ball": rg.LoadSet.ball(weight, force=0.4, torque=0.7),
        "line": rg.LoadSet.ellipsoid(weight, [[0.3], [0.1], [0.2]]),
        "tilted": rg.LoadSet.tilted(weight, 0.2),
    }[kind]
    found = rg.quality(grasp, loads=loads, gap=1e-3)["task_factor"]
    lower, upper = found.bounds
    assert 0 < lower == found.value <= upper <= lower * (1.03 if kind == "tilted" else 1.0011)
    twists = np.random.default_rng(1).normal(size=(1500, 3))
    e = edges(grasp)
    bound = np.array([np.cross(a, b) for a in e.T for b in e.T])
    bound = bound[(bound @ e >= -1e-12).all(axis=1) & bound.any(axis=1)]  # y . w <= 0 holds what is balanced

    def outside(factor: float) -> float:
        wrenches = np.array([loads.scaled(factor).extreme(y).vector for y in [*twists, *bound]])
        return float((wrenches @ bound.T).max())

    assert outside(lower * (1 - 1e-9)) < 0 < outside(upper * (1 + 1e-6))


def test_task_factor_without_an_end_and_of_a_point() -> None:
    facing = rg.Grasp(rg.Contact([x, 0], [-x, 0], 0.5) for x in (-1.0, 1.0))
    ball, point = (rg.LoadSet.ball(rg.Wrench([0, -1]), force=r) for r in (0.5, 0.0))
    assert rg.quality(facing, loads=ball)["task_factor"].bounds == (inf, inf)
    assert rg.quality(facing, loads=point)["task_factor"].value == inf
    floor = rg.Grasp([rg.Contact([0, -1], [0, 1], 0.5)])
    assert rg.quality(floor, loads=rg.LoadSet.ball(rg.Wrench([0, 1])))["task_factor"].value == 0
