"""Sides on which fingers may be, by hand: arcs that overlap, corners, ends, and what is spread over them."""

import numpy as np
import pytest

from placements import BRACKET
from regrasp.outline.outline import Outline
from regrasp.planning.placement.reachable import sides_of

pytestmark = pytest.mark.contract

STARTS = np.array([0.0, 4, 5, 8, 10, 11])  # of the sides of the bracket, 14 m around
LENGTHS = np.array([4.0, 1, 3, 2, 1, 3])
INWARD = np.array([1, -1])


def stretches(arcs=None, from_corners=0.0) -> list[tuple[float, float]]:
    """Arc lengths from which to which fingers may be, side by side."""
    sides = sides_of(BRACKET, from_corners, arcs)
    assert (np.diff(sides.ends[:, 0]) > 0).all()
    return [
        tuple(sides.arc_length(i, float(u)) for u in ends)  # type: ignore[misc]
        for i, ends in enumerate(sides.ends)
    ]


@pytest.mark.parametrize(
    ("arcs", "wanted"),
    [
        ([(1, 3.5)], [(1, 3.5)]),
        ([(1, 3), (2, 3.5)], [(1, 3.5)]),
        ([(2, 3.5), (1, 3)], [(1, 3.5)]),
        ([(1, 3.5), (2, 3)], [(1, 3.5)]),  # one within the other
        ([(1, 2), (2, 3.5)], [(1, 3.5)]),  # end to end
        ([(1, 1.5), (3, 3.5), (1.2, 1.4)], [(1, 1.5), (3, 3.5)]),
        ([(0.5, 0.6), (1, 3), (1.5, 2), (2.5, 3.5)], [(0.5, 0.6), (1, 3.5)]),
        ([(3, 4.5)], [(3, 4), (4, 4.5)]),  # past a corner
        ([(13, 1)], [(0, 1), (13, 14)]),  # past the first vertex
        ([(-1, 1)], [(0, 1), (13, 14)]),
        ([(13, 15)], [(0, 1), (13, 14)]),
        ([(4, 5)], [(4, 5)]),  # a whole side
    ],
)
def test_arcs_are_what_they_cover_together(arcs, wanted) -> None:
    np.testing.assert_allclose(stretches(arcs), wanted, atol=1e-12)


def test_all_sides_lose_the_same_at_both_ends() -> None:
    ends = np.stack([STARTS, STARTS + LENGTHS], axis=1)
    np.testing.assert_allclose(stretches(), ends, atol=1e-12)
    np.testing.assert_allclose(stretches(from_corners=0.3), ends + 0.3 * INWARD, atol=1e-12)
    short = stretches(from_corners=0.6)  # sides of 1 m have nothing left
    np.testing.assert_allclose(short, (ends + 0.6 * INWARD)[LENGTHS > 1.2], atol=1e-12)
    both = stretches([(0.2, 3.8)], 0.3)
    np.testing.assert_allclose(both, [(0.3, 3.7)], atol=1e-12)


def test_vertices_that_are_no_corners_cost_nothing_but_are_near_those_that_are() -> None:
    """A floor in three parts: of 0.3 m at its ends 0.1 m are on the part beside."""
    floor = [[0, 0], [0.2, 0], [3.8, 0], [4, 0]]
    sides = sides_of(Outline([*floor, [4, 2], [0, 2]]), 0.3)
    assert sides.edges.tolist() == [1, 3, 4, 5]
    np.testing.assert_allclose(sides.ends[0], [1 + 0.1 / 3.6, 2 - 0.1 / 3.6], atol=1e-12)


def test_fingers_stop_at_both_ends_of_a_side_and_are_spread_by_its_length() -> None:
    sides = sides_of(BRACKET, 0.0, [(1, 3), (6, 7)])
    for u, way, there in ((0.5, 0.1, 0.6), (0.5, -0.1, 0.4), (0.5, 1.0, 0.75), (0.5, -1.0, 0.25)):
        assert sides.moved(0, u, way) == (0, pytest.approx(there))
    on, u = sides.spread(6)  # 3 m, by half of one
    assert on.tolist() == [0] * 4 + [1] * 2
    places = [sides.arc_length(int(side), float(at)) for side, at in zip(on, u, strict=True)]
    np.testing.assert_allclose(places, [1.25, 1.75, 2.25, 2.75, 6.25, 6.75], atol=1e-12)
