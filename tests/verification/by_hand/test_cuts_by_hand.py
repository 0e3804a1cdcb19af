"""Cuts that no hold crosses, of contacts and of places of an outline, made by hand."""

from fractions import Fraction
from math import atan, inf, nan, nextafter, tan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.refusals.cuts import _Holds, _side, _tangent_below

pytestmark = pytest.mark.oracle


def said(value) -> str:
    return "; ".join(rg.verify(value).violations)


def contact(x, y, nx, ny, mu=0.5):
    return rg.Contact([x, y], [nx, ny], mu)


def cut(contacts, start=(0, 1, 2), goal=(3, 4, 5), reached=(0, 1, 2), margin=0.0, apart=0.0):
    more = {"reached": reached, "least_margin": margin, "min_distance": apart}
    return SimpleNamespace(contacts=tuple(contacts), start=start, goal=goal, **more)


# Forces of the first three all turn the object left, those of the last three, at the same places, right.
LEFT = [contact(x, -1, 1, 0.2, 0.1) for x in (-0.1, 0.0, 0.1)]
RIGHT = [contact(x, 1, 1, -0.2, 0.1) for x in (-0.1, 0.0, 0.1)]


def test_only_contacts_that_turn_the_same_way_cannot_hold() -> None:
    assert "may hold across the cut" in said(cut(LEFT + RIGHT))
    assert said(cut(LEFT + [contact(x, -2, 1, 0.2, 0.1) for x in (-0.1, 0.0, 0.1)])) == ""
    assert said(cut(RIGHT + [contact(x, 2, 1, -0.2, 0.1) for x in (-0.1, 0.0, 0.1)])) == ""
    both = [contact(x, -2, 0, 1, 0.5) for x in (-0.1, 0.0, 0.1)]  # either way
    for mixed in (LEFT + both, both + LEFT, both + both, RIGHT + both):
        assert "may hold across the cut" in said(cut(mixed))


@pytest.mark.parametrize("sign", [1, -1])
def test_edges_of_cones_at_the_limit_of_their_turn(sign) -> None:
    """At (x, -1) with normal (0, 1) an edge (-+mu, 1) turns by x - +mu: both ways where |x| <= mu."""
    others = [contact(sign * x, -1, 0, 1, 0.25) for x in (3.0, 4.0, 5.0)]
    for x, good in (0.25 + 1e-12, True), (0.25, False), (0.25 - 1e-12, False), (0.0, False), (-3.0, False):
        near = [contact(sign * x, -1, 0, 1, 0.25), *[contact(sign * k, -1, 0, 1, 0.25) for k in (1.0, 2.0)]]
        assert (said(cut(near + others)) == "") == good, x


def test_narrowed_cones_at_their_limit() -> None:
    """The same, the cone narrowed by an angle: half-angle atan 1/4 - m about the normal."""
    others = [contact(x, -1, 0, 1, 0.25) for x in (3.0, 4.0, 5.0)]
    for margin in (0.01, 0.1, 0.2):
        edge = tan(atan(0.25) - margin)
        for x, good in (edge * (1 + 1e-9), True), (edge * (1 - 1e-9), False):
            near = [contact(x, -1, 0, 1, 0.25), contact(1, -1, 0, 1, 0.25), contact(2, -1, 0, 1, 0.25)]
            assert (said(cut(near + others, margin=margin)) == "") == good, (margin, x)
    for margin, good in (
        (nextafter(atan(0.25), 1) + 1e-12, True),
        (atan(0.25) - 1e-12, False),
    ):  # an empty cone
        near = [contact(0, -1, 0, 1, 0.25) for _ in range(3)]
        assert (said(cut(near + near, margin=margin)) == "") == good


def test_a_tangent_from_below() -> None:
    for angle in (0.0, 1e-9, 0.1, 0.785, 1.2, 1.5):
        found = float(_tangent_below(Fraction(angle)))
        assert found <= tan(angle) * (1 + 1e-15)
        assert found == pytest.approx(tan(angle), rel=1e-12)
    assert _tangent_below(Fraction(1.51)) == 14


