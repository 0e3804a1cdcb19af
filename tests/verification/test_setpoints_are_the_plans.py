"""Rows that hold the object without being the plan's, and how far rows may be from it, for every kind."""

from math import inf, nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from foreign import Plan, Record, Scaling, course, cross, soft_pair, solid_cross, turn
from regrasp.verification import verify_setpoints

pytestmark = pytest.mark.contract

EPS = 2.0**-40
CROSSES = {"plane": cross, "space": solid_cross}
PLANE = rg.Grasp(
    rg.Contact(r, n, 0.3, name=name)
    for name, r, n in (("P1", [-4, -4], [1, 1]), ("P2", [4, -5], [-1, 2]), ("P3", [0, 8], [0, -1]))
)
BALL = rg.Grasp(
    rg.Contact(p, [-x for x in p], 0.7)
    for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
)


def swinging(t) -> rg.Wrench:
    wave = np.sin(2 * np.pi * t)
    return rg.Wrench([-1.5 + 0.5 * wave, -3.5 - wave])


def plans() -> dict[str, rg.Transition]:
    load, weight = rg.Wrench([-1.5, -3.5]), rg.Wrench([0, 0, -1.0])
    two = PLANE.without("P3")
    return {
        "removal": rg.plan_removal(PLANE, "P3", load=load),
        "addition": rg.plan_addition(two, PLANE["P3"], load=load, duration=0.3),
        "load in time": rg.plan_removal(PLANE, "P3", load=swinging, instants=11),
        "rates": rg.plan_removal(PLANE, "P3", load=load, rate_limit=10.0, duration=1.0, instants=11),
        "turn": rg.plan_rotation(two, 0.2, load=load),
        "turn back": rg.plan_rotation(two, -0.2, load=load),
        "turn with torque": rg.plan_rotation(two, 0.1, load=rg.Wrench([-1.5, -3.5], 0.5)),
        "space": rg.plan_removal(BALL, "P4", load=weight),
        "turn in space": rg.plan_rotation(BALL, 1.0, axis=[1, 0, 0.5], load=weight),
    }


PLANS = plans()


def told(plan, t, forces, angles=None) -> tuple[str, ...]:
    angles = plan.orientation(t) if angles is None and plan.turn is not None else angles
    return verify_setpoints(plan, forces, t, angles).violations


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


def squeeze(grasp) -> np.ndarray:
    """A change of all forces that balances: it spoils nothing but that the row is the plan's."""
    return grasp.internal_forces[0] / abs(grasp.internal_forces[0]).max()


@pytest.mark.parametrize("sign", [1, -1])
def test_how_far_a_row_may_be_from_the_plan(plan, sign) -> None:
    t = np.linspace(0, plan.duration, 11)
    forces, change = plan.forces(t), squeeze(plan.grasp)
    growth = 1.0 if plan.turn is None else 1 + abs(plan.turn.angle)
    for finger in range(len(plan.grasp)):
        size = abs(forces[:, finger]).max()
        if size == 0:
            continue
        ratio = EPS * size / abs(change[finger]).max()
        for k in (3, 7):
            row = forces.copy()
            row[k, finger] += sign * 0.4 * ratio * change[finger]
            assert not any("not the plan's" in v for v in told(plan, t, row))
            row = forces.copy()
            row[k] += sign * 8 * growth * ratio * change
            (found,) = told(plan, t, row)
            assert found.startswith(f"set-point {k}: ")


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


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
def test_each_contact_is_compared_by_its_own_size(make) -> None:
    """Small fingers beside large ones, in a cross of their own: a part in 1e9 of a small force is seen."""
    strong, first = make((0.75,) * 4)
    weak, second = make((0.75,) * 4, length=3.0, force=2.0**-300)
    grasp = rg.Grasp([*strong, *(c.named(c.name.lower()) for c in weak)])
    forces = np.concatenate([first, second])
    state = rg.GraspState(grasp, rg.Wrench([0.0] * grasp.dimension), forces)
    plan, t = Plan("rotation", None, state, state), np.linspace(0, 1, 5)
    rows = np.array([forces] * 5)
    assert told(plan, t, rows) == ()
    rows[2, 4:] *= 1 + 1e-9
    (found,) = told(plan, t, rows)
    assert found.startswith("set-point 2: force of a is not the plan's at t = 0.5 s")


def test_torques_of_soft_fingers_are_compared_as_torques() -> None:
    grasp, load, forces = soft_pair(friction=2.0, torsion=2.0)
    state = rg.GraspState(grasp, load, forces)
    plan, t = Plan("rotation", None, state, state), np.linspace(0, 1, 3)
    for off, good in (0.9 * EPS, True), (1.1 * EPS, False), (0.5, False):
        rows = np.array([forces] * 3)
        rows[1, :, 3] += off  # in balance: the normals are opposite
        found = told(plan, t, rows)
        assert (found == ()) == good
        assert good or "N m" in found[0]


@pytest.mark.parametrize("finger", range(4))
def test_least_normal_forces_in_rows(finger) -> None:
    """Pushes of 1: the record may ask for that much, and the row may round by 2^-40 of the largest force."""
    grasp, forces = cross((0.75,) * 4)
    for least, good in (1.0, True), (1 + 2.5 * EPS, True), (1 + 4 * EPS, False), (1.5, False):
        limits = [0.0] * 4
        limits[finger] = least
        state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
        plan = Plan("rotation", None, state, state, record=Record(least_normals=tuple(limits)))
        found = told(plan, np.linspace(0, 1, 3), np.array([forces] * 3))
        assert (found == ()) == good
        assert good or f"{'ABCD'[finger]} pushes along its normal with less than" in found[0]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("finger", range(4))
