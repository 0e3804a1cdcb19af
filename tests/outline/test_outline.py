"""Outlines against closed forms, shapely and their own laws."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ellipe

import regrasp as rg
from strategies import POWERS, angles, points

pytestmark = pytest.mark.oracle

RECTANGLE = [[0, 0], [4, 0], [4, 2], [0, 2]]
# A radius for each of seven directions, too even for a spline through them to cross itself.
RADII = st.lists(st.floats(0.8, 1.6).map(lambda r: round(r, 3)), min_size=7, max_size=7)


def star(radii) -> np.ndarray:
    turn = np.arange(len(radii)) * 2 * pi / len(radii)
    return np.array(radii)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])


@st.composite
def outlines(draw) -> rg.Outline:
    through = star(draw(RADII)) + draw(points)
    return (rg.Outline if draw(st.booleans()) else rg.Outline.smooth)(through)


def along(outline: rg.Outline, count: int = 23) -> np.ndarray:
    return outline.sample(count, clearance=1e-3 * outline.length)


# -- closed forms -----------------------------------------------------------------------------------------


def test_a_rectangle() -> None:
    plate = rg.Outline(RECTANGLE)
    assert (plate.length, plate.area, list(plate.centre_of_mass)) == (12, 8, [2, 1])
    contact = plate.contact_at(5, friction=0.3, max_force=7, name="A")
    assert contact == rg.Contact([2, 0], [-1, 0], 0.3, max_force=7, name="A")
    assert plate.contact_at(17, friction=0.3) == plate.contact_at(-7, friction=0.3)
    np.testing.assert_array_equal(plate.polygon(), np.array(RECTANGLE) - [2, 1])


def test_a_circle_as_a_hole_moves_the_centre_of_mass() -> None:
    plate = rg.Outline(RECTANGLE, [rg.Outline.ellipse(0.5, 0.5, centre=[1, 1])])
    area = 8 - pi / 4
    assert plate.area == pytest.approx(area, rel=1e-14)
    np.testing.assert_allclose(plate.centre_of_mass, [(16 - pi / 4) / area, 1], rtol=1e-14)


@pytest.mark.parametrize(("a", "b"), [(1, 1), (2, 1), (1, 1000), (3e-6, 1e-6), (1e6, 3e6)])
def test_an_ellipse(a: float, b: float) -> None:
    ellipse = rg.Outline.ellipse(a, b, centre=[3 * a, b])
    perimeter = 4 * max(a, b) * ellipe(1 - (min(a, b) / max(a, b)) ** 2)
    assert ellipse.length == pytest.approx(perimeter, rel=1e-13)
    assert ellipse.area == pytest.approx(pi * a * b, rel=1e-13)
    np.testing.assert_allclose(ellipse.centre_of_mass, [3 * a, b], rtol=1e-13)
    quarters = ellipse.points(np.arange(4) * ellipse.length / 4)
    np.testing.assert_allclose(quarters, [[a, 0], [0, b], [-a, 0], [0, -b]], atol=1e-12 * max(a, b))
    np.testing.assert_allclose(ellipse.normals(ellipse.length / 4), [0, -1], atol=1e-9)


def test_arc_length_on_a_circle_is_the_angle() -> None:
    s = np.linspace(-7, 7, 57).reshape(3, 19)
    circle = rg.Outline.ellipse(1, 1)
    unit = np.stack([np.cos(s), np.sin(s)], axis=-1)
    np.testing.assert_allclose(circle.points(s), unit, atol=1e-14)
    np.testing.assert_allclose(circle.normals(s), -unit, atol=1e-14)


def test_a_spline_goes_through_its_points() -> None:
    through = star([1, 2, 1, 2, 1, 1.5, 0.7])
    outline = rg.Outline.smooth(through)
    s = [outline.nearest(point) for point in through]
    np.testing.assert_allclose(outline.points(s) + outline.centre_of_mass, through, atol=1e-12)
    assert s[0] == pytest.approx(0, abs=1e-9)
    assert sorted(s) == s


def test_polygons_agree_with_shapely_far_from_the_origin() -> None:
    outer, hole = star([2, 1, 2, 1.5, 1, 2, 1.2]) + 1e6, star([0.3] * 5) + 1e6 + 0.2
    outline, region = rg.Outline(outer, [hole]), shapely.Polygon(outer - 1e6, [hole - 1e6])
    assert outline.area == pytest.approx(region.area, rel=1e-9)
    expected = [region.centroid.x, region.centroid.y]
    np.testing.assert_allclose(outline.centre_of_mass - 1e6, expected, atol=1e-9)


# -- laws -------------------------------------------------------------------------------------------------


@given(outlines())
def test_normals_are_unit_and_point_inside(outline: rg.Outline) -> None:
    s = along(outline)
    normals, region = outline.normals(s), shapely.Polygon(outline.polygon(1e-7 * outline.length))
    np.testing.assert_allclose(np.hypot(*normals.T), 1, rtol=1e-14)
    step = 1e-4 * outline.length * normals
    assert shapely.contains_xy(region, *(outline.points(s) + step).T).all()
    assert not shapely.contains_xy(region, *(outline.points(s) - step).T).any()


@given(outlines(), st.floats(0.001, 0.999))
def test_a_short_step_of_arc_length_is_that_long_and_square_to_the_normal(
    outline: rg.Outline, part: float
) -> None:
    h = 1e-5 * outline.length
    a, b = outline.points([part * outline.length - h, part * outline.length + h])
    corners = np.append(outline.boundary.corners, [np.inf])
    if abs(corners - part * outline.length).min() > 2 * h:
        assert hypot(*(b - a)) == pytest.approx(2 * h, rel=1e-5)
        assert abs((b - a) @ outline.normals(part * outline.length)) < 1e-3 * h


@given(outlines())
def test_length_and_area_are_the_limits_of_those_of_polygons(outline: rg.Outline) -> None:
    ring = shapely.Polygon(outline.polygon(1e-7 * outline.length))
    assert outline.length == pytest.approx(ring.length, rel=1e-5)
    assert outline.area == pytest.approx(ring.area, rel=1e-5)
    assert hypot(ring.centroid.x, ring.centroid.y) < 1e-5 * outline.length


@given(outlines(), points)
def test_nearest_is_the_nearest_of_dense_samples(outline: rg.Outline, point: tuple[float, float]) -> None:
    at = outline.points(outline.nearest(point)) + outline.centre_of_mass
    dense = outline.points(np.linspace(0, outline.length, 1001)) + outline.centre_of_mass
    best = np.hypot(*(dense - point).T).min()
    found = hypot(*(at - point))
    assert best - outline.length / 1000 <= found <= best * (1 + 1e-12) + 1e-12


@given(outlines())
def test_nearest_gives_the_arc_length_of_a_point_back(outline: rg.Outline) -> None:
    s = along(outline)
    found = [outline.nearest(point + outline.centre_of_mass) for point in outline.points(s)]
    np.testing.assert_allclose(found, s, atol=1e-7 * outline.length)


@given(RADII, angles, points, POWERS, st.booleans())
def test_moving_turning_and_scaling(radii, angle, shift, scale, is_smooth) -> None:
    make = rg.Outline.smooth if is_smooth else rg.Outline
    turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
    given_, moved = make(star(radii)), make(scale * (star(radii) @ turn.T + shift))
    assert moved.length == pytest.approx(scale * given_.length, rel=1e-11)
    assert moved.area == pytest.approx(scale**2 * given_.area, rel=1e-11)
    s = along(given_)
    np.testing.assert_allclose(along(moved), scale * s, rtol=1e-11)
    np.testing.assert_allclose(moved.points(scale * s), scale * given_.points(s) @ turn.T, atol=1e-10 * scale)
    np.testing.assert_allclose(moved.normals(scale * s), given_.normals(s) @ turn.T, atol=1e-8)


@given(RADII, st.booleans())
def test_the_direction_of_the_vertices_does_not_matter(radii, is_smooth) -> None:
    make = rg.Outline.smooth if is_smooth else rg.Outline
    vertices = star(radii)
    reverse = make(np.roll(vertices[::-1], 1, axis=0))
    assert reverse == make(vertices)
    assert hash(reverse) == hash(make(vertices))


@given(RADII, st.integers(1, 6))
def test_another_first_vertex_shifts_the_arc_length(radii, k) -> None:
    outline, other = rg.Outline(star(radii)), rg.Outline(np.roll(star(radii), -k, axis=0))
    s = along(outline)
    start = outline.nearest(star(radii)[k])
    np.testing.assert_allclose(other.points(s - start), outline.points(s), atol=1e-12)


@given(RADII, st.integers(1, 60), st.floats(0.001, 0.2))
def test_samples_keep_their_clearance(radii, count, clearance) -> None:
    outline = rg.Outline(star(radii))
    evenly = (np.arange(count) + 0.5) * outline.length / count
    corners = outline.boundary.corners
    around = np.concatenate([corners - outline.length, corners, corners + outline.length])
    away = abs(evenly[:, None] - around).min(axis=1)
    s = outline.sample(count, clearance=clearance)
    kept = np.isclose(evenly[:, None], s, rtol=1e-12).any(axis=1)
    assert (away[kept] >= clearance * (1 - 1e-12)).all()
    assert (away[~kept] <= clearance * (1 + 1e-12)).all()
    assert kept.sum() == s.size