def test_fingers_that_are_too_near_cannot_hold() -> None:
    both = [contact(0.3 * k, -2 - 0.4 * k, 0, 1, 9.0) for k in range(6)]  # 1/2 from one to the next
    for apart, good in (3.0, True), (2.5 * (1 + 1e-12), True), (2.5 * (1 - 1e-12), False), (0.0, False):
        assert (said(cut(both, apart=apart)) == "") == good, apart
    two = [contact(0, -2, 0, 1, 9.0), contact(3, -2, 0, 1, 9.0), contact(0, -2, 0, 1, 9.0),
           contact(0, 2, 0, 1, 9.0), contact(3, 2, 0, 1, 9.0), contact(0, 2, 0, 1, 9.0)]  # fmt: skip
    for apart, good in (5.0 * (1 + 1e-12), True), (5.0, False), (4.5, False):  # across: 4, 5 and 4
        assert (said(cut(two, apart=apart)) == "") == good, apart


def test_a_finger_beside_one_that_holds_alone_needs_no_cone() -> None:
    empty = [contact(0, -1, 0, 1, 0.1) for _ in range(3)]
    alone, turns = contact(0, -2, 0, 1, 5.0), contact(9, -1, 0, 1, 1.0)
    margin = 0.2
    assert "contacts 0 and 3 may hold across" in said(cut([*empty, alone, *empty[:2]], margin=margin))
    assert said(cut([*empty, turns, *empty[:2]], margin=margin)) == ""
    assert "may hold" in said(cut([alone, *empty[:2], *empty], margin=margin))


def test_starts_and_goals_are_on_their_sides() -> None:
    both = [contact(x, -2, 0, 1, 9.0) for x in range(6)]
    free = cut(both, reached=())
    assert "contacts 0 and 1 of the start may hold and are not both on its side" in said(free)
    assert "of the goal" not in said(free)
    full = cut(both, reached=tuple(range(6)))
    assert "contacts 3 and 4 of the goal may hold and are not both on the other side" in said(full)
    assert "of the start" not in said(full)
    assert rg.verify(full).crossing == 0
    words = "15 of 15 pairs may hold, in 1 component of 6 contacts; those of the start in one of 6, "
    assert rg.verify(full).components == f"{words}those of the goal in one of 6"
    none = "0 of 15 pairs may hold; no two fingers of the start do, no two fingers of the goal do"
    assert rg.verify(cut([*LEFT, *LEFT])).components == none
    assert rg.verify(cut([*LEFT, *RIGHT])).components.startswith("9 of 15 pairs")
    assert rg.verify(cut(both)).crossing == 9
    assert "same contacts" in said(cut(both, goal=(2, 1, 0)))
    for wrong in ({"start": (0, 1, 1)}, {"goal": (3, 4, 4)}, {"start": (0, 1, 6)}, {"goal": (-1, 4, 5)},
                  {"reached": (0, 6)}, {"reached": (-1,)}):  # fmt: skip
        assert said(cut(both, **wrong)) == "start and goal must be three contacts each"


SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)


def outline_cut(**changes) -> SimpleNamespace:
    """Fingers on the left and right sides, and a load down: the bottom is never reached, the top is no help.

    Without friction pushes from the right and the left do no work along (0, -1, 0), and those from the top do
    it downwards, so that only with the bottom anything holds.
    """
    boxes, twists = [], []
    for i in (1, 2, 3):
        for j in (1, 2, 3):
            boxes.append([i, j, 0, 1, 0, 1])
            twists.append([0.0, -1.0, 0.0])
    given = {
        "vertices": SQUARE, "friction": 1e-3, "force": np.array([0.0, -1.0]), "turned": None,
        "min_normal": 0.0, "max_force": None,
        "forbidden": np.array([0]), "start": np.array([[1, 0.25], [1, 0.5], [1, 0.75]]),
        "goal": np.array([[3, 0.25], [3, 0.5], [3, 0.75]]), "reached": np.array([[1, 0.0, 1.0]]),
        "boxes": np.array(boxes, dtype=float), "twists": np.array(twists),
    }  # fmt: skip
    return SimpleNamespace(**given | changes)


