"""Maps, places and tolerances of the explorer are those that regrasp's own functions give."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.errors import InvalidInput
from regrasp.explore.dialogue import reply
from regrasp.explore.looks import CELLS, pair_map, places, tolerated
from regrasp.explore.question import OBJECTIVES
from regrasp.explore.start import of_shape, start_of

pytestmark = pytest.mark.oracle

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])


def value_at(asked: Any, contacts: list[rg.Contact]) -> float | None:
    """The objective's value of a pair, in the map's unit; None where it does not hold."""
    try:
        state = rg.choose_state(rg.Grasp(contacts), asked.wrench, asked.objective)
    except rg.Infeasible:
        return None
    assert state.value is not None
    return float(np.degrees(state.value) if asked.objective == "angle" else state.value)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_map_is_of_the_best_states(objective: str) -> None:
    start = of_shape(BRACKET)
    load = (0.3, -1.0, 0.2)
    asked = replace(start.question, objective=objective, load=load)
    found = pair_map(asked, BRACKET)
    values = np.array([[np.nan if v is None else v for v in row] for row in found["values"]])
    held = np.argwhere(~np.isnan(values))
    frictions = [c.friction for c in asked.grasp.without(asked.leaves)]
    rng, s = np.random.default_rng(0), (np.arange(CELLS) + 0.5) * BRACKET.length / CELLS
    cells = [*rng.choice(held, 10), *rng.integers(CELLS, size=(6, 2))]
    for j, i in cells:
        if i == j:
            continue
        pair = [BRACKET.contact_at(s[k], friction=mu) for k, mu in zip((i, j), frictions, strict=True)]
        expected = value_at(asked, pair)
        if expected is None:
            assert np.isnan(values[j, i])
        elif (
            min(np.linalg.norm(f) for f in rg.choose_state(rg.Grasp(pair), asked.wrench, objective).forces)
            > 1e-6
        ):
            assert values[j, i] == pytest.approx(expected, rel=1e-5, abs=1e-6)


def test_places_hold_and_bands_are_the_proven_regions() -> None:
    start = of_shape(BRACKET)
    found = places(start.question, BRACKET)
    rest = start.question.on(BRACKET).grasp.without("P3")
    for stretch in found["alone"]:
        k = rest.names.index(stretch["name"])
        contacts = list(rest)
        at = np.array(stretch["points"][len(stretch["points"]) // 2]) + BRACKET.centre_of_mass
        contacts[k] = BRACKET.contact_at(BRACKET.nearest(at), friction=contacts[k].friction)
        rg.choose_state(rg.Grasp(contacts), start.question.wrench)
    regions = rg.contact_regions(BRACKET, rest, start.question.wrench)
    for band, (a, b) in zip(found["together"], regions.arcs, strict=True):
        np.testing.assert_allclose(np.array(band["points"])[[0, -1]], BRACKET.points([a, b]), atol=1e-6)
    assert "Proven" in found["says"]


def test_places_of_three_that_stay_and_of_smooth_outlines() -> None:
    start = of_shape(rg.Outline.ellipse(2, 1))
    found = places(replace(start.question, leaves=None), start.shape)
    assert {stretch["name"] for stretch in found["alone"]} <= {"P1", "P2", "P3"}
    assert [band["name"] for band in found["together"]] == list(start.question.grasp.names)
    assert "Proven" in found["says"]


def test_tolerances_are_those_of_the_plan_in_words() -> None:
    asked = start_of().question
    plan = rg.plan_removal(rg.choose_state(asked.grasp, asked.wrench, "force"), "P3")
    rows = tolerated(asked)["rows"]
    assert rows[0][:2] == ["friction, all", f"down to {rg.tolerances(plan).withstood.friction:.3g} times"]
    assert len(rows) == 4 + 3
    stays = tolerated(replace(asked, leaves=None), answered=True)
    assert stays["head"][2] == "forces chosen anew"
    assert all(len(row) == 4 for row in stays["rows"])


def test_a_map_of_two_beside_a_third_that_stays() -> None:
    start = of_shape(BRACKET)
    asked = replace(start.question, leaves=None, objective="peak")
    found = pair_map(asked, BRACKET)
    assert found["title"] == "least peak beside P3"
    values = np.array([[np.nan if v is None else v for v in row] for row in found["values"]])
    j, i = np.unravel_index(np.nanargmin(values), values.shape)
    points = np.array(found["places"])[[i, j]] + BRACKET.centre_of_mass
    third = asked.on(BRACKET).grasp["P3"]
    mu = third.friction
    pair = [BRACKET.contact_at(BRACKET.nearest(p), friction=mu) for p in points]
    state = rg.choose_state(rg.Grasp([*pair, third]), asked.wrench, "peak")
    assert state.value == pytest.approx(values[j, i], rel=1e-5)


def test_a_map_needs_an_outline_and_of_more_fingers_one_friction() -> None:
    start = of_shape(BRACKET)
    first, *others = start.question.contacts
    rough = replace(start.question, leaves=None, contacts=(first | {"friction": 0.9}, *others))
    with pytest.raises(InvalidInput, match="of one friction and without force limits"):
        pair_map(rough, BRACKET)
    solid = start_of("solid-bracket")
    said = reply(solid, {"question": solid.question.to_dict(), "look": "places"})
    assert said["says"].startswith("needs an outline")
