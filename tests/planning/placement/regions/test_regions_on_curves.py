"""Regions on smooth outlines: every choice within holds, wider ones do not, and spoiled proofs are seen."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import regrasp as rg

pytestmark = pytest.mark.laws

PEAR = rg.Outline.smooth([[0, 0], [1.4, -0.5], [2.1, 0.4], [1.1, 0.8], [0.7, 1.7], [-0.3, 1.2]])
LOADS = rg.LoadSet.hull([rg.Wrench([0, -1], 0.1), rg.Wrench([0.5, -1])])


def fails(places: np.ndarray, limit: float) -> bool:
    grasp = rg.Grasp(PEAR.contact_at(s, friction=0.6) for s in places)
    assert LOADS.vertices is not None
    try:
        for w in LOADS.vertices:
            rg.choose_state(grasp, rg.Wrench.from_vector(w), "peak", max_force=limit * (1 + 1e-6))
    except rg.Infeasible:
        return True
    return False


def test_longer_least_arcs_and_larger_products_hold_too() -> None:
    chosen = rg.choose_grasp(PEAR, 2, LOADS, friction=0.6, objective="peak", tolerance=0.02)
    together, least, product_of = (
        rg.contact_regions(PEAR, chosen.grasp, LOADS, widest=w) for w in ("together", "least", "product")
    )
    assert least.widths.min() > 1.2 * together.widths.min()
    assert product_of.widths.prod() > 1.7 * together.widths.prod()
    assert product_of.widths.prod() > least.widths.prod()
    assert product_of.widths.min() < least.widths.min()
    rng = np.random.default_rng(4)
    for regions in (least, product_of):
        assert regions.max_force == together.max_force
        assert regions.half_width <= together.half_width
        assert (regions.arcs[:, 0] <= regions.places).all()
        assert (regions.places <= regions.arcs[:, 1]).all()
        assert not any(fails(rng.uniform(*regions.arcs.T), regions.max_force) for _ in range(60))
        assert rg.verify(regions).ok
        longer = replace(regions, arcs=regions.arcs + np.array([-0.01, 0.01]))
        assert any("another arc" in v or "longer than" in v for v in rg.verify(longer).violations)
        wider = replace(regions, half_width=together.half_width)
        assert any("less than the half width" in v for v in rg.verify(wider).violations)


def test_every_choice_within_regions_on_a_curve_holds() -> None:
    chosen = rg.choose_grasp(PEAR, 2, LOADS, friction=0.6, objective="peak", tolerance=0.02)
    regions = rg.contact_regions(PEAR, chosen.grasp, LOADS)
    assert regions.half_width > 0.01 * PEAR.length
    assert (regions.widths >= 2 * regions.half_width * (1 - 1e-5)).all()
    assert (regions.alone >= regions.half_width * 0.99).all()
    rng = np.random.default_rng(4)
    assert not any(fails(rng.uniform(*regions.arcs.T), regions.max_force) for _ in range(60))
    corners = np.array(list(product((-1, 1), repeat=2)))
    assert any(fails(regions.places + 1.3 * regions.half_width * way, regions.max_force) for way in corners)
    assert rg.verify(regions).ok
    assert regions.spans is not None
    assert regions.cells is not None
    assert len(regions.cells) > 4
    wide = np.array(regions.spans)
    wide[0, 1] += 0.02
    inward = np.array(regions.arcs)
    inward[0, 1] += 0.01
    slippery = rg.Grasp(c.changed(friction=0.5) for c in regions.grasp)
    for wrong, words in (
        (replace(regions, spans=wide), "do not cover the arcs"),
        (replace(regions, cells=regions.cells[1:], corners=regions.corners[8:]), "do not cover the arcs"),
        (replace(regions, cells=regions.cells[::-1]), "do not stand for all places"),
        (replace(regions, arcs=inward), "another arc"),
        (replace(regions, grasp=slippery), "do not stand for all places"),
        (replace(regions, corners=regions.corners[:-1]), "missing"),
        (replace(regions, spans=None), "span"),
        (replace(regions, half_width=regions.half_width * (1 + 1e-5)), "less than the half width"),
        (replace(regions, half_width=-0.1), "less than the half width"),
        (replace(regions, places=regions.places + np.array([1e-4, 0.0])), "not at its place"),
        (replace(regions, places=regions.places[:1]), "a place"),
    ):
        assert any(words in v for v in rg.verify(wrong).violations), words
