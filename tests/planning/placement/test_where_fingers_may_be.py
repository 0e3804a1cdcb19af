"""Distances, corners, arcs and round tips that keep fingers away, and what is refused."""

import numpy as np
import pytest

import regrasp as rg
from placements import BRACKET, DEVIATIONS, TILTED
from refusals import refusal
from regrasp.planning.placement.loads import inner_and_outer

pytestmark = pytest.mark.oracle

ANSWERED = {"objective": "answered", "max_force": 3.0, "load": rg.Wrench([0, -1])}
NOTHING_TOO = rg.Wrench([0, 0]), rg.Wrench([1, 0]), rg.Wrench([0, 1])


def test_fingers_keep_apart_and_away_from_corners() -> None:
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, objective="peak", min_distance=3.0)
    a, b = chosen.grasp.positions
    assert np.hypot(*(a - b)) >= 3.0 * (1 - 1e-9)
    free = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, objective="peak")
    assert free.bound <= chosen.value
    away = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, from_corners=0.3)
    corners = BRACKET.boundary.corners
    assert np.abs(away.places[:, None] - corners).min() >= 0.3 - 1e-9
    with pytest.raises(rg.InvalidInput, match="from_corners"):
        rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, from_corners=3.0)


@pytest.mark.parametrize("more", [{}, {"objective": "angle", "max_force": 20.0, "friction": 1e-3}])
@pytest.mark.parametrize(
    ("kept", "words"),
    [
        ({}, "no 2 fingers anywhere on this outline hold"),
        ({"arcs": [[0.0, 1.4]]}, "anywhere on the 10.0% of this outline where they may be hold"),
        ({"min_distance": 3.0}, "anywhere on this outline, 3 m apart, hold"),
    ],
)
def test_refusals_name_what_keeps_fingers_from_places(
    kept: dict[str, object], words: str, more: dict[str, object]
) -> None:
    """One was of all of the outline, in words, where arcs had left a tenth of it."""
    ways = rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([-1, 0]), rg.Wrench([0, -1])])
    asked = {"friction": 0.0, "from_corners": 0.0, **kept, **more}
    with pytest.raises(rg.Infeasible) as none:
        rg.choose_grasp(BRACKET, 2, ways, **asked)  # type: ignore[arg-type]
    assert words in str(none.value)


def test_what_cannot_be_answered_is_refused() -> None:
    for given, words in (
        ({"objective": "best"}, "objective must be one of sum_normal"),
        ({"shape": [[0, 0], [1, 0], [0, 1]]}, "shape must be an Outline"),
        ({"load": rg.Wrench([0, 0, 1])}, "planar load"),
        ({"tolerance": 2.0}, "tolerance"),
        ({"fingers": 5}, "fingers"),
    ):
        asked = {"shape": BRACKET, "fingers": 2, "load": TILTED, "friction": 0.4} | given
        assert words in str(refusal(lambda asked=asked: rg.choose_grasp(**asked)))


def test_limits_and_disturbances_go_with_their_objectives() -> None:
    for more, words in (
        ({"objective": "angle"}, "max_force"),
        ({"objective": "angle", "max_force": 3.0, "min_normal": 0.1}, "min_normal"),
        ({"removable": True}, "three fingers"),
        ({"keep": lambda p, q: True}, "keep"),
        ({"keep": lambda p, q, angle: [True, True]}, "keep must return"),
        ({"objective": "answered", "max_force": 3.0}, "disturbance"),
        ({"objective": "peak", "disturbance": DEVIATIONS}, "disturbance"),
        ({"objective": "answered", "max_force": 3.0, "disturbance": DEVIATIONS}, "one load"),
        ({**ANSWERED, "disturbance": rg.Wrench([0, 1])}, "disturbance must be a planar LoadSet.hull"),
        ({**ANSWERED, "disturbance": rg.LoadSet.turned(rg.Wrench([0, 1]))}, "a planar LoadSet.hull"),
        ({**ANSWERED, "disturbance": rg.LoadSet.hull(NOTHING_TOO)}, "every vertex of disturbance"),
        ({"objective": "friction_use", "max_force": 3.0, "friction": 0.0}, "friction"),
        ({"objective": "angle", "max_force": 3.0, "load": rg.Wrench([0, 0])}, "other than zero"),
        ({"objective": "angle", "max_force": 1e300}, "more than 1e+13 times the loads"),
        ({"objective": "force", "max_force": 1.1e13}, "more than 1e+13 times the loads"),
        ({"fingers": 1}, "fingers must be a whole number from 2 to 4, got 1"),
        ({"fingers": 5}, "fingers must be a whole number from 2 to 4, got 5"),
    ):
        asked = {"shape": BRACKET, "fingers": 2, "load": TILTED, "friction": 0.4} | more
        assert words in str(refusal(lambda asked=asked: rg.choose_grasp(**asked)))


