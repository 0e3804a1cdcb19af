"""Proofs that no least arc is wider: below a square, where levers say what is widest, and spoiled ones."""

import json
from dataclasses import replace
from functools import cache
from itertools import product
from math import inf, nan
from typing import Any

import numpy as np
import pytest

import regrasp as rg

pytestmark = pytest.mark.oracle

SQUARE = rg.Outline([[0, 0], [4, 0], [4, 4], [0, 4]])
DOWN = rg.Wrench([0, -1], 0.0)


def fingers(*places: float) -> rg.Grasp:
    return rg.Grasp(SQUARE.contact_at(s, friction=0.0, name=f"F{i}") for i, s in enumerate(places, 1))


@cache
def found() -> rg.ContactRegions:
    """Two fingers below, without friction, at 1 and 2.5 of a side whose middle is at 2.

    Whatever stands to the left of the middle has its share of the weight by the lever: forces of at most
    0.8 N for a weight of 1 N. Arcs are [a, b] to the left and [c, d] to the right of 2, and the lever of the
    force of one is the largest where the other is far and it is near: (d - 2) / (d - b) <= 0.8, and
    (2 - a) / (c - a) <= 0.8. Both arcs have the width w at best: b = a + w, d = c + w.
    """
    return rg.contact_regions(SQUARE, fingers(1.0, 2.5), DOWN, max_force=0.8, widest="least")


def widest(limit: float) -> float:
    """By a grid: from starts 20 to the unit, the ends as far as the levers let them."""
    best = 0.0
    for a, c in product(np.linspace(0, 1, 401), np.linspace(2, 2.5, 201)):
        if (2 - a) > limit * (c - a):
            continue
        lo, hi = 0.0, min(2 - a, 4 - c)
        for _ in range(30):
            w = 0.5 * (lo + hi)
            holds = max(c + w, 2.5) - 2 <= limit * (max(c + w, 2.5) - max(a + w, 1.0))
            lo, hi = (w, hi) if holds else (lo, w)
        best = max(best, lo)
    return best


def said(regions: Any) -> str:
    return "\n".join(rg.verify(regions).violations)


def test_the_widest_least_arc_is_that_of_a_grid_and_its_proof_verifies() -> None:
    regions = found()
    proof = regions.widest
    assert proof is not None
    expected = widest(0.8)
    assert regions.widths.min() == pytest.approx(expected, rel=0.01)
    assert regions.widths.min() <= proof.bound <= regions.widths.min() * 1.0101
    assert proof.bound >= expected
    verdict = rg.verify(regions)
    assert verdict.ok
    assert verdict.widest == proof.bound
    assert f"no arcs around these places are all longer than {proof.bound:.6g}" in str(verdict)
    again = rg.ContactRegions.from_dict(json.loads(json.dumps(regions.to_dict())))
    assert again == regions
    assert said(again) == ""


def test_a_bound_below_the_truth_is_refused_whatever_boxes_say() -> None:
    regions = found()
    assert regions.widest is not None
    low = replace(regions, widest=replace(regions.widest, bound=0.9 * regions.widths.min()))
    assert "proof of the widest" in said(low)
    high = replace(regions, widest=replace(regions.widest, bound=1.5 * regions.widest.bound))
    assert said(high) == ""  # weaker, and true


def test_every_part_of_the_proof_is_needed() -> None:
    regions = found()
    proof = regions.widest
    assert proof is not None
    assert len(proof.at) >= 1
    for number in range(len(proof.at)):
        rest = [i for i in range(len(proof.at)) if i != number]
        less = replace(
            proof, starts=proof.starts[rest], at=proof.at[rest], loads=proof.loads[rest],
            twists=proof.twists[rest],
        )  # fmt: skip
        assert "do not cover all starts" in said(replace(regions, widest=less))
    seen = 0
    for number, finger, end in product(range(len(proof.at)), range(2), range(2)):
        starts = np.array(proof.starts)
        starts[number, finger, end] += (1 - 2 * end) * 0.25 * np.ptp(starts[number, finger])
        seen += "do not cover all" in said(replace(regions, widest=replace(proof, starts=starts)))
    assert seen > 3 * len(proof.at)  # others stand at where arcs would leave their side
    for name, change, words in (
        ("twists", lambda v: -v, "may hold its load"),
        ("twists", lambda v: 0 * v, "may hold its load"),
        ("twists", lambda v: v + 0.3 * np.abs(v).max(), "may hold its load"),
        ("loads", lambda v: 2 * v, "not to be held"),
        ("at", lambda v: v + np.array([0.2, 0.0]), ""),
        ("at", lambda v: v - np.array([0.0, 0.2]), ""),
        ("at", lambda v: v + 7, "not in all of its arcs"),
        ("at", lambda v: v * nan, "none to compute with"),
        ("at", lambda v: v[:, :1], "parts missing"),
        ("starts", lambda v: v[:, :, :1], "parts missing"),
        ("loads", lambda v: v[1:], "parts missing"),
        ("twists", lambda v: v[:, :2], "parts missing"),
        ("places", lambda v: v + 1e-9, "other places"),
        ("places", lambda v: v[:1], "parts missing"),
        ("bound", lambda v: inf, "none to compute with"),
        ("bound", lambda v: -v, "none to compute with"),
        ("bound", lambda v: nan, "none to compute with"),
    ):
        value = change(getattr(proof, name))
        found_wrong = said(replace(regions, widest=replace(proof, **{name: value})))
        assert found_wrong != "", name
        assert words in found_wrong, (name, found_wrong)


def test_where_a_side_ends_no_box_is_needed_and_a_shorter_bound_needs_them() -> None:
    """With friction and room for forces both fingers may be all along the narrow side."""
    slab = rg.Outline([[0, 0], [4, 0], [4, 1], [0, 1]])
    grasp = rg.Grasp(slab.contact_at(s, friction=0.8) for s in (4.5, 9.5))
    regions = rg.contact_regions(slab, grasp, DOWN, max_force=9.0, widest="least")
    assert regions.widest is not None
    assert regions.widest.bound == pytest.approx(1.0, rel=1e-6)
    assert said(regions) == ""
    assert "do not cover" in said(replace(regions, widest=replace(regions.widest, bound=0.99)))


def test_the_load_is_one_of_those_held_and_forces_are_those_of_the_limit() -> None:
    regions = found()
    assert regions.widest is not None
    assert "is above" in said(replace(regions, max_force=0.7))
    weaker = replace(regions, max_force=0.9, grasp=rg.Grasp(c.changed(max_force=None) for c in regions.grasp))
    assert "may hold its load" in said(weaker)
    slippery = rg.Grasp(c.changed(friction=0.3) for c in regions.grasp)
    assert "may hold its load" in said(replace(regions, grasp=slippery))


def test_without_a_limit_nothing_is_the_widest() -> None:
    regions = found()
    free = rg.Grasp(c.changed(max_force=None) for c in regions.grasp)
    for limit in (inf, nan):
        assert "none to compute with" in said(replace(regions, max_force=limit, grasp=free))


def test_no_such_proof_is_one_on_a_curve() -> None:
    shape = rg.Outline.ellipse(2, 1)
    grasp = rg.Grasp(shape.contact_at(s * shape.length, friction=0.6) for s in (0.7, 0.8))
    regions = rg.contact_regions(shape, grasp, DOWN)
    assert regions.widest is None
    assert "one straight side each alone" in said(replace(regions, widest=found().widest))
