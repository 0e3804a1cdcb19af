"""Corners of what is checked of regrasps: no load, first steps that turn, any axis, frictions that differ."""

from dataclasses import replace
from math import atan
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

import regrasp as rg
from foreign import Plan, course, turn

pytestmark = pytest.mark.contract

EPS = 2.0**-40


def pair(d=2, frictions=(0.75, 0.75), force=2.0) -> rg.GraspState:
    grasp = rg.Grasp(
        rg.Contact([x, 0, 0][:d], [-x, 0, 0][:d], mu, name=name)
        for x, name, mu in ((-1, "A", frictions[0]), (1, "C", frictions[1]))
    )
    return rg.GraspState(grasp, rg.Wrench([0.0] * d), [[force, 0, 0][:d], [-force, 0, 0][:d]])


def still(state) -> Plan:
    return Plan("rotation", None, state, state)


def turned(state, angles, axis=None) -> Plan:
    return Plan("rotation", None, state, state, turn=turn(angles, [state.forces] * len(angles), axis))


def whole(*steps, orientations, **more) -> SimpleNamespace:
    return SimpleNamespace(steps=steps, orientations=orientations, margin=0.0, **more)


def said(plan) -> str:
    return "; ".join(rg.verify(plan).violations)


def test_an_object_without_load() -> None:
    state = pair()
    path = course([0, 0.5, 1], [state.forces] * 3, [[0, 0, 0]] * 3)
    steps = (still(state), replace(still(state), course=path))
    assert said(whole(*steps, orientations=(0.0, 0.0, 0.0))) == ""
    assert said(whole(turned(state, [0, 1.0]), still(state), orientations=(0.0, 1.0, 1.0))) == ""


@pytest.mark.parametrize("sign", [1, -1])
def test_orientations_round_by_the_turn(sign) -> None:
    """A turn of 1000 rad in 400 pieces."""
    state, angles = pair(), np.linspace(0, sign * 1000.0, 401)
    step = turned(state, angles)
    for off, good in (900 * EPS, True), (1100 * EPS, False):
        found = said(whole(step, still(state), orientations=(0.0, sign * 1000 + off, sign * 1000 + off)))
        assert (found == "") == good


@pytest.mark.parametrize("first", [0.7, -0.7])
@pytest.mark.parametrize("start", [0.0, 1.5])
def test_a_first_step_that_turns(first, start) -> None:
    """A weight held by the pair, by friction, while it turns, and then in the same place."""
    grasp, load = pair().grasp, rg.Wrench([0.6, -0.8])

    def held(angle) -> rg.GraspState:
        seen = load.rotated(-angle)
        return rg.GraspState(grasp, seen, np.array([[4.0, 0], [-4.0, 0]]) - seen.force / 2)

    begin, end = held(0.0), held(first)
    step = Plan("rotation", None, begin, end, turn=turn([0, first], [begin.forces, end.forces]))
    angles = (start, start + first, start + first)
    assert said(whole(step, still(end), orientations=angles)) == ""
    mirrored = (start, start - first, start - first)
    assert "is not the first one seen from" in said(whole(step, still(end), orientations=mirrored))
    assert "is not the first one seen from" in said(whole(step, still(begin), orientations=angles))


AXES = [
    (1, 0, 0),
    (0, 1, 0),
    (0, 0, 1),
    (1 / 3, 2 / 3, 2 / 3),
    (-2 / 3, 1 / 3, 2 / 3),
    (2 / 3, -2 / 3, 1 / 3),
]


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("angle", [0.8, -2.5])
def test_rotations_about_any_axis(axis, angle) -> None:
    """Against the exponential of a skew matrix; a pair of any direction holds no load."""
    x, y, z = axis
    after = expm(angle * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]))
    before = expm(np.array([[0, -0.3, 0.2], [0.3, 0, -0.5], [-0.2, 0.5, 0]]))
    state = pair(3)
    step = turned(state, [0, angle], axis)
    angles = (0.0, angle, angle)
    good = np.array([before, before @ after, before @ after])
    assert said(whole(step, still(state), orientations=angles, rotations=good)) == ""
    for wrong in (before @ after.T, after @ before, before):
        other = np.array([before, wrong, wrong])
        if abs(wrong - good[1]).max() > 1e-9:
            found = said(whole(step, still(state), orientations=angles, rotations=other))
            assert "step 1: its turn does not lead to the next rotation" in found


def test_rotations_of_exactly_the_tolerance() -> None:
    state = pair(3)
    for off, good in (EPS, True), (EPS * (1 + 2.0**-50), False), (-EPS, True):
        skewed = np.eye(3)
        skewed[0, 1] = off
        plan = whole(still(state), orientations=(0.0, 0.0), rotations=np.array([skewed] * 2))
        assert (said(plan) == "") == good


@pytest.mark.parametrize("entry", range(9))
def test_every_entry_of_a_rotation_counts(entry) -> None:
    """Against the identity, in the last of three matrices: off by 2 tolerances."""
    state = pair(3)
    matrices = np.array([np.eye(3)] * 3)
    matrices[2].flat[entry] += 2 * EPS
    found = said(whole(still(state), still(state), orientations=(0.0,) * 3, rotations=matrices))
    assert "rotation 3 is not orthonormal" in found or "step 2: its turn does not lead" in found


def test_the_widest_claim_is_that_of_the_roughest_contact() -> None:
    """C is smoother than A: what holds between steps has its half angle."""
    state = pair(frictions=(0.75, 0.25))
    plan = whole(still(state), orientations=(0.0, 0.0))
    for margin, good in (atan(0.75), True), (atan(0.75) + 2 * EPS, False):
        plan.margin = margin
        assert (said(plan) == "") == good
    plan = whole(still(state), still(state), orientations=(0.0, 0.0, 0.0))
    for margin, good in (atan(0.25), True), (atan(0.25) + 2 * EPS, False):
        plan.margin = margin
        assert (said(plan) == "") == good
