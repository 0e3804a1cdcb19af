"""Paths through instants: against Eq. 1-3, against cvxpy from the mathematics, against their demands."""

import warnings
from dataclasses import replace
from math import inf

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, STATE
from regrasp.programs import available_backends
from strategies import comfortable_triple

pytestmark = pytest.mark.oracle

# Largest difference from Eq. 1-3, relative to the largest force, at 21 instants.
EXACTNESS = {
    "clarabel": 1e-6,
    "daqp": 1e-9,
    "quadprog": 1e-9,
    "piqp": 1e-5,
    "proxqp": 1e-6,
    "osqp": 1e-5,
    "cvxpy": 1e-6,
}


def swinging(t: float) -> rg.Wrench:
    """A load that turns and pulls, through one period in a second."""
    wave = np.sin(2 * np.pi * t)
    return rg.Wrench([-1.5 + 0.5 * wave, -3.5 - wave], 0.5 * np.sin(4 * np.pi * t))


# |F''| <= 4 pi^2 sqrt(0.5^2 + 1), |tau''| = 16 pi^2 0.5 and the grasp's size is 8 m.
CURVATURE = 4 * np.pi**2 * 1.25**0.5


def held_triples(count: int, seed: int):
    rng = np.random.default_rng(seed)
    while count:
        grasp, load = comfortable_triple(rng)
        try:
            yield rg.plan_removal(grasp, "P3", load=load)
        except rg.Infeasible:
            continue
        count -= 1


@pytest.mark.parametrize("backend", sorted(set(EXACTNESS) & set(available_backends())))
def test_without_demands_the_least_change_is_eq_1_to_3(backend):
    for straight in held_triples(6 if backend == "clarabel" else 3, seed=1):
        path = rg.plan_removal(
            straight.start,
            "P3",
            end=straight.end,
            path_objective="change",
            instants=21,
            method=backend,
        )
        assert (path.record.path, straight.record.path) == (backend, "closed-form")
        t = path.course.times
        largest = abs(straight.forces(t)).max()
        assert abs(path.forces(t) - straight.forces(t)).max() <= EXACTNESS[backend] * largest
        assert rg.verify(path).ok


@pytest.mark.parametrize("scaling", [rg.TimeScaling.minimum_jerk(2.0), rg.TimeScaling.linear(0.5)])
def test_the_least_change_follows_the_time_function(scaling):
    straight = rg.plan_removal(STATE, "P3", scaling=scaling)
    path = rg.plan_removal(STATE, "P3", scaling=scaling, path_objective="change")
    t = np.linspace(0, scaling.duration, 101)
    assert path.forces(t) == pytest.approx(straight.forces(t), abs=1e-5)


def model(plan, objective, rates, least, weights):
    """The best value of a path problem, with cvxpy and without any of our builders."""
    grasp, course = plan.grasp, plan.course
    t, w = course.times, course.loads
    count, n = t.size, len(grasp)
    f = [cp.Variable((count, 2)) for _ in range(n)]
    held = [f[i][k] == plan.course.forces[k, i] for i in range(n) for k in (0, -1)]
    held += [sum(f) + w[:, :2] == 0]
    torque = sum(grasp.positions[i, 0] * f[i][:, 1] - grasp.positions[i, 1] * f[i][:, 0] for i in range(n))
    held += [torque + w[:, 2] == 0]
    edges = []
    for i, contact in enumerate(grasp):
        (nx, ny), mu = contact.normal, contact.friction * (1 - 1e-9)
        normal, across = nx * f[i][:, 0] + ny * f[i][:, 1], -ny * f[i][:, 0] + nx * f[i][:, 1]
        held += [cp.abs(across) <= mu * normal]
        if contact.name != plan.contact:
            edges.append((mu * normal - cp.abs(across)) / np.sqrt(1 + mu**2))
            held += [normal[1:-1] >= least]
        if contact.max_force is not None:
            held += [cp.norm(f[i][1:-1], axis=1) <= contact.max_force]
        held += [cp.norm(cp.diff(f[i], axis=0), axis=1) <= rates * np.diff(t)]
    idle = np.flatnonzero((course.forces[:, grasp.index(plan.contact)] == 0).all(axis=1))
    held += [f[grasp.index(plan.contact)][k] == 0 for k in idle]
    share = np.gradient(t)[1:-1] / (t[-1] - t[0])
    value = {
        "change": lambda: cp.Minimize(
            sum(cp.sum(cp.multiply(1 / weights, cp.sum(cp.square(cp.diff(g, axis=0)), axis=1))) for g in f)
        ),
        "effort": lambda: cp.Minimize(
            sum(cp.sum(cp.multiply(share, cp.sum(cp.square(g[1:-1]), axis=1))) for g in f)
        ),
        "force": lambda: cp.Maximize(cp.min(cp.hstack([cp.min(e) for e in edges]))),
        "peak": lambda: cp.Minimize(cp.max(cp.hstack([cp.norm(g[1:-1], axis=1) for g in f]))),
    }[objective]()
    problem = cp.Problem(value, held)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of an answer cvxpy calls inaccurate
        problem.solve(solver=cp.CLARABEL, tol_gap_abs=1e-10, tol_gap_rel=1e-10, tol_feas=1e-10)
    assert problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)
    return problem.value