def test_twists_of_boxes_at_their_limit() -> None:
    """Edges (-1, -+mu) of the right side, along (-tilt, -1): a work of tilt -+ mu."""
    mu = 0.5
    for tilt, good in ((mu, True), (mu * (1 + 1e-12), True), (mu * (1 - 1e-12), False)):
        boxes = np.array([[1, 1, 0, 1, 0, 1]], dtype=float)
        cut_ = outline_cut(
            friction=mu, boxes=boxes, twists=np.array([[-tilt, -1.0, 0.0]]), forbidden=np.array([0, 2, 3])
        )
        found = said(cut_)
        assert ("some force of a finger in it opposes its twist" not in found) == good, tilt
    for work, good in ((1e-300, True), (0.0, False), (-1e-300, False)):
        cut_ = outline_cut(force=np.array([0.0, -work]) if work else np.array([1.0, 0.0]))
        assert ("the load does no work along its twist" not in said(cut_)) == good
    turned = outline_cut(turned=np.array([1.0, 0.0]))
    assert "box 5: the load does no work along its twist" in said(turned)


def test_ends_of_a_turn_are_less_than_half_a_turn_apart() -> None:
    for turned, good in (([0.0, 1.0], False), ([1e-9, 1.0], True), ([0.0, -2.0], True), ([0.0, 0.0], False)):
        found = said(outline_cut(turned=np.array(turned)))
        assert ("half a turn apart" not in found) == good, turned
    for turned, good in (([1e-9, 1.0], False), ([1.0, 1e-9], True)):  # loads between are beyond both ends'
        found = said(outline_cut(turned=np.array(turned), max_force=9.0))
        assert ("half a turn apart" not in found) == good, turned


def test_sizes_of_loads_count_under_limits_alone() -> None:
    for limits, good in ({}, True), ({"max_force": 9.0}, False), ({"min_normal": 0.1}, False):
        found = said(outline_cut(turned=np.array([1.0, -2.0]), **limits))
        assert ("are of different sizes" not in found) == good, limits


def covering(boxes, **changes) -> str:
    """What is said of these boxes on sides 1 and 3, of a load to the left that both sides do not hold."""
    given = {
        "friction": 0.1, "force": np.array([-1.0, 0.0]), "forbidden": np.array([0, 2]),
        "vertices": np.array([[-1, -1], [1, -1], [2, 1], [-2, 1]], dtype=float),
        "start": np.array([[1, 0.0], [1, 0.0], [1, 0.0]]), "goal": np.array([[3, 1.0], [3, 1.0], [3, 1.0]]),
    }  # fmt: skip
    twists = np.tile([0.0, 1.0, 0.0], (len(boxes), 1))
    made = outline_cut(**given | {"boxes": np.array(boxes, dtype=float), "twists": twists} | changes)
    return "; ".join(v for v in rg.verify(made).violations if "cover" in v)


def test_boxes_cover_all_pairs_across_the_cut() -> None:
    words = "boxes do not cover all pairs across the cut on sides 1 and 3"
    assert covering([[1, 3, 0, 1, 0, 1]]) == ""
    assert covering([[3, 1, 0, 1, 0, 1]]) == ""  # the other way round
    assert covering([[1, 1, 0, 1, 0, 1]]) == words
    halves = [[1, 3, 0, 0.5, 0, 1], [1, 3, 0.5, 1, 0, 1]]
    assert covering(halves) == ""
    assert covering(halves[:1]) == covering(halves[1:]) == words
    assert covering([[1, 3, 0, 0.5, 0, 1], [1, 3, 0.5 + 1e-15, 1, 0, 1]]) == words
    assert covering([[1, 3, 0, 1, 0, 0.5], [1, 3, 0, 1, 0.5, 1]]) == ""
    assert covering([[1, 3, 0, 1, 0, 0.5], [1, 3, 0, 1, 0.5 + 1e-15, 1]]) == words
    assert covering([[1, 3, 0, 1, 1e-15, 1]]) == covering([[1, 3, 0, 1, 0, 1 - 1e-15]]) == words
    assert covering([[1, 3, 1e-15, 1, 0, 1]]) == covering([[1, 3, 0, 1 - 1e-15, 0, 1]]) == words
    bricks = [[1, 3, 0, 0.5, 0, 0.3], [1, 3, 0, 0.5, 0.3, 1], [1, 3, 0.5, 1, 0, 0.7], [1, 3, 0.5, 1, 0.6, 1]]
    assert covering(bricks) == ""
    for k in range(4):
        assert covering(bricks[:k] + bricks[k + 1 :]) == words


