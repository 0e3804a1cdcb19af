"""Fingers in the holes of an outline: against sampled places on all rings, proofs, and tips that fit."""

import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp import plots
from regrasp.planning.placement.reachable import sides_of

pytestmark = pytest.mark.oracle

HOLES = [[[1.6, 2.0], [2.4, 2.0], [2.4, 2.6], [1.6, 2.6]], [[0.9, 2.2], [1.3, 2.2], [1.3, 2.7]]]
WEDGE = rg.Outline([[0, 3], [2, 0], [4, 3]], holes=HOLES)
LOADS = rg.LoadSet.hull([rg.Wrench([0, -1]), rg.Wrench([0.1, -1], 0.05)])


def on_rings(count: int) -> list[rg.Contact]:
    """Contacts spread over the outline and its holes, from their vertices alone."""
    found = []
    for ring in (WEDGE.polygon(), *(hole[::-1] for hole in WEDGE.hole_polygons())):
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            d = b - a
            found += [rg.Contact(a + t * d, [-d[1], d[0]], 0.3) for t in (np.arange(count) + 0.5) / count]
    return found


def cost(grasp: rg.Grasp) -> float:
    assert LOADS.vertices is not None
    try:
        loads = map(rg.Wrench.from_vector, LOADS.vertices)
        return max(rg.choose_state(grasp, load, "sum_normal").value for load in loads)
    except rg.Infeasible:
        return np.inf


def test_a_finger_at_the_end_of_a_ring_is_not_at_the_beginning_of_the_next() -> None:
    """The last vertex of a ring is the first again; its length around is where the next ring begins."""
    pocket = rg.Outline(
        [[0, 0], [5, 0], [5, 3], [3, 3], [3, 1], [2, 1], [2, 3], [0, 3]],
        holes=[[[0.4, 0.4], [0.4, 0.8], [0.8, 0.4]]],
    )
    chosen = rg.choose_grasp(
        pocket, 3, rg.Wrench([0, 0]), friction=1.0, objective="wrench_ball", max_force=3.0,
        length=0.5 * float(np.hypot(*pocket.polygon().T).max()), in_holes=True, from_corners=0.0,
    )  # fmt: skip
    assert chosen.places[-1] >= pocket.length
    assert rg.verify(chosen).ok


def test_the_end_of_a_ring_is_its_beginning() -> None:
    sides = sides_of(WEDGE, 0.0, None, 0.0, True)
    lasts, firsts, lengths = [2, 6, 9], [0, 3, 7], [0.0, WEDGE.length, WEDGE.length + 2.8]
    for last, first, along in zip(lasts, firsts, lengths, strict=True):
        (before,), (after,) = (np.flatnonzero(sides.edges == edge) for edge in (last, first))
        for u in (last + 1.0, last + 1 - 1e-15):
            assert sides.arc_length(before, u) == sides.arc_length(after, first) == pytest.approx(along)
        assert sides.arc_length(before, last + 0.5) > along


def test_what_hangs_on_a_ceiling_needs_least_and_no_sampled_pair_less() -> None:
    outside = rg.choose_grasp(WEDGE, 2, LOADS, friction=0.3)
    found = rg.choose_grasp(WEDGE, 2, LOADS, friction=0.3, in_holes=True)
    assert found.value < 0.99 * outside.value
    assert "no placement outside of holes on the" in str(rg.verify(outside))
    assert "holes" not in str(rg.verify(found))
    assert (found.places > WEDGE.length).any()
    sampled = min(cost(rg.Grasp(pair)) for pair in combinations(on_rings(3), 2))
    assert found.bound <= found.value <= sampled * (1 + 1e-3)
    assert cost(found.grasp) == pytest.approx(found.value, rel=1e-6)
    again = rg.ChosenGrasp.from_dict(json.loads(json.dumps(found.to_dict())))
    assert again == found
    assert rg.verify(again).ok
    proof = found.certificate
    rings = np.array(proof.rings)
    for wrong in (rings + np.array([0, 1, 0]), rings[:2], rings + 1, None):
        assert not rg.verify(replace(found, certificate=replace(proof, rings=wrong))).ok
    assert not rg.verify(replace(found, shape=rg.Outline([[0, 3], [2, 0], [4, 3]], holes=HOLES[:1]))).ok


