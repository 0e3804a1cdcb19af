"""What ``verify`` finds in orientations and loads of regrasps of plain values."""

from math import nan, pi
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import EPS, course, said
from foreign.regrasps import changed, matrix, regrasp

pytestmark = pytest.mark.contract


@pytest.fixture(params=[2, 3], ids=["plane", "space"])
def d(request) -> int:
    return request.param


@pytest.mark.parametrize("k", [0, 1, 2])
@pytest.mark.parametrize("sign", [1, -1])
def test_orientations_follow_from_the_turns(d, k, sign) -> None:
    plan = regrasp(d)
    for off, good in (0.9 * EPS, True), (1.1 * EPS, False), (1e-2, False), (2 * pi, False), (99.0, False):
        angles = list(plan.orientations)
        angles[k + 1] += sign * off
        found = said(changed(plan, orientations=tuple(angles)))
        assert ("does not lead from" not in found) == good, off
        assert good or f"step {k + 1}: its turn of" in found


def test_orientations_after_many_turns_round_by_their_size() -> None:
    plan = regrasp(2)
    for off, good in (900 * EPS, True), (1100 * EPS, False):
        angles = [1000.0 + angle for angle in plan.orientations]
        angles[1:] = [angle + off for angle in angles[1:]]
        assert ("does not lead from" not in said(changed(plan, orientations=tuple(angles)))) == good


def test_orientations_may_start_anywhere() -> None:
    for d in (2, 3):
        plan = regrasp(d)
        other = tuple(1.25 + angle for angle in plan.orientations)
        if d == 2:
            assert said(changed(plan, orientations=other)) == ""
        else:
            turned = np.array([matrix(0.25) @ r for r in plan.rotations])
            assert said(changed(plan, rotations=turned)) == ""


@pytest.mark.parametrize("step", [0, 1, 2])
@pytest.mark.parametrize("end", ["start", "end"])
def test_the_load_is_one_and_the_same_in_the_world(d, step, end) -> None:
    plan = regrasp(d)
    for axis in range(d):
        for sign in (1, -1):
            for off, good in (0.9 * EPS, True), (1.1 * EPS, False):
                state = getattr(plan.steps[step], end)
                force = state.load.force.copy()
                force[axis] += sign * off
                other = rg.GraspState(state.grasp, rg.Wrench(force), state.forces)
                at = "start" if end == "start" else "end"
                words = f"step {step + 1}: its load at the {at} is not the first one seen from"
                found = said(changed(plan, step, **{end: other}))
                if (step, end) == (0, "start"):  # by that the others are judged
                    assert ("not the first one" not in found) == good or off < EPS
                else:
                    assert (words not in found) == good


def test_a_torque_at_a_joint(d) -> None:
    """A torque far below what the balance can tell, in every state of a step."""
    plan = regrasp(d)
    for step in (0, 2):
        changes = {}
        for end in ("start", "end"):
            state = getattr(plan.steps[step], end)
            torque = 2.0**-60 if d == 2 else [0, 0, 2.0**-60]
            changes[end] = rg.GraspState(state.grasp, rg.Wrench(state.load.force, torque), state.forces)
        found = said(changed(plan, step, **changes))
        assert f"step {step + 1}: its load at the start is not the first one" in found
        assert f"step {step + 1}: its load at the end is not the first one" in found


def test_an_object_dropped_within_a_step(d) -> None:
    plan = regrasp(d)
    step = plan.steps[2]
    for axis in range(len(step.start.load.vector)):
        for off, good in (0.9 * EPS, True), (1.1 * EPS, False):
            loads = np.array([step.start.load.vector] * 3)
            loads[1, axis] += off
            rows = [step.start.forces, (step.start.forces + step.end.forces) / 2, step.end.forces]
            path = course([0, 0.5, 1], rows, loads)
            found = said(changed(plan, 2, course=path))
            assert ("step 3: its load at t = 0.5 s is not the one in the world" not in found) == good


def test_a_step_with_instants_and_a_turn(d) -> None:
    plan = regrasp(d)
    step = plan.steps[1]
    path = course([0, 1], step.turn.forces, [step.start.load.vector] * 2)
    assert "step 2: it has a course and a turn" in said(changed(plan, 1, course=path))


def test_rotations_are_rotations_and_follow_from_the_turns() -> None:
    plan = regrasp(3)
    good = plan.rotations

    def with_rotations(values) -> str:
        return said(changed(plan, rotations=values))

    assert with_rotations(good) == ""
    for values in (None, good[:2], good[:, :2], np.where(good == 1, nan, good)):
        assert "3 steps in space need 4 rotations" in with_rotations(values)
    without = SimpleNamespace(**{k: v for k, v in vars(plan).items() if k != "rotations"})
    assert "3 steps in space need 4 rotations" in said(without)
    for k in range(4):
        for entry in range(9):
            other = good.copy()
            other[k].flat[entry] += 1e-9
            assert with_rotations(other) != ""
        mirrored = good.copy()
        mirrored[k, :, 2] *= -1
        assert f"rotation {k + 1} is a reflection" in with_rotations(mirrored)
        for off, fine in (0.4 * EPS, True), (1.1 * EPS, False):
            turned = good.copy()
            turned[k] = matrix(off) @ good[k]
            assert (with_rotations(turned) == "") == fine
        turned = good.copy()
        turned[k] = matrix(1e-9) @ good[k]
        assert "its turn does not lead to the next rotation" in with_rotations(turned)
    everything = good * np.array([1, 1, -1.0])
    assert "rotation 1 is a reflection" in with_rotations(everything)
    assert "is not orthonormal" in with_rotations(1.001 * good)
