"""Polygons on the bottom of a cube, and on a face with a wedge cut out: where they may be and how wide."""

from functools import partial
from itertools import product
from math import nan

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.placed.faces.polygons import polygon_wrong

pytestmark = pytest.mark.oracle

REACH, UP = 3**0.5, np.array([0, 0, 1.0])
SQUARE = np.array([[-0.1, -0.1, -1], [0.1, -0.1, -1], [0.1, 0.1, -1], [-0.1, 0.1, -1]])
VERTICES, FACES = (np.asarray(a) for a in rg.Mesh.box(2, 2, 2).surface())
NARROW = "the polygon of A is narrower than its radius, and its face does not end there"
OFF = "the polygon of A is not on faces with its normal"
AROUND = "the polygon of A is not around its place"
CONVEX = "the polygon of A is not convex"


def said(patch, place=(0, 0, -1), radius=0.0, *, vertices=VERTICES, faces=FACES, normal=UP) -> str:
    contact = rg.Contact(place, normal, 0.5, name="A")
    return "; ".join(polygon_wrong(vertices, faces, contact, np.array(patch, dtype=float), radius))


def box(left, right, low, high, z=-1.0) -> np.ndarray:
    return np.array([[left, low, z], [right, low, z], [right, high, z], [left, high, z]])


@pytest.mark.parametrize("scale", [1.0, 1e-4, 1e4])
def test_radii_are_no_wider_than_polygons(scale) -> None:
    wide = partial(said, place=[0, 0, -scale], vertices=scale * VERTICES)
    for k, (part, good) in product(range(4), ((1 + 0.9995e-9, True), (1 + 1.0005e-9, False))):
        patch = scale * SQUARE
        patch[:, :2] *= 2
        moved = [k, (k + 1) % 4]
        axis, sign = ((1, -1), (0, 1), (1, 1), (0, -1))[k]
        patch[moved, axis] = sign * scale * 0.1
        assert wide(patch, radius=0.1 * part * scale) == ("" if good else NARROW)


def test_polygons_end_where_faces_do() -> None:
    """The face ends at x = 1: a polygon about (0.7, 0) may be narrower there, and nowhere else."""

    def told(radius, right=1.0, low=-0.5, left=0.2) -> str:
        return said(box(left, right, low, 0.5), [0.7, 0, -1], radius)

    assert told(0.5) == told(0.3) == told(0.3, right=1 - 1e-12) == told(0.5, right=1 - 0.9e-9 * REACH) == ""
    for wrong in ({"right": 1 - 1.1e-9 * REACH}, {"right": 0.95}, {"low": -0.45}, {"left": 0.25}):
        assert told(0.5, **wrong) == NARROW
    for more, good in (0.9e-12, True), (1.1e-12, False):
        assert told(0.3, right=1 + more * REACH) == ("" if good else OFF)
    for way in 1, -1:  # the two triangles of the face share one of its diagonals, which is no end of it
        patch = np.array([[0, 0], [0.4, 0.4 * way], [0.4, -0.2 * way], [0.2, -0.4 * way]])
        patch = np.c_[patch[::way], -np.ones(4)]
        assert said(patch, [0.25, -0.05 * way, -1], 0.3) == NARROW


def test_a_side_is_nearest_where_its_edge_is() -> None:
    """A line through another point of the edge than the nearest leaves out what is on the face."""
    for slope, good in (0.0, True), (0.5, False), (-0.5, False):
        high = 0.5 if slope >= 0 else -0.5
        patch = [[0.3, -0.5, -1], [1, -0.5, -1], [1, 0.5, -1], [0.3, 0.5, -1]]
        if slope:  # through (1, 0.15), at a right angle to the way there from (0.7, 0)
            cut = 1 - 0.5 * (abs(high) - 0.15)
            patch[2 if slope > 0 else 1] = [cut, high, -1]
            patch.insert(2, [1, 0.15 * np.sign(slope), -1])
        assert said(patch, [0.7, 0, -1], 0.38) == ("" if good else NARROW)


