"""Regrasps in physics on the ways that were planned for their fingers."""

import numpy as np
import pytest

import regrasp as rg
from executed_plans import ellipse, lifted, removal
from regrasp.execution import simulate
from regrasp.mesh import parts
from regrasp.motions import plan_motions

pytestmark = pytest.mark.laws

pytest.importorskip("mujoco")

SHAPE = rg.Outline.ellipse(0.04, 0.02)


ENDS = ellipse(0.02, 0.35, 0.7), ellipse(0.2, 0.5, 0.85)
LOAD = rg.Wrench([0, -3.0])


def regrasp() -> rg.RegraspPlan:
    """Without turning."""
    return rg.plan_regrasp(SHAPE, *ENDS, LOAD, friction=0.5, orientations=1)


def test_fingers_go_the_ways_planned_and_the_object_is_held() -> None:
    plan = regrasp()
    motions = plan_motions(plan, SHAPE, tip_radius=0.003, clearance=0.002)
    run = simulate(plan, shape=SHAPE, motions=motions)
    assert run.held
    assert run == simulate(plan, shape=SHAPE, motions=motions)
    assert run.touching.sum(axis=1).min() >= 2
    inside = np.einsum("mij,mki->mkj", run.rotations, run.tips - run.positions[:, None])
    x, y = np.moveaxis(inside, -1, 0)
    # outside of the ellipse whose half axes are longer by the radius, to a tenth of a millimetre of lag
    assert ((x / 0.0429) ** 2 + (y / 0.0229) ** 2).min() > 0.99
    for motion in motions.motions:  # somewhere in the run a tip is at the middle of each way
        middle, _ = motion.way.over_time(np.array([0.5]), motion.duration)
        away = np.linalg.norm(inside[:, motion.finger] - middle, axis=1).min()
        assert away < 2e-3


def test_a_regrasp_that_turns_holds_on_its_ways() -> None:
    """Steps of 4 s: the simulation's contacts creep with the square of the angular velocity."""
    plan = rg.plan_regrasp(SHAPE, *ENDS, LOAD, friction=0.5, step_duration=4.0)
    assert abs(np.diff(plan.orientations)).max() > 1.0
    motions = plan_motions(plan, SHAPE, tip_radius=0.003, clearance=0.002)
    run = simulate(plan, shape=SHAPE, motions=motions)
    assert run.held
    assert run.touching.sum(axis=1).min() >= 2
    assert run.tilt.max() < 0.01


def test_motions_of_another_plan_are_refused() -> None:
    plan = regrasp()
    motions = plan_motions(plan, SHAPE, tip_radius=0.003, clearance=0.002)
    with pytest.raises(rg.InvalidInput, match="motions must be those of the plan that is simulated"):
        simulate(removal(), motions=motions)
    with pytest.raises(rg.InvalidInput, match="leave contact_errors and tip_radius out"):
        simulate(plan, motions=motions, tip_radius=0.001)


def test_in_space_three_fingers_touch_at_every_instant() -> None:
    plan, solid = lifted(), parts.bracket()
    motions = plan_motions(plan, solid, tip_radius=0.003, clearance=0.002)
    run = simulate(plan, shape=solid, motions=motions)
    assert run.held
    assert run.touching.sum(axis=1).min() >= 3
    assert motions.touching(np.linspace(0, motions.duration, 500)).sum(axis=1).min() == 3
    last = np.linalg.norm(run.tips[-1][3] - plan.grasp["P4"].position)
    assert last > 0.003 + 0.002  # the fourth has lifted off
