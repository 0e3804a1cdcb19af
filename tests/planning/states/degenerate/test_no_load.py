"""No load, and loads and frictions next to none: one meaning each, the same on both sides of zero."""

from math import atan, cos, isnan, pi, radians, sin

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg
from exact_judge import is_held, state_faults
from space import random_grasp, soft_random
from strategies import comfortable_triple

pytestmark = pytest.mark.laws

MARGINS = ("angle", "force", "friction_use")
LEAST = ("effort", "peak", "peak_normal")


def ring(turn: float, friction: float = 0.6) -> rg.Grasp:
    """Three fingers on the unit circle, their normals turned out of the middle."""
    angles = [2 * pi * k / 3 for k in range(3)]
    return rg.Grasp(
        rg.Contact([cos(a), sin(a)], [cos(a + pi + turn), sin(a + pi + turn)], friction) for a in angles
    )


def level_by_cvxpy(grasp: rg.Grasp, objective: str) -> float:
    """The best angle or friction use of internal forces, by bisection: is any left in narrower cones?"""
    n, d = grasp.positions.shape
    f = cp.Variable((n, d))
    torques = sum(
        grasp.positions[i, 0] * f[i, 1] - grasp.positions[i, 1] * f[i, 0]
        if d == 2
        else np.cross(np.eye(3), grasp.positions[i]).T @ f[i] * -1
        for i in range(n)
    )
    low, high = 0.0, 1.0 if objective == "friction_use" else max(map(atan, grasp.frictions))
    while high - low > 1e-5:
        middle = (low + high) / 2
        held = [cp.sum(f, axis=0) == 0, torques == 0]
        pushes = []
        for i in range(n):
            angle = atan(grasp.frictions[i]) - middle
            mu = grasp.frictions[i] * (1 - middle) if objective == "friction_use" else np.tan(angle)
            along = grasp.normals[i] @ f[i]
            if objective == "angle" and angle < 0:
                held.append(f[i] == 0)
            else:
                held.append(cp.norm(f[i] - along * grasp.normals[i]) <= mu * along)
                pushes.append(along)
        problem = cp.Problem(cp.Maximize(sum(pushes)), [*held, sum(pushes) <= 1])
        problem.solve(solver=cp.CLARABEL)
        low, high = (middle, high) if problem.value > 0.5 else (low, middle)
    return low


def test_three_fingers_that_only_squeeze() -> None:
    grasp = ring(radians(15))
    none = rg.Wrench([0, 0])
    assert rg.choose_state(grasp, none, "angle", max_force=1).value == pytest.approx(0.278620, abs=1e-6)
    assert rg.choose_state(grasp, none, "angle", max_force=1).value == pytest.approx(
        atan(0.6) - radians(15), abs=1e-7
    )
    use = rg.choose_state(grasp, none, "friction_use", max_force=1)
    assert use.value == pytest.approx(0.446582, abs=1e-6)
    assert use.magnitudes.max() == pytest.approx(1)  # as hard as the limit lets them
    for objective in LEAST:
        assert not rg.choose_state(grasp, none, objective, max_force=1).forces.any()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("objective", ["angle", "friction_use"])
def test_the_best_squeeze_as_cvxpy_bisects_it(seed: int, objective: str) -> None:
    rng = np.random.default_rng(seed)
    grasp = comfortable_triple(rng)[0] if seed % 2 else random_grasp(rng, 4, 0.8)
    found = rg.choose_state(grasp, rg.Wrench(np.zeros(grasp.dimension)), objective, max_force=2.0)
    best = level_by_cvxpy(grasp, objective)
    if not found.forces.any():
        assert best < 2e-5
        return
    assert (found.value if objective == "angle" else 1 - found.value) == pytest.approx(best, abs=3e-5)
    assert found.gap < 1e-5
    assert found.magnitudes.max() == pytest.approx(2.0)


