"""Paths through instants: against Eq. 1-3, against cvxpy from the mathematics, against their demands."""

import warnings

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
