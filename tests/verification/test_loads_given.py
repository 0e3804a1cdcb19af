"""A load given as a function: how far it may be from the plan's between instants, to the last bit."""

from math import inf, nan, sqrt

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, course, cross, solid_cross, turn

pytestmark = pytest.mark.contract

CROSSES = {"plane": cross, "space": solid_cross}


def steady(
    make=cross, frictions=(0.75,) * 4, limits=(None,) * 4, least=(), kind=("rotation", None), **units
) -> Plan:
    """The same state throughout, from 0 to 1 s."""
    grasp, forces = make(frictions, limits, **units)
    if kind[1] is not None:
        forces[:, 1:] = 0
        forces[[1, 3]] = 0
    state = rg.GraspState(grasp, rg.Wrench([0.0] * grasp.dimension), forces)
    return Plan(*kind, state, state, record=Record(least_normals=least))


def still(plan):
    return lambda t: plan.start.load


def least_singular(grasp, arm=None) -> float:
    """Of the grasp matrix, written out: columns of unit forces, torques over the largest arm."""
    d, columns = grasp.dimension, []
    arm = max(np.linalg.norm(c.position) for c in grasp) if arm is None else arm
    for c in grasp:
        for axis in np.eye(d):
            r = c.position / arm
            torque = [r[0] * axis[1] - r[1] * axis[0]] if d == 2 else np.cross(r, axis)
            columns.append([*axis, *torque])
    return float(np.linalg.svd(np.array(columns).T, compute_uv=False)[-1])


def test_a_bound_on_the_curvature_at_the_room_of_the_margins() -> None:
    """The gap is c / 8 over 1 s, forces change by sqrt(2) times it over the least singular value."""
    for make in CROSSES.values():
        plan = steady(make)
        f, grasp = plan.start.forces[0], plan.start.grasp
        push, across = abs(f[0]), float(np.linalg.norm(f[1:]))
        room = (0.75 * push - across) / sqrt(1 + 0.75**2)
        at = 8 * room * least_singular(grasp) / sqrt(2)
        for times, good in (1 - 1e-12, True), (1 + 1e-12, False):
            verdict = rg.verify(plan, still(plan), curvature=at * times)
            assert verdict.ok == good
            assert verdict.load_gap == pytest.approx(at / 8)
            assert verdict.load_gap_is_proven
            assert good or "more than the margins take" in verdict.violations[0]


@pytest.mark.parametrize("finger", range(4))
def test_room_under_limits_and_above_least_normals(finger) -> None:
    """Fingers push with 1 and across with 1/2: a limit 0.01 above, or a least normal force of 0.99."""
    size = sqrt(1.25)
    for changes, room in (
        ({"limits": size + 0.01}, 0.01), ({"least": 0.99}, 0.01),
    ):  # fmt: skip
        values = {"limits": [None] * 4, "least": [0.0] * 4}
        for name, value in changes.items():
            values[name][finger] = value
        plan = steady(limits=tuple(values["limits"]), least=tuple(values["least"]))
        at = 8 * room * least_singular(plan.start.grasp) / sqrt(2)
        for times, good in (1 - 1e-9, True), (1 + 1e-9, False):
            assert rg.verify(plan, still(plan), curvature=at * times).ok == good


@pytest.mark.parametrize("kind", [("removal", "B", None), ("exchange", "B", "D"), ("addition", "D", None)])
def test_fingers_that_leave_or_arrive_take_no_part(kind) -> None:
    """B and D carry nothing: of the others alone the room and the singular value are taken."""
    *kind, arrival = kind
    plan = steady(kind=tuple(kind))
    plan = Plan(*kind, plan.start, plan.end, arrival=arrival)
    assert rg.verify(plan).ok
    others = [i for i, name in enumerate("ABCD") if name not in (kind[1], arrival)]
    grasp = rg.Grasp([plan.start.grasp[i] for i in others])
    idle = [i for i in (1, 3) if i in others]
    room = 0.0 if idle else 0.75 / sqrt(1 + 0.75**2)
    if room == 0:  # a finger that stays, but carries nothing, has no room
        assert not rg.verify(plan, still(plan), curvature=1e-6).ok
        return
    at = 8 * room * least_singular(grasp, plan.start.grasp.size) / sqrt(2)
    assert rg.verify(plan, still(plan), curvature=at * (1 - 1e-9)).ok
    assert not rg.verify(plan, still(plan), curvature=at * (1 + 1e-9)).ok


def test_one_finger_takes_no_other_load() -> None:
    """A ball on the floor: no other finger could help."""
    grasp = rg.Grasp([rg.Contact([0, -1], [0, 1], 0.5)])
    state = rg.GraspState(grasp, rg.Wrench([0, -1.0]), [[0, 1.0]])
    plan = Plan("rotation", None, state, state)
    assert rg.verify(plan, still(plan), curvature=0.0).ok
    assert not rg.verify(plan, still(plan), curvature=1e-6).ok


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("held", "most"), [(2.0**-20, 2.0**-40), (2.0**-34, 2.0**-44)])
def test_the_load_at_instants_is_the_plans(axis, sign, held, most) -> None:
    """To 2^-40 of the forces, of 1, and to 2^-10 of the load."""
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, -held]), forces + np.array([0, held / 4]))
    plan = Plan("rotation", None, state, state)
    size = sqrt(2) if axis == 2 else 1.0  # torque over the arm
    for at in (0.0, 1.0):
        for off, good in (0.9 * most, True), (1.1 * most, False):

            def load(t, at=at, off=off):
                vector = np.array([0, -held, 0])
                vector[axis] += sign * off * size * (t == at)
                return rg.Wrench.from_vector(vector)

            found = rg.verify(plan, load)
            assert found.ok == good
            assert good or f"at t = {at:g} s the load given differs from the plan's by" in found.violations[0]


