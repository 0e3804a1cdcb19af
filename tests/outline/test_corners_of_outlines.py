"""Corners, holes and contacts of outlines."""

import pickle
from itertools import pairwise
from math import pi

import numpy as np
import pytest
import shapely
from hypothesis import given

import regrasp as rg
from regrasp.outline import parts
from regrasp.plots import plot_outline
from strategies import POWERS, points

pytestmark = pytest.mark.oracle


RECTANGLE = [[0, 0], [4, 0], [4, 2], [0, 2]]


# -- corners ----------------------------------------------------------------------------------------------


def test_a_vertex_on_a_straight_side_is_no_corner() -> None:
    plate = rg.Outline([[0, 0], [1, 0], [4, 0], [4, 2], [0, 2]])
    assert list(plate.boundary.corners) == [0, 4, 6, 10]
    assert plate.contact_at(1, friction=0.3) == rg.Contact([-1, -1], [0, 1], 0.3)


@pytest.mark.parametrize(("sides", "corners"), [(71, 71), (73, 0)])
def test_a_turn_of_more_than_five_degrees_is_a_corner(sides: int, corners: int) -> None:
    turn = np.arange(sides) * 2 * pi / sides
    wheel = rg.Outline(np.column_stack([np.cos(turn), np.sin(turn)]))
    assert wheel.boundary.corners.size == corners


def test_no_contact_at_a_corner() -> None:
    for s in (0, 4, 12, 6 + 1e-12):
        with pytest.raises(
            rg.InvalidInput, match=r"^arc length \d+ is at a corner, where no normal is defined$"
        ):
            rg.Outline(RECTANGLE).contact_at(s, friction=0.3)


def test_smooth_outlines_have_no_corners() -> None:
    assert rg.Outline.ellipse(2, 1).sample(9).size == 9


# -- values -----------------------------------------------------------------------------------------------


def test_outlines_are_values() -> None:
    same = [rg.Outline(RECTANGLE, [[[1, 0.5], [2, 0.5], [2, 1]]]) for _ in range(2)]
    assert same[0] == same[1]
    assert len({*same, rg.Outline(RECTANGLE), rg.Outline.smooth(RECTANGLE), rg.Outline.ellipse(1, 2)}) == 4
    assert pickle.loads(pickle.dumps(same[0])) == same[0]
    with pytest.raises(AttributeError):
        same[0].holes = ()
    for array in (same[0].boundary.vertices, same[0].centre_of_mass, same[0].boundary.corners):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 9


def test_the_array_given_may_change_afterwards() -> None:
    vertices = np.array(RECTANGLE, dtype=float)
    outline = rg.Outline(vertices)
    vertices[:] = 0
    assert outline == rg.Outline(RECTANGLE)


def test_closing_and_repeated_vertices_are_left_out() -> None:
    nearly = [[0, 0], [4, 0], [4, 0], [4, 2], [0, 2], [1e-12, -1e-12]]
    assert rg.Outline(nearly) == rg.Outline([*RECTANGLE, [0, 0]]) == rg.Outline(RECTANGLE)


def test_it_prints_itself() -> None:
    holes = [[[1, 0.5], [2, 0.5], [2, 1]], [[3, 0.5], [3.5, 0.5], [3, 1]]]
    assert repr(rg.Outline(RECTANGLE, holes)) == "Outline(polygon, length 12, area 7.625, 2 holes)"
    assert repr(rg.Outline.ellipse(1, 1)) == "Outline(smooth, length 6.28319, area 3.14159)"


# -- what is refused --------------------------------------------------------------------------------------


def square(side: float, x: float, y: float) -> np.ndarray:
    """Its lower left corner at (x, y)."""
    return side * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) + (x, y)


@pytest.mark.parametrize(
    ("vertices", "text"),
    [
        ([], "outline must have shape (any, 2), got (0,)"),
        (np.zeros((0, 2)), "outline needs three different points or more, got 0"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "outline must have shape (any, 2), got (3, 3)"),
        ("abc", "outline must be numbers of shape (any, 2), got 'abc'"),
        ([[0, 0], [1, 0], [np.nan, 1]], "outline must be finite"),
        ([[0, 0], [1, 0], [0, 0]], "outline needs three different points or more, got 2"),
        ([[1, 1]] * 5, "outline needs three different points or more, got 0"),
        ([[0, 0], [1, 1], [2, 2]], "outline encloses no area: its points lie on one line"),
        ([[0, 0], [2, 2], [2, 0], [0, 2]], "outline crosses or touches itself near (1, 1)"),
        ([[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]], "outline crosses or touches itself near (2, 0)"),
        ([[0, 0], [2, 0], [1, 0], [1, 1], [0, 1]], "outline crosses or touches itself near (2, 0)"),
    ],
)
def test_polygons_refused(vertices, text: str) -> None:
    with pytest.raises(rg.InvalidInput) as caught:
        rg.Outline(vertices)
    assert str(caught.value).startswith(text)


@given(POWERS, points)
def test_a_crossing_is_named_at_every_scale(scale: float, shift: tuple[float, float]) -> None:
    with pytest.raises(rg.InvalidInput, match=r"crosses or touches itself near \("):
        rg.Outline(scale * (np.array([[0, 0], [2, 2], [2, 0], [0, 2]]) + shift))