def test_fingers_stay_within_arcs() -> None:
    arcs = [(13.5, 2.0), (6.0, 7.0)]  # the first runs past the first vertex
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.6, arcs=arcs, load_offset=1e-3)
    for s in chosen.places:
        assert 0 <= s <= 2.0 or 6.0 <= s <= 7.0 or s >= 13.5
    free = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.6, load_offset=1e-3)
    assert free.bound <= chosen.value
    assert rg.verify(chosen).ok
    assert float((chosen.certificate.sides[:, 2] - chosen.certificate.sides[:, 1]).max()) <= 1.0
    whole = rg.choose_grasp(
        BRACKET, 2, TILTED, friction=0.6, arcs=[(1.0, 1.0 + BRACKET.length)], load_offset=1e-3
    )
    assert whole.value == pytest.approx(free.value, rel=1e-3)
    for none in (
        [],
        [(0, 2.01 * BRACKET.length)],
        [(-1.01 * BRACKET.length, 0)],
        [(1.0, 1.01 + BRACKET.length)],
    ):
        assert "arcs" in str(
            refusal(lambda none=none: rg.choose_grasp(BRACKET, 2, TILTED, friction=0.6, arcs=none))
        )


@pytest.mark.parametrize("radius", [0.1, 0.3, 0.45, 0.6])
def test_round_tips_touch_nothing_else(radius: float) -> None:
    """Against the distance of the tip's centre to the outline, by sampling; a slot one wide takes no 0.6."""
    from regrasp.planning.placement.reachable import sides_of

    slotted = rg.Outline([[0, 0], [5, 0], [5, 3], [3, 3], [3, 1], [2, 1], [2, 3], [0, 3]])
    sides = sides_of(slotted, 0.0, None, radius)
    ring = slotted.points(np.linspace(0, slotted.length, 4001))
    for s in np.linspace(0.01, slotted.length - 0.01, 331):
        point, normal = slotted.points(s), slotted.normals(s)
        reach = np.hypot(*(ring - (point - radius * normal)).T).min()
        edge = int(np.searchsorted(sides.starts, s, side="right")) - 1
        u = edge + (s - sides.starts[edge]) / sides.lengths[edge]
        allowed = bool(((sides.ends[:, 0] <= u) & (u <= sides.ends[:, 1])).any())
        if abs(reach - radius) > 0.01:
            assert not allowed
        elif allowed:
            assert reach >= radius - 1e-3
    inside = (sides.edges == 4).any()
    assert inside == (radius < 0.5)


def test_fingers_further_apart_than_the_outline_is_wide_are_refused_at_once() -> None:
    square = rg.Outline([[0, 0], [3, 0], [3, 4], [0, 4]])
    with pytest.raises(rg.InvalidInput, match=r"no two points of the shape are further apart than 5$"):
        rg.choose_grasp(square, 2, rg.Wrench([0, -1]), friction=0.5, objective="peak", min_distance=5.001)


def test_fingers_far_apart_are_found_where_those_at_the_middles_are_too_near() -> None:
    crooked = [[0.92, 0.35], [0.9, 0.95], [-0.16, 1.05], [-1.26, 0.77], [-1.33, 0.13], [-0.99, -0.49]]
    crooked += [[-0.23, -0.69], [0.26, -1.31], [0.81, -0.2]]
    chosen = rg.choose_grasp(
        rg.Outline(crooked), 3, rg.Wrench([0.2, -1], -0.02), friction=0.3, objective="effort",
        min_distance=1.5, most_boxes=5000,
    )  # fmt: skip
    points = np.array([contact.position for contact in chosen.grasp])
    assert np.hypot(*(points - np.roll(points, 1, axis=0)).T).min() >= 1.5 * (1 - 1e-12)
    assert rg.verify(chosen).ok


def test_a_round_set_stands_for_no_more_than_a_thousand_loads() -> None:
    """Of a tolerance of 1e-9 it was a hundred thousand loads, and a search without an end."""
    turned = rg.LoadSet.turned(rg.Wrench([0, -2.0]))
    inner, outer = inner_and_outer(turned, 1e-10)
    assert len(inner) == len(outer) == 1000
    assert np.allclose(np.hypot(*inner[:, :2].T), 2.0, rtol=1e-12)
    middles = 0.5 * (outer + np.roll(outer, 1, axis=0))[:, :2]
    assert np.hypot(*middles.T).min() >= 2.0 * (1 - 1e-12)
    assert np.hypot(*outer[:, :2].T).max() <= 2.0 * (1 + 5e-6)


@pytest.mark.parametrize("objective", ["angle", "force"])
def test_large_limits_are_no_rounding(objective: str) -> None:
    found = rg.choose_grasp(
        BRACKET, 3, TILTED, friction=0.4, objective=objective, max_force=1e12, most_boxes=3000
    )
    assert rg.verify(found).ok
    assert found.gap < 1e-2
