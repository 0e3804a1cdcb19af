"""Arrays of grasps say what one grasp after the other says."""

import os
from math import inf

import numpy as np
import pytest

import regrasp as rg
from regrasp.mechanics.arrays.planar import BLOCK
from regrasp.planning.states.arrays import many_states
from regrasp.threads import threads
from strategies import comfortable_pair, comfortable_triple

pytestmark = pytest.mark.oracle


def grasps(count: int, fingers: int):
    """Grasps, loads and forces that balance them with room."""
    rng, found = np.random.default_rng(fingers), []
    while len(found) < count:
        grasp, load = comfortable_pair(rng) if fingers == 2 else comfortable_triple(rng)
        try:
            state = rg.choose_state(grasp, load, "force")
        except rg.Infeasible:
            continue
        found.append(rg.GraspState(grasp, load, state.forces))
    return found


@pytest.mark.parametrize("fingers", [2, 3])
def test_tolerances_of_arrays_are_those_of_each(fingers: int) -> None:
    states = grasps(40, fingers)
    rng = np.random.default_rng(0)
    stiffness = rng.uniform(100, 2000, (len(states), fingers))
    found = rg.batch_tolerances(
        np.array([s.grasp.positions for s in states]),
        np.array([3 * s.grasp.normals for s in states]),
        np.array([s.grasp.frictions for s in states]),
        np.array([s.forces for s in states]),
        stiffness=stiffness,
    )
    for i, state in enumerate(states):
        alone = rg.tolerances(state, stiffness=stiffness[i]).withstood
        for key in ("friction", "load", "tilt", "centre"):
            value = getattr(alone, key)
            if value < inf:
                assert getattr(found, key)[i] == pytest.approx(value, rel=1e-8, abs=1e-10), key
        np.testing.assert_allclose(found.position[i], alone.position, rtol=1e-7, atol=1e-10)
        kept = rg.least_stiffness(state, stiffness=stiffness[i])
        assert found.stiffness[i] == pytest.approx(kept, rel=1e-9, abs=1e-12)
        wrench = rg.Criteria("wrench", stiffness=stiffness[i]).objective.value(state)
        assert found.wrench[i] * state.grasp.size**0 == pytest.approx(wrench, rel=1e-8)


def test_springs_of_arrays_differ_by_direction_and_idle_fingers_do_not_answer() -> None:
    rng = np.random.default_rng(1)
    states = grasps(12, 3)
    spread = rng.normal(size=(12, 3, 2, 2))
    springs = spread @ spread.transpose(0, 1, 3, 2) + 0.1 * np.eye(2)
    positions, normals, frictions, forces = (
        np.array([getattr(owner, name) for owner in owners])
        for name, owners in (
            ("positions", [s.grasp for s in states]), ("normals", [s.grasp for s in states]),
            ("frictions", [s.grasp for s in states]), ("forces", states),
        )
    )  # fmt: skip
    found = rg.batch_tolerances(positions, normals, frictions, forces, stiffness=springs)
    for i, state in enumerate(states):
        alone = rg.tolerances(state, stiffness=springs[i]).withstood
        assert found.centre[i] == pytest.approx(alone.centre, rel=1e-8)
        if state.grasp.contacts[0].max_force is None and np.isfinite(found.position[i]).all():
            np.testing.assert_allclose(found.position[i], alone.position, rtol=1e-7)
    two = grasps(1, 2)[0]
    idle = rg.Contact([0.1, 5.0], [0, -1], 0.5, name="idle")
    state = rg.GraspState(two.grasp.with_contact(idle), two.load, [*two.forces, [0, 0]])
    g = state.grasp
    both = rg.batch_tolerances(g.positions, g.normals, g.frictions, state.forces)
    alone = rg.tolerances(state).withstood
    assert both.load == pytest.approx(alone.load)
    np.testing.assert_allclose(both.position, alone.position, rtol=1e-7)
    assert both.position[2] == inf
    with pytest.raises(rg.InvalidInput, match="symmetric and positive definite"):
        rg.batch_tolerances(positions, normals, frictions, forces, stiffness=np.ones((12, 3, 2, 2)))


