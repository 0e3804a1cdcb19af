"""Regions on rows of chords, as drawings have them: as wide as on the curve, and every choice holds."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.placement.regions.curved import CurvedPlaces

pytestmark = pytest.mark.laws

LOADS = rg.LoadSet.hull([rg.Wrench([0, -1]), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1])])
DISC = rg.Outline([(np.cos(a), np.sin(a)) for a in np.arange(180) * np.pi / 90])
ROUND = np.radians(np.linspace(-90, 90, 61))
SLOT = rg.Outline(
    [*((2 + np.cos(a), np.sin(a)) for a in ROUND), *((-2 - np.cos(a), -np.sin(a)) for a in ROUND)]
)
"""Two half discs with a belt between them, which no vertex of is a corner."""

LOW = {180: ((-0.8, -0.62), (0.85, -0.53)), 122: ((-2.71, -0.71), (2.8, -0.61))}


def grasp(shape: rg.Outline, *places: float, friction: float = 0.6) -> rg.Grasp:
    return rg.Grasp(shape.contact_at(s, friction=friction) for s in places)


def fails(shape: rg.Outline, places: np.ndarray, limit: float) -> bool:
    """With the normals on either side of a vertex."""
    assert LOADS.vertices is not None
    near = [{tuple(shape.normals(s + d).tolist()) for d in (-1e-9, 1e-9)} for s in places]
    for normals in product(*near):
        held = rg.Grasp(rg.Contact(shape.points(s), n, 0.6) for s, n in zip(places, normals, strict=True))
        try:
            for w in LOADS.vertices:
                rg.choose_state(held, rg.Wrench.from_vector(w), "peak", max_force=limit * (1 + 1e-6))
        except rg.Infeasible:
            return True
    return False


@pytest.mark.parametrize("shape", [DISC, SLOT], ids=["disc", "slot"])
def test_every_choice_within_holds(shape: rg.Outline) -> None:
    """Places at vertices, too; and little more at once does not."""
    held = grasp(shape, *(shape.nearest(shape.centre_of_mass + p) for p in LOW[len(shape.polygon())]))
    regions = rg.contact_regions(shape, held, LOADS)
    assert rg.verify(regions).ok
    assert (regions.widths > 5 * np.pi / 90).all()  # of a chord
    assert not regions.ended.any()
    assert (regions.alone >= regions.half_width * 0.99).all()
    vertex = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(shape.polygon(), axis=0).T))])
    rng = np.random.default_rng(2)
    for number in range(50):
        places = rng.uniform(*regions.arcs.T)
        if number % 2:
            nearest = vertex[np.abs((places[:, None] - vertex) % shape.length).argmin(axis=1)]
            inside = (regions.arcs[:, 0] <= nearest) & (nearest <= regions.arcs[:, 1])
            places = np.where(inside, nearest, places)
        assert not fails(shape, places, regions.max_force)
    ways = [np.array(way) for way in product((-1, 1), repeat=2)]
    assert any(fails(shape, regions.places + 1.4 * regions.half_width * w, regions.max_force) for w in ways)


def test_chords_are_nearly_as_good_as_their_curve() -> None:
    smooth = rg.Outline.ellipse(1, 1)
    for widest in ("together", "least"):
        chords, curve = (
            rg.contact_regions(
                shape, grasp(shape, *(f * shape.length for f in (0.603, 0.902))), LOADS, widest=widest
            )
            for shape in (DISC, smooth)
        )
        assert rg.verify(chords).ok
        assert chords.spans is not None
        assert chords.widest is None
        assert chords.widths.min() > 0.9 * curve.widths.min()
        assert chords.widths.prod() > 0.9 * curve.widths.prod()


def test_where_the_first_vertex_is_changes_nothing() -> None:
    held = grasp(DISC, 0.603 * DISC.length, 0.953 * DISC.length)
    first = rg.contact_regions(DISC, held, LOADS)
    other = rg.Outline(np.roll(DISC.polygon(), 7, axis=0))
    second = rg.contact_regions(other, held, LOADS)
    assert rg.verify(second).ok
    assert (first.arcs > DISC.length).any() or (second.arcs > DISC.length).any()
    assert second.half_width == pytest.approx(first.half_width, rel=1e-9)
    assert second.widths == pytest.approx(first.widths, rel=1e-9)


def test_corners_end_regions() -> None:
    """A half disc on its flat side: fingers on the round may go as far as its corners."""
    half = rg.Outline([(np.cos(a), np.sin(a)) for a in np.radians(np.linspace(0, 180, 91))])
    up = rg.LoadSet.hull([rg.Wrench([0.1, -1]), rg.Wrench([-0.1, -1])])
    at = half.boundary.corners
    held = grasp(half, at[0] + 0.1, at[1] - 0.1, at[1] + 1.0, friction=2.0)
    regions = rg.contact_regions(half, held, up, max_force=50.0)
    assert rg.verify(regions).ok
    assert regions.spans is not None
    assert regions.ended.any()
    assert regions.half_width > 0.1
    for (lo, hi), place in zip(regions.arcs, regions.places, strict=True):
        for end, corner in product((lo, hi), at):
            assert (end - corner) * (place - corner) > 0  # none is passed
    assert "less than the half width" in str(rg.verify(replace(regions, arcs=regions.arcs * 0.999)))


def test_sides_that_meet_at_corners_are_exact_as_before() -> None:
    box = rg.Outline([(-2, -1), (2, -1), (2, 1), (-2, 1)])
    regions = rg.contact_regions(box, grasp(box, 0.5, 3.5, 8.0), LOADS)
    assert regions.spans is None
    assert rg.verify(regions).ok


def test_regions_on_one_side_each_stand_where_wider_ones_fail_by_rounding(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def none(*_: object) -> None:
        raise rg.Infeasible("left without forces by rounding")

    held = grasp(DISC, 0.603 * DISC.length, 0.902 * DISC.length)
    monkeypatch.setattr(CurvedPlaces, "states", none)
    regions = rg.contact_regions(DISC, held, LOADS)
    assert regions.spans is None
    assert rg.verify(regions).ok


def test_spoiled_proofs_are_seen() -> None:
    regions = rg.contact_regions(DISC, grasp(DISC, 0.603 * DISC.length, 0.902 * DISC.length), LOADS)
    assert regions.cells is not None
    dented = DISC.polygon().copy()
    within = int(0.6 * 180)
    dented[within] *= 0.995
    first = regions.grasp[0]
    turned = rg.Contact(first.position, DISC.normals(0.61 * DISC.length), first.friction, name=first.name)
    each = len(regions.corners) // len(regions.cells)
    for wrong, words in (
        (replace(regions, shape=rg.Outline(dented)), ""),
        (replace(regions, cells=regions.cells[1:], corners=regions.corners[each:]), "do not cover the arcs"),
        (replace(regions, arcs=regions.arcs * [1, 1.001]), "another arc"),
        (replace(regions, half_width=regions.half_width * (1 + 1e-5)), "less than the half width"),
        (replace(regions, places=regions.places + 1e-4), "not at its place"),
        (replace(regions, grasp=rg.Grasp([turned, regions.grasp[1]])), "another normal than its place"),
        (replace(regions, spans=None), "not on one straight side"),
    ):  # fmt: skip
        verdict = rg.verify(wrong)
        assert not verdict.ok
        assert any(words in v for v in verdict.violations), words


@pytest.mark.parametrize("way", [-1e-9, 0.0, 1e-9])
def test_a_finger_at_a_vertex_may_go_either_way(way: float) -> None:
    """It has the normal of the side before, or after."""
    vertex = DISC.polygon()[108]
    s = DISC.nearest(vertex + DISC.centre_of_mass)
    held = rg.Grasp([rg.Contact(vertex, DISC.normals(s + way), 0.6), *grasp(DISC, 0.902 * DISC.length)])
    regions = rg.contact_regions(DISC, held, LOADS)
    assert rg.verify(regions).ok
    assert (np.abs(regions.arcs - regions.places[:, None]) > 5 * np.pi / 90).all()


@pytest.mark.parametrize("way", [-1e-9, 1e-9])
def test_a_finger_at_a_corner_is_on_the_side_of_its_arc(way: float) -> None:
    """With the normal of the other side no region is proven."""
    half = rg.Outline([(np.cos(a), np.sin(a)) for a in np.radians(np.linspace(0, 180, 91))])
    up = rg.LoadSet.hull([rg.Wrench([0.1, -1]), rg.Wrench([-0.1, -1])])
    corner = half.boundary.corners[1]
    others = grasp(half, half.boundary.corners[0] + 0.1, corner + 1.0, friction=2.0)

    def at(way: float) -> rg.Contact:
        return rg.Contact(half.points(corner), half.normals(corner + way), 2.0, name="1")

    regions = rg.contact_regions(half, rg.Grasp([at(way), *others]), up, max_force=50.0)
    assert regions.spans is not None
    assert rg.verify(regions).ok
    first, *rest = regions.grasp
    turned = rg.Contact(first.position, at(-way).normal, 2.0, name=first.name)
    assert "another normal than its place" in str(
        rg.verify(replace(regions, grasp=rg.Grasp([turned, *rest])))
    )


def test_boxes_that_fail_by_rounding_are_taken_smaller(monkeypatch: pytest.MonkeyPatch) -> None:
    """A box within one that held may be cut otherwise, and fail: regions are smaller then, not refused."""
    held = grasp(DISC, 0.603 * DISC.length, 0.902 * DISC.length)
    whole = rg.contact_regions(DISC, held, LOADS)
    for parts in (0.97,), ():
        monkeypatch.setattr("regrasp.planning.placement.regions.curved._SMALLER", parts)
        smaller = rg.contact_regions(DISC, held, LOADS)
        assert rg.verify(smaller).ok
        assert (smaller.spans is not None) == bool(parts)
        for part in parts:
            assert smaller.widths == pytest.approx(part * whole.widths, rel=1e-9)
            assert smaller.half_width == pytest.approx(part * whole.half_width, rel=1e-9)
