"""The widest force margin that places reach: against sampled placements, and its bound against its region."""

import json
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.verification.placed.forces.eroded import cone_edges, most_eroded, roughly_eroded

pytestmark = pytest.mark.oracle

LOADS = rg.LoadSet.hull([rg.Wrench([0, -1], 0.2), rg.Wrench([0.9, 0.3]), rg.Wrench([-0.3, 1], -0.2)])
BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
ASKED = {"friction": 0.4, "objective": "force", "max_force": 3.0}


def margin(grasp: rg.Grasp) -> float:
    assert LOADS.vertices is not None
    loads = map(rg.Wrench.from_vector, LOADS.vertices)
    try:
        return min(rg.choose_state(grasp, load, "force", max_force=3.0).value for load in loads)
    except rg.Infeasible:
        return -np.inf


@pytest.mark.parametrize(
    ("shape", "fingers", "count"),
    [(BRACKET, 2, 10), (BRACKET, 3, 9), (rg.Outline.ellipse(2, 1), 2, 10)],
    ids=["bracket", "three on the bracket", "ellipse"],
)
def test_no_sampled_placement_has_a_wider_margin(shape: rg.Outline, fingers: int, count: int) -> None:
    chosen = rg.choose_grasp(shape, fingers, LOADS, tolerance=0.01, **ASKED)
    contacts = [shape.contact_at(s, friction=0.4) for s in shape.sample(count)]
    sampled = max(margin(rg.Grasp(few)) for few in combinations(contacts, fingers))
    assert 0 < sampled <= chosen.bound
    assert chosen.value <= chosen.bound <= 1.0101 * chosen.value
    assert margin(chosen.grasp) == pytest.approx(chosen.value, rel=1e-6)
    again = rg.ChosenGrasp.from_dict(json.loads(json.dumps(chosen.to_dict())))
    assert again == chosen
    assert rg.verify(again).ok
    proof = chosen.certificate
    what, row = "motions", 2  # of all loads, or of one for each box
    if proof.motions is None:
        what, row = "twists", np.flatnonzero(proof.children[:, 1] == 0)[2]
    spoiled = np.array(getattr(proof, what))
    spoiled[row] *= -1
    for wrong in (
        replace(chosen, bound=chosen.value),
        replace(chosen, value=1.001 * chosen.value),
        replace(chosen, certificate=replace(proof, margin=0.98 * proof.margin)),
        replace(chosen, certificate=replace(proof, bound=1.02 * proof.bound)),
        replace(chosen, certificate=replace(proof, **{what: spoiled})),
    ):
        assert not rg.verify(wrong).ok


def test_without_a_placement_or_a_limit_or_friction_it_says_so() -> None:
    with pytest.raises(rg.Infeasible, match=r"forces of at most 0\.2 N") as caught:
        rg.choose_grasp(BRACKET, 3, LOADS, **ASKED | {"max_force": 0.2})
    assert rg.verify(caught.value.certificate).ok
    for more, words in (({"max_force": None}, "needs max_force"), ({"friction": 1e-9}, "above 1e-09")):
        assert words in str(refusal(lambda more=more: rg.choose_grasp(BRACKET, 2, LOADS, **ASKED | more)))


def test_without_a_load_opposite_fingers_squeeze_at_the_limit() -> None:
    """Forces along the normals, of the limit: the margin is F sin(atan mu), and needs no proof."""
    chosen = rg.choose_grasp(BRACKET, 2, rg.Wrench([0, 0]), **ASKED)
    assert chosen.value == pytest.approx(3 * np.sin(np.arctan(0.4)), rel=1e-3)
    assert rg.verify(chosen).ok


def test_what_bounds_a_region_is_reached_by_it() -> None:
    """Against points of the region: the bound is above all of them, and nearly one of them."""
    rng = np.random.default_rng(8)
    for _ in range(60):
        mu, limit = float(rng.choice([0.05, 0.4, 2.0])), float(rng.uniform(0.5, 3))
        top = limit * mu / np.hypot(1, mu)
        distance = float(rng.uniform(0.01, 0.95)) * top
        d, v = rng.normal(size=2), rng.normal(size=2)
        edges = cone_edges((Fraction(d[0]), Fraction(d[1])), Fraction(mu))
        exact = (Fraction(v[0]), Fraction(v[1]))
        found = float(most_eroded(*edges, Fraction(limit), Fraction(distance), exact))
        a, b = (np.array(e, float) / np.hypot(*np.array(e, float)) for e in edges)
        rough = roughly_eroded(a[None], b[None], limit, distance, v[None])[0]
        # doubles judge no cone as thin as 0.05
        assert rough == (np.inf if mu == 0.05 else pytest.approx(found, rel=1e-9, abs=1e-9))
        angle = np.linspace(0, 2 * np.pi, 2001)
        f = (
            np.sqrt(np.linspace(0, 1, 401))[:, None, None]
            * limit
            * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        )
        inside = (a[0] * f[..., 1] - a[1] * f[..., 0] >= distance) & (
            f[..., 0] * b[1] - f[..., 1] * b[0] >= distance
        )
        best = (f[inside] @ v).max(initial=-np.inf)
        assert best <= found + 1e-9
        assert found - best <= 0.05 * limit * np.hypot(*v) or not inside.any()


def test_a_map_of_margins_has_the_optimum_of_its_places() -> None:
    found = rg.placement_map(BRACKET, LOADS, count=14, **ASKED)
    chosen = rg.choose_grasp(BRACKET, 2, LOADS, tolerance=0.01, **ASKED)
    assert 0 < np.nanmax(found.values) <= chosen.bound
    assert np.nanmax(found.best) == np.nanmax(found.values)


@pytest.mark.parametrize("objective", ["friction_use", "angle", "force"])
def test_a_level_cut_short_is_read_from_plain_data_too(objective: str) -> None:
    chosen = rg.choose_grasp(
        BRACKET, 3, LOADS, most_boxes=200, tolerance=1e-6, **ASKED | {"objective": objective}
    )
    again = rg.ChosenGrasp.from_dict(json.loads(json.dumps(chosen.to_dict())))
    assert again == chosen
    assert again.gap > 1e-6
    assert rg.verify(again).ok


def test_a_centre_of_pressure_that_rounds_past_a_corner_is_at_it() -> None:
    nearly_flat = rg.Outline([[0, 0], [1, 0], [2, 0], [2 + 1e-6, 0], [4, 0], [4, 3], [2, 3 + 1e-7], [0, 3]])
    load = rg.LoadSet.turned(rg.Wrench([0, -1]))
    chosen = rg.choose_grasp(
        nearly_flat, 2, load, friction=0.3, objective="force", max_force=3.0, from_corners=0.0, tolerance=1e-3
    )
    assert rg.verify(chosen).ok, rg.verify(chosen)
