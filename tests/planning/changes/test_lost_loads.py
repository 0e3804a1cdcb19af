"""No plan is handed out whose forces round to more than its load, or change at no finite rate."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.changes.lost_loads import refuse_lost, refuse_lost_load
from regrasp.plans.record import Record
from regrasp.plans.sampled import SampledPath
from regrasp.plans.transition import Transition

pytestmark = [pytest.mark.contract, pytest.mark.filterwarnings("error")]

FLAT = rg.Grasp(
    [
        rg.Contact([-4, -4], normal=[1, 1], friction=0.3),
        rg.Contact([4, -5], normal=[-1, 2], friction=0.3),
        rg.Contact([0, 8], normal=[0, -1], friction=0.3),
    ]
)
SOLID = rg.Grasp(
    [
        rg.Contact([-1, 0, 0.1], normal=[1, 0, 0], friction=0.5),
        rg.Contact([1, 0.5, 0], normal=[-1, 0, 0], friction=0.5),
        rg.Contact([1, -0.5, 0], normal=[-1, 0, 0], friction=0.5),
        rg.Contact([0, 1, 0], normal=[0, -1, 0], friction=0.5),
    ]
)


def planned(verb, grasp, load, **options):
    last = grasp.names[-1]
    if verb == "removal":
        return rg.plan_removal(grasp, last, load=load, **options)
    if verb == "addition":
        return rg.plan_addition(grasp.without(last), grasp[last], load=load, **options)
    if verb == "exchange":
        new = rg.Contact(1.1 * grasp[last].position, grasp[last].normal, grasp[last].friction, name="new")
        return rg.plan_exchange(grasp, last, new, load=load, **options)
    axis = None if grasp.dimension == 2 else [1, 0, 0]
    return rg.plan_rotation(grasp, 0.3, axis=axis, load=load, **options)


def tried(*call, **options):
    """(the plan, nothing), or (None, the words it was refused with)."""
    try:
        return planned(*call, **options), ""
    except rg.InvalidInput as refusal:
        return None, str(refusal)


VERBS = ("removal", "addition", "exchange", "rotation")


@pytest.mark.parametrize("grasp", [FLAT, SOLID], ids=["plane", "space"])
@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("power", [-9, -12, -14, -16, -30, -300])
def test_every_plan_holds_its_load_or_is_refused(grasp, verb, power) -> None:
    weight = np.array([-1.5, -3.5]) if grasp.dimension == 2 else np.array([0, 0.3, -1.0])
    plan, words = tried(verb, grasp, rg.Wrench(weight * 10.0**power), max_force=1.0)
    if plan is None:
        assert power <= -12
        assert "times the load and round to" in words
    else:
        assert power >= -14
        assert rg.verify(plan).ok


@pytest.mark.parametrize("power", [-12, -16])
def test_paths_through_instants_hold_their_load_or_are_refused(power) -> None:
    load = rg.LoadSeries([0, 1], np.array([[-1.5, -3.5, 0], [1.5, -3.5, 0]]) * 10.0**power)
    if power == -12:
        assert rg.verify(rg.plan_removal(FLAT, "P3", load=load, max_force=1.0)).ok
    else:
        with pytest.raises(rg.InvalidInput, match="times the load and round to"):
            rg.plan_removal(FLAT, "P3", load=load, max_force=1.0)


def test_a_still_torque_lost_in_a_turn_is_refused() -> None:
    with pytest.raises(rg.InvalidInput, match="times the load and round to"):
        rg.plan_rotation(FLAT, 0.3, load=rg.Wrench([-1.5e-15, -3.5e-15], 1e-15), max_force=1.0)


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("duration", [5e-324, 1e-320, 1e-309, 1e-307, 1e-306, 1e-300, 1e-30, 1e308])
def test_every_duration_is_kept_or_refused(verb, duration) -> None:
    for force in (1.0, 1e6):
        load = rg.Wrench([-1.5 * force, -3.5 * force])
        plan, words = tried(verb, FLAT, load, duration=duration)
        if plan is None:
            assert duration <= 1e-300
            assert "falls faster than any number" in words or "at a finite rate" in words
        else:
            assert rg.verify(plan).ok


def test_durations_at_their_limit() -> None:
    largest = np.finfo(float).max
    for count, degree in (2, 1), (5, 3):
        control = tuple(np.linspace(1, 0, count))
        least = count**2 / largest
        assert rg.TimeScaling(least * 1.01, control, degree).steepest < np.inf
        with pytest.raises(rg.InvalidInput, match="falls faster than any number"):
            rg.TimeScaling(least * 0.99, control, degree)
    plan = planned("removal", FLAT, rg.Wrench([-150, -350]))
    peak = max(abs(plan.start.forces).max(), abs(plan.end.forces).max())
    for times, good in (1.01, True), (0.99, False):
        scaling = rg.TimeScaling.spline(times * 25 * peak / largest)
        if good:
            assert rg.verify(plan.retimed(scaling)).ok
        else:
            with pytest.raises(rg.InvalidInput, match="cannot change within"):
                plan.retimed(scaling)


def test_a_turn_whose_middle_is_lost_is_refused() -> None:
    """The squeeze between two ends may be larger than at both."""
    rng, refused = np.random.default_rng(6), 0
    for _ in range(30):
        r = rng.normal(size=(3, 3))
        grasp = rg.Grasp(rg.Contact(p, -p + 0.4 * rng.normal(size=3), 0.8) for p in r)
        load = rg.Wrench.from_vector(10.0 ** rng.uniform(-14, -11) * rng.normal(size=6))
        options = {"axis": rng.normal(size=3), "load": load, "objective": "effort", "max_force": 1.0}
        try:
            plan = rg.plan_rotation(grasp, float(rng.uniform(0.5, 2)), **options)
        except (rg.Infeasible, rg.InvalidInput):
            refused += 1
            continue
        assert rg.verify(plan).ok
    assert refused < 30


ROUND = 2.0**-11
"""What is lost at most, of a load of 1 N."""


@pytest.mark.parametrize("size", [2.0**-20, 1.0, 2.0**20])
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("off", "good"), [(ROUND, True), (2 * ROUND, False)])
@pytest.mark.parametrize("kind", ["force", "torque"])
def test_what_is_lost_is_measured_by_the_load(size, way, sign, off, good, kind) -> None:
    """Fingers a size apart from the centre squeeze by 2^40 N, and miss each other by ``off``."""
    grasp = rg.Grasp([rg.Contact([-size, 0], [1, 0], 1.0), rg.Contact([size, 0], [-1, 0], 1.0)])
    forces = np.array([[[2.0**40 + sign * off, 0.0], [-(2.0**40), 0.0]]])
    if kind == "force":  # half of it by each finger, and the larger of two loads
        forces[0, :, 1] = -way / 2
        loads = np.array([[0.0, way, 0.0]])
    else:
        forces[0, :, 1] = way / 2, -way / 2
        loads = np.array([[0.0, 0.0, size * way]])
    state = rg.GraspState(grasp, rg.Wrench.from_vector(loads[0]), forces[0])
    straight = Transition(state, state, rg.TimeScaling.spline(1.0), Record(0.0))
    gentle = rg.GraspState(grasp, rg.Wrench([0, 0]), np.zeros((2, 2)))
    course = SampledPath(
        [0, 0.5, 1], [gentle.forces, forces[0], gentle.forces], [0 * loads[0], loads[0], 0 * loads[0]]
    )
    sampled = Transition(gentle, gentle, rg.TimeScaling.spline(1.0), Record(0.0), path=course)
    for plan in (straight, sampled):
        if good:
            assert refuse_lost_load(plan) is plan
        else:
            with pytest.raises(rg.InvalidInput, match="times the load and round to"):
                refuse_lost_load(plan)


def test_of_what_is_lost_the_largest_counts() -> None:
    """Of components and of instants."""
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 1.0), rg.Contact([1, 0], [-1, 0], 1.0)])
    forces = np.array([[[2.0**40, -0.5], [-(2.0**40), -0.5]]] * 3)
    loads = np.array([[0, 1.0, 0.0]] * 3)
    refuse_lost(grasp, forces, loads)
    for k, component in ((0, 0), (1, 1), (2, 0), (2, 1)):
        spoilt = forces.copy()
        spoilt[k, 0, component] += 2 * ROUND
        with pytest.raises(rg.InvalidInput, match="round to"):
            refuse_lost(grasp, spoilt, loads)


@pytest.mark.parametrize("way", [1, -1])
def test_the_largest_force_is_told_whichever_way_it_pushes(way) -> None:
    """One finger against two."""
    grasp = rg.Grasp(rg.Contact([-x * way, y], [x * way, 0], 1.0) for x, y in ((1, 0), (-1, 0.5), (-1, -0.5)))
    forces = way * 2.0**40 * np.array([[[2.0, 0], [-1, 0], [-1, 0]]])
    with pytest.raises(rg.InvalidInput, match=r"forces up to 2\.2e\+12 N are 2\.2e\+12 times the load"):
        refuse_lost(grasp, forces, np.array([[0, 1.0, 0.0]]))


def test_loads_that_pull_one_way_alone_are_measured_as_well() -> None:
    load = rg.LoadSeries([0, 1], np.array([[-1.5, -3.5, 0], [-1.5, -3.5, -0.1]]))
    assert rg.verify(rg.plan_removal(FLAT, "P3", load=load)).ok
    with pytest.raises(rg.InvalidInput, match="times the load and round to"):
        planned("removal", FLAT, rg.Wrench([-1.5e-16, -3.5e-16]), max_force=1.0)