def test_a_small_load_given_is_not_that_of_a_plan_without_load() -> None:
    assert not rg.verify(steady(), lambda t: rg.Wrench([0, 1e-13])).ok
    assert rg.verify(steady(), lambda t: rg.Wrench([0, 0])).ok


def test_gaps_are_measured_between_all_instants() -> None:
    """A bump in one stretch of three, as high as the margins take or a little higher."""
    plan = steady()
    times = np.linspace(0, 1, 4)
    path = course(times, [plan.start.forces] * 4, [[0, 0, 0]] * 4)
    plan = Plan("rotation", None, plan.start, plan.end, course=path)
    room = (0.75 - 0.5) / sqrt(1 + 0.75**2)
    most = room * least_singular(plan.start.grasp) / sqrt(2)
    for stretch in range(3):
        for height, good in (0.9 * most, True), (1.3 * most, False):

            def load(t, stretch=stretch, height=height):
                u = np.clip(3 * t - stretch, 0, 1)
                return rg.Wrench([0, 4 * height * u * (1 - u)])

            verdict = rg.verify(plan, load)
            assert verdict.ok == good
            assert verdict.load_gap == pytest.approx(height, rel=0.05)
            assert not verdict.load_gap_is_proven
            bent = rg.verify(plan, load, curvature=72 * height)
            assert bent.load_gap == pytest.approx(height)
            assert bent.load_gap_is_proven
            assert (
                "bends more than the curvature" in rg.verify(plan, load, curvature=60 * height).violations[0]
            )


def test_loads_are_compared_at_the_size_of_the_largest() -> None:
    """Four fingers carry 1/4 of the load each, which grows from 1 to 4: that is more than any force."""
    grasp = rg.Grasp(rg.Contact([x, -1.0], [0, 1], 0.5) for x in (-1.5, -0.5, 0.5, 1.5))
    sizes = np.array([1.0, 2.5, 4.0])
    states = [rg.GraspState(grasp, rg.Wrench([0, -k]), [[0, k / 4]] * 4) for k in sizes]
    path = course([0, 0.5, 1], [s.forces for s in states], [s.load.vector for s in states])
    plan = Plan("rotation", None, states[0], states[-1], course=path)
    for off, good in (3.9 * 2.0**-40, True), (4.1 * 2.0**-40, False):
        assert rg.verify(plan, lambda t, off=off: rg.Wrench([0, -1.0 - 3 * t + off * (t == 0)])).ok == good


def test_a_curvature_counts_over_the_longest_stretch() -> None:
    plan = steady()
    path = course([0, 0.25, 1], [plan.start.forces] * 3, [[0, 0, 0]] * 3)
    plan = Plan("rotation", None, plan.start, plan.end, course=path)
    assert rg.verify(plan, still(plan), curvature=0.01).load_gap == pytest.approx(0.01 * 0.75**2 / 8)


@pytest.mark.parametrize("force", [2.0**-550, 2.0**-300, 2.0**300, 2.0**500])
@pytest.mark.parametrize("length", [2.0**-300, 1.0, 2.0**300])
def test_gaps_in_any_units(force, length) -> None:
    plan = steady(force=force, length=length)
    room = (0.75 - 0.5) / sqrt(1 + 0.75**2) * force
    at = 8 * room * least_singular(steady().start.grasp) / sqrt(2)
    for times, good in (0.999, True), (1.001, False):
        assert rg.verify(plan, still(plan), curvature=at * times).ok == good
    assert not rg.verify(plan, lambda t: rg.Wrench([0, 2.0**-38 * force])).ok
    assert not rg.verify(plan, lambda t: rg.Wrench([0, 0], 2.0**-38 * force * length)).ok


def test_no_margin_of_a_huge_friction_is_taken_for_room() -> None:
    plan = steady(frictions=(1e200,) * 4)
    assert not rg.verify(plan, still(plan), curvature=1e3).ok
    assert rg.verify(plan, still(plan), curvature=1e-3).ok


def test_what_is_no_load_and_no_curvature() -> None:
    plan = steady()
    for load in (3, rg.Wrench([0, 0])):
        with pytest.raises(rg.InvalidInput, match="load must be the function of time"):
            rg.verify(plan, load)
    for returned in (None, [0, 0, 0], rg.Wrench([0, 0, 0])):
        with pytest.raises(rg.InvalidInput, match="load must return a Wrench of the plan's dimension"):
            rg.verify(plan, lambda t, returned=returned: returned)
    with pytest.raises(rg.InvalidInput, match="curvature bounds a load function"):
        rg.verify(plan, curvature=1.0)
    for curvature in (-1e-9, nan, inf, "1"):
        with pytest.raises(rg.InvalidInput, match="curvature must be"):
            rg.verify(plan, still(plan), curvature=curvature)
    turned = Plan("rotation", None, plan.start, plan.end, turn=turn([0, 1.0], [plan.start.forces] * 2))
    with pytest.raises(rg.InvalidInput, match="a turning path holds the load that turns with it"):
        rg.verify(turned, still(plan))


def test_a_torque_between_instants_counts_over_the_largest_arm() -> None:
    """Arms of 1, 2 and 0; the measured instant nearest to the middle is 0.4721 s."""
    grasp = rg.Grasp(rg.Contact([x, 0], [-x or 1, 0], 0.5) for x in (-1.0, 2.0, 0.0))
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), [[1, 0], [-1, 0], [0, 0]])
    plan = Plan("rotation", None, state, state)
    verdict = rg.verify(plan, lambda t: rg.Wrench([0, 0], 0.1 * t * (1 - t)))
    assert verdict.load_gap == pytest.approx(0.05 * 0.472136 * 0.527864, rel=1e-6)
