"""A crest between two angles, at a linear limit of it, from both sides and at every scale."""

from math import cos
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, turn

pytestmark = pytest.mark.contract


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e6])
@pytest.mark.parametrize("step", [0.5, -1.0, 3.0])
@pytest.mark.parametrize("finger", [0, 1])
def test_a_crest_at_its_linear_limit(scale, step, finger) -> None:
    """Two equal ends rise by 1 / cos(step / 2) between; the load is next to nothing."""
    limits = [None, None]
    load, crest = rg.Wrench([0, 0]), scale / cos(step / 2)
    for most, good in (crest * (1 + 1e-14), True), (crest * (1 - 1e-14), False), (2 * crest, True):
        limits[finger] = ([[1.0, 0.0], [-1.0, 0.0]], [most, scale])
        grasp = rg.Grasp(rg.Contact([x, 0], [-x, 0], 0.5, limits=limits[k]) for k, x in enumerate((-1, 1)))
        forces = np.array([[scale, 0], [-scale, 0]])
        state = rg.GraspState(grasp, load, forces)
        verdict = rg.verify(Plan("rotation", None, state, state, turn=turn([0, step], [forces, forces])))
        assert verdict.ok is good
        assert good or "breaks its linear limit 0 between two angles" in verdict.violations[0]


@pytest.mark.parametrize("way", [1, -1])
def test_no_crest_where_a_force_rises_to_an_end(way) -> None:
    """A push that goes from 1 to 2 rises all the way, 0.5 rad apart: its end is its highest."""
    load = rg.Wrench([0, 0])
    for most, good in (2.0, True), (1.999, False):
        grasp = rg.Grasp(rg.Contact([x, 0], [-x, 0], 0.5, limits=([[1.0, 0.0]], [most])) for x in (-1, 1))
        states = [rg.GraspState(grasp, load, k * np.array([[1.0, 0], [-1.0, 0]])) for k in (1, 2)[::way]]
        path = turn([0, 0.5], [state.forces for state in states])
        verdict = rg.verify(Plan("rotation", None, *states, turn=path))
        assert verdict.ok is good
        assert good or "between" not in "; ".join(verdict.violations)


@pytest.mark.parametrize("scale", [1e-6, 1e-2, 1.0, 1e3])
@pytest.mark.parametrize("way", [1, -1])
def test_no_crest_of_a_size_either(scale, way) -> None:
    """Nor does |f| rise between: from 1 to 2 the limit of 2 holds, whatever the unit of forces."""
    for most, good in (2.0 * scale, True), (1.999 * scale, False):
        grasp = rg.Grasp(rg.Contact([x, 0], [-x, 0], 0.5, max_force=most) for x in (-1, 1))
        sizes = [scale * k for k in (1, 2)][::way]
        states = [rg.GraspState(grasp, rg.Wrench([0, 0]), [[k, 0], [-k, 0]]) for k in sizes]
        path = turn([0, 0.5 * way], [state.forces for state in states])
        verdict = rg.verify(Plan("rotation", None, *states, turn=path))
        assert verdict.ok is good


def test_each_choice_on_record_is_looked_at() -> None:
    """One for too many fingers hides no other."""
    grasp = rg.Grasp(rg.Contact([x, 0], [-x, 0], 0.5) for x in (-1, 1))
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), [[1, 0], [-1, 0]])
    start, end = ({"end": end, "objective": "force", "method": "x"} for end in ("start", "end"))
    choices = (
        SimpleNamespace(**start, force_limits=(2.0,) * 3),
        SimpleNamespace(**end, force_limits=(0.5, 2.0)),
    )
    said = rg.verify(Plan("rotation", None, state, state, record=Record(choices=choices))).violations
    assert len(said) == 2
    assert "3 force limits are on record" in said[0]
    assert "up to 0.5, it has 1" in said[1]
