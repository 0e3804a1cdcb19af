"""Where round tips do not fit, by hand: corners, slots, edges beside, and hollows of curves."""

import numpy as np
import pytest

from placements import BRACKET
from regrasp.outline.outline import Outline
from regrasp.planning.placement.curves import tips
from regrasp.planning.placement.curves.curved_sides import CurvedSides
from regrasp.planning.placement.curves.tips import _nearest, out_of_reach, within_reach
from regrasp.planning.placement.reachable import sides_of

pytestmark = pytest.mark.contract


def taken(shape: Outline, edge: int, radius: float) -> list[tuple[float, float]]:
    """Of an edge, from where to where [m] a tip does not fit; all of an edge from 0 to its length."""
    sides = sides_of(shape, 0.0)
    spans = out_of_reach(sides, edge, radius)
    length = sides.lengths[edge]
    return [(max((lo - edge) * length, 0.0), min((hi - edge) * length, length)) for lo, hi in spans]


def test_a_right_angle_that_is_hollow_takes_the_radius() -> None:
    """Of the bracket the floor of the notch, 3 m long, and its wall, 2 m high."""
    for radius in (0.1, 0.7, 1.5):
        np.testing.assert_allclose(taken(BRACKET, 2, radius), [(3 - radius, 3)], atol=1e-8)
        np.testing.assert_allclose(taken(BRACKET, 3, radius), [(0, radius)], atol=1e-8)
        for edge in (0, 1, 4, 5):
            assert taken(BRACKET, edge, radius) == []


def test_an_angle_that_is_hollow_takes_the_radius_over_the_tangent_of_its_half() -> None:
    """A chevron, whose inner angle is 2 x 60 degrees from the outside."""
    slope = np.tan(np.radians(30))
    chevron = Outline([[-3, 3 * slope], [-3, -2], [3, -2], [3, 3 * slope], [0, 0]])
    for radius in (0.2, 1.0):
        found = taken(chevron, 3, radius)
        np.testing.assert_allclose(found, [(np.hypot(3, 3 * slope) - radius * slope, np.hypot(3, 3 * slope))])


def test_corners_that_stand_out_keep_tips_away_by_their_own_distance() -> None:
    """Above the floor a roof whose edge is 0.5 m up ends at 1 m: a tip of 0.5 m or more meets it."""
    shape = Outline([[0, 0], [4, 0], [4, 0.2], [0.6, 0.2], [0.6, 0.9], [1, 0.7], [1, 1.2], [0, 1.2]])
    for radius in (0.3, 0.4):
        # the centre, radius above the floor, is `radius` from the tip of the roof at (1, 0.7)
        up = 0.7 - 0.2 - radius
        reach = 1 + np.sqrt(radius**2 - up**2)
        (found,) = taken(shape, 2, radius)
        np.testing.assert_allclose(found, (4 - reach, 3.4), atol=1e-8)


def test_distances_from_sides_of_a_polygon() -> None:
    """From the middles of sides, past their ends, and from within."""
    ring = np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]])
    along = np.roll(ring, -1, axis=0) - ring
    points = np.array([[1.0, -0.5], [3, -1], [-3, -4], [2.002, 1.5], [1, 0.25]])
    found = _nearest(points, ring, along, (along**2).sum(axis=1))
    np.testing.assert_allclose(found, [0.5, np.sqrt(2), 5, np.hypot(0.002, 0.5), 0.25], atol=1e-15)


def test_hollows_of_curves_against_distances_of_the_centre(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bean, drawn far finer than the tip: it fits where nothing is nearer to its centre."""
    radius = 0.45
    monkeypatch.setattr(tips, "_POINTS", 250)
    turn = 2 * np.pi * np.arange(16) / 16
    reach = 1 - 0.45 * np.exp(-(((turn - np.pi / 2) / 0.5) ** 2))
    bean = Outline.smooth(np.column_stack([reach * np.cos(turn), reach * np.sin(turn)]))
    sides = sides_of(bean, 0.0)
    assert isinstance(sides, CurvedSides)
    ring = bean.points(np.linspace(0, bean.length, 2001))
    spans = within_reach(sides, radius)
    assert len(spans) == 2  # the first vertex is between them
    inside = 0
    for s in np.linspace(0.003, bean.length, 70, endpoint=False):
        away = np.hypot(*(ring - (bean.points(s) - radius * bean.normals(s))).T).min() / radius
        u = sides.u_at(float(s))
        fits = any(lo <= u <= hi for lo, hi in spans)
        inside += fits
        assert fits == (away > 1 - 1e-3) or abs(away - 1) < 2e-3, (s, away)
    assert 25 < inside < 68