@pytest.mark.parametrize("turned", [1, -1])
@pytest.mark.parametrize(
    ("patch", "words"),
    [
        (SQUARE, ""),
        (SQUARE[[0, 2, 1, 3]], AROUND),
        (np.vstack([SQUARE, SQUARE[3]]), CONVEX),
        (np.vstack([SQUARE, [-0.1, 0, -1]]), ""),  # in one line
        (np.vstack([SQUARE, [-0.05, 0, -1]]), CONVEX),
        (np.vstack([SQUARE, [-0.1 + 0.45 * 2.0**-46 * REACH, 0, -1]]), ""),
        (np.vstack([SQUARE, [-0.1 + 0.55 * 2.0**-46 * REACH, 0, -1]]), CONVEX),
        (SQUARE + np.array([0.1, 0, 0]), AROUND),
        (SQUARE + np.array([0.0999, 0, 0]), ""),
        (SQUARE + np.array([0.1 - 0.9e-12 * REACH, 0, 0]), AROUND),
        (SQUARE + np.array([0.1 - 1.1e-12 * REACH, 0, 0]), ""),
        (SQUARE - np.array([0, 0.1001, 0]), AROUND),
        (SQUARE + 0.9e-9 * REACH * UP, ""),
        (SQUARE + 1.1e-9 * REACH * UP, AROUND),
        (SQUARE - 1.1e-9 * REACH * UP, AROUND),
        (SQUARE * [1, 1, -1], AROUND),
        (SQUARE[:2], "A has no polygon"),
        (SQUARE[:3] - np.array([0.02, -0.02, 0]), ""),
        (SQUARE + nan, AROUND),
        (
            [[np.cos(t), np.sin(t), -10] for t in 0.4 * np.pi * np.array([0, 2, 4, 1, 3])] / np.array(10.0),
            CONVEX,
        ),
    ],
)
def test_polygons_are_convex_about_their_places(patch, words, turned) -> None:
    assert said(np.array(patch)[::turned]) == words


def test_polygons_are_flat_to_rounding() -> None:
    for part, good in (0.97, True), (1.03, False):
        for k, sign in product(range(4), (-1, 1)):
            patch = SQUARE.copy()
            patch[k, 2] += sign * part * 2.0**-46 * REACH
            assert said(patch) == ("" if good else "the polygon of A is not flat")


def test_a_finger_of_no_polygon_is_at_its_place() -> None:
    for axis, sign, (part, good) in product(range(3), (-1, 1), ((0.9, True), (1.1, False))):
        at = np.array([[0, 0, -1]]) + sign * part * 1e-9 * REACH * np.eye(3)[axis]
        assert said(at) == ("" if good else "A has no polygon")
    assert said(SQUARE[:1] * [0, 0, 1], radius=1e-300) == "A has no polygon"
    assert said([[nan, 0, -1]]) == "A has no polygon"


def test_a_place_alone_is_on_a_face_with_its_normal() -> None:
    away = "A is on no face with its normal"
    for place, normal, good in (
        ((0.3, -0.2, -1), UP, True), ((0.3, -0.2, -1), -UP, False), ((0.3, -0.2, 1), UP, False),
        ((0.3, -0.2, -1.1), UP, False), ((1.1, -0.2, -1), UP, False), ((5.0, 0.3, -0.2), UP, False),
    ):  # fmt: skip
        assert said([place], place, normal=normal) == ("" if good else away)
    for part, good in (0.9, True), (1.1, False):
        for place in (1 + part * 1e-9 * REACH, 0, -1), (0, 0, -1 - part * 1e-9 * REACH):
            assert said([place], place) == ("" if good else away)


def test_faces_have_the_normal_and_the_plane_of_the_place() -> None:
    assert said(SQUARE, normal=-UP) == OFF
    assert said(SQUARE, vertices=VERTICES * [1, 1, 1.05]) == OFF
    for part, good in (0.9, True), (1.1, False):
        assert said(SQUARE + part * 1e-9 * REACH * UP, [0, 0, -1 + part * 1e-9 * REACH]) == (
            "" if good else OFF
        )
        lean = np.array([part * 1e-9, 0, 1])
        sides = np.c_[SQUARE[:, :2], -1 - part * 1e-9 * SQUARE[:, 0]]
        assert said(sides, normal=lean) == ("" if good else OFF)
    for place in [1.3, 0, -1], [0, -1.3, -1], [1.15, 1.15, -1]:  # beside the face, in its plane
        assert said(SQUARE + np.array(place) + UP, place) == OFF
    for part, good in (0.9, True), (1.1, False):  # the place itself, with a little polygon
        at = np.array([1 + part * 1e-9 * REACH, 0, -1])
        less = 0.5e-9 * REACH
        assert said(box(at[0] - less, at[0] + less, -less, less), at) == ("" if good else OFF)


