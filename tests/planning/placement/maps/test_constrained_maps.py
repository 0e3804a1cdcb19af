"""Maps of placements under constraints against forces and distances worked out here, cell by cell."""

from contextlib import suppress
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal

pytestmark = pytest.mark.oracle

BRACKET = rg.Outline(
    [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], holes=[[[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]]
)
HOLE = BRACKET.hole_polygons()[0][::-1]
LOADS = rg.LoadSet.hull([rg.Wrench([0, -1], 0.2), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1], -0.2)])


def contact(s: float) -> rg.Contact:
    """By hand in the hole, whose sides are 0.4 long."""
    if s < BRACKET.length:
        return BRACKET.contact_at(s, friction=0.5)
    side, along = divmod(s - BRACKET.length, 0.4)
    start = HOLE[int(side)]
    way = (HOLE[(int(side) + 1) % 4] - start) / 0.4
    return rg.Contact(start + along * way, [-way[1], way[0]], 0.5)


def apart(a: np.ndarray, b: np.ndarray, _: float) -> np.ndarray:
    """Fingers beside each other along x."""
    return np.abs(a[:, 0] - b[:, 0]) > 0.45


@pytest.mark.parametrize(
    ("objective", "given"),
    [
        ("sum_normal", {"max_force": 1.2, "min_normal": 0.2}),
        ("peak_normal", {"min_normal": 0.3}),
        ("peak", {"max_force": 3.0, "min_normal": 0.2}),
        ("effort", {"min_normal": 0.3, "in_holes": True}),
        ("friction_use", {"max_force": 2.0, "keep": apart}),
        ("peak", {"max_force": 0.8}),
    ],
)
def test_cells_keep_the_limits_of_forces(objective: str, given: dict[str, object]) -> None:
    found = rg.placement_map(BRACKET, LOADS, friction=0.5, objective=objective, count=14, **given)  # type: ignore[arg-type]
    assert LOADS.vertices is not None
    limits = {name: given[name] for name in ("max_force", "min_normal") if name in given}
    held = 0
    for i, j in combinations(range(len(found.places)), 2):
        both = rg.Grasp([contact(float(found.places[n])) for n in (i, j)])
        value = np.nan
        if found.allowed[i, j]:
            with suppress(rg.Infeasible):
                value = max(
                    rg.choose_state(both, rg.Wrench.from_vector(w), objective, **limits).value  # type: ignore[arg-type]
                    for w in LOADS.vertices
                )
        held += not np.isnan(value)
        for cell in (found.values[i, j], found.values[j, i]):
            assert cell == pytest.approx(value, rel=3e-5, abs=1e-6, nan_ok=True)
    assert held > 1


def test_constraints_let_fingers_be_where_they_say() -> None:
    def allowed(**given: object) -> tuple[np.ndarray, np.ndarray]:
        found = rg.placement_map(BRACKET, LOADS, friction=0.5, count=28, **given)  # type: ignore[arg-type]
        assert np.isnan(found.values[~found.allowed]).all()
        return found.places, found.allowed

    def pairs(single: np.ndarray) -> np.ndarray:
        return single[:, None] & single & ~np.eye(len(single), dtype=bool)

    s, found = allowed()
    at = BRACKET.points(s)
    assert (found == pairs(np.ones(len(s), bool))).all()
    _, found = allowed(arcs=[(1, 5), (13, 14.5)])
    assert (found == pairs(((s > 1) & (s < 5)) | (s > 13) | (s < 0.5))).all()
    _, found = allowed(from_corners=0.3)
    assert (found == pairs(np.abs(s[:, None] - [0, 4, 5, 8, 10, 11, 14]).min(axis=1) > 0.3)).all()
    _, found = allowed(tip_radius=0.6)
    assert (found == pairs(np.abs(s - 8) > 0.6)).all()
    _, found = allowed(min_distance=1.45)
    away = np.linalg.norm(at[:, None] - at, axis=2)
    assert (found == (away >= 1.45)).all()
    _, found = allowed(keep=apart)
    assert (found == (np.abs(at[:, None, 0] - at[:, 0]) > 0.45)).all()


def test_places_in_holes_go_on_after_the_outline() -> None:
    found = rg.placement_map(BRACKET, LOADS, friction=0.5, in_holes=True, count=78)
    inside = found.places[found.places > BRACKET.length]
    assert 6 <= len(inside) <= 8
    assert found.rings.length == pytest.approx(BRACKET.length + 1.6)
    points = found.rings.points(found.places, np.zeros((len(found.places), 1)))[:, 0]
    assert points == pytest.approx(np.array([contact(float(s)).position for s in found.places]))
    third = rg.placement_map(BRACKET, LOADS, friction=0.5, fixed=[2.1, 14.3], free=1, in_holes=True, count=20)
    assert third.allowed.all()
    assert (~np.isnan(third.values)).any()


def test_keep_is_asked_of_fingers_that_stay_too() -> None:
    asked: list[int] = []

    def far(a: np.ndarray, b: np.ndarray, angle: float) -> np.ndarray:
        asked.append(len(a))
        assert angle == 0.0
        return np.hypot(*(a - b).T) > 2.0

    found = rg.placement_map(BRACKET, LOADS, friction=0.5, fixed=[2.2], free=2, keep=far, count=20)
    near = np.hypot(*(BRACKET.points(found.places) - BRACKET.points(2.2)).T) <= 2.0
    assert near.any()
    assert not found.allowed[near].any()
    assert not found.allowed[:, near].any()
    assert len(asked) == 2  # with the one that stays, and among those that move


def test_a_finger_that_stays_where_none_may_be_is_refused() -> None:
    for given, words in (
        ({"fixed": [4.0]}, "fixed: arc length 4 is at a corner, where no normal is defined"),
        ({"fixed": [14.0]}, "fixed: arc length 0 is at a corner"),
        ({"fixed": [14.4], "in_holes": True}, "fixed: arc length 14.4 is at a corner"),
        ({"fixed": [15.7], "in_holes": True}, "fixed must be arc lengths of the boundaries, 0 to 15.6"),
        ({"fixed": [4.1], "from_corners": 0.2}, "let no finger be at arc length 4.1"),
        ({"fixed": [3.0], "arcs": [(5, 9)]}, "let no finger be at arc length 3"),
        ({"fixed": [7.9], "tip_radius": 0.3}, "let no finger be at arc length 7.9"),
        ({"fixed": [2.0, 2.3], "min_distance": 0.5}, "let no two fingers be at arc lengths 2 and 2.3"),
        ({"fixed": [2.0, 2.0]}, "let no two fingers be at arc lengths 2 and 2"),
        ({"fixed": [2.0, 2.3], "keep": apart}, "min_distance or keep let no two fingers"),
        ({"fixed": [2.0], "min_normal": 3.0, "max_force": 2.0}, "min_normal 3 is above max_force 2"),
        ({"min_distance": 50.0}, "no two points of the shape are further apart"),
        ({"objective": "angle", "max_force": 2.0, "min_normal": 0.1}, "min_normal: for objectives"),
        ({"in_holes": True, "arcs": [(0, 1)]}, "True goes with no arcs"),
    ):
        said = refusal(lambda given=given: rg.placement_map(BRACKET, LOADS, friction=0.5, **given))  # type: ignore[misc]
        assert words in str(said)
