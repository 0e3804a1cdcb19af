"""States that withstand a set of deviations: against programs written again, at both sides of their edge."""

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from regrasp.mechanics.robust.stiffness import checked_stiffness, response
from robust import (
    answers,
    random_stiffness,
    widest_by_cvxpy,
    widest_of_ball_by_cvxpy,
    worst_of_ball,
    worst_slack,
)
from space import random_grasp, random_load
from strategies import comfortable_pair, comfortable_triple
from values import WEIGHT, space_grasp

pytestmark = pytest.mark.oracle

NONE = rg.Wrench([0, 0])
STILL = rg.Wrench([0, 0, 0])


def planar(rng: np.random.Generator) -> tuple[rg.Grasp, rg.Wrench]:
    while True:
        grasp, load = comfortable_pair(rng) if rng.random() < 0.5 else comfortable_triple(rng)
        try:
            rg.choose_state(grasp, load, "force")
        except rg.Infeasible:
            continue
        return grasp, load


def spatial(rng: np.random.Generator) -> tuple[rg.Grasp, rg.Wrench]:
    while True:
        grasp, load = random_grasp(rng, int(rng.integers(3, 5)), 0.7), random_load(rng)
        try:
            rg.choose_state(grasp, load, "force")
        except rg.Infeasible:
            continue
        return grasp, load


def test_forces_answer_as_a_displaced_object_makes_them() -> None:
    rng = np.random.default_rng(0)
    for _ in range(40):
        soft = rng.random() < 0.3
        grasp, _ = planar(rng) if rng.random() < 0.5 and not soft else (random_grasp(rng, 4), None)
        if soft:
            grasp = rg.Grasp(c.changed(torsion=0.1) for c in grasp)
        stiffness = random_stiffness(rng, len(grasp), soft)
        found = response(grasp, checked_stiffness(stiffness))
        np.testing.assert_allclose(found, answers(grasp, stiffness), atol=1e-9 * abs(found).max())
        np.testing.assert_allclose(grasp.matrix @ found, -np.eye(len(grasp.matrix)), atol=1e-9)


def test_stiffness_of_all_kinds_says_the_same() -> None:
    each = np.array([300.0, 500.0, 200.0])
    directed = np.column_stack([each, each])
    matrices = each[:, None, None] * np.eye(2)
    kinds = [checked_stiffness(k) for k in (each, directed, matrices)]
    first, *others = (response(GRASP, k) for k in kinds)
    for other in others:
        np.testing.assert_allclose(other, first, atol=1e-12)
    np.testing.assert_allclose(response(GRASP, 7.0), response(GRASP), atol=1e-12)
    gone = response(GRASP, 1.0, (2,))
    np.testing.assert_allclose(gone[:4], response(GRASP.without("P3")), atol=1e-12)
    assert not gone[4:].any()


@pytest.mark.parametrize("where", ["plane", "space"])
def test_the_widest_factor_of_a_hull_is_that_of_a_program_written_again(where: str) -> None:
    rng = np.random.default_rng(1)
    for _ in range(25 if where == "plane" else 8):
        grasp, load = planar(rng) if where == "plane" else spatial(rng)
        stiffness = random_stiffness(rng, len(grasp))
        deviations = rng.normal(size=(4, load.vector.size)) * np.where(
            np.arange(load.vector.size) < grasp.dimension, 1, 0.2
        )
        limit = 4 * float(rg.choose_state(grasp, load, "peak").value)
        loads = rg.LoadSet.hull(
            [rg.Wrench.from_vector(d) for d in deviations], center=NONE if where == "plane" else STILL
        )
        state = rg.choose_state(
            grasp, load, "wrench", disturbance=loads, stiffness=stiffness, max_force=limit
        )
        expected = widest_by_cvxpy(grasp, load, answers(grasp, stiffness), deviations, limit)
        assert state.value == pytest.approx(expected, rel=1e-5)


def test_round_sets_reach_the_edge_in_the_plane_and_nearly_in_space() -> None:
    rng = np.random.default_rng(2)
    shares, bounds = [], []
    for case in range(16):
        grasp, load = planar(rng) if case % 2 else spatial(rng)
        stiffness = random_stiffness(rng, len(grasp))
        loads = rg.LoadSet.ball(NONE if case % 2 else STILL, force=1.0, torque=0.5)
        state = rg.choose_state(grasp, load, "wrench", disturbance=loads, stiffness=stiffness)
        change, axes = answers(grasp, stiffness), loads.half_axes
        lowest = worst_of_ball(grasp, state.forces, change, 0.999 * state.value * axes)
        assert lowest > 0
        over = worst_of_ball(grasp, state.forces, change, 1.001 * state.value * axes)
        at_limit = max(np.linalg.norm(state.forces, axis=1)) > 0.5 * state.force_limits[0]
        assert over < 0 or at_limit
        widest = widest_of_ball_by_cvxpy(grasp, load, change, axes, state.force_limits[0])
        shares.append(state.value / widest)
        bounds.append((state.value + state.gap) / widest)
    assert max(shares) <= 1 + 1e-6
    assert min(shares[1::2]) > 0.998  # in the plane
    assert min(shares[::2]) > 0.985
    assert min(bounds) > 0.998  # of a program that lies a little above the widest factor itself