def test_only_what_is_reached_and_what_is_left_need_boxes() -> None:
    half = [[1, 3, 0, 0.5, 0, 1]]
    reached = np.array([[1, 0.0, 0.5]])
    assert covering(half, reached=reached) == "boxes do not cover all pairs across the cut on sides 1 and 1"
    assert covering([*half, [1, 1, 0, 0.5, 0.5, 1]], reached=reached) == ""
    assert covering([*half, [1, 1, 0, 0.5, 0.5 + 1e-9, 1]], reached=reached) != ""
    two = np.array([[1, 0.0, 0.25], [1, 0.5, 1.0]])
    assert "1 and 1" in covering([[1, 3, 0, 1, 0, 1]], reached=two)
    assert covering([[1, 3, 0, 1, 0, 1], [1, 1, 0, 1, 0.25, 0.5]], reached=two) == ""
    assert covering([[1, 3, 0, 1, 0, 1], [1, 1, 0, 1, 0.3, 0.5]], reached=two) != ""
    assert covering([[1, 3, 0, 1, 0, 1], [1, 1, 0, 1, 0, 1]], reached=np.array([[1, 0.25, 1.0]])) == ""
    assert "sides 1 and 0" in covering([[1, 3, 0, 1, 0, 1]], forbidden=np.array([2]))
    assert covering([[1, 3, 0, 1, 0, 1], [1, 0, 0, 1, 0, 1]], forbidden=np.array([2])) == ""
    point = np.array([[1, 0.5, 0.5]])
    boxes = [[1, 3, 0.25, 0.75, 0, 1], [1, 1, 0.5, 0.5, 0, 1]]
    assert covering(boxes, reached=point) == ""
    assert covering(boxes[1:], reached=point) != ""


def test_ends_of_cuts_are_on_their_sides() -> None:
    def told(**changes) -> str:
        return "; ".join(
            v
            for v in rg.verify(
                outline_cut(boxes=np.zeros((0, 6)), twists=np.zeros((0, 3)), **changes)
            ).violations
            if "start" in v or "goal" in v
        )

    assert told() == ""
    for place, good in (0.5, True), (0.5 + 1e-9, False), (0.0, True):
        reached = np.array([[1, 0.0, 0.5]])
        start = np.array([[1, 0.25], [1, 0.125], [1, place]])
        assert (
            "places of the start on sides 1 and 1 may hold" not in told(reached=reached, start=start)
        ) == good
    goal = np.array([[3, 0.25], [3, 0.5], [1, 0.5]])
    assert "places of the goal on sides 3 and 1 may hold and are on the start's side" in told(goal=goal)
    same = outline_cut().start
    assert "the same places" in told(goal=same[[2, 0, 1]])
    inside = outline_cut(
        goal=goal, boxes=np.array([[1, 3, 0, 1, 0, 1]], dtype=float), twists=np.array([[0, -1.0, 0]])
    )
    assert "of the goal" not in said(inside)
    for box in ([1, 3, 0, 1, 0, 0.25], [1, 3, 0, 0.25, 0, 1]):  # one of the two places is in it
        inside.boxes = np.array([box], dtype=float)
        assert "places of the goal on sides 3 and 1 may hold" in said(inside)


@pytest.mark.parametrize(
    "changes",
    [
        {"friction": 0.0}, {"friction": -1.0}, {"friction": nan}, {"force": np.array([0.0, nan])},
        {"force": np.array([0.0, -1.0, 0.0])}, {"turned": np.array([1.0])}, {"turned": np.array([0.0, nan])},
        {"forbidden": np.array([4])}, {"forbidden": np.array([-1])}, {"forbidden": np.array([0.5])},
        {"start": np.array([[1, 0.5], [1, 0.25]])}, {"goal": np.array([[1, 0.5]] * 4)},
        {"start": np.array([[1, 0.5], [1, 0.25], [4, 0.5]])},
        {"start": np.array([[1, 0.5], [1, 0.25], [-1, 0.5]])},
        {"start": np.array([[1, 0.5], [1, 0.25], [1.5, 0.5]])},
        {"goal": np.array([[1, 0.5], [1, 0.25], [1, 1.01]])},
        {"goal": np.array([[1, 0.5], [1, 0.25], [1, -0.01]])}, {"reached": np.array([[4, 0.0, 1.0]])},
        {"reached": np.array([[1, 0.0, 1.5]])}, {"boxes": np.zeros((1, 6))}, {"twists": np.full((9, 3), nan)},
        {"vertices": SQUARE * nan}, {"friction": inf}, {"forbidden": np.array([0, 9])},
        {"start": np.array([[1, 0.5], [1, 0.25], [1, 1.5]])}, {"reached": np.array([[1, -0.5, 1.0]])},
        {"boxes": np.array([[1, 1, -0.5, 1, 0, 1]] * 9)}, {"boxes": np.array([[1, 1, 0, 1, 0, 1.5]] * 9)},
    ],
)  # fmt: skip
def test_cuts_of_no_form(changes) -> None:
    words = "a cut has three places at either end and a twist for every box"
    assert words not in said(outline_cut())
    assert words in said(outline_cut(**changes))


