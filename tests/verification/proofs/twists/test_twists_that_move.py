"""Boxes that twists exclude which move with the fingers, by hand; and such a proof of a search."""

from dataclasses import replace

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, planar
from regrasp.closed_form.compiled.places.moving_twists import room_to_move
from regrasp.planning.placement.laws import law_of
from regrasp.planning.placement.levels.moving_search import twists_or_place
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sides import Sides
from regrasp.verification.placed.placements import _Checked

pytestmark = pytest.mark.oracle

TRIANGLE = [[1.0, 0.6], [-0.9, 0.0], [-0.4, -0.9]]
SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
LOADS = np.array([[0, -1, -1.9375], [0, -1, -2.0625]])
# about the finger on the floor, wherever it is, one way and the other: it does no work, the loads do 1/8
ABOUT = [[0, 0, -1, 0, 4], [0, 0, 1, 0, -4]]


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def moving(motions=ABOUT, movers=((0, 0), (0, 1)), *, sides=((0, 0, 1.0),), **changes):
    """One finger on the floor, under two loads that ask for it in two places."""
    nodes = [(everything(sides, 1), (0, 0), 0, (0.0, 0.0, 0.0))]
    given = {"size": "force", "norm": "largest", "friction": 0.75, "sides": np.array(sides), "bound": 1e6}
    more = {"movers": np.array(movers), "motions": np.array(motions, dtype=float)}
    return planar(SQUARE, LOADS, nodes, **given | more | changes)


def test_what_no_fixed_twists_exclude_they_do() -> None:
    assert said(moving()) == ""
    for wrong in ([[0, 0, -1, 0, 3.75], ABOUT[1]], [ABOUT[0], [0, 0, 1, 0, -3.75]], [ABOUT[1], ABOUT[0]]):
        assert said(moving(wrong)) == "proof: the twists of box 0 do not exclude it"
    for fixed in np.linspace(0, 4, 9):
        found = moving([[0, fixed, -1, 0, 0], [0, -fixed, 1, 0, 0]])
        assert said(found) == "proof: the twists of box 0 do not exclude it"


def test_the_limit_is_that_of_work_over_most_work() -> None:
    """Upward velocity of 1/40 at both ends, and the finger does 1/40 N along it: 1/8 + 1/40 of work, 6 N."""
    for aside in 0.0, 1 / 80, 1 / 10:
        shifted = [[aside, 1 / 40, -1, 0, 4], ABOUT[1]]
        most = np.hypot(aside, 1 / 40) if aside <= 0.75 / 40 else (1 / 40 + 0.75 * aside) / 1.25
        limit = (1 / 8 + 1 / 40) / most
        for factor, good in (1 - 1e-12, True), (1 + 1e-12, False):
            assert (said(moving(shifted, bound=limit * factor)) == "") == good
    # equal is not more
    assert said(moving([[0, 0.0625, -1, 0, 4], ABOUT[1]], bound=3.0)) != ""


def test_many_twists_of_one_box_are_left_to_rationals() -> None:
    """Doubles lose a little of each in a sum; rationals find the same."""
    for times, clear in (100, True), (101, False):
        for motions, good in (ABOUT, True), (ABOUT[::-1], False):
            proof = moving(motions * times, [(0, load) for load in (0, 1)] * times)
            judged = _Checked(proof)
            assert (judged.violations() == []) == good
            assert judged.clear.tolist() == [clear and good]


def test_of_many_fingers_they_are_refused_before_their_corners_are_counted() -> None:
    nodes = [(everything([(0, 0, 1.0)], 40), (0, 0), 0, (0.0, 0.0, 0.0))]
    given = {"size": "force", "norm": "largest", "sides": np.array([(0, 0, 1.0)]), "bound": 1.0}
    more = {"movers": np.array([(0, 0)]), "motions": np.zeros((1, 83))}
    assert said(planar(SQUARE, LOADS, nodes, **given, **more)) == (
        "proof: twists that move go with up to 7 fingers"
    )


def test_a_search_finds_them() -> None:
    """The same finger and loads, friction of any size: a turn about the finger for each load, as above."""
    for friction in 0.75, 0.01, 0.0:
        sides = Sides(SQUARE, np.array([0]), np.array([[0.0, 1.0]]))
        search = Search(sides, 1, friction, LOADS, law_of("friction_use")[1], 1e-6, 10.0)
        assert not search.excluded(np.array([0]), 1e6)
        numbers, twists = twists_or_place(search, 0, 1e6, room_to_move(2, 1))
        assert sorted(numbers) == [0, 1]
        assert (twists[:, 4] / twists[:, 2]).tolist() == pytest.approx([-4, -4], rel=0.05)
        assert said(moving(twists, [(0, n) for n in numbers], friction=friction)) == ""


def test_a_search_finds_a_placement_instead() -> None:
    """Where both loads are one, the finger holds it in the middle, and within a little of it."""
    sides = Sides(SQUARE, np.array([0]), np.array([[0.0, 1.0]]))
    loads = np.array([[0, -1, -2.0], [0, -1, -2.0]])
    search = Search(sides, 1, 0.75, loads, law_of("friction_use")[1], 1e-6, 10.0)
    assert twists_or_place(search, 0, 1.01, room_to_move(2, 1)) == [0.5]
    assert isinstance(twists_or_place(search, 0, 0.99, room_to_move(2, 1)), tuple)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"movers": ((0, 0), (0, 2))}, "box 0 has no load"),
        ({"movers": ((0, 0), (0, -1))}, "box 0 has no load"),
        ({"movers": ((0, 0),)}, "motions must have shape"),
        ({"norm": "sum"}, "boxes and a largest force"),
        ({"sides": ((0, 0, 1.0), (1, 1, 2.0))}, "the twists of box 0 do not exclude it"),
    ],
)
def test_what_they_cannot_be(changes, words) -> None:
    assert words in said(moving(**changes))


