"""Contacts at one point along different normals (an inner corner), and contacts a hair apart."""

from itertools import pairwise

import numpy as np
import pytest

import regrasp as rg
from exact_judge import is_held, state_faults
from regrasp.mechanics.exact.membership import vertex_forces

pytestmark = pytest.mark.laws

OBJECTIVES = ("effort", "angle", "peak", "force", "friction_use", "peak_normal")


def corner() -> rg.Grasp:
    places = (((-1, -2), (1, 0)), ((-1, -2), (0, 1)), ((1, 2), (-1, 0)), ((1, 2), (0, -1)))
    return rg.Grasp(rg.Contact(r, n, 0.5) for r, n in places)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_body_in_two_inner_corners(objective: str) -> None:
    grasp, load = corner(), rg.Wrench([0.3, -1], 0.2)
    state = rg.choose_state(grasp, load, objective)
    faults = state_faults(
        grasp.positions, grasp.normals, grasp.frictions, np.full(4, np.inf), load.vector, state.forces
    )
    assert faults == []
    assert rg.verify(rg.plan_removal(grasp, "P4", load=load, objective=objective)).ok


def test_two_fingers_at_one_point_hold_what_passes_through_it() -> None:
    grasp = corner().subset(["P1", "P2"])
    through = rg.Wrench([-0.2, -1], -1 * -1 - -2 * -0.2)  # r x F
    assert rg.choose_state(grasp, through, "effort").is_balanced()
    with pytest.raises(rg.Infeasible) as error:
        rg.choose_state(grasp, through + rg.Wrench([0, 0], 1e-3), "effort")
    assert error.value.certificate.is_proof
    with pytest.raises(rg.InvalidInput, match="at two points"):
        rg.choose_state(grasp, through, method="closed-form")
    with pytest.raises(rg.InvalidInput, match="P1 and P2 are at one"):
        rg.EquilibriumLocus(grasp, through)


def test_one_point_and_one_normal_is_one_contact_given_twice() -> None:
    for off in (0.0, 1e-13):
        with pytest.raises(rg.InvalidInput, match=r"coincide at .*; place them at different points"):
            rg.Grasp([rg.Contact([1, 2], [0, 1], 0.5), rg.Contact([1 + off, 2], [0, 1], 0.3)])
    rg.Grasp([rg.Contact([1, 2], [0, 1], 0.5), rg.Contact([1 + 1e-11, 2], [0, 1], 0.3)])
    rg.Grasp([rg.Contact([0, 0], [0, 1], 0.5), rg.Contact([0, 0], [1, 1], 0.3)])  # the origin has no size


def vertex_is_small(grasp: rg.Grasp, load: rg.Wrench) -> bool:
    forces = vertex_forces(grasp, load, grasp.frictions)
    return forces is not None and abs(forces).max() < 1e8 * abs(load.vector).max()


@pytest.mark.parametrize("fingers", [2, 3])
def test_a_hair_apart_they_say_what_they_say_at_one_point(fingers: int) -> None:
    """For random loads that three fingers hold with room, and two exactly: the load through their middle."""
    rng, held = np.random.default_rng(fingers), 0
    for _ in range(25):
        r, u = rng.normal(size=(3, 2)), rng.normal(size=2)
        n = -r + 0.6 * rng.normal(size=(3, 2))
        n[1] = n[0] @ [[0, 1], [-1, 0]] if rng.random() < 0.5 else n[1]
        load = rng.normal(size=3)
        if fingers == 2:
            push = rng.uniform(0.2, 1, 2) @ (n[:2] / np.linalg.norm(n[:2], axis=1)[:, None])
        values: list[float | None] = []
        for gap in (0.0, 1e-13, 1e-12, 1e-11, 1e-10):
            places = r.copy()
            places[0], places[1] = r[0] - gap / 2 * u, r[0] + gap / 2 * u
            grasp = rg.Grasp(rg.Contact(*c, 0.6) for c in zip(places[:fingers], n[:fingers], strict=True))
            wrench = rg.Wrench.from_vector(load)
            if fingers == 2:
                wrench = rg.Wrench(-push, -(r[0, 0] * push[1] - r[0, 1] * push[0]))
            truly = is_held(grasp.positions, grasp.normals, grasp.frictions, wrench.vector)
            refused = None
            try:
                state = rg.choose_state(grasp, wrench, "effort")
            except rg.Infeasible as reason:
                refused = reason
            if refused is not None:
                # A lever of a hair makes forces of 1e9 times the load and more, which hold nothing.
                small = vertex_is_small(grasp, wrench)
                assert refused.certificate is None or not truly or not small
                assert refused.certificate is not None or "at its limit" in str(refused) or not small
                values.append(None)
                continue
            if fingers == 3:
                assert truly
                if state.value > 1e12:
                    continue
            values.append(state.value)
            assert state.is_balanced()
        if fingers == 3:
            assert len({value is None for value in values}) == 1, values
            assert all(a == pytest.approx(b, rel=1e-6) for a, b in pairwise(values) if a is not None)
        assert values[0] is not None or fingers == 3
        held += values[0] is not None
    assert held > 8


