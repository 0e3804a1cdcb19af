"""Cuts of outlines at the limits of their forms, works, boxes and arcs, made by hand."""

from fractions import Fraction

import numpy as np
import pytest
from test_cuts_by_hand import SQUARE, covering, outline_cut, said

import regrasp as rg
from regrasp.verification.refusals.outline_cuts import _Cut

pytestmark = pytest.mark.oracle


def test_outlines_of_no_area_and_far_from_their_middle() -> None:
    assert "counter-clockwise" in said(outline_cut(vertices=SQUARE[[0, 1, 2, 1]]))
    assert "counter-clockwise" not in said(outline_cut(vertices=SQUARE + np.array([0, 10])))
    assert "three places" not in said(outline_cut(start=np.array([[0, 0.5], [1, 0.5], [2, 0.5]])))
    left = np.array([[3, 0.0, 1.0]])
    assert "three places" not in said(outline_cut(reached=left))


def test_turns_of_any_size_are_said() -> None:
    one = np.array([1e200, 0.0])
    for other in ([1e200, 1e-200], [-1e200, 1e-200], [0.0, 0.0]):
        said(outline_cut(force=one, turned=np.array(other)))


def test_works_are_those_of_the_worst_place_and_load() -> None:
    """A twist about the middle pushes in at one end of a side and out at the other; and a turn of 1.2 rad."""

    def first(y, **changes) -> list[str]:
        twists = outline_cut().twists
        twists[0] = y
        broken = rg.verify(outline_cut(twists=twists, **changes)).violations
        return [x for x in broken if x.startswith("box 1:")]

    assert first([0, -1, 0.5]) == ["box 1: some force of a finger in it opposes its twist"]
    assert first([0, 0, 0]) == ["box 1: the load does no work along its twist"]
    turn = [np.array([np.cos(0.6), sign * np.sin(0.6)]) for sign in (-1, 1)]  # tangents meet at 1 / cos 0.6
    for least, good in (0.61, True), (0.5, False):
        found = first([-1, 0, 0], force=turn[0], turned=turn[1], min_normal=least)
        assert (found == []) == good, least
    judged = _Cut(outline_cut(min_normal=1.0, max_force=9.0))  # by (1/2, 2) at (1, -1/2)
    least = judged.least_work([Fraction(0), Fraction(1), Fraction(1)], (1, Fraction(1, 4)))
    assert float(least) == pytest.approx(9 * (-0.5 - 2e-3) / np.hypot(1, 1e-3))


def test_places_on_the_ends_of_boxes_are_in_them() -> None:
    for order in [0.0, 0.5, 1.0], [1.0, 0.5, 0.0]:
        start = np.array([[1, f] for f in order])
        assert "of the start" not in said(outline_cut(start=start, reached=np.zeros((0, 3))))
    for rows in [[1, 0.1], [3, 0.5], [3, 0.7]], [[3, 0.5], [3, 0.7], [1, 0.1]]:
        none = {"boxes": np.zeros((0, 6)), "twists": np.zeros((0, 3))}
        assert "goal on sides" in said(outline_cut(goal=np.array(rows), **none))


def test_every_arc_needs_its_boxes_and_what_is_inside_another_none() -> None:
    words = "boxes do not cover all pairs across the cut on sides 1 and 3"
    arcs = np.array([[1, 0, 0.5], [1, 0.5, 1]])
    assert covering([[1, 3, 0, 0.5, 0, 1]], reached=arcs) == words
    assert covering([[1, 3, 0, 1, 0, 1]], reached=arcs) == ""
    assert covering([[1, 3, 0, 1, 0, 1]], reached=np.array([[1, 0, 1], [1, 0.2, 0.5]])) == ""