def test_each_finger_has_one_side() -> None:
    """One of two on two sides is one too many, whichever."""
    sides = ((0, 0, 1.0), (1, 1, 2.0))
    proof = moving([[0, 0, -1, 0, 0, 4, 0], [0, 0, 1, 0, 0, -4, 0]], sides=sides[:1])
    proof = planar(SQUARE, LOADS, [(everything(sides, 2), (0, 0), 0, (0.0,) * 3)], **_changes(proof, sides))
    assert "shape" not in said(proof)
    for one in 0, 1:
        proof.arcs[0] = [[0, 1], [0, 1]]
        proof.arcs[0][one] = [0, 0]
        proof.ends[0][one] = [0, 1]
        assert "the twists of box 0 do not exclude it" in _Checked(proof)._excluded(0)[0]


def _changes(proof, sides) -> dict[str, object]:
    given = {
        name: getattr(proof, name) for name in ("size", "norm", "friction", "bound", "movers", "motions")
    }
    return given | {"sides": np.array(sides)}


def test_a_quarter_turn_of_all_changes_nothing() -> None:
    """So that what is added to x is, and at the end of the arc alone."""
    nodes = [(everything(((0, 0, 1.0),), 1), (0, 0), 0, (0.0, 0.0, 0.0))]
    turned = np.stack([-SQUARE[:, 1], SQUARE[:, 0]], axis=1)
    loads = np.array([[1, 0, -1.9375], [1, 0, -2.0625]])
    for aside, good in (4.0, True), (-4.0, False), (3.75, False):
        motions = np.array([[0, 0, -1, -aside, 0], [0, 0, 1, 4.0, 0]])
        proof = planar(turned, loads, nodes, **_changes(moving(), ((0, 0, 1.0),)) | {"motions": motions})
        assert (said(proof) == "") == good, aside


def test_a_bound_of_nothing_needs_no_twist_and_any_other_does() -> None:
    nothing = np.zeros((2, 5))
    for bound, good in (0.0, True), (-1.0, True), (1e-300, False), (0.5, False), (1.0, False):
        assert (said(moving(nothing, bound=bound)) == "") == good, bound


def test_twists_are_needed() -> None:
    proof = moving()
    proof.motions = None
    assert "motions must have shape" in said(proof) or "a largest force" in said(proof)


def test_a_search_is_closed_by_them() -> None:
    shape = rg.Outline(TRIANGLE)
    loads = rg.LoadSet.hull([
        rg.Wrench([x, y], t) for x, y in ((1, 0), (-0.5, 0.9), (-0.5, -0.9)) for t in (0.05, -0.05)
    ])  # fmt: skip
    chosen = rg.choose_grasp(
        shape, 3, loads, friction=0.4, objective="friction_use", max_force=4, most_boxes=2000
    )
    proof = chosen.certificate
    assert proof.movers is not None
    assert proof.motions is not None
    assert len(proof.movers) > 100
    read = type(proof).from_dict(proof.to_dict())
    assert rg.verify(read).ok
    assert rg.verify(chosen).ok
    motions = proof.motions.copy()
    motions[:, 2] *= 1.5
    assert not rg.verify(replace(proof, motions=motions)).ok
    assert not rg.verify(replace(proof, movers=None, motions=None)).ok


def test_an_interrupt_of_the_last_progress_ends_no_search_with_nothing() -> None:
    calls: list[float] = []

    def progress(*told: float) -> None:
        calls.append(told[0])
        if len(calls) == 2 * whole:
            raise KeyboardInterrupt

    whole = 0
    given = {"friction": 0.4, "objective": "force", "max_force": 4, "tolerance": 1e-2, "progress": progress}
    found = rg.choose_grasp(rg.Outline(TRIANGLE), 2, rg.Wrench([0, -1]), **given)
    whole = len(calls)
    again = rg.choose_grasp(rg.Outline(TRIANGLE), 2, rg.Wrench([0, -1]), **given)
    assert len(calls) == 2 * whole
    assert (again.value, again.bound) == (found.value, found.bound)


@pytest.mark.parametrize("objective", ["friction_use", "force"])
def test_a_search_that_is_cut_short_has_a_bound_that_stands(objective: str) -> None:
    """Levels that were closed on the way are one, while what was asked is left open."""
    told, stop = list[float](), [0]

    def progress(_: float, best: float) -> None:
        told.append(best)
        if stop[0] == len(told):
            raise KeyboardInterrupt

    shape, loads = rg.Outline(TRIANGLE), rg.LoadSet.hull([rg.Wrench([x, 1], 0.1 * x) for x in (1, 0, -1)])
    asked = {"friction": 0.4, "max_force": 4, "tolerance": 1e-4, "objective": objective, "progress": progress}
    whole = rg.choose_grasp(shape, 3, loads, **asked)
    every, first, gaps = len(told), int(np.isnan(told).sum()) + 1, []
    for after in sorted({first, max(first, every - 1), every}):
        told.clear()
        stop[0] = after
        chosen = rg.choose_grasp(shape, 3, loads, **asked)
        assert rg.verify(chosen).ok
        value, bound = (-1 if objective == "friction_use" else 1) * np.array([whole.value, chosen.bound])
        assert value <= bound
        gaps.append(chosen.gap)
    assert objective == "friction_use" or gaps[0] > 0.03 > gaps[1] > gaps[2] == whole.gap
