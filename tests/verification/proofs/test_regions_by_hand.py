"""Regions on curves made by hand: straight pieces of a square, whose limits can be read off."""

from dataclasses import dataclass, replace
from itertools import product
from math import atan, cos, inf, nan, sin, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.curved_regions import beside, point_at

pytestmark = pytest.mark.oracle

SLACK = float(RESOLUTION)


def bent(vertices) -> np.ndarray:
    p = np.array(vertices, dtype=float)
    q = np.roll(p, -1, axis=0)
    return np.stack([p, (2 * p + q) / 3, (p + 2 * q) / 3, q], axis=1)


FLOOR = bent([[2, 0], [4, 0], [4, 4], [0, 4], [0, 0]])
"""The lower side is two pieces, from 4 to 6: x = 2 (u - 4)."""


def stands(lo, hi, x0, x1, *, height=0.0, inner=0.5, friction=0.5, tilt=0.0) -> bool:
    """Chords below the lower side, from x0 to x1."""
    ends = np.array([[x0, -height], [x1, -height]])
    return beside(
        FLOOR, np.array([4 + lo / 2, 4 + hi / 2]), ends, np.array([-sin(tilt), cos(tilt)]), inner, friction
    )


@pytest.mark.parametrize(("lo", "hi"), [(0.25, 1.5), (1.0, 3.0), (2.0, 3.5), (0.0, 4.0)])
@pytest.mark.parametrize("height", [0.0, 0.5, -0.5])
@pytest.mark.parametrize("inner", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("tilt", [0.0, 0.2, -0.2])
def test_chords_reach_beyond_arcs_by_what_forces_may_lean(lo, hi, height, inner, tilt) -> None:
    lean = abs(height) * tan(abs(tilt) + atan(inner))
    friction = tan(abs(tilt) + atan(inner))
    given = {"height": height, "inner": inner, "friction": friction, "tilt": tilt}
    assert stands(lo, hi, lo - lean - 1e-9, hi + lean + 1e-9, **given)
    assert not stands(lo, hi, lo - lean + 1e-6, hi + lean + 1e-9, **given)
    assert not stands(lo, hi, lo - lean - 1e-9, hi + lean - 1e-6, **given)
    assert not stands(lo, hi, hi + lean + 1, lo - lean - 1, **given)  # its normal points the other way
    assert stands(lo, hi, lo - lean - 1, hi + lean + 1, **given | {"friction": friction + 1e-9})
    assert not stands(lo, hi, lo - lean - 1, hi + lean + 1, **given | {"friction": friction - 1e-9})


def test_leaning_is_less_than_a_right_angle() -> None:
    for inner, good in (14.0, True), (14.2, False):  # 1.5 rad are 14.1
        assert stands(1, 2, 1, 2, inner=inner, friction=inner + 1) == good


def test_a_place_alone_is_its_own_chord() -> None:
    for off, good in (0.0, True), (0.5 * SLACK, True), (8 * SLACK, False), (-8 * SLACK, False):
        assert stands(1, 1, 1 + off, 1 + off) == good
        assert stands(1, 1, 1, 1, height=off) == good
    assert not stands(1, 1 + 1e-9, 1, 1)
    assert not stands(1 - 1e-9, 1, 1, 1)
    assert stands(1, 1, 1 - 1e-6, 1 + 1e-6)


CURVE = np.array([[[3, -1], [4, 0.5], [3.5, 2], [2, 3]], [[2, 3], [0, 4], [-2, 2], [-2, 0]],
                  [[-2, 0], [-2, -3], [1, -3], [3, -1]]], dtype=float)  # fmt: skip


def test_places_of_a_curve_are_those_of_its_cubics() -> None:
    for u in np.linspace(0, 5.9, 60):
        t, c = u % 1, CURVE[int(u) % 3]
        weights = [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3]
        assert point_at(CURVE, float(u)) == pytest.approx(weights @ c, abs=1e-12)


@pytest.mark.parametrize("friction", [0.6, 1.5])
def test_chords_beside_a_curve_are_those_that_samples_allow(friction) -> None:
    """Every force of a place leans into the chord; short arcs that do so by a margin are accepted."""
    rng, seen = np.random.default_rng(0), {True: 0, False: 0}
    for _ in range(150):
        lo = float(rng.uniform(0, 3))
        hi = lo + float(rng.choice([0.02, 0.1]))
        points = np.array([point_at(CURVE, u) for u in np.linspace(lo, hi, 21)])
        tangents = np.diff(points, axis=0)
        tangents /= np.hypot(*tangents.T)[:, None]
        t = points[-1] - points[0]
        length = np.hypot(*t)
        t /= length
        angle = float(rng.normal(0, 0.05))
        normal = np.array([-t[1] * cos(angle) - t[0] * sin(angle), t[0] * cos(angle) - t[1] * sin(angle)])
        inner = friction * float(rng.uniform(0.3, 1.0))
        off = float(rng.uniform(-0.2, 0.2)) * length
        more = float(rng.uniform(0, 0.5)) * length
        shift = off * np.array([-t[1], t[0]])
        ends = np.array([points[0] - more * t + shift, points[-1] + more * t + shift])
        found = beside(CURVE, np.array([lo, hi]), ends, normal, inner, friction)
        inward = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
        apart = np.arccos(np.clip(inward @ normal, -1, 1)).max()
        gamma = abs(angle) + atan(inner)
        along, away = (points - ends[0]) @ t, np.abs((points - ends[0]) @ [-t[1], t[0]]).max()
        need = away * tan(gamma)
        room = min(
            atan(friction) - apart - atan(inner),
            along.min() / length - need / length,
            (np.hypot(*(ends[1] - ends[0])) - along.max() - need) / length,
        )
        seen[found] += 1
        assert not found or room > -0.02
        assert found or room < 0.1
    assert min(seen.values()) > 20


@dataclass(frozen=True)
class Regions:
    shape: Any
    grasp: rg.Grasp
    places: np.ndarray
    arcs: np.ndarray
    spans: np.ndarray | None
    half_width: float
    corners: tuple[rg.GraspState, ...]
    max_force: float = 9.0
    cells: Any = None


SIDES = bent([[-2, -1], [2, -1], [2, 1], [-2, 1]])
"""Around from the lower left, 12 long: the lower side from 0 to 4, the upper from 6 to 10."""
WIDE = 0.25


def points(s: float) -> np.ndarray:
    s = s % 12
    edge = int(np.searchsorted([4, 6, 10, 12], s, side="right"))
    start, whole = ((0, 4), (4, 2), (6, 4), (10, 2))[edge]
    return point_at(SIDES, edge + (s - start) / whole)


def pair(low: float, high: float, friction: float) -> rg.Grasp:
    return rg.Grasp([rg.Contact([low, -1], [0, 1], friction), rg.Contact([high, 1], [0, -1], friction)])


def squeeze(grasp: rg.Grasp) -> rg.GraspState:
    """Both push along the line between them."""
    f = grasp.positions[1] - grasp.positions[0]
    return rg.GraspState(grasp, rg.Wrench([0, 0]), [f, -f])


def regions(**changes) -> Regions:
    """Both fingers may be a quarter to either side of the middle; corners are an eighth beyond."""
    ends = (-WIDE - 0.125, WIDE + 0.125)
    given = {
        "shape": SimpleNamespace(cubics=lambda: SIDES, polygon=lambda: SIDES[:, 0], points=points),
        "grasp": pair(0, 0, 0.5), "places": np.array([2.0, 8.0]), "half_width": WIDE,
        "arcs": np.array([[2 - WIDE, 2 + WIDE], [8 - WIDE, 8 + WIDE]]),
        "spans": np.array([[0.5 - WIDE / 4, 0.5 + WIDE / 4], [2.5 - WIDE / 4, 2.5 + WIDE / 4]]),
        "corners": tuple(squeeze(pair(a, -b, 0.5)) for a, b in product(ends, ends)),
    }  # fmt: skip
    return Regions(**given | changes)


def said(value) -> str:
    return "; ".join(rg.verify(value).violations)


def test_states_beside_arcs_prove_regions() -> None:
    good = regions()
    verdict = rg.verify(good)
    assert verdict.ok
    assert 0 <= verdict.worst_residual < 1e-15
    assert verdict.least_angle == pytest.approx(min(s.margins.least_angle for s in good.corners))
    most = max(s.magnitudes.max() for s in good.corners)
    assert said(replace(good, max_force=most)) == ""
    for limit in (np.nextafter(most, 0), nan):
        assert said(replace(good, max_force=limit)).count("is above") >= 2


@pytest.mark.parametrize("k", [0, 1])
def test_arcs_spans_and_places_are_about_each_other(k) -> None:
    good = regions()

    def moved(name: str, end: int, by: float) -> str:
        other = np.array(getattr(good, name), dtype=float)
        other[(k, end) if other.ndim == 2 else k] += by
        return said(replace(good, **{name: other}))

    size = 100 * SLACK * 2
    for end, out in (0, -1), (1, 1):
        assert f"the span of arc {k + 1} is another arc" in moved("spans", end, out * 1e-6)
        assert f"the span of arc {k + 1} is another arc" in moved("arcs", end, out * 1.1 * size)
        assert moved("arcs", end, out * 0.9 * size) == ""
        assert "less than the half width" in moved("arcs", end, -out * 1e-9)
    for by, fine in (0.9 * size, False), (-1.1 * size, False), (1e-13, True), (-1e-13, True):
        found = moved("places", 0, by)
        assert (found == "") == fine
        assert fine or f"contact {k + 1} is not at its place" in found or "less than the half width" in found
    assert f"contact {k + 1} is not at its place" in moved("places", 0, 0.125)
    backwards = np.array(good.spans)
    backwards[k] = backwards[k, ::-1]
    assert f"arc {k + 1} must not end before it begins" in said(replace(good, spans=backwards))


@pytest.mark.parametrize("k", [0, 1])
@pytest.mark.parametrize("end", [0, 1])
def test_a_half_width_is_that_of_the_shorter_side(k, end) -> None:
    arcs, spans = np.array(regions().arcs), np.array(regions().spans)
    arcs[k, end] += (1, -1)[end] * 0.05
    spans[k, end] += (1, -1)[end] * 0.05 / 4
    widths = ((WIDE - 0.05, True), (WIDE - 0.05 + 1e-9, False), (WIDE, False), (0.0, True), (-1e-9, False))
    for half, good in (*widths, (inf, False), (nan, False)):
        found = said(regions(arcs=arcs, spans=spans, half_width=half))
        assert (found == "") == good, half
        assert good or f"arc {k + 1} is less than the half width" in found or "arc 1 is less" in found


def test_what_regions_on_curves_need() -> None:
    good = regions()
    for changes, words in (
        ({"spans": None}, "an arc and its span are needed"),
        ({"spans": good.spans[:1]}, "an arc and its span are needed"),
        ({"arcs": good.arcs[:1]}, "an arc and its span are needed"),
        ({"arcs": good.arcs[:1], "spans": good.spans[:1]}, "an arc and its span are needed"),
        ({"places": good.places[:1]}, "a place is needed for each finger"),
        ({"places": good.places[:, None]}, "a place is needed for each finger"),
        ({"corners": ()}, "no corner has a state"),
    ):
        assert said(replace(good, **changes)) == words + (" for each finger" if "span" in words else "")
    three = rg.Grasp([*good.corners[0].grasp, rg.Contact([2, 0], [-1, 0], 0.5)])
    other = rg.GraspState(three, rg.Wrench([0, 0]), [*good.corners[0].forces, [0, 0]])
    tilted = rg.Grasp([rg.Contact([-0.375, -1], [0.01, 1], 0.5), good.corners[0].grasp[1]])
    for wrong in (other, squeeze(tilted)):
        for corners in ((wrong, *good.corners[1:]), (*good.corners[:-1], wrong)):
            assert "corners must have one normal for each finger" in said(replace(good, corners=corners))


@pytest.mark.parametrize("corner", range(4))
def test_every_corner_of_every_load_has_a_state(corner) -> None:
    good = regions()
    state = good.corners[corner]
    rest = [c for c in good.corners if c is not state]
    if corner in (1, 2):  # first and last say where corners are
        assert "1 states of corners are missing" in said(replace(good, corners=tuple(rest)))
    other = rg.GraspState(state.grasp, rg.Wrench([0, 0.125]), state.forces - np.array([[0, 0.125], [0, 0]]))
    more = said(replace(good, corners=(good.corners[0], other, *good.corners[1:])))
    assert "3 states of corners are missing" in more  # those of the new load
    if corner in (1, 2):
        for off, fine in ((1e-13, True), (1e-9, False), (-1e-9, False)):
            a, b = state.grasp.positions[:, 0] + np.array([off, 0])
            at = replace(
                good, corners=tuple(squeeze(pair(a, b, 0.5)) if c is state else c for c in good.corners)
            )
            assert (said(at) == "") == fine
        for turn in (1e-9, -1e-9):
            lean = rg.Contact(state.grasp[0].position, [turn, 1], 0.5)
            leaning = squeeze(rg.Grasp([lean, state.grasp[1]]))
            at = replace(good, corners=tuple(leaning if c is state else c for c in good.corners))
            assert "1 states of corners are missing" in said(at)
        for mu, fine in ((0.45, True), (0.55, False)):
            slid = squeeze(pair(*state.grasp.positions[:, 0], mu))
            at = replace(good, corners=tuple(slid if c is state else c for c in good.corners))
            assert ("states of corners are missing" in said(at)) != fine


def test_corners_that_do_not_reach_around_an_arc_do_not_stand_for_it() -> None:
    for beyond, fine in ((1e-12, True), (-1e-6, False)):
        ends = (-WIDE - beyond, WIDE + beyond)
        short = regions(corners=tuple(squeeze(pair(a, -b, 0.5)) for a, b in product(ends, ends)))
        assert (said(short) == "") == fine
        assert fine or "the corners do not stand for all places of arc 1" in said(short)
    rough = regions(grasp=pair(0, 0, 0.49))
    assert "the corners do not stand for all places of arc 1" in said(rough)


def test_a_side_of_a_polygon_holds_its_arc_in_any_position() -> None:
    """The same on straight sides: the shorter of two sides of a place counts, but for the end of the side."""
    shape = SimpleNamespace(cubics=lambda: None, polygon=lambda: SIDES[:, 0])
    for k, end in product((0, 1), (0, 1)):
        arcs = np.array(regions().arcs)
        arcs[k, end] += (1, -1)[end] * 0.05
        lows, highs = (arc - place for arc, place in zip(arcs, (2.0, 8.0), strict=True))
        corners = tuple(squeeze(pair(a, -b, 0.5)) for a, b in product(lows, highs))
        for half, good in ((WIDE - 0.05, True), (WIDE - 0.05 + 1e-9, False)):
            found = said(regions(shape=shape, spans=None, arcs=arcs, half_width=half, corners=corners))
            assert (found == "") == good, (k, end, half)
            assert good or f"arc {k + 1} is less than the half width" in found