@pytest.mark.parametrize(
    "objective", ["angle", "force", "effort", "peak", "friction_use", "sum_normal", "peak_normal"]
)
def test_every_objective_withstands_the_set_it_is_given(objective: str) -> None:
    rng = np.random.default_rng(3)
    for case in range(6):
        grasp, load = planar(rng) if case % 2 else spatial(rng)
        stiffness, center = random_stiffness(rng, len(grasp)), NONE if case % 2 else STILL
        limit = 4 * float(rg.choose_state(grasp, load, "peak").value)
        whole = rg.LoadSet.ball(center, force=1.0, torque=0.5)
        widest = rg.choose_state(
            grasp, load, "wrench", disturbance=whole, stiffness=stiffness, max_force=limit
        )
        loads = whole.scaled(0.9 * widest.value)
        free = rg.choose_state(grasp, load, objective, max_force=limit)
        state = rg.choose_state(
            grasp, load, objective, disturbance=loads, stiffness=stiffness, max_force=limit
        )
        change = answers(grasp, stiffness)
        assert worst_of_ball(grasp, state.forces, change, loads.half_axes) > 0
        better = state.value - free.value if state.criteria.objective.maximise else free.value - state.value
        assert better <= 1e-6 * (1 + abs(free.value))
        members = rng.normal(size=(300, load.vector.size))
        members /= np.linalg.norm(members, axis=1)[:, None]
        limited = rg.Grasp(c.changed(max_force=limit) for c in grasp)
        assert worst_slack(limited, state.forces, change, members @ loads.half_axes.T) > 0


def test_what_cannot_be_withstood_is_refused() -> None:
    loads = rg.LoadSet.ball(NONE, force=1.0, torque=8.0)
    widest = rg.choose_state(GRASP, LOAD, "wrench", disturbance=loads, max_force=12.0)
    just = rg.choose_state(
        GRASP, LOAD, "effort", disturbance=loads.scaled(0.999 * widest.value), max_force=12.0
    )
    assert just.value >= rg.choose_state(GRASP, LOAD, "effort", max_force=12.0).value
    with pytest.raises(rg.Infeasible, match=r"withstand deviations in the ellipsoid .* were found"):
        rg.choose_state(GRASP, LOAD, "effort", disturbance=loads.scaled(1.001 * widest.value), max_force=12.0)


def test_a_tilt_is_withstood_by_its_members() -> None:
    for grasp, load in ((GRASP, LOAD), (space_grasp(), WEIGHT)):
        loads = rg.LoadSet.tilted(load, 0.2).deviations
        state = rg.choose_state(grasp, load, "effort", disturbance=loads)
        rng, change = np.random.default_rng(4), answers(grasp, None)
        members = []
        for _ in range(200):
            v = rng.normal(size=load.vector.size)
            members.append(loads.extreme(v).vector)
        assert worst_slack(grasp, state.forces, change, np.array(members)) > 0
        without = rg.choose_state(grasp, load, "effort")
        assert worst_slack(grasp, without.forces, change, np.array(members)) < 0


def test_the_default_set_is_a_unit_ball_by_the_size_of_the_grasp() -> None:
    unit = rg.LoadSet.ball(NONE, force=1.0, torque=GRASP.size)
    given = rg.choose_state(GRASP, LOAD, "wrench", disturbance=unit, max_force=12.0)
    assert rg.choose_state(GRASP, LOAD, "wrench", max_force=12.0).value == pytest.approx(given.value)
    scale = 1000.0  # millimetres
    grasp = rg.Grasp(rg.Contact(scale * c.position, c.normal, c.friction, name=c.name) for c in GRASP)
    assert rg.choose_state(grasp, LOAD, "wrench", max_force=12.0).value == pytest.approx(
        given.value, rel=1e-6
    )


def test_no_load_at_all_is_squeezed_for_the_widest_factor() -> None:
    state = rg.choose_state(GRASP, NONE, "wrench", max_force=5.0)
    assert state.value > 0
    assert state.criteria.disturbance is None
    with pytest.raises(rg.InvalidInput, match="needs max_force"):
        rg.choose_state(GRASP, NONE, "wrench")


def test_a_frictionless_finger_withstands_only_what_it_answers_along_its_normal() -> None:
    groove = rg.Grasp(
        [
            rg.Contact([-1, 0], [1, 1], 0.0),
            rg.Contact([1, 0], [-1, 1], 0.0),
            rg.Contact([0.3, 2], [0, -1], 0.5),
        ]
    )
    load = rg.Wrench([0, -1])
    loads = rg.LoadSet.hull([rg.Wrench([0, -0.2]), rg.Wrench([0.1, 0])])
    with pytest.raises(rg.Infeasible):
        rg.choose_state(groove, load, "effort", disturbance=loads)
    slippery = [[1000.0, 0.0], [1000.0, 0.0], [1000.0, 500.0]]
    state = rg.choose_state(groove, load, "effort", disturbance=loads, stiffness=slippery)
    assert worst_slack(groove, state.forces, answers(groove, slippery), loads.vertices) > -1e-9


def test_two_fingers_in_space_need_stiffness_about_their_line() -> None:
    pair = space_grasp().subset([0, 1])
    with pytest.raises(rg.InvalidInput, match="does not resist turning about the line through P1 and P2"):
        rg.choose_state(pair, WEIGHT, "wrench")
    soft = rg.Grasp(c.changed(torsion=0.1) for c in pair)
    with pytest.raises(rg.InvalidInput, match="soft fingers need a stiffness about their normals"):
        rg.choose_state(soft, WEIGHT, "wrench")
    state = rg.choose_state(
        soft, WEIGHT, "wrench", stiffness=[[1000, 500, 2], [1000, 500, 2]], max_force=50.0
    )
    assert state.value > 0