@pytest.mark.parametrize("norm", ["Linf", "L1"])
@pytest.mark.parametrize("fingers", [2, 3, 4])
def test_wrench_balls_of_arrays_are_those_of_each(norm: str, fingers: int) -> None:
    rng = np.random.default_rng(fingers)
    r = rng.normal(size=(30, fingers, 2))
    n = -r + 0.5 * rng.normal(size=r.shape)
    mu = rng.uniform(0, 1, (30, fingers))
    found = rg.wrench_balls(r, n, mu, limit=2.0, norm=norm).tolist()
    closed = 0
    for i, radius in enumerate(found):
        grasp = rg.Grasp(rg.Contact(*c) for c in zip(r[i], n[i], mu[i], strict=True))
        alone = rg.wrench_ball(grasp, limit=2.0, norm=norm).radius
        assert radius == pytest.approx(alone, rel=1e-9, abs=1e-12)
        closed += radius > 0
    assert 0 < closed < 30
    one = rg.wrench_balls(r[0], n[0], mu[0], limit=2.0, norm=norm, length=3.0)
    grasp = rg.Grasp(rg.Contact(*c) for c in zip(r[0], n[0], mu[0], strict=True))
    assert one == pytest.approx(rg.wrench_ball(grasp, limit=2.0, norm=norm, length=3.0).radius, rel=1e-9)


def test_shapes_broadcast_and_degenerate_grasps_have_nothing() -> None:
    r, n = np.array([[-1.0, 0], [1, 0]]), np.array([[1.0, 0], [-1, 0]])
    balls = rg.wrench_balls(r, n, np.array([[0.1], [0.2], [0.5]]))
    assert balls.shape == (3,)
    assert (np.diff(balls) > 0).all()
    assert rg.wrench_balls(r, n, 0.0) == 0
    assert rg.wrench_balls([[0, 0], [0, 0]], n, 0.5) == 0
    still = rg.batch_tolerances(r, n, 0.5, np.zeros((2, 2)))
    assert np.isnan(still.wrench)
    outside = rg.batch_tolerances(r, n, 0.5, [[1, 2], [-1, -2]])
    assert outside.friction > 1
    assert outside.wrench < 0


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: rg.wrench_balls([[0, 0, 0]], [[1, 0, 0]], 1), r"must have shape \(\.\.\., n, 2\)"),
        (lambda: rg.wrench_balls([[0, 0]], [[1, 0]], 1), "2 to 8 fingers, got 1"),
        (lambda: rg.wrench_balls(np.ones((2, 2)), np.zeros((2, 2)), 1), "normals must not be zero"),
        (lambda: rg.wrench_balls(np.ones((2, 2)), np.ones((2, 2)), -1), "at least 0 everywhere"),
        (lambda: rg.wrench_balls(np.ones((4, 2, 2)), np.ones((3, 2, 2)), 1), "must broadcast"),
        (
            lambda: rg.batch_tolerances(np.ones((2, 2)), np.ones((2, 2)), 1, np.ones(3)),
            "forces must have shape",
        ),
    ],
)
def test_wrong_arrays_are_refused(call, said: str) -> None:
    with pytest.raises(rg.InvalidInput, match=said):
        call()


def arrays(count: int, fingers: int, dimension: int):
    """Positions, normals, frictions, forces and torques of random grasps."""
    rng = np.random.default_rng(10 * fingers + dimension)
    if dimension == 2:
        angles = rng.uniform(0, 6, (count, 1)) + 2 * np.pi * np.arange(fingers) / fingers
        angles = angles + rng.uniform(-0.4, 0.4, angles.shape)
        r = np.stack([np.cos(angles), np.sin(angles)], axis=-1) * rng.uniform(0.6, 1.4, (count, fingers, 1))
    else:
        r = rng.normal(size=(count, fingers, 3))
    n = -r + 0.3 * rng.normal(size=r.shape)
    torques = 0.1 * rng.normal(size=(count, 3) if dimension == 3 else count)
    return r, n, rng.uniform(0.4, 1.0, r.shape[:2]), rng.normal(size=(count, dimension)), torques


