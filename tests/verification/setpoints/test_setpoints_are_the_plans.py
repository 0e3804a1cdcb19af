"""Rows that hold the object without being the plan's, for every kind of plan."""

from math import inf, nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from foreign import Plan, Scaling
from regrasp.verification import verify_setpoints
from setpoint_plans import PLANS, told

pytestmark = pytest.mark.contract


@pytest.fixture(params=PLANS)
def plan(request) -> rg.Transition:
    return PLANS[request.param]


def test_the_plans_own_rows_verify_at_any_times(plan) -> None:
    for t in (plan.times(50.0), np.array([0.0, plan.duration]), plan.duration * np.array([0.1, 0.35, 0.36])):
        assert told(plan, t, plan.forces(t)) == ()
    t = np.linspace(0, plan.duration, 7)
    angles = None if plan.turn is None else plan.orientation(t)
    assert verify_setpoints(plan, plan.forces(t), angles=angles).ok  # spread evenly


def test_rows_that_stand_still_run_backwards_or_run_late(plan) -> None:
    """All of them hold the object wherever the load is the same."""
    t = np.linspace(0, plan.duration, 41)
    forces = plan.forces(t)
    late = plan.forces(np.clip(t - 0.01 * plan.duration, 0, None))
    frozen = forces.copy()
    frozen[10:21] = forces[10]
    half = forces.copy()
    half[20:] = forces[20]
    for rows in (np.broadcast_to(forces[0], forces.shape), forces[::-1], late, frozen, half):
        found = told(plan, t, np.array(rows))
        assert found
        if plan.turn is None and plan.course is None:
            assert all("is not the plan's at t = " in v or "must carry no force" in v for v in found)


def test_one_row_in_the_place_of_its_neighbour(plan) -> None:
    t = np.linspace(0, plan.duration, 41)
    forces = plan.forces(t)
    for k in (10, 20, 30):
        swapped = forces.copy()
        swapped[[k, k + 1]] = forces[[k + 1, k]]
        found = told(plan, t, swapped)
        rows = {v.split(":")[0] for v in found}
        assert {f"set-point {k}", f"set-point {k + 1}"} <= rows
        assert rows <= {f"set-point {k + i}" for i in range(3)}  # the next one may be reached too fast


def test_idle_fingers_carry_nothing_at_their_ends() -> None:
    for name, where, finger in (("removal", -1, 2), ("addition", 0, 2), ("space", -1, 3)):
        plan = PLANS[name]
        t = np.linspace(0, plan.duration, 11)
        for at in (0, -1):
            row = plan.forces(t)
            row[at, finger] += 1e-18 * plan.grasp[finger].normal if at == where else 0.0
            found = told(plan, t, row)
            words = f"set-point {at % 11}: {plan.grasp.names[finger]} must carry no force there"
            assert found == ((words,) if at == where else ())
        inner = plan.forces(t[1:-1])  # without the ends nothing is asked of them
        assert told(plan, t[1:-1], inner) == ()


def test_exchanges_are_idle_at_both_ends() -> None:
    """A holds with B, which leaves, and then with D."""
    grasp = rg.Grasp(
        rg.Contact([x, y], [-x, 0], 0.75, name=name)
        for name, x, y in (("A", -1, 0), ("B", 1, 0), ("D", 1, 0.5))
    )
    load = rg.Wrench([0, 0])
    start = rg.GraspState(grasp, load, [[1, 0], [-1, 0], [0, 0]])
    end = rg.GraspState(grasp, load, [[1, 0.25], [0, 0], [-1, -0.25]])
    plan, t = Plan("exchange", "B", start, end, arrival="D"), np.linspace(0, 1, 5)
    assert rg.verify(plan).ok
    assert told(plan, t, plan.forces(t)) == ()
    for at, finger in ((0, 2), (-1, 1)):
        rows = plan.forces(t)
        rows[at, finger, 0] = -5e-324
        assert told(plan, t, rows) == (f"set-point {at % 5}: {'ABD'[finger]} must carry no force there",)


def test_a_finger_without_force_throughout_has_none_in_any_row() -> None:
    plan = PLANS["turn in space"]
    t = np.linspace(0, 1, 5)
    rows = plan.forces(t)
    assert not rows[:, 3].any()
    rows[2, 3] = 1e-300 * plan.grasp[3].normal
    assert "force of P4 is not the plan's" in told(plan, t, rows)[0]