def notched() -> tuple[np.ndarray, np.ndarray]:
    """A face from -2 to 2 without a wedge, whose tip is in its middle, from (2, 1) to (1, 2)."""
    points = np.array([[-2, -2], [2, -2], [2, 1], [1, 2], [-2, 2], [0, 0]], dtype=float)
    return np.c_[points, -np.ones(6)], np.array([[0, 5, 1], [1, 5, 2], [0, 4, 5], [4, 3, 5]])


def test_no_end_of_a_face_is_within_a_polygon() -> None:
    """Ends may touch a polygon, pass by it, and lie beyond it; none goes through, however little."""
    points, faces = notched()
    told, reach = partial(said, vertices=points, faces=faces), 3.0
    for patch, good in (
        (box(-1.5, 0, -1.5, 0), True),  # the tip is its corner
        (box(-1.5, 0.9e-12 * reach, -1.5, 0.9e-12 * reach), True),
        (box(-1.5, 1e-11, -1.5, 1e-11), False),
        (box(-1.5, -0.001, -1.5, 0), True),  # an end, longer by a thousandth, would reach it
        (box(-1.5, 0.5, -1.5, 0), True),
        (box(-1.5, 0.5, -1.5, 1e-9), False),
        (box(-1.5, 1e-9, -1.5, 1.5), False),
        (box(-2, 0, -2, 2), True),
        (box(-2, 2, -2, 0), True),
        (box(-2, 2, -2, 2), False),
        (box(-1.9, 1.9, -1.9, 1.9), False),  # the wedge goes through
        (box(-1.9, 0.9, -1.9, 0.2), False),
        (box(-2.1, 0, -1.5, 0), False),
        ([[-1.5, -1.5, -1], [1, -0.2, -1], [0.9, 0.4501, -1]], False),
        ([[-2.0004, -1, -1], [-1, -2, -1], [0, -1, -1], [-1, 0, -1]], False),  # a tip, of little area
        ([[-1.5, -1.5, -1], [1, -0.2, -1], [0.9, 0.4499, -1]], True),
        ([[-1.5, -1.5, -1], [1.5, -0.2, -1], [0.9, 0.5, -1]], False),
        ([[-1.5, -1.5, -1], [1.5, -0.2, -1], [1.5, 0.751, -1]], False),
    ):
        inside = [-1.0, -1, -1] if len(patch) == 4 else [-0.2, -0.6, -1]
        assert (told(patch, inside) == "") == good, patch
        turn = np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1.0]])
        assert (told(patch @ turn.T, turn @ inside, vertices=points @ turn.T) == "") == good


def test_ends_at_reflex_corners_end_polygons_at_their_tip_alone() -> None:
    """About (-1, -1) the tip of the wedge is 2^0.5 away: a side may be there, at a right angle to the way."""
    points, faces = notched()
    told = partial(said, place=[-1, -1, -1], vertices=points, faces=faces)
    for less, radius, good in (0, 1.5, True), (0, 2.95, False), (0.01, 1.5, False), (0.01, 1.4, True):
        cut = np.array([[-2, -2], [1.9, -2], [1.9, -1.9 - less], [-1.9 - less, 1.9], [-2, 1.9]])
        assert told(np.c_[cut, -np.ones(5)], radius=radius) == ("" if good else NARROW)


def test_faces_in_other_planes_do_not_count() -> None:
    """Their ends pass below and above the polygon, and those of its own plane beside it."""
    for height, good in (-1.0, True), (1.0, True), (0.0, False):
        more = np.array([[0, -3, -1 + height], [0, 3, -1 + height], [3, 0, -1 + height]])
        points = np.vstack([VERTICES, more])
        for order in [8, 10, 9], [8, 9, 10]:
            given = np.vstack([FACES, order])
            corners = points[order]
            facing = np.cross(corners[1] - corners[0], corners[2] - corners[0])[2] < 0
            assert (said(SQUARE, vertices=points, faces=given) == "") == (good or not facing)
