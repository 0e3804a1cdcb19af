"""Fingers in the holes of an outline: against sampled places on all rings, proofs, and tips that fit."""

import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
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
