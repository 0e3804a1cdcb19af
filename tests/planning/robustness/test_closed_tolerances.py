"""Closed forms of planar fingers beside the search that knows none of them."""

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from strategies import comfortable_pair, comfortable_triple
from values import WEIGHT, removal, space_grasp

pytestmark = pytest.mark.oracle


def with_discs(state: rg.GraspState, rng: np.random.Generator) -> rg.Grasp:
    sizes = np.linalg.norm(state.forces, axis=1) * rng.uniform(1.05, 1.6, len(state.grasp))
    limits = np.where(sizes > 0, sizes, 1.0)
    return rg.Grasp(c.changed(max_force=float(m)) for c, m in zip(state.grasp, limits, strict=True))


def with_rows(state: rg.GraspState, rng: np.random.Generator) -> rg.Grasp:
    contacts = []
    for c, force in zip(state.grasp, state.forces, strict=True):
        local = np.array([force @ c.normal, c.normal[0] * force[1] - c.normal[1] * force[0]])
        rows = rng.normal(size=(2, 2))
        bounds = np.maximum(rows @ local, 0.0) + rng.uniform(0.1, 0.5, 2) * (np.linalg.norm(local) + 0.1)
        contacts.append(c.changed(limits=(rows, bounds)))
    return rg.Grasp(contacts)


def test_planar_closed_forms_are_what_a_search_finds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stiffness by finger and direction, discs, linear limits, a finger idle or leaving; states and plans."""
    rng = np.random.default_rng(18)
    compared = 0
    for k in range(36):
        grasp, load = (comfortable_pair, comfortable_triple)[k % 2](rng)
        state = rg.choose_state(grasp, load, ("force", "effort")[k // 2 % 2])
        if k // 4 % 3:
            grasp = (with_discs, with_rows)[k // 4 % 3 - 1](state, rng)
            state = rg.GraspState(grasp, load, state.forces)
        springs = (None, rng.uniform(0.3, 3, len(grasp)), rng.uniform(0.3, 3, (len(grasp), 2)))[k % 3]
        asked = {"stiffness": springs, "tip_radius": 0.05 * grasp.size}
        found = rg.tolerances(state, **asked)
        with monkeypatch.context() as patch:
            patch.setitem(rg.tolerances.__globals__, "planar_forces", lambda view: None)
            other = rg.tolerances(state, **asked)
        for field in ("friction", "load", "tilt", "centre"):
            ours, theirs = getattr(found.withstood, field), getattr(other.withstood, field)
            assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-8), field
            firsts = [each.first.get(field) for each in (found, other)]
            assert firsts[0] == firsts[1] or firsts[0].how == firsts[1].how
        assert found.withstood.position == pytest.approx(other.withstood.position, abs=1e-9 * grasp.size)
        assert found.stiffness == pytest.approx(other.stiffness, abs=1e-12)
        compared += np.isfinite(found.withstood.position).sum()
    assert compared > 20
    plan = removal()
    found = rg.tolerances(plan)
    monkeypatch.setitem(rg.tolerances.__globals__, "planar_forces", lambda view: None)
    other = rg.tolerances(plan)
    assert found.first == other.first
    assert found.withstood.position == pytest.approx(other.withstood.position, rel=1e-7)


@pytest.mark.parametrize("where", ["plane", "space"])
def test_a_finger_at_its_limit_lets_no_centre_be_off(where: str) -> None:
    """Its force grows one way or the other; a search over directions once missed just that of the force."""
    grasp, load = (GRASP, LOAD) if where == "plane" else (space_grasp(), WEIGHT)
    state = rg.choose_state(grasp, load, "force", max_force=12.0)
    limit = float(np.linalg.norm(state.forces, axis=1).max())
    found = rg.tolerances(state, max_force=limit)
    assert found.withstood.centre <= 1e-6 * grasp.size
    assert found.first["centre"].how == "exceeds its limit"
