"""A crest between two angles, at a linear limit of it, from both sides and at every scale."""

from math import cos

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, turn

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