@pytest.mark.parametrize("objective", MARGINS)
def test_a_pair_says_the_same_by_closed_form_and_by_program(objective: str) -> None:
    rng = np.random.default_rng(3)
    none = rg.Wrench([0, 0])
    for _ in range(40):
        r, n = rng.normal(size=(2, 2)), rng.normal(size=2)
        u = (r[1] - r[0]) / np.linalg.norm(r[1] - r[0])
        grasp = rg.Grasp(
            [rg.Contact(r[0], u + 0.5 * n, 0.6), rg.Contact(r[1], 0.4 * rng.normal(size=2) - u, 0.8)]
        )
        closed = rg.choose_state(grasp, none, objective, max_force=1)
        solved = rg.choose_state(grasp, none, objective, max_force=1, method="clarabel")
        assert closed.forces.any() == solved.forces.any()
        if closed.forces.any():
            assert solved.value == pytest.approx(closed.value, abs=1e-6)


@pytest.mark.parametrize("objective", [*MARGINS, *LEAST])
def test_nothing_is_held_by_nothing_where_nothing_else_is(objective: str) -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([0, -0.5], [0, 1], 0.499),
            rg.Contact([0.5, 0], [-1, 0], 0),
            rg.Contact([0.25, 0.5], [0, -1], 0),
        ]
    )
    state = rg.choose_state(grasp, rg.Wrench([0, 0]), objective, max_force=1)
    assert not state.forces.any()
    assert isnan(state.value) if objective in ("angle", "friction_use") else state.value == 0


def test_zero_forces_come_from_a_grasp_without_a_squeeze_only() -> None:
    """Whether forces f cancel but for f = 0: then none of 1 N along a normal is balanced by the others."""
    rng, seen = np.random.default_rng(8), set()
    for _ in range(80):
        n = 3
        r, normals = rng.normal(size=(2, n, 2))
        mu = rng.choice([0.0, 0.2, 0.6], n)
        grasp = rg.Grasp(rg.Contact(*c) for c in zip(r, normals, mu.tolist(), strict=True))
        state = rg.choose_state(grasp, rg.Wrench([0, 0]), "angle", max_force=1.0)
        can = False
        for i in range(n):  # an edge of cone i as the load of the others
            x, y = grasp.normals[i]
            for s in (-1, 1):
                e = np.array([x - s * mu[i] * y, y + s * mu[i] * x])
                load = np.array([*e, r[i, 0] * e[1] - r[i, 1] * e[0]])
                can |= is_held(r, grasp.normals, mu, load)
        assert state.forces.any() == can
        assert state_faults(r, grasp.normals, mu, np.full(n, 1.0), np.zeros(3), state.forces) == []
        seen.add(can)
    assert seen == {True, False}


@pytest.mark.parametrize("objective", MARGINS)
def test_a_load_next_to_none_changes_nothing(objective: str) -> None:
    rng, some = np.random.default_rng(4), 0
    for case in range(24):
        grasp = comfortable_triple(rng)[0] if case % 2 else random_grasp(rng, 4)
        d = grasp.dimension
        zero = rg.choose_state(grasp, rg.Wrench(np.zeros(d)), objective, max_force=3.0)
        if len(zero.in_use) < len(grasp):
            continue  # the others, idle without a load, may have to hold it
        for power in (-13, -12, -11, -10, -9.5):
            load = rg.Wrench(3.0 * 10.0**power * rng.normal(size=d) / 4)
            state = rg.choose_state(grasp, load, objective, max_force=3.0)
            assert state.value == pytest.approx(zero.value, abs=1e-6)
            assert state.is_balanced()
            some += 1
    assert some > 40


