"""Grasps that stay while their load changes, and the load of an object that is carried."""

from math import cos, sin

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from values import WEIGHT, space_grasp

pytestmark = pytest.mark.laws

SOFT = rg.Grasp(c.changed(torsion=0.1) if i < 2 else c for i, c in enumerate(space_grasp()))


def swung(t: float) -> list[float]:
    return [0.2 * sin(2 * t), 0.1 * t * t]


def turned(t: float) -> np.ndarray:
    a, b = 0.4 * sin(t), 0.3 * t
    about_z = np.array([[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, cos(b), -sin(b)], [0, sin(b), cos(b)]])
    return about_z @ about_x


def test_a_carried_object_weighs_what_newton_and_euler_say() -> None:
    load = rg.carried_load(0.4, [0, -9.81], position=swung, orientation=lambda t: 0.5 * sin(t), inertia=0.002)
    for t in (0.0, 0.3, 1.7):
        force = 0.4 * (np.array([0, -9.81]) - [-0.8 * sin(2 * t), 0.2])
        a = 0.5 * sin(t)
        seen = np.array([[cos(a), sin(a)], [-sin(a), cos(a)]]) @ force
        np.testing.assert_allclose(load(t).force, seen, atol=1e-8)
        assert load(t).torque[0] == pytest.approx(0.002 * 0.5 * sin(t), abs=1e-9)
    inertia = np.diag([0.001, 0.002, 0.003])
    in_space = rg.carried_load(0.4, [0, 0, -9.81], orientation=turned, inertia=inertia)

    def momentum(t: float) -> np.ndarray:  # in the world, by the spin of the matrix
        h = 1e-4
        rate = (turned(t + h) - turned(t - h)) / (2 * h)
        skew = rate @ turned(t).T
        spin = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
        return turned(t) @ inertia @ turned(t).T @ spin

    for t in (0.2, 1.1):
        change = (momentum(t + 1e-3) - momentum(t - 1e-3)) / 2e-3
        np.testing.assert_allclose(in_space(t).torque, -turned(t).T @ change, atol=1e-8)
        np.testing.assert_allclose(in_space(t).force, turned(t).T @ [0, 0, -0.4 * 9.81], atol=1e-12)
    at_rest = rg.carried_load(2.0, [0, 0, -9.81])
    assert at_rest(5.0) == rg.Wrench([0, 0, -2.0 * 9.81])


@pytest.mark.parametrize(
    "grasp", [GRASP, space_grasp(), SOFT, SOFT.subset([0, 1])], ids=["plane", "space", "soft", "pair"]
)
def test_a_hold_balances_its_load_at_every_instant(grasp: rg.Grasp) -> None:
    if grasp.dimension == 2:
        load = rg.carried_load(0.4, [0, -9.81], position=swung)
    else:
        load = rg.carried_load(0.4, [0, 0, -9.81], orientation=turned, inertia=np.diag([0.001, 0.002, 0.003]))
    plan = rg.plan_hold(grasp, load, duration=1.0, instants=11, max_force=40.0)
    assert plan.kind == "hold"
    assert rg.verify(plan).ok
    for t in plan.course.times[:: len(plan.course.times) // 5]:
        np.testing.assert_allclose(plan.load(t), load(t).vector, atol=1e-12)
        balance = grasp.matrix @ plan.forces(t).ravel() + plan.load(t)
        assert abs(balance).max() < 1e-9


def test_soft_fingers_leave_and_arrive_on_paths_through_instants() -> None:
    plan = rg.plan_removal(SOFT, 0, load=WEIGHT, idle_from=0.7, max_force=40.0)
    assert rg.verify(plan).ok
    assert not plan.forces([0.7, 0.8, 1.0])[:, 0].any()
    only = rg.plan_removal(
        SOFT, [0, 1], load=rg.Wrench([0, 0, -0.5]), rate_limit=60.0, duration=1.0, max_force=20.0
    )
    assert rg.verify(only).ok
    assert plan.forces(0.5).shape == (4, 4)


def test_a_hold_under_a_constant_load_goes_straight() -> None:
    plan = rg.plan_hold(GRASP, LOAD, start_objective="effort", objective="force")
    assert isinstance(plan.path, rg.StraightPath)
    np.testing.assert_array_equal(plan.start.forces, rg.choose_state(GRASP, LOAD, "effort").forces)
    assert rg.verify(plan).ok
    back = rg.plan_hold(plan.end, end=plan.start)
    np.testing.assert_array_equal(back.forces(1.0), plan.forces(0.0))


def test_a_hold_withstands_its_set_at_every_instant() -> None:
    load = rg.carried_load(0.4, [0, -9.81], position=swung)
    for loads in (
        rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.3, torque=0.4),
        rg.LoadSet.hull([rg.Wrench([0.3, 0.1]), rg.Wrench([-0.3, 0], 0.5), rg.Wrench([0, -0.2])]),
    ):
        plan = rg.plan_hold(GRASP, load, duration=1.0, instants=11, max_force=40.0, disturbance=loads)
        assert rg.verify(plan, disturbance=loads).ok
        assert not rg.verify(plan, disturbance=loads.scaled(60)).ok


def test_holds_that_cannot_be_are_refused() -> None:
    thrown = rg.LoadSeries([0, 1], [[0, -1, 0], [0, 50, 0]])
    with pytest.raises(rg.Infeasible, match="balance"):
        rg.plan_hold(GRASP.without("P3"), thrown)
    with pytest.raises(rg.InvalidInput, match="end must be a state of the start's contacts"):
        rg.plan_hold(GRASP, LOAD, end=rg.choose_state(GRASP.without("P3"), LOAD))
    with pytest.raises(rg.InvalidInput, match="has an inertia"):
        rg.carried_load(1.0, [0, -9.81], orientation=lambda t: t)
    with pytest.raises(rg.InvalidInput, match=r"position must return \(2,\)"):
        rg.carried_load(1.0, [0, -9.81], position=lambda t: t)(0.0)