def test_a_triple_holds_what_its_pair_holds() -> None:
    rng, held = np.random.default_rng(9), 0
    for _ in range(60):
        gap, u = 10.0 ** rng.uniform(-11, -9), rng.normal(size=2)
        r = rng.normal(size=2)
        n1, n2 = u + 0.3 * rng.normal(size=2), -u + 0.3 * rng.normal(size=2)
        pair = [rg.Contact(r, n1, 0.5), rg.Contact(r + gap * u, n2, 0.5)]
        force = rng.normal(size=2)
        load = rg.Wrench(force, float(r[0] * force[1] - r[1] * force[0]))
        try:
            rg.choose_state(rg.Grasp(pair), load, "effort")
        except rg.Infeasible:
            continue
        third = rg.Contact(rng.normal(size=2), rng.normal(size=2), 0.4)
        assert rg.choose_state(rg.Grasp([*pair, third]), load, "effort").is_balanced()
        held += 1
    assert held > 20


def test_a_pair_near_one_point_under_a_load_just_off_it() -> None:
    for gap in (1e-12, 1.5e-10, 1e-9):
        grasp = rg.Grasp([rg.Contact([0, -1], [1, 1], 0.5), rg.Contact([gap, -1], [-1, 1], 0.5)])
        assert not is_held(grasp.positions, grasp.normals, grasp.frictions, np.array([0, -1.0, 0]))
        with pytest.raises(rg.Infeasible) as error:
            rg.choose_state(grasp, rg.Wrench([0, -1]), "effort")
        assert "at its limit" in str(error.value) or error.value.certificate.is_proof
        middle = rg.Wrench([0, -1], -gap / 2)
        assert rg.choose_state(grasp, middle, "effort").value == pytest.approx(5 / 9, abs=1e-2)


@pytest.mark.parametrize("fingers", [2, 3, 4])
def test_in_space_a_hair_apart_they_hold_what_they_make(fingers: int) -> None:
    """Loads that forces well inside the cones make, of contacts two of which leave G nearly singular."""
    rng = np.random.default_rng(40 + fingers)
    for _ in range(3):
        r = rng.normal(size=(fingers, 3))
        r[1] = r[0] + 10.0 ** rng.uniform(-11, -7) * rng.normal(size=3)
        n = rng.normal(size=(fingers, 3))
        n /= np.linalg.norm(n, axis=1)[:, None]
        f = n * rng.uniform(0.5, 2, (fingers, 1)) + 0.1 * rng.normal(size=(fingers, 3))
        load = -np.r_[f.sum(axis=0), np.cross(r, f).sum(axis=0)]
        grasp = rg.Grasp(rg.Contact(*c, 1.5) for c in zip(r, n, strict=True))
        state = rg.choose_state(grasp, rg.Wrench.from_vector(load), str(rng.choice(OBJECTIVES)))
        limits = np.full(fingers, np.inf)
        assert state_faults(r, n, grasp.frictions, limits, load, state.forces) == []
