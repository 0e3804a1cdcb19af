"""Starts of three fingers with little friction, against all triples of middles of sides by exact programs."""

from itertools import combinations
from math import inf

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.placement.laws import law_of
from regrasp.planning.placement.levels.level import FrictionLevel
from regrasp.planning.placement.levels.starts import little_friction
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.search import Search

pytestmark = pytest.mark.oracle

FRICTION, LIMIT = 0.4, 4.0
ANGLES = np.repeat(np.arange(6) * np.pi / 3, 2)


def searched(shape: rg.Outline, torque: float) -> Search:
    sides = sides_of(shape, 0.0, None, 0.0, False)
    loads = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), torque * np.tile([1.0, -1.0], 6)])
    return Search(sides, 3, FRICTION, loads, law_of("friction_use")[1], 1e-6, 1e-3, (inf, 0.0))


@pytest.mark.parametrize("count", [11, 12])
def test_the_best_start_is_the_best_of_all_middles(count) -> None:
    rng = np.random.default_rng(count)
    around = 2 * np.pi * (np.arange(count) + 0.5 * rng.random(count)) / count
    shape = rg.Outline(np.column_stack([np.cos(around), np.sin(around)]) * rng.uniform(0.9, 1.1, (count, 1)))
    search, level = searched(shape, 0.02), FrictionLevel(LIMIT, FRICTION, angle=False)

    def use(places: np.ndarray) -> float:
        return level.of(search, places, search.sides.ends[places].mean(axis=1))

    starts = little_friction(search, LIMIT, FRICTION)
    found = [use(places) for places, _ in starts]
    every = [use(np.array(few)) for few in combinations(range(count), 3)]
    assert found[0] <= 1.05 * np.nanmin(every)
    assert found[0] < 0.3


def test_none_where_no_three_normals_balance() -> None:
    """On a square normals are opposite, and a third finger has no share."""
    assert little_friction(searched(rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]]), 0.1), 4.0, 0.4) == []


def test_a_search_starts_there_and_ends_as_without(monkeypatch) -> None:
    corners = ((1.0, 0.6), (-0.9, 0.0), (-0.4, -0.9))
    loads = rg.LoadSet.hull([rg.Wrench(at, turn) for at in corners for turn in (0.05, -0.05)])
    found = []
    for many in 1000, 2:
        monkeypatch.setattr("regrasp.planning.placement.levels.searching.MANY", many)
        chosen = rg.choose_grasp(
            rg.Outline(corners), 3, loads, friction=0.4, objective="friction_use", max_force=4, tolerance=1e-2
        )
        assert chosen.gap <= 1e-2
        assert rg.verify(chosen).ok
        found.append(chosen)
    assert found[1].value >= found[0].bound
    assert found[0].value >= found[1].bound


def test_where_no_friction_is_needed_nothing_is_searched(monkeypatch) -> None:
    monkeypatch.setattr("regrasp.planning.placement.levels.searching.MANY", 2)
    shape = rg.Outline([[-2, -1], [2, -1], [0, 2]])
    for objective in "friction_use", "angle":
        chosen = rg.choose_grasp(
            shape, 3, rg.Wrench([0, -1]), friction=0.4, objective=objective, max_force=30
        )
        assert chosen.gap <= 1e-3
        assert rg.verify(chosen).ok


@pytest.mark.parametrize("friction", [0.0, 1e-12])
@pytest.mark.parametrize("fingers", [2, 3])
def test_normals_of_a_circle_make_no_torque(fingers: int, friction: float) -> None:
    """Fingers pass its centre by: a load that does not is held by none, which is proven at once."""
    circle = rg.Outline.ellipse(1, 1)
    with pytest.raises(rg.Infeasible, match=r"not by forces of 1.02e\+06 N either") as refused:
        rg.choose_grasp(circle, fingers, rg.Wrench([0, -1], 0.02), friction=friction, objective="peak")
    assert rg.verify(refused.value.certificate).ok
    assert len(refused.value.certificate.children) < 10


@pytest.mark.parametrize(
    ("objective", "height", "friction"),
    [("effort", 0.01, 0.0), ("effort", 0.003, 0.3), ("sum_normal", 0.01, 0.3)],
)
def test_two_fingers_at_the_ends_of_a_flat_ellipse(objective: str, height: float, friction: float) -> None:
    """They push up along normals that turn within a hundredth of the length."""
    flat = rg.Outline.ellipse(2, height)
    found = rg.choose_grasp(flat, 2, rg.Wrench([0, -1], 0.04), friction=friction, objective=objective)
    assert found.gap <= 1e-3
    assert rg.verify(found).ok


def test_set_points_that_withstand_by_rounding_alone_withstand_nothing() -> None:
    """Without friction a deviation's part along a side is left: cones of 1e-12 took a factor of 2e-11."""
    half = np.arange(16) * np.pi / 8
    star = np.where(np.arange(16) % 2, 0.02, 1.0)[:, None] * np.column_stack([np.cos(half), np.sin(half)])
    deviations = rg.LoadSet.hull([rg.Wrench([0.3, 0]), rg.Wrench([-0.3, 0]), rg.Wrench([0, 0], 0.1)])
    found = rg.choose_grasp(
        rg.Outline(star), 3, rg.Wrench([0, -1]), friction=1e-12, objective="wrench", max_force=3,
        disturbance=deviations, from_corners=0.0, most_boxes=200, tolerance=1e-2,
    )  # fmt: skip
    assert found.value == 0
    assert rg.verify(found).ok