def reached(plan, objective, weights):
    course = plan.course
    f, t = course.forces, course.times
    if objective == "change":
        return ((np.diff(f, axis=0) ** 2).sum(axis=(1, 2)) / weights).sum()
    if objective == "effort":
        return ((f[1:-1] ** 2).sum(axis=(1, 2)) * np.gradient(t)[1:-1]).sum() / t[-1]
    if objective == "peak":
        return np.linalg.norm(f[1:-1], axis=-1).max()
    stays = [i for i, name in enumerate(plan.grasp.names) if name != plan.contact]
    return plan.margins(t).force[:, stays].min()


@pytest.mark.parametrize("objective", ["change", "effort", "force", "peak"])
def test_an_independent_model_finds_no_better_path(objective):
    rates, least, limit = 14.0, 0.2, 9.5
    plan = rg.plan_removal(
        GRASP,
        "P3",
        load=swinging,
        path_objective=objective,
        rate_limit=rates,
        min_normal=least,
        max_force=limit,
        idle_from=0.85,
        instants=41,
    )
    assert rg.verify(plan).ok
    weights = -np.diff(plan.scaling(plan.course.times))
    best = model(plan, objective, rates, least, weights / weights.sum())
    assert reached(plan, objective, weights / weights.sum()) == pytest.approx(best, rel=1e-5)
    assert plan.steepest.max() <= rates
    assert plan.forces([0.85, 0.9])[:, 2] == pytest.approx(0, abs=0)
    assert plan.forces(0.84)[2].any()


@pytest.mark.parametrize("backend", sorted({"osqp", "daqp", "piqp", "clarabel"} & set(available_backends())))
def test_polygons_bring_rate_limits_to_qp_solvers(backend):
    options = {"rate_limit": 5.0, "duration": 1.0, "instants": 21, "facets": 16}
    round_ = rg.plan_removal(STATE, "P3", rate_limit=5.0, duration=1.0, instants=21)
    path = rg.plan_removal(STATE, "P3", end=round_.end, method=backend, **options)
    assert rg.verify(path).ok
    assert path.steepest.max() <= 5.0
    assert abs(path.course.forces - round_.course.forces).max() < 0.1


def test_a_path_under_a_load_in_time_holds_at_every_time():
    plan = rg.plan_removal(GRASP, "P3", load=swinging)
    t = np.linspace(0, 1, 2001)
    residual = plan.wrenches(t).sum(axis=1) + plan.load(t)
    assert abs(residual).max() < 1e-12 * 80
    normal = (plan.forces(t) * GRASP.normals).sum(axis=-1)
    tangential = abs((plan.forces(t) * GRASP.tangents).sum(axis=-1))
    assert (tangential <= 0.3 * normal + 1e-12).all()
    assert plan.load(0.25) == pytest.approx(swinging(0.25).vector, abs=1e-12)
    assert plan.start.load == swinging(0.0)
    assert plan.rates(0.5) * 0.01 == pytest.approx(plan.forces(0.51) - plan.forces(0.5), abs=1e-9)
    assert rg.verify(plan).ok


@pytest.mark.parametrize("objective", ["change", "force"])
def test_no_path_jumps(objective):
    """Ten times the instants, a tenth of the largest step."""
    steps = []
    for instants in (41, 401):
        plan = rg.plan_removal(GRASP, "P3", load=swinging, path_objective=objective, instants=instants)
        steps.append(np.linalg.norm(np.diff(plan.course.forces, axis=0), axis=-1).max())
    assert steps[1] < 0.15 * steps[0]


def test_an_arriving_finger_is_a_leaving_one_run_backwards():
    def backwards(t: float) -> rg.Wrench:
        return swinging(1.0 - t)

    rest = GRASP.without("P3")
    added = rg.plan_addition(rest, GRASP["P3"], load=backwards, idle_until=0.25, instants=41)
    removed = rg.plan_removal(added.end, "P3", load=swinging, end=added.start, idle_from=0.75, instants=41)
    again = removed.reversed()
    assert (again.kind, again.contact) == ("addition", "P3")
    assert again.course.times == pytest.approx(added.course.times)
    assert again.course.forces == pytest.approx(added.course.forces, abs=1e-4)
    assert rg.verify(again).ok
    assert rg.verify(added).ok
    assert not added.forces(0.2)[2].any()


def test_a_series_keeps_its_own_times():
    series = rg.LoadSeries([0.0, 0.013, 1.4], [[-1.5, -3.5, 0.0], [-1.4, -3.6, 0.1], [-1.0, -3.0, 0.0]])
    plan = rg.plan_removal(GRASP, "P3", load=series, instants=8)
    assert 0.013 in plan.course.times
    assert plan.duration == 1.4
    assert plan.course.times.size == 9
    assert plan.load([0.0065, 0.7]) == pytest.approx(series.at([0.0065, 0.7]))
    assert rg.verify(plan, series).ok
    assert rg.verify(plan, series, curvature=0.0).load_gap == 0.0


def test_the_gap_between_instants_is_bounded():
    for instants, ok in ((5, False), (11, True), (101, True)):
        plan = rg.plan_removal(GRASP, "P3", load=swinging, instants=instants)
        measured, proven = rg.verify(plan, swinging), rg.verify(plan, swinging, curvature=CURVATURE)
        assert measured.ok == proven.ok == ok
        assert (measured.load_gap_is_proven, proven.load_gap_is_proven) == (False, True)
        assert 0.5 * proven.load_gap < measured.load_gap <= proven.load_gap
        assert ("plan with more instants" in str(measured)) != ok
    assert "which the margins can take" in str(measured)
    other = rg.verify(plan, lambda t: rg.Wrench([0.0, -1.0]))
    assert "the load given differs from the plan's by 3.64" in other.violations[0]


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
