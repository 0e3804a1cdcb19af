"""The facts of docs/facts.md in space, over random grasps, loads, units and frames."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import regrasp as rg
from space import random_grasp, random_load, random_rotation, rotated

pytestmark = pytest.mark.laws

SEEDS = st.integers(0, 10**6)
POWERS = st.integers(-6, 6).map(lambda k: 10.0**k)


def drawn(seed, count=None, friction=0.7):
    """A grasp, a load, and the generator that made them."""
    rng = np.random.default_rng(seed)
    grasp = random_grasp(rng, count or int(rng.integers(3, 6)), friction)
    return grasp, random_load(rng), rng


def held(grasp, load, objective="effort", **options):
    """The state, or None; every refusal must prove itself."""
    try:
        return rg.choose_state(grasp, load, objective, **options)
    except rg.Infeasible as reason:
        assert reason.certificate is None or reason.certificate.is_proof  # noqa: PT017
        return None


@given(SEEDS)
@settings(max_examples=40)
def test_between_two_states_everything_holds(seed):
    grasp, load, _ = drawn(seed)
    first, last = held(grasp, load, "effort"), held(grasp, load, "force")
    assume(first is not None)
    assert last is not None
    for part in np.linspace(0, 1, 21):
        between = rg.GraspState(grasp, load, (1 - part) * first.forces + part * last.forces)
        scale = max(between.magnitudes.max(), 1)
        assert between.residual <= 1e-12 * scale
        assert (
            between.margins.force.min()
            >= min(first.margins.force.min(), last.margins.force.min()) - 1e-9 * scale
        )
        assert between.magnitudes.max() <= max(first.magnitudes.max(), last.magnitudes.max()) * (1 + 1e-12)
        assert between.margins.least_angle >= min(first.margins.least_angle, last.margins.least_angle) - 1e-9


@given(SEEDS, POWERS, POWERS)
@settings(max_examples=40)
def test_units_frames_and_order_change_nothing(seed, length, force):
    grasp, load, rng = drawn(seed)
    matrix, order = random_rotation(rng), rng.permutation(len(grasp)).tolist()
    seen = rotated(grasp, matrix, length).subset(order)
    turned = rg.Wrench(force * (matrix @ load.force), force * length * (matrix @ load.torque))
    for objective in ("effort", "peak"):
        one, other = held(grasp, load, objective), held(seen, turned, objective)
        assert (one is None) == (other is None)
        if one is not None:
            unit = force**2 if objective == "effort" else force
            assert abs(other.value - unit * one.value) <= 1e-6 * unit * one.value
            if objective == "effort":
                expected = force * one.forces[order] @ matrix.T
                assert abs(other.forces - expected).max() <= 1e-5 * force * one.magnitudes.max()


@given(SEEDS)
@settings(max_examples=40)
def test_a_held_load_has_no_escape_and_a_lost_one_has(seed):
    grasp, load, rng = drawn(seed)
    try:
        state = rg.choose_state(grasp, load, "effort")
    except rg.Infeasible as reason:
        twist = reason.certificate
        assume(twist is not None)
        assert twist.is_proof
        for _ in range(50):  # no force inside the cones does enough work against the motion
            pushes = rng.normal(size=(len(grasp), 3)) + 2 * grasp.normals
            normal = (pushes * grasp.normals).sum(axis=1)
            across = pushes - normal[:, None] * grasp.normals
            use = np.linalg.norm(across, axis=1) / np.maximum(grasp.frictions * normal, 1e-300)
            inside = (normal > 0) & (use <= 1)
            work = (pushes * twist.velocities).sum(axis=1)[inside]
            assert (work >= -1e-8 * abs(pushes).max() * np.linalg.norm(twist.velocities)).all()
        assert twist.load_power > 0
        return
    assert state.residual <= 1e-12 * max(1.0, state.magnitudes.max())
    assert state.margins.force.min() >= -1e-12


@given(SEEDS, st.floats(-pi, pi), st.lists(st.floats(-1, 1), min_size=3, max_size=3))
@settings(max_examples=30)
def test_turns_hold_on_the_way(seed, angle, axis):
    grasp, load, _ = drawn(seed, 5, 0.9)
    assume(abs(angle) > 0.05)
    assume(np.linalg.norm(axis) > 0.1)
    try:
        plan = rg.plan_rotation(grasp, angle, axis=axis, load=load)
    except rg.Infeasible:
        assume(False)
    t = np.linspace(0, 1, 101)
    scale = max(plan.peak, 1.0)
    assert abs(plan.wrenches(t).sum(axis=1) + plan.load(t)).max() <= 1e-11 * scale
    assert plan.margins(t).force.min() >= -1e-9 * scale
    assert rg.verify(plan).ok


@given(SEEDS)
@settings(max_examples=30)
def test_removals_verify_and_run_backwards(seed):
    grasp, load, rng = drawn(seed, 4, 0.8)
    gone = int(rng.integers(4))
    try:
        plan = rg.plan_removal(grasp, gone, load=load)
    except rg.Infeasible:
        assume(False)
    assert rg.verify(plan).ok
    assert rg.verify(plan.reversed()).ok
    t = np.linspace(0, 1, 51)
    assert abs(plan.wrenches(t).sum(axis=1) + load.vector).max() <= 1e-11 * max(
        1.0, abs(plan.forces(t)).max()
    )
    assert not plan.end.forces[gone].any()


@given(SEEDS)
@settings(max_examples=30)
def test_pyramids_are_inside_and_close(seed):
    grasp, load, _ = drawn(seed, 4)
    exact = held(grasp, load, "effort", reserve=0.0)
    values = [held(grasp, load, "effort", facets=m, reserve=0.0) for m in (4, 8, 16, 32)]
    found = [v.value for v in values if v is not None]
    if exact is None:
        assert found == []
        return
    assert all(v >= exact.value * (1 - 1e-7) for v in found)
    assert all(a >= b * (1 - 1e-7) for a, b in pairwise(found))  # vertices among the next
