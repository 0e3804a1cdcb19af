"""What verify finds in regrasps that drop the object, lift limits, or claim what is not so."""

import random
from dataclasses import replace
from fractions import Fraction
from math import cos, sin

import numpy as np
import pytest

import regrasp as rg
from box import BOX, GOAL, MU, START, WEIGHT
from regrasp.plans.sampled import SampledPath
from regrasp.verification.rotated_loads import cosine_sine

pytestmark = pytest.mark.contract

OUTLINE = rg.Outline.ellipse(2, 1)


def planar():
    first, last = (
        rg.Grasp(OUTLINE.contact_at(p * OUTLINE.length, friction=0.5) for p in places)
        for places in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    return rg.plan_regrasp(OUTLINE, first, last, rg.Wrench([0, -3.0]), friction=0.5, orientations=1)


def solid():
    return rg.plan_regrasp(BOX, START, GOAL, WEIGHT, friction=MU, orientations=12, candidates=12)


PLANS = {"plane": planar(), "space": solid()}


def broken(plan, **changes):
    return "; ".join(rg.verify(replace(plan, **changes)).violations)


@pytest.fixture(params=PLANS)
def plan(request):
    return PLANS[request.param]


def test_they_verify_as_planned(plan):
    assert rg.verify(plan).ok
    assert rg.verify(plan.reversed()).ok


def test_an_object_dropped_within_a_step(plan):
    step = next(s for s in plan.steps if s.turn is None)
    k = plan.steps.index(step)
    first, last, load = step.start.forces, step.end.forces, step.start.load.vector
    times, forces = [0, step.duration / 2, step.duration], [first, 0 * first, last]
    path = SampledPath(times, forces, [load, 0 * load, load])
    dropped = replace(step, path=path)
    steps = (*plan.steps[:k], dropped, *plan.steps[k + 1 :])
    assert f"step {k + 1}: its load at t = 0.5 s is not the one in the world" in broken(plan, steps=steps)


@pytest.mark.parametrize("change", [{"max_force": 1e6}, {"friction": 5.0}, {"name": "another"}])
def test_a_finger_that_may_do_more_after_a_joint(plan, change):
    last = plan.steps[-1]
    grasp = rg.Grasp(
        c.changed(**{k: f"{c.name}!" if k == "name" else v for k, v in change.items()}) for c in last.grasp
    )
    other = replace(
        last,
        leaving=tuple(grasp.names[last.grasp.names.index(name)] for name in last.leaving),
        arriving=tuple(grasp.names[last.grasp.names.index(name)] for name in last.arriving),
        start=rg.GraspState(grasp, last.start.load, last.start.forces),
        end=rg.GraspState(grasp, last.end.load, last.end.forces),
    )
    assert "the forces jump or a finger moves under force" in broken(plan, steps=(*plan.steps[:-1], other))


def test_orientations_and_margins_that_are_not_so(plan):
    turned = tuple(angle + 2 * np.pi * (k > 1) for k, angle in enumerate(plan.orientations))
    assert "does not lead from" in broken(plan, orientations=turned)
    assert "it claims a margin of 99 rad" in broken(plan, margin=99.0)


def test_a_regrasp_without_steps():
    assert "one step or more" in "; ".join(rg.verify(rg.RegraspPlan((), (0.0,), 0.1)).violations)


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
@pytest.mark.parametrize("angle", [120.0, -300.0])
def test_many_whole_turns(angle):
    ball = rg.Grasp(
        rg.Contact(p, [-x for x in p], 0.7)
        for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
    )
    assert rg.verify(rg.plan_rotation(ball, angle, axis=[0, 0, 1], load=rg.Wrench([0.2, 0.3, 0]))).ok


def test_cosines_and_sines_are_right_to_2_to_the_minus_80():
    """Against mathematics, which tells more than floats do: lengths of one, double angles and whole turns."""
    rng = random.Random(8)
    pi = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
    for size in (1e-30, 1e-9, 1e-3, 1.0, 3.0, 1e3, 1e9):
        for _ in range(20):
            angle = Fraction(rng.uniform(-size, size))
            c, s = cosine_sine(angle)
            assert (float(c), float(s)) == pytest.approx((cos(angle), sin(angle)), rel=1e-14, abs=1e-18)
            assert abs(c * c + s * s - 1) < Fraction(1, 2**80)
            double = cosine_sine(2 * angle)
            assert abs(double[0] - (c * c - s * s)) < Fraction(1, 2**80)
            assert abs(double[1] - 2 * c * s) < Fraction(1, 2**80)
            turned = cosine_sine(angle + 2 * pi * round(size))
            assert max(abs(turned[0] - c), abs(turned[1] - s)) < Fraction(1, 2**80)
            assert cosine_sine(-angle) == (c, -s)
    assert cosine_sine(Fraction(0)) == (1, 0)


@pytest.mark.parametrize("angle", [1e-15, 1e-12, 1e-9, 1e-8, 1e-7, 1e-5, 1e-3])
def test_small_turns(angle):
    grasp = rg.Grasp(
        rg.Contact(p, [-x for x in p], 0.7, max_force=m)
        for p, m in (([1, 0.1], 0.5), ([-0.6, 0.8], 0.5), ([-0.6, -0.8], 5.0))
    )
    plan = rg.plan_rotation(grasp, angle, load=rg.Wrench([0.2, -0.3]), objective="force")
    assert rg.verify(plan).ok
    assert plan.peaks == pytest.approx(plan.start.magnitudes, rel=1e-3)
    fast = plan.fastest(1.0)
    t = np.linspace(0, fast.duration, 501)
    assert np.linalg.norm(fast.rates(t), axis=-1).max() <= 1 + 1e-9


def test_limits_of_soft_fingers_are_one_thing_everywhere():
    grasp = rg.Grasp(
        rg.Contact(p, n, 0.5, torsion=0.05, max_force=0.65)
        for p, n in (([-1, 0, 0], [1, 0, 0]), ([1, 0, 0], [-1, 0, 0]))
    )
    load = rg.Wrench([0, 0, 0], [0.06, 0, 0])
    state = rg.GraspState(grasp, load, [[0.62, 0, 0, -0.03], [-0.62, 0, 0, 0.03]])  # |(f, g)| = 0.689
    with pytest.raises(rg.Infeasible) as caught:
        rg.choose_state(grasp, load, "effort")
    assert caught.value.certificate.is_proof
    turn = rg.plan_rotation(
        rg.Grasp(c.changed(max_force=None) for c in grasp), 0.5, axis=[1, 0, 0], load=load, objective="effort"
    )
    wide = rg.GraspState(turn.grasp, load, state.forces)
    assert wide.is_balanced()
    assert not state.is_balanced()
    claimed = replace(turn, start=state, end=rg.GraspState(grasp, turn.end.load, turn.end.forces))
    assert "above its limit" in "; ".join(rg.verify(claimed).violations)


def test_load_functions_of_soft_fingers_are_held_between_instants() -> None:
    """By forces inside their cones that differ from the plan's by what the fingers that stay answer."""
    from space import soft_random

    grasp = soft_random(np.random.default_rng(0), 5)

    def load(t: float) -> rg.Wrench:
        return rg.Wrench([0, 0.05 * np.sin(7 * t), -1.0], [0.01, 0.02, 0])

    def planned(instants: int) -> rg.Transition:
        return rg.plan_removal(
            grasp, 1, load=load, instants=instants, duration=1.0, objective="effort", reserve=0.2
        )

    fine, coarse = planned(41), planned(3)
    found = rg.verify(fine, load, curvature=0.05 * 49)
    assert found.ok, str(found)
    assert found.load_gap_is_proven
    assert not rg.verify(coarse, load).ok
    gone = grasp.names.index(fine.leaving[0])
    arms = np.array([[1, 1, 1, (c.torsion or 0) / c.friction] for c in grasp])
    arms[gone] = 0
    answer = arms.ravel()[:, None] * np.linalg.pinv(grasp.matrix * arms.ravel())
    for t in np.linspace(0, 1, 97):
        forces = fine.forces(t) - (answer @ (load(t).vector - fine.load(t))).reshape(5, 4)
        assert rg.GraspState(grasp, load(t), forces).is_balanced(reserve=0.0)


def test_places_belong_to_single_steps():
    plan, shaken = PLANS["plane"], rg.LoadSet.ball(rg.Wrench([0, 0]), force=1e-6)
    for given in ({"position": np.zeros(3)}, {"surface": 0.0}):
        with pytest.raises(rg.InvalidInput, match="step by step"):
            rg.verify(plan, disturbance=shaken, **given)


def test_a_row_of_stiffness_belongs_to_each_finger():
    plan, shaken = PLANS["plane"], rg.LoadSet.ball(rg.Wrench([0, 0]), force=1e-6)
    for count in (2, 4):
        with pytest.raises(rg.InvalidInput, match="have a row for each of 3 fingers"):
            rg.verify(plan, disturbance=shaken, stiffness=[1.0] * count)
    with pytest.raises(rg.InvalidInput, match="does not resist every motion"):
        rg.verify(plan, disturbance=shaken, stiffness=[1.0] * 3)


@pytest.mark.parametrize(("beyond", "good"), [(0.0, True), (2.0**-40, True), (2.0**-39, False)])
def test_a_margin_claimed_at_its_limit(beyond, good):
    """One hold of two fingers has no state between steps: the widest cone alone decides."""
    grasp = rg.Grasp(rg.Contact([x, 0], [-x, 0], 0.5) for x in (-1, 1))
    hold = rg.plan_hold(rg.GraspState(grasp, rg.Wrench([0, -1]), [[2, 0.5], [-2, 0.5]]), objective="effort")
    plan = rg.RegraspPlan((hold,), (0.0, 0.0), grasp[0].half_angle + beyond)
    assert rg.verify(plan).ok is good
