"""Regions on curves made by hand: straight pieces of a square, whose limits can be read off."""

from dataclasses import dataclass, replace
from itertools import product
from math import inf, nan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from proofs import bent
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.curves.pieces import Cubics

pytestmark = pytest.mark.oracle

SLACK = float(RESOLUTION)


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
    widest: Any = None


SIDES = bent([[-2, -1], [2, -1], [2, 1], [-2, 1]])
"""Around from the lower left, 12 long: the lower side from 0 to 4, the upper from 6 to 10."""
WIDE = 0.25
SHAPES = {"cubics": lambda: SIDES, "sides": lambda: None}


@pytest.fixture(params=SHAPES, autouse=True)
def pieces(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """The square is one of cubics, or a polygon, whose verdicts are the same but for its corners."""
    monkeypatch.setitem(SHAPES, "is", SHAPES[request.param])
    return request.param


def points(s: float) -> np.ndarray:
    s = s % 12
    edge = int(np.searchsorted([4, 6, 10, 12], s, side="right"))
    start, whole = ((0, 4), (4, 2), (6, 4), (10, 2))[edge]
    return Cubics(SIDES).point(edge + (s - start) / whole)


def normals(s: float) -> np.ndarray:
    edge = int(np.searchsorted([4, 6, 10, 12], s % 12, side="right"))
    return np.array([[0.0, 1], [-1, 0], [0, -1], [1, 0]])[edge]


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
        "shape": SimpleNamespace(
            cubics=SHAPES["is"], polygon=lambda: SIDES[:, 0], points=points, normals=normals
        ),
        "grasp": pair(0, 0, 0.5 + 1e-12), "places": np.array([2.0, 8.0]), "half_width": WIDE,
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
    far = replace(
        good,
        corners=tuple(squeeze(pair(a, -b, 2)) for a, b in product((-0.75, 0.75), repeat=2)),
        grasp=pair(0, 0, 3),
    )
    for limit, above in (2.5, 0), (np.nextafter(2.5, 0), 2), (1.9, 4), (inf, 0), (nan, 4), (-3.0, 4):
        found = said(replace(far, max_force=limit))  # forces are 2 and 2.5
        assert found.count("is above") == above
        assert above != 2 or found.startswith(f"corner state 1: a force of 2.5 is above {limit:.12g}")


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
        assert f"the span of arc {k + 1} is another arc" in moved("arcs", end, out * 1.005 * size)
        assert moved("arcs", end, out * 0.995 * size) == ""
        assert "less than the half width" in moved("arcs", end, -out * 1e-9)
    for by, fine in (0.9 * size, False), (-1.1 * size, False), (1e-13, True), (-1e-13, True):
        found = moved("places", 0, by)
        assert (found == "") == fine
        assert fine or f"contact {k + 1} is not at its place" in found or "less than the half width" in found
    assert f"contact {k + 1} is not at its place" in moved("places", 0, 0.125)
    backwards = np.array(good.spans)
    backwards[k] = backwards[k, ::-1]
    assert said(replace(good, spans=backwards)).startswith("a cell must not end before it begins")
    for turns, words in ((0, 1), f"arc {k + 1} is longer than its span"), ((1, 1), "less than the half"):
        arcs = np.array(good.arcs)  # as points the same
        arcs[k] += 12 * np.array(turns)
        assert words in said(replace(good, arcs=arcs))


def test_arcs_are_no_longer_than_their_spans() -> None:
    """Once around more is another arc, which begins and ends as this one does."""
    good = regions()
    around = np.add(good.arcs, (-12, 12))
    assert said(replace(good, arcs=around, half_width=12.0)) == "arc 1 is longer than its span"
    half_around = replace(
        good, spans=np.array([[-1.0, 1], [2, 3]]), places=np.array([3.0, 8]), half_width=0.0
    )
    half_around = replace(half_around, grasp=pair(1, 0, 0.5 + 1e-12))
    for arc, longer in ((-2, 4), False), ((-2, 16), True), ((-14, 4), True):
        arcs = np.array([arc, (6, 10)], dtype=float)
        assert (said(replace(half_around, arcs=arcs)) == "arc 1 is longer than its span") == longer
    for turn in -4, 4:
        assert said(replace(good, spans=good.spans + turn)) == ""
    for wrong in (-8, 0), (8, 0), (0, -8), (0, 8), (1e17, 1e17):
        told = said(replace(good, spans=np.add(good.spans, np.array([wrong]).T)))
        assert told == "a cell must not end before it begins, nor run around more than once", wrong
    for never in np.full((2, 2), nan), np.full((2, 2), inf), np.array([[-inf, inf]] * 2):
        assert said(replace(good, spans=never)) != ""
    for far in [1e17, 1e17], [-4.1, 0.5], [0.5, 8.1], [0.5, 0.4], [nan, 1.0]:
        cells = np.array([good.spans, [far, good.spans[1]]])
        assert "nor run around more than once" in said(replace(good, cells=cells, corners=good.corners * 2))


def test_places_alone_are_regions() -> None:
    state = squeeze(pair(0, 0, 0.5))
    at, u = np.array([[2.0, 2], [8, 8]]), np.array([[0.5, 0.5], [2.5, 2.5]])
    assert said(regions(arcs=at, spans=u, half_width=0.0, corners=(state,))) == ""


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_how_near_is_the_same_is_a_part_of_the_largest_coordinate(scale) -> None:
    """All of it moved by -10: places are where they are to 100 of 2^-40 times 12, corners to 2^-40 of it."""
    slack, off = 12 * SLACK * scale, np.array([-10.0, -10])

    def moved(grasp: rg.Grasp, by=(0, 0, 0, 0)) -> rg.Grasp:
        at = scale * (grasp.positions + off) + np.reshape(by, (2, 2))
        return rg.Grasp(rg.Contact(p, c.normal, c.friction) for p, c in zip(at, grasp, strict=True))

    def told(place=(0, 0, 0, 0), corner=(0, 0, 0, 0)) -> str:
        good = regions()
        corners = [rg.GraspState(moved(s.grasp), s.load, s.forces) for s in good.corners]
        corners[1] = rg.GraspState(moved(good.corners[1].grasp, corner), corners[1].load, corners[1].forces)
        return said(
            replace(
                good,
                shape=SimpleNamespace(
                    cubics=lambda: scale * (SIDES + off),
                    polygon=lambda: scale * (SIDES[:, 0] + off),
                    points=lambda s: scale * (points(s / scale) + off),
                    normals=lambda s: normals(s / scale),
                ),
                grasp=moved(good.grasp, place),
                places=scale * good.places,
                arcs=scale * good.arcs,
                half_width=scale * good.half_width,
                corners=tuple(corners),
            )
        )

    assert told() == ""
    for k, sign in product(range(4), (-1, 1)):
        for part, good in (0.995, True), (1.005, False):
            by = sign * part * slack * np.eye(4)[k]
            assert told(100 * by) == ("" if good else f"contact {k // 2 + 1} is not at its place")
            assert ("1 states of corners are missing" not in told(corner=by)) == good


def test_corners_have_no_more_friction_than_the_first_of_their_cell() -> None:
    good = regions(grasp=pair(0, 0, 0.6))
    for mus, fine in ((0.5, 0.5), True), ((0.55, 0.5), False), ((0.5, 0.55), False):
        at = good.corners[1].grasp
        slid = squeeze(rg.Grasp(rg.Contact(c.position, c.normal, mu) for c, mu in zip(at, mus, strict=True)))
        at = replace(good, corners=(good.corners[0], slid, *good.corners[2:]))
        assert (said(at) == "") == fine


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


def test_what_regions_on_curves_need(pieces: str) -> None:
    good = regions()
    without = {
        "cubics": "an arc and its span are needed for each finger",
        "sides": "4 states of corners are missing",
    }
    assert said(replace(good, spans=None)) == without[pieces]
    for changes, words in (
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
    shape = SimpleNamespace(cubics=lambda: None, polygon=lambda: SIDES[:, 0], points=points)
    for k, end in product((0, 1), (0, 1)):
        arcs = np.array(regions().arcs)
        arcs[k, end] += (1, -1)[end] * 0.05
        lows, highs = (arc - place for arc, place in zip(arcs, (2.0, 8.0), strict=True))
        corners = tuple(squeeze(pair(a, -b, 0.5)) for a, b in product(lows, highs))
        for half, good in ((WIDE - 0.05, True), (WIDE - 0.05 + 1e-9, False)):
            found = said(regions(shape=shape, spans=None, arcs=arcs, half_width=half, corners=corners))
            assert (found == "") == good, (k, end, half)
            assert good or f"arc {k + 1} is less than the half width" in found


HALVES = np.array([[[0.4375, 0.5], [2.4375, 2.5625]], [[0.5, 0.5625], [2.4375, 2.5625]]])


def in_cells(cells, **changes) -> Regions:
    """As ``regions``, with corners an eighth beyond each cell."""
    corners = []
    for (a, b), (c, d) in cells:
        low, high = ((4 * a - 2) - 0.125, (4 * b - 2) + 0.125), ((4 * c - 10) - 0.125, (4 * d - 10) + 0.125)
        corners += [squeeze(pair(x, -y, 0.5)) for x, y in product(low, high)]
    return regions(cells=np.array(cells), corners=tuple(corners), **changes)


def test_cells_have_corners_of_their_own() -> None:
    good = in_cells(HALVES)
    assert said(good) == ""
    swapped = replace(good, corners=good.corners[4:] + good.corners[:4])
    assert said(swapped) == "the corners do not stand for all places of arc 1"
    second = replace(good, corners=(*good.corners[:5], good.corners[4], *good.corners[6:]))
    assert said(second) == "1 states of corners are missing"  # that of the first cell does not count
    other = [
        rg.GraspState(s.grasp, rg.Wrench([0, 0.125]), s.forces - np.array([[0, 0.125], [0, 0]]))
        for s in good.corners
    ]
    one_load = replace(good, corners=(*good.corners[:4], *other[:4], *good.corners[4:], *good.corners[4:]))
    assert "4 states of corners are missing" in said(one_load)
    for short in good.corners[:-1], good.corners[:1], ():
        words = "no corner has a state" if not short else "some states of corners are missing"
        assert said(replace(good, corners=tuple(short))) == words
    for wrong in HALVES[:1], HALVES[1:], HALVES[:, :1], HALVES[0]:
        assert said(replace(good, cells=wrong)) == "the cells do not cover the arcs"