def test_a_spline_that_crosses_itself_is_refused() -> None:
    with pytest.raises(rg.InvalidInput, match="outline crosses or touches itself"):
        rg.Outline.smooth([[0, 0], [2, 2], [2, 0], [0, 2.5]])


@pytest.mark.parametrize(
    ("holes", "text"),
    [
        ([square(1, 5, 0)], "hole 0 must lie inside the outline without touching it"),
        ([square(1, 3.5, 0.5)], "hole 0 must lie inside the outline without touching it"),
        ([square(1, 1, 0)], "hole 0 must lie inside the outline without touching it"),
        ([square(0.5, 0.5, 0.5), square(0.5, 1, 1)], "holes 0 and 1 overlap or touch"),
        ([square(0.5, 0.5, 0.5), square(0.2, 0.6, 0.6)], "holes 0 and 1 overlap or touch"),
        (
            [square(0.5, 0.5, 0.5), [[2, 0.5], [3, 1.5], [3, 0.5], [2, 1.5]]],
            "hole 1 crosses or touches itself",
        ),
        ([rg.Outline(square(1, 0.5, 0.5), [square(0.2, 0.8, 0.8)])], "hole 0 has holes itself"),
        ([[[1, 1], [2, 1]]], "hole 0 needs three different points or more, got 2"),
    ],
)
def test_holes_refused(holes, text: str) -> None:
    with pytest.raises(rg.InvalidInput) as caught:
        rg.Outline(RECTANGLE, holes)
    assert str(caught.value).startswith(text)


@pytest.mark.parametrize(
    ("ask", "text"),
    [
        (lambda o: o.nearest([1, 2, 3]), "position must have shape (2), got (3,)"),
        (lambda o: o.sample(0), "count must be a whole number of at least 1, got 0"),
        (lambda o: o.sample(2.5), "count must be a whole number of at least 1, got 2.5"),
        (lambda o: o.sample(9, clearance=-1), "clearance must be at least 0, got -1"),
        (lambda o: o.points(np.inf), "arc lengths must be finite, got inf"),
        (lambda o: o.normals("a"), "arc lengths must be numbers, got 'a'"),
        (lambda o: o.contact_at(np.nan, friction=0.3), "arc_length must be finite, got nan"),
        (lambda o: o.contact_at(1, friction=-1), "contact: friction must be at least 0, got -1"),
        (lambda o: o.polygon(0), "tolerance must be greater than 0, got 0"),
        (lambda _: rg.Outline.ellipse(1, 0), "b must be greater than 0, got 0"),
    ],
)
def test_questions_refused(ask, text: str) -> None:
    with pytest.raises(rg.InvalidInput) as caught:
        ask(rg.Outline(RECTANGLE))
    assert str(caught.value).startswith(text.replace("(2)", "(2,)"))


# -- parts and pictures -----------------------------------------------------------------------------------


def test_parts_measure_what_their_dimensions_say() -> None:
    assert np.ptp(parts.bottle(height=0.3).polygon()[:, 1]) == pytest.approx(0.3, rel=1e-6)
    assert np.ptp(parts.bracket(width=0.1).polygon()[:, 0]) == pytest.approx(0.1, rel=1e-6)
    reach = np.hypot(*parts.gear(teeth=12, module=0.002, keyway=1e-5).polygon().T)
    assert reach.max() == pytest.approx(0.002 * (12 / 2 + 1), rel=1e-2)
    assert np.ptp(parts.cam(base=0.01, lift=0.005).polygon()[:, 1]) == pytest.approx(0.025, rel=1e-4)
    assert parts.wrench(length=0.3).length > parts.wrench().length + 0.27
    assert parts.puzzle_piece().area == pytest.approx(
        0.02**2, rel=2e-3
    )  # what the sockets lose the knobs gain


@pytest.mark.parametrize("name", parts.PARTS)
def test_parts_scale_and_take_fingers_everywhere(name: str) -> None:
    part = parts.PARTS[name]()
    assert part.sample(100).size >= 96
    assert 0.02 < np.ptp(part.polygon(), axis=0).max() < 0.3


def test_a_picture_shows_the_outline() -> None:
    bracket = parts.bracket()
    s = bracket.sample(10)
    ax = plot_outline(bracket, arc_lengths=s)
    named = {artist.get_gid(): artist for artist in ax.get_children() if artist.get_gid()}
    np.testing.assert_allclose(np.column_stack(named["candidates"].get_data()), bracket.points(s))
    rings = named["material"].get_path().to_polygons()
    drawn = abs(shapely.Polygon(rings[0], rings[1:]).area)
    assert drawn == pytest.approx(bracket.area, rel=1e-6)
    assert ax.get_aspect() == 1
    marks = [text.get_text() for text in ax.texts]
    steps = [float(b) - float(a) for a, b in pairwise(marks)]
    assert marks[0] == "0"
    np.testing.assert_allclose(steps, steps[0])
    assert "normals" in named


def test_a_picture_goes_where_it_is_told() -> None:
    ax = plot_outline(rg.Outline.ellipse(2, 1))
    assert plot_outline(rg.Outline(RECTANGLE), ax) is ax
    assert "candidates" not in {artist.get_gid() for artist in ax.get_children()}
