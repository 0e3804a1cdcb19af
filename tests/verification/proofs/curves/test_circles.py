"""Circles under loads of every orientation: known values, and what verify makes of touched proofs."""

import json
from dataclasses import replace
from functools import cache
from math import pi, sqrt

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.placed.cubic import CubicEdges
from regrasp.verification.placed.curves.circles import play_of

pytestmark = pytest.mark.oracle

ROUND = rg.LoadSet.turned(rg.Wrench([0, -1]))
ANGLES = np.linspace(0, pi, 20001)
S, C = np.sin(ANGLES), np.cos(ANGLES)
# two fingers face to face at a friction of 0.5 push with s and s + c, s along and c across their line
WORST = {
    "sum_normal": sqrt(5),
    "peak_normal": sqrt(2),
    "peak": np.hypot(S + C, 0.5 * S).max(),
    "effort": ((S + C) ** 2 + 1.5 * S**2).max(),
}


def spline(count: int) -> rg.Outline:
    turn = 2 * pi * np.arange(count) / count
    return rg.Outline.smooth(np.column_stack([2 + np.cos(turn), np.sin(turn)]))


@cache
def chosen(objective: str, fingers: int = 2, points: int = 0) -> rg.ChosenGrasp:
    shape = spline(points) if points else rg.Outline.ellipse(1, 1, centre=(0.3, -2))
    return rg.choose_grasp(shape, fingers, ROUND, friction=0.5, objective=objective)


@pytest.mark.parametrize(("objective", "points"), [*((word, 0) for word in WORST), ("peak", 100)])
def test_bounds_of_circles_are_of_all_turns(objective: str, points: int) -> None:
    found = chosen(objective, 2, points)
    assert found.certificate.turned
    assert found.certificate.leaves < 1000
    assert found.bound <= WORST[objective] * (1 + 1e-4) <= found.value * (1 + 1e-3)
    assert found.gap <= 1e-3
    assert rg.verify(found).ok
    again = rg.ChosenGrasp.from_dict(json.loads(json.dumps(found.to_dict())))
    assert again == found
    assert rg.verify(again).ok


def test_three_fingers_on_a_circle_are_a_third_of_a_turn_apart() -> None:
    found = chosen("sum_normal", 3)
    assert np.diff(found.places) == pytest.approx([2 * pi / 3] * 2, abs=0.02)
    assert found.gap <= 1e-3
    assert rg.verify(found).ok


@pytest.mark.parametrize(
    ("shape", "load"),
    [
        (rg.Outline.ellipse(1, 1.01), ROUND),
        (
            rg.Outline.ellipse(1, 1),
            rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([0, 1]), rg.Wrench([-1, 0])]),
        ),
        (rg.Outline.ellipse(1, 1), rg.Wrench([1, 0])),
    ],
)
def test_what_turns_change_is_searched_all_around(shape: rg.Outline, load: rg.LoadSet | rg.Wrench) -> None:
    found = rg.choose_grasp(shape, 2, load, friction=0.5, tolerance=0.05)
    assert not found.certificate.turned
    assert rg.verify(found).ok


def test_arcs_are_searched_as_they_are() -> None:
    circle = rg.Outline.ellipse(1, 1)
    found = rg.choose_grasp(circle, 2, ROUND, friction=0.5, tolerance=0.05, arcs=[(0.1, 6.2)])
    assert not found.certificate.turned
    assert rg.verify(found).ok


def words(found: rg.ChosenGrasp, **changes: object) -> str:
    proof = replace(found.certificate, **changes)
    return "; ".join(rg.verify(replace(found, certificate=proof)).violations)


def test_touched_proofs_of_circles_are_refused() -> None:
    found = chosen("peak", 2)
    proof = found.certificate
    assert proof.control is not None
    assert "box 0 must" in words(found, turned=False)
    assert "does not exclude" in words(found, bound=proof.bound * 1.01)
    assert "no circle" in words(found, sides=proof.sides[:-1])
    assert "no circle" in words(found, sides=proof.sides[1:])
    gap = proof.sides.copy()
    gap[3, 2] -= 1e-3
    assert "no circle" in words(found, sides=gap)
    for limits in {"max_force": 9.0}, {"min_normal": 1e-3}:
        assert "turns go with" in words(found, **limits)
    ends = proof.ends.copy()
    ends[0, 0, 1] = 0.5
    assert "box 0 must" in words(found, ends=ends)
    bent = proof.control.copy()
    bent[5, 1] += 2e-3 * (bent[5, 1] - proof.centre_of_mass)
    assert "does not exclude" in words(found, control=bent)  # it is one, but for more
    bent = proof.control.copy()
    bent[5, 0] *= 1 + 1e-12
    assert "no circle" in words(found, control=bent, vertices=bent[:, 0])  # it is not closed
    assert "must begin at its vertices" in words(found, control=bent)
    assert "must begin at its vertices" in words(found, vertices=10 * proof.vertices)
    assert "does not exclude" in words(found, centre_of_mass=proof.centre_of_mass + 0.2)


def test_states_hold_what_turns_make_of_loads() -> None:
    found = chosen("peak", 2)
    said = "a load that a turn makes of one of the proof has no state"
    half = found.states[: len(found.states) // 2]
    assert said in rg.verify(replace(found, states=half)).violations
    less = tuple(
        rg.GraspState(s.grasp, rg.Wrench.from_vector(0.9 * s.load.vector), 0.9 * s.forces)
        for s in found.states
    )
    assert said in rg.verify(replace(found, states=less)).violations
    few = found.certificate.loads[:1]  # whose edge is held, but not its turns
    one = [s for s in found.states if np.abs(s.load.vector - few[0]).max() < 0.05]
    assert said in rg.verify(replace(found, states=tuple(one))).violations


def test_a_turned_finger_is_no_farther_from_a_place_than_is_counted() -> None:
    shape = spline(24)
    proof = chosen("peak", 2, 100).certificate
    cubics = shape.cubics()
    assert cubics is not None
    near = replace(
        proof, control=cubics + proof.centre_of_mass, vertices=cubics[:, 0] + proof.centre_of_mass,
        sides=np.array([[e, e, e + 1] for e in range(24)], dtype=float),
    )  # fmt: skip
    found = play_of(near, CubicEdges(near).control)
    assert found is not None
    play, reach = map(float, found)
    s = shape.sample(5000)
    points, normals = shape.points(s), shape.normals(s)
    away = np.hypot(*points.T)
    tilt = np.abs(points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]) / away
    assert reach == pytest.approx(away.max(), rel=1e-6)
    off = np.ptp(away) / reach + 2 * tilt.max()
    assert 0.4 * play < off <= play
