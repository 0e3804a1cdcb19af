"""Boxes that twists exclude which move with the fingers, by hand; and such a proof of a search."""

from dataclasses import replace

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, planar
from regrasp.planning.placement.levels.moving import MovingTwists
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


def test_what_finger_adds_to_what() -> None:
    """Each finger's way adds to its own number alone, that of x first, at the end of its arc alone."""
    twists = MovingTwists(2)
    at = twists.at_corners @ np.arange(7.0)
    for corner, y in zip(twists.corners, at, strict=True):
        assert y == pytest.approx([0 + corner @ [3, 4], 1 + corner @ [5, 6], 2])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"movers": ((0, 0), (0, 2))}, "there is no load"),
        ({"movers": ((0, 0), (0, -1))}, "there is no load"),
        ({"movers": ((0, 0),)}, "motions must have shape"),
        ({"norm": "sum"}, "a largest force and no margin"),
        ({"sides": ((0, 0, 1.0), (1, 1, 2.0))}, "more than one side"),
        ({"size": "margin", "margin": 0.1}, "a largest force and no margin"),
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
        assert "more than one side" in _Checked(proof)._excluded(0)[0]


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
