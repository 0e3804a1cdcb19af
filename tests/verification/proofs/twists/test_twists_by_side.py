"""Boxes with twists of which one excludes each side of a finger, by hand and against single sides."""

from fractions import Fraction
from math import inf

import numpy as np
import pytest

import regrasp as rg
from proofs import SHAPES, everything, limit, planar, planar_points
from regrasp.verification.placed.placements import _Checked

pytestmark = pytest.mark.oracle

SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
# the floor in four quarters, as four sides
QUARTERS = tuple((0, c / 4, (c + 1) / 4) for c in range(4))
LOADS = np.array([[0, -1, -0.5], [0, -1, -3.5]])
# about (2, 0): up on the side of the load, down on the other, where a finger does nothing
LEFT, RIGHT = [0.0, -2, 1], [0.0, 2, -1]
EXCLUDED = "proof: the twists of box 0 do not exclude each side"
COVERED = "proof: box 0 is not covered by the boxes it is split into, of one finger's sides"


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def sided(twists=(RIGHT, LEFT), boxes=((0, 0), (0, 1)), inside=(), fingers=1, **changes):
    """One finger on the floor under two loads; ``inside``: (arcs, load, twist) of boxes within."""
    whole = (1, len(inside)) if inside else (0, 0)
    nodes = [(everything(QUARTERS, fingers), whole, 0, (0.0, 0.0, 0.0))]
    nodes += [(arcs, (0, 0), load, twist) for arcs, load, twist in inside]
    given = {"size": "force", "norm": "largest", "friction": 0.0, "sides": np.array(QUARTERS), "bound": 1e6}
    more = {"by_side": np.array(boxes), "side_twists": np.array(twists, dtype=float)}
    return planar(SQUARE, LOADS, nodes, **given | more | changes)


def test_one_of_them_is_enough_for_each_side() -> None:
    """What neither excludes alone: no finger holds both loads."""
    assert said(sided()) == ""
    for twists, boxes in ([RIGHT], [(0, 0)]), ([LEFT], [(0, 1)]), ([RIGHT, RIGHT], [(0, 0)] * 2):
        assert said(sided(twists, boxes)) == EXCLUDED
    assert said(sided(boxes=((0, 1), (0, 0)))) == EXCLUDED
    assert said(sided(boxes=((0, 0), (0, 2)))) == "proof: box 0 has no load"
    assert said(sided(boxes=((0, 0), (0, -1)))) == "proof: box 0 has no load"


def test_doubles_and_rationals_find_the_same() -> None:
    """At x = 2 a finger does nothing; a little beside it, something."""
    for off, good in (0.0, True), (1.4e-6, True), (1.6e-6, False), (1e-3, False):
        proof = sided([RIGHT, [0, -2 + off, 1]])
        judged = _Checked(proof)
        assert (judged.violations() == []) == good
        assert judged.by_side._clear.tolist() == [good]
        judged.by_side._clear[:] = False
        assert (judged.by_side.violations(0) == []) == good
    tiny = sided(np.multiply([RIGHT, LEFT], 1e-200))  # too small for doubles to tell
    judged = _Checked(tiny)
    assert (judged.violations(), judged.by_side._clear.tolist()) == ([], [False])


def arc(first, last, lo=None, hi=None):
    least, most = QUARTERS[first][1], QUARTERS[last][2]
    return [(first, last, least if lo is None else lo, most if hi is None else hi)]


def test_boxes_inside_have_whole_sides_and_the_others_a_twist() -> None:
    left = (arc(0, 1), 1, LEFT)
    assert said(sided([RIGHT], [(0, 0)], [left])) == ""
    assert said(sided([RIGHT], [(0, 0)], [(arc(0, 0), 1, LEFT), (arc(1, 1), 1, LEFT)])) == ""
    assert said(sided([RIGHT], [(0, 0)], [(arc(0, 0), 1, LEFT)])) == EXCLUDED
    assert said(sided([RIGHT], [(0, 0)], [(arc(1, 1), 1, LEFT)])) == EXCLUDED
    # a box inside has to be excluded, too
    assert "box 1" in said(sided([RIGHT], [(0, 0)], [(arc(0, 1), 0, LEFT)]))
    for wrong in (arc(0, 1, hi=0.499), arc(0, 1, lo=1e-9), arc(0, 1, hi=0.501)):
        assert said(sided([RIGHT], [(0, 0)], [(wrong, 1, LEFT)])).startswith(COVERED)


