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