def test_rates_between_rows(sign, finger) -> None:
    """All fingers grow or fade by 1 along the normal in a second, in the rows of a plan that says less."""
    grasp, forces = cross((0.75,) * 4)
    sizes = [1.0, 2.0][::sign]
    start, end = (rg.GraspState(grasp, rg.Wrench([0, 0]), size * forces) for size in sizes)
    fast = float(np.linalg.norm(forces[finger]))
    for limit, good in (fast, True), (fast * (1 - 1e-9), False), (inf, True):
        rates = [inf] * 4
        rates[finger] = limit
        path = course([0, 1], [start.forces, end.forces], [[0, 0, 0]] * 2)
        plan = Plan("rotation", None, start, end, record=Record(rate_limits=tuple(rates)), course=path)
        t = np.array([0.0, 0.25, 0.5, 1.0])
        found = told(plan, t, plan.forces(t))
        assert (found == ()) == good
        assert good or found[0].startswith(f"set-point 1: {'ABCD'[finger]} changes faster than {limit:.9g}")
        assert good or len(found) == 3


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


def test_growth_of_rounding_in_turns() -> None:
    """Between angles 3 rad apart weights reach 14: a row may differ by that much more."""
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    for step in (3.0, -3.0):
        plan = Plan("rotation", None, state, state, turn=turn([0, step], [forces] * 2))
        t = np.linspace(0, 1, 5)
        growth = 4 / np.cos(1.5)
        for off, good in (0.9, True), (1.1, False):
            rows = plan.forces(t)
            rows[2] += off * EPS * growth * forces
            assert (told(plan, t, rows, step * t) == ()) == good


def test_a_load_in_time_is_taken_at_the_time_of_each_row() -> None:
    plan = PLANS["load in time"]
    t = np.linspace(0, 1, 41)
    rows = plan.forces(t)
    assert told(plan, t, rows) == ()
    moved = t.copy()
    moved[20] += 1e-9
    assert told(plan, moved, rows)[0].startswith("set-point 20: not in equilibrium")


@pytest.mark.parametrize("bad", [3, 8192, 9998])
def test_rows_are_named_by_their_number(bad) -> None:
    """In the first block of rows and in the next: what is not the plan's, pushes little, moves fast."""
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    t = np.linspace(0, 1, 9999)
    rows = np.broadcast_to(forces, (t.size, 4, 2)).copy()
    rows[bad] *= 1 - 1e-9

    class As(Plan):
        """A plan that answers as the rows are, so that nothing but its record is broken."""

        def forces(self, t):
            return np.interp(t, times, 1 - 1e-9 * (np.arange(times.size) == bad))[:, None, None] * forces

    times = t
    plain = Plan("rotation", None, state, state)
    (found,) = told(plain, t, rows)
    assert found.startswith(f"set-point {bad}: force of A is not the plan's")
    path = course(t, rows, [[0, 0, 0]] * t.size)
    end = rg.GraspState(grasp, state.load, rows[-1])
    least = As(
        "rotation", None, state, end, course=path, record=Record(least_normals=(0.0, 1 - 1e-10, 0.0, 0.0))
    )
    (found,) = told(least, t, rows)
    assert found.startswith(f"set-point {bad}: B pushes along its normal")
    fast = As("rotation", None, state, end, course=path, record=Record(rate_limits=(inf, inf, 1e-6, inf)))
    numbers = [bad, bad + 1] if bad + 1 < t.size else [bad]
    assert [v.split(":")[0] for v in told(fast, t, rows)] == [f"set-point {k}" for k in numbers]
    assert all("C changes faster than 1e-06" in v for v in told(fast, t, rows))


def test_torques_of_soft_fingers_are_no_size_of_forces() -> None:
    """Torques of 2^30 beside pushes of 1: least normal forces and rates are judged by the pushes."""
    grasp = rg.Grasp(
        rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=2.0**32, name=name)
        for x, name in ((-1, "A"), (1, "B"))
    )
    first, last = (
        np.array([[1, 0, 0, 0.0], [-1, 0, 0, 0.0]]),
        np.array([[1.5, 0, 0, 2.0**30], [-1.5, 0, 0, 2.0**30]]),
    )
    start, end = (rg.GraspState(grasp, rg.Wrench([0, 0, 0]), f) for f in (first, last))
    path, t = course([0, 1], [first, last], [[0.0] * 6] * 2), np.linspace(0, 1, 5)
    for record, good in (
        (Record(), True),
        (Record(least_normals=(1.0, 1.0)), True),
        (Record(least_normals=(1.001, 1.0)), False),
        (Record(rate_limits=(0.5, 0.5)), True),
        (Record(rate_limits=(0.5, 0.499)), False),
    ):
        plan = Plan("rotation", None, start, end, record=record, course=path)
        assert (told(plan, t, plan.forces(t)) == ()) == good
        assert rg.verify(plan).ok == good


def test_growth_of_rounding_over_many_turns() -> None:
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    angles = np.linspace(0, 100.0, 101)

    class Still(Plan):
        def forces(self, t):
            return np.broadcast_to(forces, (*np.shape(t), 4, 2))

    plan = Still("rotation", None, state, state, turn=turn(angles, [forces] * 101))
    t = np.linspace(0, 1, 101)
    rows = np.broadcast_to(forces, (101, 4, 2))
    for off, good in (50.0, True), (150.0, False):
        assert (told(plan, t, rows * (1 + off * EPS), 100 * t) == ()) == good