def test_vertices_run_counter_clockwise() -> None:
    assert "counter-clockwise" not in said(outline_cut())
    assert "the vertices do not run counter-clockwise" in said(outline_cut(vertices=SQUARE[::-1]))
    for small in (1e-3, 1e3):
        assert "counter-clockwise" in said(outline_cut(vertices=small * SQUARE[::-1]))
        assert "counter-clockwise" not in said(outline_cut(vertices=small * SQUARE))


def test_contacts_without_a_cone_hold_beside_those_that_hold_alone() -> None:
    """Ones whose forces turn left, both ways, and right, and one whose cone is empty once it is narrowed."""
    left, both, right, none = (contact(x, -1, 0, 1, mu) for x, mu in ((2, 1), (0, 1), (-2, 1), (1, 0.01)))
    holds = _Holds(cut([left, both, right, none], margin=0.1))
    assert holds.sides == [1, 0, -1, None]
    expected = {(0, 1), (0, 2), (1, 2), (1, 3)}
    for i in range(4):
        for j in range(4):
            assert i == j or holds.may(i, j) == ((min(i, j), max(i, j)) in expected), (i, j)


def test_which_way_forces_along_oblique_normals_turn() -> None:
    """At (0, -1) with normal (4, 3) and mu = t the torque is 4 -+ 3 t: both ways above 4/3."""
    for mu, side in (1.33, 1), (1.34, 0), (0.0, 1):
        holds = _Holds(cut([contact(0, -1, 4, 3, mu), contact(0, 1, 4, 3, mu), contact(0, 1, -4, 3, mu)]))
        assert holds.sides == [side, -side, side], mu


def test_numbers_of_verdicts_on_cuts() -> None:
    fine = rg.verify(cut(LEFT + [contact(x, -2, 1, 0.2, 0.1) for x in (-0.1, 0.0, 0.1)]))
    assert (fine.worst_residual, fine.least_angle, fine.least_cone_slack) == (0.0, inf, inf)
    assert fine.crossing == 9
    bad = rg.verify(cut(LEFT + RIGHT, start=(0, 1, 9)))
    assert (bad.worst_residual, bad.least_angle, bad.least_cone_slack) == (inf, 0.0, -inf)
    made = rg.verify(outline_cut())
    assert (made.worst_residual, made.least_angle, made.least_cone_slack) == (0.0, inf, inf)
    for wrong in {"friction": nan}, {"vertices": SQUARE[[0, 1, 2, 3, 3]]}:
        broken = rg.verify(outline_cut(**wrong))
        assert (broken.worst_residual, broken.least_angle, broken.least_cone_slack) == (inf, 0.0, -inf)


def test_the_edges_of_an_oblique_cone() -> None:
    """At (-4, 3), beside the normal (3, 4) / 5, forces along the tangent make no torque, however steep."""
    for mu in 0.5, 2.0, 9.0:
        for sign in 1, -1:
            place = [Fraction(-4 * sign), Fraction(3 * sign)]
            assert _side(rg.Contact([-4 * sign, 3 * sign], [3, 4], mu), place, Fraction(0)) == -sign


def test_the_side_of_a_start_may_be_the_only_two_that_hold() -> None:
    """Contacts 0 and 2 turn the same way, 1 the other, from which 2 is not far enough."""
    places = [contact(x, -1, 0, 1, 0.25) for x in (3.0, -0.3, 0.3, 4.0, 5.0, 6.0)]
    for reached, good in ((0, 1), True), ((0,), False), ((1,), False):
        assert ("of the start may hold" not in said(cut(places, reached=reached, apart=1.0))) == good