def test_a_plan_that_answers_otherwise_than_was_proven(plan) -> None:
    """Rows as its own forces(t) says, which is not the path between its ends, instants or angles."""

    class Liar:
        def __init__(self, by) -> None:
            self.by = by

        def __getattr__(self, name):
            return getattr(plan, name)

        def forces(self, t):
            return self.by(np.asarray(t))

    t = np.linspace(0, plan.duration, 9)
    angles = None if plan.turn is None else plan.orientation(t)
    late = Liar(lambda t: plan.forces(t**2 / plan.duration))
    assert rg.verify(late).ok
    assert verify_setpoints(late, late.forces(t), t, angles).violations
    for k in range(9):
        spoilt = Liar(
            lambda t, k=k: plan.forces(t) * np.where(np.arange(t.size) == k, 1 + 1e-9, 1)[:, None, None]
        )
        assert verify_setpoints(spoilt, spoilt.forces(t), t, angles).violations
        assert verify_setpoints(spoilt, plan.forces(t), t, angles).violations
    assert verify_setpoints(Liar(plan.forces), plan.forces(t), t, angles).ok


@pytest.mark.parametrize(
    "scaling",
    [
        rg.TimeScaling.linear(2.0),
        rg.TimeScaling.minimum_jerk(0.1),
        rg.TimeScaling.spline(1e-3, (1, 0.5, 0)),
        rg.TimeScaling.spline(1e3, (1, 1, 0.9, 0.2, 0.2, 0.1, 0, 0, 0)),
        rg.TimeScaling(1.0, (1, 1, 0.5, 0.5, 0, 0), 2),
        rg.TimeScaling(1.0, (1, 1, 1, 0.7, 0.5, 0.3, 0, 0, 0), 7),
        rg.TimeScaling(1.0, (1, 1, 0.4, 0, 0), 1),
    ],
)
def test_any_time_function_is_retraced(scaling) -> None:
    for name in ("removal", "turn", "turn with torque", "turn in space"):
        plan = PLANS[name].retimed(scaling)
        t = np.linspace(0, plan.duration, 201)
        assert told(plan, t, plan.forces(t)) == ()


CONTROLS = [(1, 0), (1, 0.5, 0), (1, 0.7, 0.1, 0), (1, 1, 0.5, 0, 0), (1, 1, 1, 0.5, 0.2, 0, 0)]


@pytest.mark.parametrize("control", CONTROLS)
def test_a_time_function_without_a_degree_is_cubic(control) -> None:
    """Or of one less than it has control values."""
    spline = rg.TimeScaling.spline(2.0, control)
    plan = PLANS["removal"].retimed(spline)

    class Foreign(Plan):
        def forces(self, t):
            return plan.forces(t)

    bare = Foreign("removal", "P3", plan.start, plan.end, scaling=Scaling(2.0, spline.control))
    t = np.linspace(0, 2, 33)
    assert told(bare, t, plan.forces(t)) == ()


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
def test_turns_in_many_steps_are_retraced() -> None:
    two = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.8, name="A"), rg.Contact([1, 0.1], [-1, 0], 0.8, name="B")])
    for angle, load in (
        (7.0, rg.Wrench([0, -3.0])),
        (-7.0, rg.Wrench([0, -3.0])),
        (-5.0, rg.Wrench([0, -3.0], 0.2)),
    ):
        plan = rg.plan_rotation(two, angle, load=load)
        assert plan.turn.angles.size > 3
        t = np.linspace(0, plan.duration, 101)
        assert told(plan, t, plan.forces(t)) == ()


@given(st.integers(0, 2**32), st.sampled_from(sorted(PLANS)))
@settings(max_examples=60)
def test_any_change_of_any_number_is_seen(seed, name) -> None:
    rng, plan = np.random.default_rng(seed), PLANS[name]
    t = np.linspace(0, plan.duration, 9)
    rows = plan.forces(t)
    row, finger, axis = (rng.integers(size) for size in rows.shape)
    size = abs(rows[:, finger]).max() or 1.0
    rows[row, finger, axis] += rng.choice([-1, 1]) * size * 10.0 ** rng.uniform(-10, 2)
    found = told(plan, t, rows)
    assert found
    assert all(v.startswith((f"set-point {row}: ", f"set-point {row + 1}: ")) for v in found)


