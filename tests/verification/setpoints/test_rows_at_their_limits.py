"""How far rows may be from a plan: by contact, in torques, pushes, rates and over turns."""

from math import inf

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, course, cross, soft_pair, solid_cross, turn
from setpoint_plans import PLANS, told

pytestmark = pytest.mark.contract


EPS = 2.0**-40


CROSSES = {"plane": cross, "space": solid_cross}


@pytest.fixture(params=PLANS)
def plan(request) -> rg.Transition:
    return PLANS[request.param]


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