def test_boxes_inside_keep_the_other_arcs() -> None:
    """Of two fingers on all sides the first one's are left out, and the other one stays."""
    whole = (0, 3, 0.0, 1.0)
    up = [0.0, 1, 0]
    each = [(0, 0)]
    assert said(sided([up], each, fingers=2, bound=0.49)) == ""
    assert said(sided([up], each, [([*arc(0, 1), whole], 0, up)], fingers=2, bound=0.49)) == ""
    for wrong in ([whole, *arc(0, 1)], arc(0, 1) + arc(0, 2), [*arc(0, 1), (0, 3, 0.0, 0.9)]):
        assert said(sided([up], each, [(wrong, 0, up)], fingers=2, bound=0.49)).startswith(COVERED)


def test_shapes_that_do_not_fit_are_said() -> None:
    what = "proof: by_side and side_twists must have shape (2, 2) and (2, 3)"
    assert said(sided([RIGHT])) == what
    assert said(sided([RIGHT[:2], LEFT[:2]])) == what
    assert "go with boxes" in said(sided(norm="sum"))
    assert "go with boxes" in said(sided(side_twists=None))
    assert "go with boxes" in said(sided(max_force=2.0))
    assert said(sided([RIGHT, [0, np.nan, 1]])) == "proof: its numbers must be finite"


@pytest.mark.parametrize("box", [-1, 10**6])
def test_boxes_that_are_not_there_are_said(box: int) -> None:
    wrong = sided([RIGHT, LEFT, LEFT], [(0, 0), (0, 1), (box, 1)])
    assert said(wrong) == "proof: by_side is about boxes from 0 to 0"


@pytest.mark.parametrize("seed", range(40))
def test_against_a_box_for_each_side(seed) -> None:
    """The largest bound is the least over sides of the largest over twists."""
    rng = np.random.default_rng(seed)
    vertices = SHAPES[int(rng.integers(len(SHAPES)))]
    k, count = int(rng.integers(1, 4)), len(vertices)
    sides = [(e, e + lo, e + hi) for e in range(count) for lo, hi in ((0.0, 0.25), (0.25, 1.0))]
    loads = rng.integers(-3, 4, size=(2, 3)) + np.array([0, 0.5, 0])
    number = rng.integers(2, size=3)
    twists = rng.integers(-4, 5, size=(3, 3)).astype(float)
    given = {
        "size": str(rng.choice(["force", "normal"])), "norm": "largest", "sides": np.array(sides),
        "friction": float(rng.choice([0, 0.25, 1])), "centre_of_mass": rng.integers(-2, 9, size=2) * 1.0,
    }  # fmt: skip
    all_arcs = everything(sides, k)

    def proven(side: int, row: int) -> Fraction | float:
        if not -loads[number[row]] @ twists[row] > 0:
            return 0
        lo, hi = sides[side][1:]
        arcs = [(side, side, lo, hi), *all_arcs[1:]]
        one = planar(vertices, loads, [(arcs, (0, 0), int(number[row]), tuple(twists[row]))], **given)
        return limit(one, planar_points(one)) or inf  # of no work of fingers

    best = min(max(proven(side, row) for row in range(3)) for side in range(len(sides)))
    proof = planar(vertices, loads, [(all_arcs, (0, 0), 0, (0.0, 0.0, 0.0))], **given)
    proof.by_side, proof.side_twists = np.column_stack([np.zeros(3, int), number]), twists
    for factor, good in (1 - 1e-11, True), (1 + 1e-9, False):
        if best == inf and not good:
            continue
        proof.bound = 1e9 if best == inf else float(best) * factor if best > 0 else (0.0 if good else 1e-6)
        judged = _Checked(proof)
        assert (judged.violations() == []) == good
        judged.by_side._clear[:] = False
        assert (judged.by_side.violations(0) == []) == good