def test_rows_and_times_of_no_form() -> None:
    plan = PLANS["removal"]
    t = np.linspace(0, 1, 5)
    rows = plan.forces(t)
    for forces, times, words in [
        (rows[:, :2], t, "set-points must have shape (m, 3, 2), got (5, 2, 2)"),
        (rows[0], t, "set-points must have shape (m, 3, 2)"),
        (rows, t[:4], "must rise within"),
        (rows, t[::-1], "must rise within"),
        (rows, np.array([0, 0.25, 0.25, 0.5, 1]), "must rise within"),
        (rows, t + 1e-15, "must rise within"),
        (rows, t - 1e-15, "must rise within"),
        (rows, np.array([0, 0.25, nan, 0.5, 1]), "must rise within"),
        (np.where(rows == 0, nan, rows), t, "forces of set-points must be finite numbers"),
        (np.where(rows == 0, inf, rows), t, "forces of set-points must be finite numbers"),
    ]:
        (found,) = verify_setpoints(plan, forces, times).violations
        assert words in found
    assert verify_setpoints(plan, rows[:0], t[:0]).ok
    turning = PLANS["turn"]
    t = np.linspace(0, turning.duration, 5)
    rows, angles = turning.forces(t), turning.orientation(t)
    assert verify_setpoints(turning, rows, t).violations == (
        "set-points of an object that turns need its angles",
    )
    for bad in (angles[:4], np.where(angles == 0, nan, angles)):
        assert (
            "angles of set-points must be finite numbers"
            in verify_setpoints(turning, rows, t, bad).violations[0]
        )


@pytest.mark.parametrize("sign", [1, -1])
def test_angles_of_rows_turn_the_load(sign) -> None:
    for name in ("turn", "turn back", "turn with torque", "turn in space"):
        plan = PLANS[name]
        t = np.linspace(0, plan.duration, 5)
        rows, angles = plan.forces(t), plan.orientation(t)
        off = angles.copy()
        off[2] += sign * 1e-9
        found = told(plan, t, rows, off)
        assert found[0].startswith("set-point 2: not in equilibrium")
        assert told(plan, t, rows, angles) == ()
        assert told(plan, t, rows, -angles) != ()


def test_a_load_in_time_is_taken_at_the_time_of_each_row() -> None:
    plan = PLANS["load in time"]
    t = np.linspace(0, 1, 41)
    rows = plan.forces(t)
    assert told(plan, t, rows) == ()
    moved = t.copy()
    moved[20] += 1e-9
    assert told(plan, moved, rows)[0].startswith("set-point 20: not in equilibrium")


def test_angles_are_the_plans_where_the_load_does_not_tell() -> None:
    """About the load's own axis it looks the same at every angle."""
    three = rg.Grasp(
        rg.Contact(p, [-x for x in p], 0.7) for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1])
    )
    load = rg.Wrench([-0.5, 0, 0])
    plan = rg.plan_rotation(three, 0.5, axis=[1, 0, 0], load=load)
    t = np.linspace(0, plan.duration, 5)
    rows, angles = plan.forces(t), plan.orientation(t)
    off = np.where(np.arange(5) == 2, 1.6e-9, 0)
    for good in (angles, angles + off / 2, angles - off / 2):
        assert told(plan, t, rows, good) == ()
    for wrong in (angles + off, angles - off):
        assert told(plan, t, rows, wrong) == (
            f"set-point 2: its angle is not the plan's at t = {t[2]:.9g} s, off by 1.6e-09 rad",
        )
    assert len(told(plan, t, rows, angles + 2 * np.pi)) == 5


def test_lists_are_rows_and_what_are_no_numbers_is_refused() -> None:
    plan = PLANS["turn"]
    t = np.linspace(0, plan.duration, 5)
    rows, angles = plan.forces(t), plan.orientation(t)
    assert verify_setpoints(plan, rows.tolist(), t.tolist(), angles.tolist()).ok
    for wrong in ((None, t, angles), (rows, "x", angles), (rows, t, [None] * 5), (rows * 1j, t, angles)):
        with pytest.raises(rg.InvalidInput, match="of set-points must be numbers"):
            verify_setpoints(plan, *wrong)
    for no_plan in (None, "x", plan.start):
        with pytest.raises(rg.InvalidInput, match="verify_setpoints needs a plan that is one transition"):
            verify_setpoints(no_plan, rows)
