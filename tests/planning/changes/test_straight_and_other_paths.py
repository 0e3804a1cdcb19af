"""Paths through instants beside straight ones: where they are needed, and what they refuse."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, STATE
from regrasp.programs import available_backends

pytestmark = pytest.mark.oracle


def swinging(t: float) -> rg.Wrench:
    """A load that turns and pulls, through one period in a second."""
    wave = np.sin(2 * np.pi * t)
    return rg.Wrench([-1.5 + 0.5 * wave, -3.5 - wave], 0.5 * np.sin(4 * np.pi * t))


def test_straight_where_straight_is_enough():
    easy = rg.plan_removal(STATE, "P3", duration=1.0, rate_limit=7.0, min_normal=0.3)
    assert type(easy) is rg.Transition
    assert (easy.record.path, easy.record.least_normals) == ("closed-form", (0.3, 0.3, 0.0))
    quickest = rg.plan_removal(STATE, "P3", rate_limit=7.0)
    assert quickest.record.path == "closed-form"
    assert quickest.steepest.max() == pytest.approx(7.0)
    bent = rg.plan_removal(STATE, "P3", duration=1.0, rate_limit=5.0)
    assert type(bent.path) is rg.SampledPath
    assert bent.record.path == "clarabel"
    assert bent.steepest.max() <= 5.0 < rg.plan_removal(STATE, "P3").steepest.max()
    assert "path of 101 instants for change by clarabel" in str(bent)


def tampered(plan, change):
    forces = plan.course.forces.copy()
    change(forces)
    return replace(plan, path=replace_course(plan.course, forces=forces))


def replace_course(course, **changes):
    given = {"times": course.times, "forces": course.forces, "loads": course.loads} | changes
    return type(course)(**given)


def test_the_verifier_finds_what_is_wrong_at_one_instant():
    plan = rg.plan_removal(STATE, "P3", duration=1.0, rate_limit=5.0, min_normal=0.9, instants=21)
    assert rg.verify(plan).ok
    squeeze = plan.grasp.internal_forces[0]

    def moved(k, by):
        def change(forces):
            forces[k] += by * squeeze

        return rg.verify(tampered(plan, change)).violations

    assert any("changes faster than 5" in v for v in moved(10, 0.2))
    assert any("instant 10: force of P1 is outside its friction cone" in v for v in moved(10, 10.0))
    assert any("the path at that instant" in v for v in moved(0, 1e-9))

    def unbalance(forces):
        forces[7, 0] *= 1 + 1e-9

    assert any("instant 7: not in equilibrium" in v for v in rg.verify(tampered(plan, unbalance)).violations)
    hidden = replace(plan, record=replace(plan.record, least_normals=(1.3, 1.3, 0.0)))
    assert any("below 1.3" in v for v in rg.verify(hidden).violations)
    loads = plan.course.loads.copy()
    loads[3] *= 1 + 1e-6
    assert not rg.verify(replace(plan, path=replace_course(plan.course, loads=loads))).ok


def lifting(t: float) -> rg.Wrench:
    """In the middle the object is pulled away from the two fingers that stay."""
    return rg.Wrench([-1.5, -3.5 + 8 * np.sin(np.pi * t)])


FAILURES = {
    "no state at an instant": (
        {"load": lifting, "idle_from": 0.3}, rg.Infeasible,
        r"at t = 0\.\d+ s: no forces of P1, P2 .*: the object escapes by"
    ),
    "rates": (
        {"duration": 1.0, "rate_limit": 2.0}, rg.Infeasible,
        r"would have to change at 2\.\d+ times the rate limits"
    ),
    "effort jumps": (
        {"path_objective": "effort"}, rg.InvalidInput,
        "'effort' would jump at both ends; give rate_limit as well"
    ),
    "weak end": (
        {"min_normal": 1.3, "end": rg.choose_state(GRASP.without("P3"), STATE.load)}, rg.InvalidInput,
        r"end: P2 pushes with a normal force of 1\.\d+, below min_normal 1.3; give another state"
    ),
    "idle after the end": (
        {"idle_from": 1.5}, rg.InvalidInput, r"idle time must lie inside \(0, 1\) s, got 1.5"
    ),
    "closed form cannot": (
        {"path_objective": "change", "method": "closed-form"}, rg.InvalidInput,
        "Eq. 1-3 holds under a constant load, and no straight path keeps these demands"
    ),
    "unknown objective": (
        {"path_objective": "jerk"}, rg.InvalidInput,
        "path_objective must be one of change, effort, force, peak"
    ),
    "instants": ({"instants": 2}, rg.InvalidInput, "instants must be a whole number of at least 3, got 2"),
    "negative rate": ({"rate_limit": -1.0}, rg.InvalidInput, "rate_limit must be greater than 0"),
    "rates of another shape": (
        {"rate_limit": [1.0, 2.0]}, rg.InvalidInput, r"rate_limit must be a number or have shape \(3,\)"
    ),
    "NaN normal": ({"min_normal": np.nan}, rg.InvalidInput, "min_normal must be finite"),
    "load that is no wrench": (
        {"load": lambda t: [0, -1]}, rg.InvalidInput, r"must return a Wrench, at t = 0 it returned \[0, -1\]"
    ),
    "series and duration": (
        {"load": rg.LoadSeries([0, 2], [[-1.5, -3.5, 0]] * 2), "duration": 1.0}, rg.InvalidInput,
        "the load series lasts 2 s, the plan 1 s; make them equal"
    ),
    "second-order cones on a QP solver": (
        {"duration": 1.0, "rate_limit": 5.0, "method": "osqp"}, rg.InvalidInput, "use linearised"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAILURES)
def test_failures_say_what_stands_in_the_way(name):
    options, kind, words = FAILURES[name]
    start = GRASP if callable(options.get("load")) or "load" in options else STATE
    with pytest.raises(kind, match=words) as refused:
        rg.plan_removal(start, "P3", **options)
    if kind is rg.Infeasible and "load" in options:
        assert refused.value.certificate.is_proof


@pytest.mark.parametrize(
    ("times", "vectors", "words"),
    [
        ([0.0], [[0, 0, 0]], "times of a load must rise from 0, two or more"),
        ([0.1, 1.0], [[0, 0, 0]] * 2, "must rise from 0"),
        ([0.0, 0.0], [[0, 0, 0]] * 2, "must rise from 0"),
        ([0.0, np.inf], [[0, 0, 0]] * 2, "must be finite"),
        ([0.0, 1.0], [[0, 0]] * 2, r"3 \(plane\) or 6 \(space\) numbers at each time, got 2"),
        ([0.0, 1.0], [[0, 0, 0]] * 3, "vectors of a load must have shape"),
    ],
)
def test_bad_series(times, vectors, words):
    with pytest.raises(rg.InvalidInput, match=words):
        rg.LoadSeries(times, vectors)


def test_units_and_frames_change_nothing_else():
    plan = rg.plan_removal(STATE, "P3", duration=1.0, rate_limit=5.0, instants=21)
    length, force, turn = 1e3, 1e-4, np.array([[0.6, -0.8], [0.8, 0.6]])
    contacts = [
        rg.Contact(length * turn @ c.position, turn @ c.normal, c.friction, name=c.name) for c in GRASP
    ]
    load = rg.Wrench(force * turn @ STATE.load.force, force * length * STATE.load.torque[0])
    state = rg.GraspState(rg.Grasp(contacts), load, force * STATE.forces @ turn.T)
    there = rg.plan_removal(state, "P3", duration=1.0, rate_limit=5.0 * force, instants=21)
    assert there.course.forces / force == pytest.approx(plan.course.forces @ turn.T, abs=1e-4)
    assert rg.verify(there).ok
    assert inf not in there.record.rate_limits


@pytest.mark.parametrize("backend", sorted({"highs", "scs", "clarabel"} & set(available_backends())))
def test_a_solver_that_fails_proves_nothing(backend):
    """The path exists: whatever a back end makes of it, it is not called impossible."""
    options = {"duration": 1.0, "rate_limit": 5.2, "facets": 16, "instants": 61}
    try:
        plan = rg.plan_removal(STATE, "P3", method=backend, **options)
    except rg.SolverFailed:
        return
    assert plan.steepest.max() <= 5.2


def test_no_period_hides_between_instants():
    def trembling(t: float) -> rg.Wrench:
        return rg.Wrench([-1.5, -3.5 + 2 * np.sin(800 * np.pi * t)])

    plan = rg.plan_removal(GRASP, "P3", load=trembling)
    assert "differs from the plan's by up to" in str(rg.verify(plan, trembling))


def test_a_curvature_is_not_believed_against_what_is_measured():
    plan = rg.plan_removal(GRASP, "P3", load=swinging)
    assert "bends more than the curvature 1 given" in str(rg.verify(plan, swinging, curvature=1.0))
    for options, words in (
        ({"load": swinging, "curvature": np.nan}, "curvature must be finite"),
        ({"load": swinging, "curvature": -1.0}, "curvature must be at least 0"),
        ({"load": swinging, "curvature": "a"}, "curvature must be"),
        ({"curvature": 1.0}, "give load as well"),
        ({"load": 5}, "load must be the function of time"),
        ({"load": lambda t: np.zeros(3)}, "load must return a Wrench"),
        ({"load": lambda t: rg.Wrench([0, 0, 0])}, "of the plan's dimension"),
    ):
        with pytest.raises(rg.InvalidInput, match=words):
            rg.verify(plan, **options)
    with pytest.raises(rg.InvalidInput, match="verify needs a plan"):
        rg.verify(STATE)


def test_many_instants_are_merged_quickly():
    series = rg.LoadSeries(np.linspace(0, 1, 20_001), np.tile([-1.5, -3.5, 0.0], (20_001, 1)))
    assert series.refined(20_001, 0.33333).times.size == 20_002


def test_the_quickest_path_is_straight_at_any_rate():
    planned = rg.plan_removal(STATE, "P3")
    for rate in np.random.default_rng(0).uniform(0.1, 50, 200):
        quickest = rg.plan_removal(planned.start, "P3", end=planned.end, rate_limit=rate)
        assert quickest.record.path == "closed-form"
        assert quickest.steepest.max() == pytest.approx(rate, rel=1e-12)


def test_one_finger_left_cannot_take_up_a_torque():
    """The gap of the load is a torque, and the finger that stays pushes through the centre of mass."""
    grasp = rg.Grasp([rg.Contact([0, -1], [0, 1], 0.5, name="A"), rg.Contact([1, 0], [-1, 0], 0.5, name="B")])
    state = rg.GraspState(grasp, rg.Wrench([0, -1.0]), [[0, 1], [0, 0]])
    plan = rg.plan_removal(state, "B", end=state)

    def twisted(t: float) -> rg.Wrench:
        return rg.Wrench([0, -1], 0.05 * np.sin(np.pi * t))

    assert not rg.verify(plan, twisted, curvature=0.05 * np.pi**2).ok


def test_a_series_of_its_own_is_no_gap_even_without_any_margin():
    grasp = rg.Grasp([*GRASP, rg.Contact([5, 0], [-1, 0], 0.0, name="P4")])
    series = rg.LoadSeries(
        [0.0, 0.3, 0.7, 1.0], [[-1.5, -3.5, 0], [-1, -3.5, 0], [-1.5, -4, 0.5], [-1.5, -3.5, 0]]
    )
    plan = rg.plan_removal(grasp, "P3", load=series, instants=21)
    assert rg.verify(plan, series).ok


def test_a_leaving_finger_without_friction():
    smooth = rg.Grasp([*GRASP.without("P3"), rg.Contact([0, 8], [0, -1], 0.0, name="P3")])
    plan = rg.plan_removal(smooth, "P3", load=swinging, idle_from=0.01, instants=11)
    assert rg.verify(plan).ok
    assert plan.record.path == "clarabel"


def test_the_least_peak_is_the_same_path_in_any_frame():
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    options = {"path_objective": "peak", "rate_limit": 14.0, "duration": 1.0, "instants": 21}
    here = rg.plan_removal(STATE, "P3", **options)
    contacts = [rg.Contact(turn @ c.position, turn @ c.normal, c.friction, name=c.name) for c in GRASP]
    state = rg.GraspState(rg.Grasp(contacts), rg.Wrench(turn @ STATE.load.force), STATE.forces @ turn.T)
    there = rg.plan_removal(state, "P3", **options)
    assert there.course.forces == pytest.approx(here.course.forces @ turn.T, abs=1e-3)