def test_tips_go_into_holes_that_they_fit_into() -> None:
    hole_edges = {0.05: 7, 0.15: 4, 0.35: 0}  # the triangle takes a tip of 0.1, the rectangle one of 0.3
    for radius, count in hole_edges.items():
        sides = sides_of(WEDGE, 0.0, None, radius, True)
        assert len(set(sides.edges[sides.edges >= 3].tolist())) == count
    assert sides_of(WEDGE, 0.1, None, 0.0, True).ends[3] == pytest.approx([3 + 0.1 / 0.8, 4 - 0.1 / 0.8])


def test_holes_that_are_curves_and_arcs_are_refused() -> None:
    round_hole = rg.Outline([[0, 0], [4, 0], [4, 4], [0, 4]], holes=[rg.Outline.ellipse(1, 1, centre=(2, 2))])
    for shape, more, words in (
        (round_hole, {}, "holes that are polygons"),
        (WEDGE, {"arcs": [(0.0, 1.0)]}, "no arcs"),
        (WEDGE, {"in_holes": 1}, "True or False"),
    ):
        asked = {"friction": 0.3, "in_holes": True} | more
        assert words in str(refusal(lambda s=shape, a=asked: rg.choose_grasp(s, 2, LOADS, **a)))


def test_regions_of_fingers_in_holes_hold_and_are_no_wider_than_that() -> None:
    """Every choice within holds, some at the ends of wider ones do not, and arcs elsewhere do not verify."""
    chosen = rg.choose_grasp(WEDGE, 2, LOADS, friction=0.3, in_holes=True, objective="peak", tolerance=0.01)
    assert (chosen.places > WEDGE.length).all()
    regions = rg.contact_regions(WEDGE, chosen.grasp, LOADS)
    assert regions.places == pytest.approx(chosen.places, abs=1e-9)
    assert rg.verify(regions).ok
    assert regions.half_width > 0.1
    tangents = np.stack([regions.grasp.normals[:, 1], -regions.grasp.normals[:, 0]], axis=1)

    def need(off: np.ndarray) -> float:
        assert LOADS.vertices is not None
        moved = rg.Grasp(
            rg.Contact(c.position + s * t, c.normal, 0.3)
            for c, s, t in zip(regions.grasp, off, tangents, strict=True)
        )
        try:
            loads = map(rg.Wrench.from_vector, LOADS.vertices)
            return max(rg.choose_state(moved, load, "peak").value for load in loads)
        except rg.Infeasible:
            return np.inf

    rng = np.random.default_rng(3)
    low, high = (regions.arcs - regions.places[:, None]).T
    assert all(need(rng.uniform(low, high)) <= regions.max_force * (1 + 1e-6) for _ in range(40))
    wider = 1.01 * regions.half_width * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    assert max(map(need, wider)) > regions.max_force
    again = rg.ContactRegions.from_dict(json.loads(json.dumps(regions.to_dict())))
    assert again == regions
    shift = np.array([[WEDGE.length], [0.0]])
    for wrong in (
        replace(regions, arcs=regions.arcs - shift, places=regions.places - shift[:, 0]),
        replace(regions, shape=rg.Outline([[0, 3], [2, 0], [4, 3]], holes=HOLES[::-1])),
        replace(regions, shape=rg.Outline([[0, 3], [2, 0], [4, 3]])),
    ):
        assert not rg.verify(wrong).ok
    ax = plots.plot_contact_regions(regions)
    drawn = [line.get_xydata() for line in ax.lines if line.get_gid() == "region"]
    for line, contact, t, *ends in zip(drawn, regions.grasp, tangents, low, high, strict=True):
        assert line == pytest.approx(contact.position + np.outer(ends, t))
    pairs = rg.placement_map(WEDGE, LOADS, friction=0.3, count=12)
    said = refusal(lambda: plots.plot_placement_map(pairs, regions=regions))
    assert "on the outline of the map" in str(said)


def test_contacts_in_round_holes_have_no_regions() -> None:
    plate = rg.Outline([[0, 0], [4, 0], [4, 4], [0, 4]], holes=[rg.Outline.ellipse(1, 1, centre=(2, 2))])
    fingers = rg.Grasp([rg.Contact([0, 1], [0, 1], 0.5), plate.contact_at(2.0, friction=0.5)])
    said = str(refusal(lambda: rg.contact_regions(plate, fingers, rg.Wrench([0, -1]))))
    assert "on no side of the outline or of a hole that is a polygon" in said
