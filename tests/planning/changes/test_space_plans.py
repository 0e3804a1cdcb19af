"""Transitions, paths and turns in space, checked by verify and by arithmetic that shares nothing with it."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.closed_form.turning_path import arc_path, arc_peaks, arc_slope, arc_weights
from regrasp.mechanics.loads.rotated import load_between, turned_load
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.plans.turning import TurningPath
from space import nose_cone, random_grasp, random_load, random_rotation, rotated

pytestmark = pytest.mark.laws

NOSE, DOWN = nose_cone(5, 0.3), rg.Wrench([0, 0, -1.0])
GRIPPY = nose_cone(5, 0.5)
BALL = rg.Grasp(
    rg.Contact(p, [-x for x in p], 0.7)
    for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
)
LOADS = [DOWN, rg.Wrench([0.2, 0, -1], [0.05, 0.02, 0.1])]


def check_sampled(plan, count=2001):
    """Equilibrium, cones and limits at many instants, from contacts, forces, load and time only."""
    t = np.linspace(0, plan.duration, count)
    forces, loads, grasp = plan.forces(t), plan.load(t), plan.grasp
    torques = np.cross(grasp.positions, forces).sum(axis=1)
    scale = max(abs(forces).max(), abs(loads).max())
    assert abs(forces.sum(axis=1) + loads[:, :3]).max() < 1e-12 * scale
    assert abs(torques + loads[:, 3:]).max() < 1e-12 * scale * max(grasp.size, 1)
    normal = np.einsum("mnd,nd->mn", forces, grasp.normals)
    tangential = np.linalg.norm(forces - normal[..., None] * grasp.normals, axis=-1)
    assert (tangential <= grasp.frictions * normal + 1e-12 * scale).all()
    assert (np.linalg.norm(forces, axis=-1) <= grasp.max_forces * (1 + 1e-12)).all()
    steps = np.linalg.norm(np.diff(forces, axis=0), axis=-1)
    assert steps.max() < 0.05 * scale  # nothing jumps
    return t, forces


@pytest.mark.parametrize("finger", range(5))
@pytest.mark.parametrize("objective", ["angle", "effort"])
def test_a_finger_leaves_and_arrives(finger, objective):
    removal = rg.plan_removal(NOSE, finger, load=DOWN, objective=objective)
    check_sampled(removal)
    assert rg.verify(removal).ok
    assert rg.verify(removal.reversed()).ok
    assert not removal.end.forces[finger].any()
    rest = NOSE.without(finger)
    addition = rg.plan_addition(rest, NOSE[finger], load=DOWN, objective=objective)
    check_sampled(addition)
    assert rg.verify(addition).ok
    assert removal.to_dataframe(100).shape == (101, 15)


def test_four_to_three_fingers_over_random_grasps():
    rng = np.random.default_rng(11)
    planned = refused = 0
    for _ in range(60):
        grasp, load = random_grasp(rng, 4, 0.8), random_load(rng)
        try:
            plan = rg.plan_removal(grasp, int(rng.integers(4)), load=load, objective="effort")
        except rg.Infeasible as reason:
            refused += reason.certificate is not None and reason.certificate.is_proof
            continue
        check_sampled(plan)
        assert rg.verify(plan).ok
        planned += 1
    assert planned + refused == 60
    assert min(planned, refused) > 5


def shaken(t):
    return rg.Wrench([0.1 * np.sin(2 * np.pi * t), 0, -1 - 0.1 * np.sin(2 * np.pi * t)], [0, 0.01 * t, 0])


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"rate_limit": 3.0},
        {"path_objective": "force"},
        {"path_objective": "peak", "rate_limit": 3.0},
        {"path_objective": "effort", "rate_limit": 3.0},
        {"min_normal": 0.001},
        {"facets": 8, "method": "piqp", "rate_limit": 3.0},
    ],
)
def test_paths_under_a_load_that_varies(options):
    options = {"objective": "force", "reserve": 0.05, **options}
    plan = rg.plan_removal(GRIPPY, 0, load=shaken, duration=2.0, **options)
    assert plan.record.path == options.get("method", "clarabel")
    assert rg.verify(plan).ok
    if options.get("path_objective") != "effort":  # the least effort leaves fingers idle, without any room
        assert rg.verify(plan, shaken).ok
    check_sampled(plan)
    if "rate_limit" in options:
        assert np.linalg.norm(plan.rates(np.linspace(0, 2, 999)), axis=-1).max() <= 3.0 * (1 + 1e-9)
    if "min_normal" in options:
        normals = (plan.forces(np.linspace(0, 2, 999)) * GRIPPY.normals).sum(axis=-1)
        assert normals[:, 1:].min() >= 0.001


def test_the_least_change_is_the_straight_path():
    straight = rg.plan_removal(NOSE, 0, load=DOWN, objective="force")
    path = rg.plan_removal(NOSE, 0, load=DOWN, objective="force", path_objective="change")
    t = np.linspace(0, 1, 101)
    assert path.forces(t) == pytest.approx(straight.forces(t), abs=1e-4)


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
@pytest.mark.parametrize("angle", [0.4, -0.4, 2.0, -2.0, pi, 4.5, -7.0])
@pytest.mark.parametrize("axis", [[1, 0, 0], [0, 0, 2], [1, 2, -0.5]])
@pytest.mark.parametrize("load", LOADS)
def test_turns_about_any_axis_under_any_load(angle, axis, load):
    plan = rg.plan_rotation(BALL, angle, axis=axis, load=load)
    t, _ = check_sampled(plan)
    unit = np.array(axis) / np.linalg.norm(axis)
    theta = plan.orientation(t)
    assert theta[[0, -1]] == pytest.approx([0, angle])
    for part in (slice(0, 3), slice(3, 6)):  # in the world the load stays
        world = np.einsum("tij,tj->ti", plan.rotations(t), plan.load(t)[:, part])
        assert abs(world - load.vector[part]).max() < 1e-12
    assert plan.rotations(t) @ unit == pytest.approx(np.tile(unit, (t.size, 1)), abs=1e-12)
    sizes = np.linalg.norm(plan.forces(t), axis=-1)
    assert (sizes.max(axis=0) <= plan.peaks * (1 + 1e-12) + 1e-12).all()
    assert sizes.max() == pytest.approx(plan.peak, rel=1e-3)
    assert np.linalg.norm(plan.rates(t), axis=-1).max() <= plan.steepest.max() * (1 + 1e-12)
    back = plan.reversed()
    assert back.forces(0.25) == pytest.approx(plan.forces(0.75), abs=1e-11)
    assert rg.verify(plan).ok
    assert rg.verify(back).ok


def test_a_planar_turn_with_a_torque():
    grasp = rg.Grasp(
        [
            rg.Contact([-1, 0], [1, 0], 0.8),
            rg.Contact([1, 0.1], [-1, 0], 0.8),
            rg.Contact([0, 1], [0, -1], 0.5),
        ]
    )
    plan = rg.plan_rotation(grasp, 2.5, load=rg.Wrench([0, -1], 0.2))
    t = np.linspace(0, 1, 501)
    assert abs(plan.wrenches(t).sum(axis=1) + plan.load(t)).max() < 1e-12
    assert plan.margins(t).least_angle > 0
    assert plan.turn.middles is not None
    assert rg.verify(plan).ok


@pytest.mark.parametrize("load", LOADS)
def test_a_path_program_holds_what_a_turn_holds(load):
    turn = rg.plan_rotation(BALL, 0.9, axis=[1, 2, -0.5], load=load, max_force=8.0)

    def turning(t):
        return rg.Wrench.from_vector(turn.load(t))

    whole = BALL.with_contact(rg.Contact([0, -0.2, -1], [0, 0.2, 1], 0.7))
    start = rg.GraspState(whole, load, [*turn.start.forces, [0, 0, 0]])
    path = rg.plan_removal(start, 4, load=rg.LoadSeries.sampled(turning, 1.0), end=None)
    check_sampled(path)
    t = np.linspace(0, 1, 101)
    assert path.load(t) == pytest.approx(turn.load(t), abs=1e-12)


@given(
    st.lists(st.floats(-1, 1), min_size=9, max_size=9).map(lambda x: np.reshape(x, (3, 3))),
    st.floats(0.01, 3.0) | st.floats(-3.0, -0.01),
)
@settings(max_examples=200)
def test_arcs(forces, delta):
    theta = np.linspace(0, delta, 4001)
    a, c, b = arc_weights(delta, theta)
    assert min(a.min(), b.min(), c.min()) >= -1e-12
    assert abs(a + b + c - 1).max() <= 1e-9
    start, middle, end = forces
    path = arc_path(start[None], middle[None], end[None], delta, theta)[:, 0]
    slope = arc_slope(start[None], middle[None], end[None], delta, theta)[:, 0]
    peak, steepest = arc_peaks(start, middle, end, delta)
    size = abs(forces).max() + 1e-300
    sampled = size * np.linalg.norm(path / size, axis=1).max()  # squares of tiny forces vanish
    assert sampled - 1e-9 * size <= peak <= sampled + 1e-4 * size
    fastest = size * np.linalg.norm(slope / size, axis=1).max()
    assert fastest * (1 - 1e-9) - 1e-9 * size <= steepest <= fastest * (1 + 1e-4) + 1e-9 * size
    inner = slice(1, -1)
    measured = np.gradient(path, theta, axis=0)[inner]
    allowed = np.maximum(1e-3 * size / min(abs(delta), 1) ** 2, 1e-6 * abs(slope[inner]))
    assert (abs(measured - slope[inner]) <= allowed).all()


@given(st.floats(-3, 3), st.floats(0.01, 3.0), st.lists(st.floats(-1, 1), min_size=9, max_size=9))
@settings(max_examples=100)
def test_the_arc_of_a_load(first, step, numbers):
    axis, force, torque = np.reshape(numbers, (3, 3))
    if np.linalg.norm(axis) < 0.1:
        axis = np.array([0, 0, 1.0])
    axis = axis / np.linalg.norm(axis)
    load = rg.Wrench(force, torque)
    a, c, b = arc_weights(step, np.array([0.3 * step]))
    ends = [turned_load(load, first, axis), turned_load(load, first + step, axis)]
    there = a * ends[0].vector + c * load_between(load, first, first + step, axis).vector + b * ends[1].vector
    expected = turned_load(load, first + 0.3 * step, axis).vector
    assert there == pytest.approx(expected, abs=1e-9)


def test_the_verifier_finds_wrong_turns_in_space():
    plan = rg.plan_rotation(BALL, 1.5, axis=[0, 1, 1], load=DOWN)
    turn = plan.turn

    def verdict(**changes):
        fields = {"angles": turn.angles, "forces": turn.forces, "axis": turn.axis, "middles": turn.middles}
        return "; ".join(rg.verify(replace(plan, path=TurningPath(**{**fields, **changes}))).violations)

    assert verdict() == ""
    assert "between 0 and 0.75 rad: not in equilibrium" in verdict(middles=1.001 * turn.middles)
    assert "not in equilibrium" in verdict(axis=[0, 1, 1.01])
    assert "not in equilibrium" in verdict(angles=1.001 * turn.angles)
    with pytest.raises(rg.InvalidInput, match="does not turn: middles are needed"):
        verdict(middles=None)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "needs the axis"),
        ({"axis": [0, 0, 0]}, "axis must not be zero"),
        ({"axis": [0, 1]}, "axis must have shape"),
        ({"axis": [0, np.nan, 1]}, "axis must be finite"),
    ],
)
def test_bad_axes(options, words):
    with pytest.raises(rg.InvalidInput, match=words):
        rg.plan_rotation(BALL, 1.0, load=DOWN, **options)


def test_a_turn_that_cannot_be_held_says_where():
    flat = rg.Grasp(rg.Contact([np.cos(a), np.sin(a), 0], [0, 0, 1], 0.3) for a in (0.0, 2.1, 4.2))
    with pytest.raises(rg.Infeasible, match="escapes by"):
        rg.plan_rotation(flat, pi / 2, axis=[1, 0, 0], load=DOWN)


@pytest.mark.parametrize(("length", "force"), [(1.0, 1.0), (1e-6, 1e6), (1e6, 1e-6)])
def test_frames_and_units(length, force):
    rng = np.random.default_rng(2)
    matrix = random_rotation(rng)
    grasp = rotated(BALL, matrix, length)
    load = rg.Wrench(force * (matrix @ LOADS[1].force), force * length * (matrix @ LOADS[1].torque))
    axis = np.array([1, 2, -0.5])
    plan = rg.plan_rotation(BALL, 2.0, axis=axis, load=LOADS[1], objective="effort")
    same = rg.plan_rotation(grasp, 2.0, axis=matrix @ axis, load=load, objective="effort")
    assert same.forces(0.4) == pytest.approx(force * plan.forces(0.4) @ matrix.T, rel=1e-5, abs=1e-6 * force)
    assert rg.verify(same).ok
    assert rotation_matrix([0, 0, 1], 0.3)[:2, :2] == pytest.approx(
        np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    )