def test_fingers_that_do_not_squeeze_hold_a_load_next_to_none() -> None:
    """Two face each other across a plate that a third carries: they cannot resist a turn about their line."""
    grasp = rg.Grasp(
        [
            rg.Contact([-1, 0, 0], [1, 0, 0], 0.5),
            rg.Contact([1, 0, 0], [-1, 0, 0], 0.5),
            rg.Contact([0, -1, -1], [0, 0, 1], 0.5),
        ]
    )
    for power in (-3, -9, -10, -12):  # one of 1e-13 of the squeeze is lost in its rounding
        load = rg.Wrench(10.0**power * np.array([0, 0, -1.0]), 10.0**power * np.array([0.4, 0, 0]))
        state = rg.choose_state(grasp, load, "angle", max_force=1.0)
        assert state.magnitudes[2] > 0
        assert state.value > 0.4  # of atan 0.5, 0.46: the third pushes along its normal
        assert state.is_balanced()


def test_a_load_next_to_none_that_takes_large_forces() -> None:
    """A wedge of 2e-6 rad needs half a million times the load: far below a limit of 1e10 of it, and held."""
    wedge = rg.Grasp(
        [
            rg.Contact([-1, 0, 0], [1, 0, 1e-6], 0.0),
            rg.Contact([1, 0, 0], [-1, 0, 1e-6], 0.0),
            rg.Contact([0, 0, 1], [0, 0, -1], 0.5),
        ]
    )
    for objective in MARGINS:
        state = rg.choose_state(wedge, rg.Wrench([0, 0, -1e-10]), objective, max_force=1.0)
        assert state.is_balanced()
        assert state.magnitudes.max() > 4e-5


def test_a_larger_load_is_continuous_with_it() -> None:
    grasp = ring(radians(15))
    for power in range(-12, -2):
        load = rg.Wrench([0, -(10.0**power)])
        assert rg.choose_state(grasp, load, "angle", max_force=1).value == pytest.approx(
            0.278620112, abs=1e-6
        )
        assert rg.choose_state(grasp, load, "friction_use", max_force=1).value == pytest.approx(
            0.446582, abs=1e-6
        )


@pytest.mark.parametrize("dimension", [2, 3])
def test_friction_next_to_none_is_none(dimension: int) -> None:
    rng, held = np.random.default_rng(dimension), 0
    for _ in range(8):
        n = dimension + 1
        r = rng.normal(size=(n, dimension))
        normals = -r / np.linalg.norm(r, axis=1)[:, None] + 0.4 * rng.normal(size=(n, dimension))
        load = rg.Wrench(0.3 * rng.normal(size=dimension))
        mu, slippery = rng.uniform(0.3, 1, n), int(rng.integers(n))
        for objective in ("angle", "force", "effort"):
            found = []
            for tiny in (0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9):
                mu[slippery] = tiny
                grasp = rg.Grasp(rg.Contact(*c) for c in zip(r, normals, mu.tolist(), strict=True))
                twist = None
                try:
                    found.append(rg.choose_state(grasp, load, objective).value)
                except rg.Infeasible as reason:
                    found.append(None)
                    twist = reason.certificate
                assert found[-1] is not None or twist is not None
            if found[0] is None:
                assert found == [None] * 6
            else:
                assert found == pytest.approx([found[0]] * 6, abs=1e-6)
                held += 1
    assert held > 3


def test_soft_fingers_squeeze_too() -> None:
    rng = np.random.default_rng(2)
    for _ in range(4):
        grasp = soft_random(rng, 3)
        state = rg.choose_state(grasp, rg.Wrench([0, 0, 0]), "angle", max_force=1.0)
        if state.forces.any():
            assert state.residual < 1e-12
            assert state.value >= 0


def test_a_finger_need_not_take_part() -> None:
    """Two face each other and a third pushes the same way as the first, beside them: it can only be idle."""
    grasp = rg.Grasp(
        [rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5), rg.Contact([-1, 5], [1, 0], 0.0)]
    )
    state = rg.choose_state(grasp, rg.Wrench([0, 0]), "force", max_force=1.0)
    assert state.in_use == ("P1", "P2")
    assert state.magnitudes[:2] == pytest.approx([1, 1], abs=1e-9)