@pytest.mark.parametrize(("fingers", "dimension"), [(2, 2), (3, 2), (3, 3), (4, 3)])
def test_states_of_arrays_are_those_of_each(fingers: int, dimension: int) -> None:
    given = arrays(12, fingers, dimension)
    for objective, limit in (
        ("force", 4.0),
        ("angle", None),
        ("friction_use", 4.0),
        ("effort", None),
        ("peak", None),
        ("peak_normal", 6.0),
        ("sum_normal", None),
    ):
        found = rg.choose_states(*given, objective=objective, max_force=limit)
        assert (found.held | found.refused).all()
        assert not (found.held & found.refused).any()
        for k, (r, n, mu, f, tau) in enumerate(zip(*given, strict=True)):
            grasp, load = rg.Grasp(rg.Contact(*c) for c in zip(r, n, mu, strict=True)), rg.Wrench(f, tau)
            try:
                state = rg.choose_state(grasp, load, objective, max_force=limit)
            except rg.Infeasible:
                assert found.refused[k]
                proof = rg.EscapeTwist(
                    grasp, load, found.twists[k], tuple(mu.tolist()), (limit or np.inf,) * fingers
                )
                assert (
                    proof.least_force > 0.999e4 * np.abs(load.force).max() / fingers
                    if limit is None
                    else proof.is_proof
                )
                continue
            assert found.held[k]
            assert found.values[k] == pytest.approx(state.value, rel=1e-6, abs=1e-7)
            seen = rg.GraspState(grasp, load, found.forces[k])
            assert seen.is_balanced(reserve=0.0)
            np.testing.assert_allclose(found.margins.force[k], seen.margins.force, atol=1e-12)


def test_states_of_arrays_take_any_leading_shape_and_say_what_they_leave_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    r, n, mu, f, tau = arrays(6, 3, 2)
    flat = rg.choose_states(r, n, mu, f, tau, objective="effort")
    shaped = rg.choose_states(
        r.reshape(2, 3, 3, 2), n.reshape(2, 3, 3, 2), mu.reshape(2, 3, 3), f.reshape(2, 3, 2),
        tau.reshape(2, 3), objective="effort",
    )  # fmt: skip
    assert (shaped.forces.reshape(6, 3, 2) == flat.forces)[flat.held].all()
    assert rg.choose_states(r[:0], n[:0], mu[:0], f[:0], tau[:0]).forces.shape == (0, 3, 2)
    none = rg.choose_states(r, n, mu, np.zeros((6, 2)), objective="peak")
    assert none.held.all()
    assert not none.forces.any()
    with pytest.raises(rg.InvalidInput, match="under a zero load needs max_force"):
        rg.choose_states(r, n, mu, np.zeros((6, 2)), objective="force")
    line = np.array([[[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]]])  # leaves the turn about it free
    torques = [[0, 0, 0], [1.0, 0, 0]]  # nothing resists the second
    asked = rg.choose_states(line, [[[0, 0, 1.0]] * 3], 0.5, [[0, 0, -1.0]], torques, objective="effort")
    assert asked.held.tolist() == [True, False]
    assert asked.refused.tolist() == [False, True]
    monkeypatch.setattr(many_states, "_ASKED", 0)
    asked = rg.choose_states(line, [[[0, 0, 1.0]] * 3], 0.5, [[0, 0, -1.0]], torques, objective="effort")
    assert not (asked.held | asked.refused).any()


def test_blocks_of_threads_are_parts_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many threads as Numba is told to use, for NumPy's arrays, too."""
    rng = np.random.default_rng(4)
    places = rng.normal(size=(BLOCK + 50, 3, 2))
    whole = rg.wrench_balls(places, -places, 0.5)
    np.testing.assert_array_equal(whole[-60:], rg.wrench_balls(places[-60:], -places[-60:], 0.5))
    monkeypatch.setattr("sys.modules", {})
    for given, count in (("3", 3), ("0", None), ("", None)):
        monkeypatch.setenv("NUMBA_NUM_THREADS", given)
        assert threads() == (count or len(os.sched_getaffinity(0)))


def test_states_that_small_programs_left_open_are_found() -> None:
    """Forces of least effort beside more edges than they need: duals are not found to the last digits."""
    rng, m = np.random.default_rng(0), 4000
    angles = rng.uniform(0, 2 * np.pi, (m, 1)) + 2 * np.pi * np.arange(3) / 3 + rng.uniform(-0.3, 0.3, (m, 3))
    arms = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    pushes, loads = -arms + 0.2 * rng.normal(size=arms.shape), rng.normal(size=(m, 2))
    rows = [94, 277, 725, 729, 988, 1087, 2450, 3698, 3873]
    found = rg.choose_states(arms[rows], pushes[rows], 0.6, loads[rows], objective="effort")
    assert found.held.all()
    for k, row in enumerate(rows):
        grasp = rg.Grasp(rg.Contact(r, n, 0.6) for r, n in zip(arms[row], pushes[row], strict=True))
        alone = rg.choose_state(grasp, rg.Wrench(loads[row]), "effort")
        assert found.values[k] == pytest.approx(alone.value, rel=1e-8)
