"""The nearest equilibrium inside cones and limits against cvxpy's projection, in the plane and in space."""

import warnings
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg

pytestmark = pytest.mark.oracle


@dataclass(frozen=True)
class Task:
    """A grasp that holds its load with forces ``held``, and forces to be moved into equilibrium."""

    state: rg.GraspState
    held: np.ndarray


def task(rng: np.random.Generator, dimension: int, limited: bool, far: float, rays: bool = False) -> Task:
    """``far``: distance of the given forces from the set, forces being of order 1; ``rays``: no friction."""
    n = int(rng.integers(2, 5) if dimension == 2 else rng.integers(3, 6))
    positions = rng.normal(size=(n, dimension))
    positions /= np.linalg.norm(positions, axis=1)[:, None]
    normals = -positions + 0.3 * rng.normal(size=(n, dimension))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    frictions = np.zeros(n) if rays else rng.uniform(0.2, 1.0, n)
    tangents = rng.normal(size=(n, dimension))
    tangents -= (tangents * normals).sum(axis=1)[:, None] * normals
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    share = rng.uniform(0, 0.8, n)[:, None]
    held = rng.uniform(0.5, 2, n)[:, None] * (normals + share * frictions[:, None] * tangents)
    limits = 1.05 * np.linalg.norm(held, axis=1) if limited else [None] * n
    grasp = rg.Grasp(
        rg.Contact(r, normal, mu, max_force=limit)
        for r, normal, mu, limit in zip(positions, normals, frictions, limits, strict=True)
    )
    load = rg.Wrench.from_vector(-grasp.matrix @ held.ravel())
    return Task(rg.GraspState(grasp, load, held + far * rng.normal(size=held.shape)), held)


def projected(state: rg.GraspState) -> np.ndarray:
    """The same by cvxpy: least squares over equilibrium, second-order cones and balls."""
    grasp, wanted = state.grasp, state.forces
    f = cp.Variable(wanted.shape)
    total = grasp.matrix @ cp.reshape(f, (wanted.size,), order="C")
    constraints = [total + state.load.vector == 0]
    for i, contact in enumerate(grasp):
        along = f[i] @ contact.normal
        constraints.append(cp.norm(f[i] - along * contact.normal) <= contact.friction * along)
        if contact.max_force is not None:
            constraints.append(cp.norm(f[i]) <= contact.max_force)
    problem = cp.Problem(cp.Minimize(cp.sum_squares(f - wanted)), constraints)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        problem.solve(solver=cp.CLARABEL, tol_gap_abs=1e-12, tol_gap_rel=1e-12, tol_feas=1e-12)
    assert problem.status in ("optimal", "optimal_inaccurate")
    return f.value


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("limited", [False, True])
def test_nearest_as_cvxpy_finds_it(dimension: int, limited: bool) -> None:
    rng = np.random.default_rng(dimension + 10 * limited)
    for far in (1e-3, 0.1, 1.0, 1.0):
        for _ in range(6):
            state = task(rng, dimension, limited, far).state
            ours, theirs = state.balanced(), projected(state)
            assert ours.forces == pytest.approx(theirs, abs=1e-5 * max(1, far))
            distance, best = (np.linalg.norm(f - state.forces) for f in (ours.forces, theirs))
            assert distance <= best * (1 + 1e-6) + 1e-8


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("limited", [False, True])
def test_what_exists_is_found_from_anywhere(dimension: int, limited: bool) -> None:
    """From forces a thousandth to ten times as large away; a refusal would be a false verdict."""
    rng = np.random.default_rng(20 + dimension + 10 * limited)
    for case in range(200):
        given = task(rng, dimension, limited, far=(1e-3, 0.1, 1.0, 10.0)[case % 4], rays=case % 10 == 0)
        state = given.state
        found = state.balanced()
        assert found.residual <= 2e-13 * abs(found.forces).max() * len(found.grasp)
        use = found.margins.friction_use[found.grasp.frictions > 0]
        assert np.nanmax(use, initial=0.0) <= 1
        assert (found.magnitudes <= found.grasp.max_forces).all()
        distance = np.linalg.norm(found.forces - state.forces)
        assert distance <= np.linalg.norm(given.held - state.forces) * (1 + 1e-6)
        assert found.balanced() is found  # once is enough


@pytest.mark.parametrize("dimension", [2, 3])
def test_balanced_already_is_returned_as_it_is(dimension: int) -> None:
    rng = np.random.default_rng(40 + dimension)
    for _ in range(50):
        given = task(rng, dimension, limited=True, far=0.0)
        assert given.state.balanced() is given.state
        assert given.state.balanced(reserve=0.1) is given.state  # at most 0.8 of the friction


def test_a_tenth_in_reserve_is_kept() -> None:
    rng = np.random.default_rng(50)
    for _ in range(50):
        found = task(rng, 2, limited=False, far=0.5).state.balanced(reserve=0.1)
        assert found.margins.largest_friction_use <= 0.9 * (1 + 1e-12)


@pytest.mark.parametrize("power", [-6, -3, 3, 6])
def test_units_do_not_matter(power: int) -> None:
    rng = np.random.default_rng(60)
    for _ in range(20):
        state = task(rng, 2, limited=True, far=0.3).state
        length, force = 10.0**power, 10.0 ** (-power / 2)
        grasp = rg.Grasp(
            rg.Contact(c.position * length, c.normal, c.friction, max_force=c.max_force * force)
            for c in state.grasp
        )
        load = rg.Wrench(state.load.force * force, float(state.load.torque[0]) * force * length)
        scaled = rg.GraspState(grasp, load, state.forces * force).balanced()
        assert scaled.forces == pytest.approx(force * state.balanced().forces, rel=1e-7, abs=1e-8 * force)


def test_what_cannot_be_balanced_is_refused() -> None:
    shelf = rg.Grasp([rg.Contact([-1, 0], [0, 1], 0.3), rg.Contact([1, 0], [0, 1], 0.3)])
    for load in (rg.Wrench([0, 1]), rg.Wrench([0, -1], -1.5), rg.Wrench([1, -1])):
        with pytest.raises(rg.Infeasible, match="no forces of P1, P2 inside their friction cones"):
            rg.GraspState(shelf, load, [[0, 0.5], [0, 0.5]]).balanced()
    limited = rg.Grasp([rg.Contact(c.position, c.normal, c.friction, max_force=0.4) for c in shelf])
    with pytest.raises(rg.Infeasible, match="and force limits"):
        rg.GraspState(limited, rg.Wrench([0, -1]), [[0, 0.5], [0, 0.5]]).balanced()


def test_no_force_where_no_load_asks_for_any() -> None:
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.3), rg.Contact([1, 0], [-1, 0], 0.3)])
    assert not rg.GraspState(grasp, rg.Wrench([0, 0]), np.zeros((2, 2))).balanced().forces.any()


def test_forces_near_none_are_none() -> None:
    """What is left of given forces where no load asks for any, and the cones let none cancel."""
    rng, none = np.random.default_rng(4), 0
    for _ in range(40):
        r, n = rng.normal(size=(3, 2)), rng.normal(size=(3, 2))
        grasp = rg.Grasp(rg.Contact(*c, 0.4) for c in zip(r, n, strict=True))
        found = rg.GraspState(grasp, rg.Wrench([0, 0]), rng.normal(size=(3, 2))).balanced()
        size = abs(found.forces).max()
        assert size == 0 or size > 1e-12
        none += size == 0
    assert 5 < none < 40
