"""Least friction: textbook answers, independent programs, degenerate loads, units."""

from math import cos, inf, pi, sin, sqrt, tan

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from scipy.optimize import linprog

import regrasp as rg
from cones import edges
from invariance import Frame, frames
from space import random_grasp, soft_random
from strategies import held_triples

pytestmark = pytest.mark.oracle


def facing(mu: float = 0.5) -> rg.Grasp:
    return rg.Grasp([rg.Contact([-1, 0], [1, 0], mu), rg.Contact([1, 0], [-1, 0], mu)])


def table(mu: float = 0.5) -> rg.Grasp:
    """Two feet on the ground."""
    return rg.Grasp([rg.Contact([-1, 0], [0, 1], mu), rg.Contact([1, 0], [0, 1], mu)])


@pytest.mark.parametrize("angle", [0.3, 0.6, 1.0, 1.3, 1.5])
def test_ladders(angle: float) -> None:
    """Textbook: smooth wall, 1 / (2 tan a); the same at both ends, tan a = (1 - mu^2) / (2 mu)."""
    ladder = rg.Grasp(
        [
            rg.Contact([-cos(angle), -sin(angle)], [0, 1], 0.0, name="floor"),
            rg.Contact([cos(angle), sin(angle)], [-1, 0], 0.7, name="wall"),
        ]
    )
    weight = rg.Wrench([0, -9.81])
    floor = rg.least_friction(ladder, weight, contacts=["floor"])
    assert floor.value == pytest.approx(1 / (2 * tan(angle)), rel=1e-9)
    both = rg.least_friction(ladder, weight)
    assert (1 - both.value**2) / (2 * both.value) == pytest.approx(tan(angle), rel=1e-9)
    for found in (floor, both):
        lower, upper = found.bounds
        assert upper * (1 - 1e-5) < lower <= upper == found.value
        assert found.state.is_balanced(reserve=0.0)
        assert found.escape.is_proof
        assert max(found.escape.frictions) == pytest.approx(lower)


def is_held(grasp: rg.Grasp, mu: float, load: rg.Wrench, limit: float | None) -> bool:
    """Decided by a program of its own, with polygons of 64 sides around the discs of the limit."""
    same = rg.Grasp(c.changed(friction=mu) for c in grasp)
    e = edges(same)
    n = e.shape[1]
    rows, bounds = np.zeros((0, n)), np.zeros(0)
    if limit is not None:
        around = np.array([[cos(a), sin(a)] for a in 2 * pi * np.arange(64) / 64])
        rows = np.zeros((64 * (n // 2), n))
        for i in range(n // 2):
            rows[64 * i : 64 * i + 64, 2 * i : 2 * i + 2] = around @ e[:2, 2 * i : 2 * i + 2]
        bounds = np.full(len(rows), limit)
    return linprog(np.zeros(n), A_ub=rows, b_ub=bounds, A_eq=e, b_eq=-load.vector).status == 0


@pytest.mark.parametrize("limit", [None, 4.0])
def test_least_friction_against_linear_programs(limit: float | None) -> None:
    rng = np.random.default_rng(3)
    finite = 0
    for _ in range(8):
        count = int(rng.integers(2, 6))
        points, normals = rng.normal(size=(2, count, 2))
        grasp = rg.Grasp(rg.Contact(p, n - p, 0.1) for p, n in zip(points, 0.7 * normals, strict=True))
        load = rg.Wrench(rng.normal(size=2), 0.3 * rng.normal())
        found = rg.least_friction(grasp, load, max_force=limit)
        if found.value == inf:
            assert not is_held(grasp, 100.0, load, limit)
            continue
        finite += 1
        assert found.state.is_balanced(reserve=0.0)
        if found.value > 1e-3:
            assert is_held(grasp, found.value * 1.01, load, None if limit is None else limit * 1.002)
            assert not is_held(grasp, found.value * 0.999, load, None if limit is None else limit * 0.998)
    assert finite > 3


def margin_in_space(grasp: rg.Grasp, mu: float, load: rg.Wrench) -> bool:
    """Whether friction mu holds the load with forces up to 1e3, by cvxpy."""
    f = cp.Variable((len(grasp), 3))
    s = cp.Variable()
    torques = [
        np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ f[i] for i, (x, y, z) in enumerate(grasp.positions)
    ]
    rows = [sum(f[i] for i in range(len(grasp))) + s * load.force == 0, sum(torques) + s * load.torque == 0]
    for i, c in enumerate(grasp):
        rows += [cp.norm(f[i] - (c.normal @ f[i]) * c.normal) <= mu * (c.normal @ f[i]), cp.norm(f[i]) <= 1]
    problem = cp.Problem(cp.Maximize(s), [*rows, s <= 1])
    problem.solve(solver=cp.CLARABEL)
    return float(problem.value) > 1e-3


def test_least_friction_in_space_against_cone_programs() -> None:
    rng = np.random.default_rng(6)
    for count in (3, 4, 5):
        grasp = random_grasp(rng, count)
        load = rg.Wrench(rng.normal(size=3), 0.2 * rng.normal(size=3))
        found = rg.least_friction(grasp, load, max_force=1e3 * float(np.linalg.norm(load.force)))
        assert 1e-3 < found.value < inf
        assert found.bounds[0] > 0.999 * found.value
        assert found.escape.is_proof
        assert margin_in_space(grasp, 1.02 * found.value, load)
        assert not margin_in_space(grasp, 0.98 * found.value, load)
    soft = rg.least_friction(soft_random(rng, 3), rg.Wrench([0, 0, -1]))
    assert soft.value == inf or soft.state.is_balanced(reserve=0.0)


def test_least_friction_of_degenerate_loads() -> None:
    still = rg.least_friction(facing(), rg.Wrench([0, 0]))
    assert (still.value, still.bounds, still.escape) == (0.0, (0.0, 0.0), None)
    assert rg.least_friction(table(), rg.Wrench([0, -2])).value == 0.0
    lifted = rg.least_friction(table(), rg.Wrench([0, 2]))
    assert (lifted.value, lifted.state) == (inf, None)
    assert lifted.escape.is_proof
    assert str(lifted).startswith("no friction coefficient up to 10000 lets P1, P2 hold")
    # facing fingers need the less friction the more they squeeze: half the load over a million loads
    assert rg.least_friction(facing(), rg.Wrench([0, -3])).value == pytest.approx(0.5e-6, rel=1e-5)
    assert rg.least_friction(facing(), rg.Wrench([0, -1]), max_force=2).value == pytest.approx(1 / sqrt(15))


@given(held_triples(), frames)
@settings(max_examples=4, deadline=None)
def test_least_friction_does_not_depend_on_units(triple: tuple[rg.Grasp, rg.Wrench], frame: Frame) -> None:
    grasp, load = triple
    mine = rg.least_friction(grasp, load).value
    moved = rg.least_friction(frame.grasp(grasp, [2, 0, 1]), frame.load(load)).value
    assert moved == pytest.approx(mine, rel=1e-5, abs=1e-5)


def test_a_box_pressed_against_a_wall() -> None:
    """A box pressed with 20 N, mu 1 at the wall only: 20 / 9.81 kg (textbook)."""
    grasp = rg.Grasp(
        [rg.Contact([-1, y], [1, 0], 1.0) for y in (-2, 2)] + [rg.Contact([1, 0], [-1, 0], 0.0, max_force=20)]
    )
    found = rg.largest_load(grasp, rg.Wrench([0, -9.81]))
    assert found.factor == pytest.approx(20 / 9.81)
    assert found.bounds[1] == pytest.approx(20 / 9.81)
