"""Whole regrasps: held at every instant by a check that knows contacts, forces, load and time only."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from regrasp.closed_form.choice import ANGLE, best_squeeze
from regrasp.outline import parts
from regrasp.planning.holds.pairs import HoldGraph, evenly, named

pytestmark = pytest.mark.laws

WEIGHT = rg.Wrench([0, -3.0])
ELLIPSE = rg.Outline.ellipse(2, 1)


def grasp_on(outline: rg.Outline, places, friction=0.5, prefix="A") -> rg.Grasp:
    return rg.Grasp(
        outline.contact_at(s * outline.length, friction=friction, name=f"{prefix}{i}")
        for i, s in enumerate(places)
    )


START, GOAL = grasp_on(ELLIPSE, (0.02, 0.35, 0.7)), grasp_on(ELLIPSE, (0.2, 0.5, 0.85), prefix="B")


def holds_of(plan):
    """The states between steps in which a finger is free."""
    return [step.end for step in plan.steps[:-1] if len(step.end.in_use) <= 2]


def check_simulated(plan, start, goal, weight, friction):
    """Nothing of the plan is used but who touches where, which force, and the object's angle, over time."""
    assert {tuple(c.position) for c in plan.steps[0].grasp} == {tuple(c.position) for c in start}
    assert {tuple(c.position) for c in plan.steps[-1].grasp} == {tuple(c.position) for c in goal}
    before = None
    elapsed = 0.0
    for step in plan.steps:
        t = np.linspace(0, step.duration, 101)
        forces, turned = step.forces(t), plan.orientation(elapsed + t)
        positions, normals = step.grasp.positions, step.grasp.normals
        assert len(positions) <= 3
        load = np.stack(
            [np.cos(turned) * weight[0] + np.sin(turned) * weight[1],
             np.cos(turned) * weight[1] - np.sin(turned) * weight[0]], axis=-1
        )  # fmt: skip
        assert abs(forces.sum(axis=1) + load).max() < 1e-11
        torque = positions[:, 0] * forces[:, :, 1] - positions[:, 1] * forces[:, :, 0]
        assert abs(torque.sum(axis=1)).max() < 1e-11
        normal = (forces * normals).sum(axis=-1)
        across = abs(normals[:, 0] * forces[..., 1] - normals[:, 1] * forces[..., 0])
        assert (across <= friction * normal + 1e-12).all()
        here = {tuple(p): f for p, f in zip(positions.tolist(), forces.swapaxes(0, 1), strict=True)}
        if before is not None:
            gone, come = before.keys() - here.keys(), here.keys() - before.keys()
            assert len(gone) <= 1 >= len(come)
            assert all(not before[p][-1].any() for p in gone)  # it left without force
            assert all(not here[p][0].any() for p in come)
            for p in before.keys() & here.keys():
                assert before[p][-1] == pytest.approx(here[p][0], abs=1e-12)
        before = here
        elapsed += step.duration
    assert elapsed == pytest.approx(plan.duration)


@pytest.mark.parametrize("orientations", [1, 24])
@pytest.mark.parametrize("goal_orientation", [0.0, np.pi / 2, -2.0])
def test_a_regrasp_holds_throughout(orientations, goal_orientation):
    if orientations == 1 and goal_orientation:
        pytest.skip("one orientation forbids turning")
    plan = rg.plan_regrasp(
        ELLIPSE,
        START,
        GOAL,
        WEIGHT,
        friction=0.5,
        orientations=orientations,
        goal_orientation=goal_orientation,
    )
    check_simulated(plan, START, GOAL, WEIGHT.force, 0.5)
    assert rg.verify(plan).ok
    assert rg.verify(plan.reversed()).ok
    assert plan.orientations[0] == 0
    assert np.cos(plan.orientations[-1] - goal_orientation) > np.cos(np.pi / max(orientations, 2))
    least = min(np.nanmin(state.margins.angle) for state in holds_of(plan))
    assert least == pytest.approx(plan.margin, abs=1e-6)
    if orientations == 1:
        assert set(plan.orientations) == {0.0}


@pytest.mark.parametrize("part", ["wrench", "cam", "bracket", "bottle"])
def test_parts_are_regrasped(part):
    outline = getattr(parts, part)()
    rng = np.random.default_rng(0)
    candidates = outline.sample(60)
    found = 0
    for _ in range(30):
        places = rng.choice(candidates, (2, 3), replace=False) / outline.length
        start, goal = (grasp_on(outline, p, 0.6, x) for p, x in zip(places, "AB", strict=True))
        try:
            plan = rg.plan_regrasp(outline, start, goal, WEIGHT, friction=0.6, orientations=12, candidates=60)
        except rg.Infeasible:
            continue
        found += 1
        check_simulated(plan, start, goal, WEIGHT.force, 0.6)
        assert rg.verify(plan).ok
    assert found >= 2


def test_margins_of_the_graph_are_those_of_chosen_states():
    rng = np.random.default_rng(1)
    contacts = named([ELLIPSE.contact_at(x, friction=0.4) for x in rng.uniform(0, ELLIPSE.length, 12)], "c")
    graph = HoldGraph(tuple(contacts), WEIGHT, evenly(7))
    held = 0
    for i, j in combinations(range(12), 2):
        for o in (0, 3):
            load = WEIGHT.rotated(-float(graph.angles[o]))
            try:
                state = rg.choose_state(rg.Grasp([contacts[i], contacts[j]]), load, reserve=0)
            except rg.Infeasible:
                assert graph.margin(i, j, o) < 0
                continue
            held += 1
            assert graph.margin(j, i, o) == pytest.approx(state.value, abs=1e-6)
            assert graph.row(i, o)[j] == graph.margin(i, j, o)
    assert held > 20


def test_a_filter_and_a_distance_are_kept():
    def right(first, second, angle):
        return first[:, 0] + second[:, 0] > -1.0

    plan = rg.plan_regrasp(
        ELLIPSE, START, GOAL, WEIGHT, friction=0.5, orientations=12, keep=right, min_distance=1.0
    )
    for state in holds_of(plan):
        (a, b) = (c.position for c, f in zip(state.grasp, state.forces, strict=True) if f.any())
        assert np.hypot(*(a - b)) >= 1.0
        assert a[0] + b[0] > -1.0


def test_force_limits_hold_while_it_turns():
    plan = rg.plan_regrasp(
        ELLIPSE,
        START,
        GOAL,
        WEIGHT,
        friction=0.5,
        orientations=24,
        goal_orientation=np.pi / 2,
        max_force=16.0,
    )
    assert all(c.max_force == 16.0 for step in plan.steps for c in step.grasp)
    assert rg.verify(plan).ok


def test_the_trade_off_widens_the_margin():
    plans = rg.plan_regrasps(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, orientations=12, extra=3)
    margins = [plan.margin for plan in plans]
    assert margins == sorted(margins)
    assert [len(p.steps) for p in plans] == sorted(len(p.steps) for p in plans)


def test_the_verifier_finds_bad_joints():
    plan = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, orientations=1)

    def verdict(steps, orientations=plan.orientations):
        return "; ".join(rg.verify(replace(plan, steps=tuple(steps), orientations=orientations)).violations)

    steps = list(plan.steps)
    assert verdict(steps) == ""
    assert "forces jump or a finger moves under force" in verdict([steps[0], *steps[2:]], (0.0,) * len(steps))
    assert "is not the first one seen from 0.3 rad" in verdict(steps, (*plan.orientations[:-1], 0.3))
    assert "need 5 orientations, got 4" in verdict(steps, plan.orientations[:-1])
    four = rg.plan_removal(rg.Grasp([*START, GOAL["B1"]]), "B1", load=WEIGHT)
    assert "4 fingers touch the object" in verdict([four, *steps[1:]])
    shifted = replace(steps[1], start=rg.GraspState(steps[1].grasp, WEIGHT, 2 * steps[1].start.forces))
    assert "step 2: start: not in equilibrium" in verdict([steps[0], shifted, *steps[2:]])


@pytest.mark.parametrize(
    ("options", "kind", "words"),
    [
        ({"friction": 0.01}, rg.InvalidInput, None),
        ({"start": START.without(0)}, rg.InvalidInput, "start must be a Grasp of three planar contacts"),
        ({"load": rg.Wrench([0, -1], 0.2)}, rg.InvalidInput, "a planar force through the centre of mass"),
        ({"orientations": 0}, rg.InvalidInput, "orientations must be a whole number of at least 1, got 0"),
        ({"goal_orientation": np.nan}, rg.InvalidInput, "goal_orientation must be finite"),
        ({"load": [0, -1]}, rg.InvalidInput, "load must be a Wrench"),
        ({"max_turn": 4.0}, rg.InvalidInput, "max_turn must be above 0 and below pi"),
        ({"objective": "speed"}, rg.InvalidInput, "objective must be one of"),
        ({"candidates": 0.5}, rg.InvalidInput, "candidates must be a whole number"),
        (
            {"start": grasp_on(ELLIPSE, (0.4, 0.45, 0.5), 0.05)}, rg.Infeasible,
            r"fingers of the start cannot hold the load at 0 deg: .*; they would with friction 2\.27",
        ),
    ],
)  # fmt: skip
def test_bad_requests(options, kind, words):
    given = {"start": START, "goal": GOAL, "load": WEIGHT, "friction": 0.5, "orientations": 6} | options
    if words is None:
        assert rg.verify(rg.plan_regrasp(ELLIPSE, **given)).ok  # the grasps' own friction is enough
        return
    with pytest.raises(kind, match=words):
        rg.plan_regrasp(ELLIPSE, **given)


def test_an_outline_is_needed():
    with pytest.raises(rg.InvalidInput, match="a regrasp needs an Outline or a Mesh, got 3"):
        rg.plan_regrasp(3, START, GOAL, WEIGHT, friction=0.5)


def test_memory_is_bounded():
    contacts = named([ELLIPSE.contact_at(float(x), friction=0.5) for x in ELLIPSE.sample(100)], "c")
    graph = HoldGraph(tuple(contacts), WEIGHT, evenly(360), most_bytes=2**20)
    with pytest.raises(rg.InvalidInput, match=r"100 points at 360 orientations need 0\.00664 GiB"):
        graph.margin(0, 1, 0)
    assert graph.widest().holding.shape == (360,)


def lower_half(first, second, angle):
    return np.cos(angle) * (first[:, 1] + second[:, 1]) < 0.1


@pytest.mark.parametrize("keep", [None, lower_half])
def test_the_widest_holds_are_those_of_the_table(keep):
    contacts = named([ELLIPSE.contact_at(float(x), friction=0.4) for x in ELLIPSE.sample(120)], "c")
    graph = HoldGraph(tuple(contacts), WEIGHT, evenly(15), min_distance=0.4, keep=keep)
    found = graph.widest()
    assert (found.margins == graph.margins.max(axis=0)).all()
    assert (found.places == graph.margins.argmax(axis=0)).all()
    assert (found.holding == (graph.margins >= 0).sum(axis=1)).all()
    assert 0 < (found.margins >= 0).sum() < found.margins.size


@pytest.mark.parametrize("limited", [False, True])
def test_compiled_margins_are_those_of_best_squeeze(limited):
    rng = np.random.default_rng(7)
    for scale in (1e-3, 1.0, 1e3):
        outline = rg.Outline.ellipse(2 * scale, scale)
        contacts = named(
            [
                outline.contact_at(
                    x, friction=rng.choice([0.0, 0.1, 0.5, 2.0]), max_force=6.0 if limited else None
                )
                for x in (*rng.uniform(0, outline.length, 20), *outline.sample(12).tolist())
            ],
            "c",
        )
        graph = HoldGraph(tuple(contacts), WEIGHT, evenly(16))
        for o, angle in enumerate(graph.angles.tolist()):
            load = WEIGHT.rotated(-angle).force
            for (i, a), (j, b) in combinations(enumerate(contacts), 2):
                _, f, _ = best_squeeze(
                    *a.position, *a.normal, a.friction, *b.position, *b.normal, b.friction, *load, 0.0,
                    ANGLE, *([6.0] * 2 if limited else [np.inf] * 2), graph.peak_ratio,
                )  # fmt: skip
                if np.isnan(f[0]):
                    assert graph.margin(i, j, o) < 0
                    continue
                least = min(
                    np.arctan(c.friction)
                    - np.arctan2(abs(c.normal[0] * g[1] - c.normal[1] * g[0]), c.normal @ g)
                    for c, g in ((a, f[:2]), (b, f[2:]))
                )
                assert graph.margin(i, j, o) == pytest.approx(max(least, 0.0), abs=1e-6)


def test_states_chosen_together_have_the_widest_worst_margin_and_change_least():
    options = {"friction": 0.5, "orientations": 1}
    each = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **options)
    joint = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, states="joint", **options)
    assert rg.verify(joint).ok
    check_simulated(joint, START, GOAL, WEIGHT.force, 0.5)
    assert [s.grasp.names for s in joint.steps] == [s.grasp.names for s in each.steps]

    def worst(plan):
        ends = [plan.steps[0].start, *(step.end for step in plan.steps)]
        return min(state.margins.least_force for state in ends)

    def change(plan):
        return sum(((step.end.forces - step.start.forces) ** 2).sum() for step in plan.steps)

    assert worst(joint) >= worst(each) - 1e-6
    assert change(joint) < change(each)
    best = cp_worst_margin(each)
    assert worst(joint) == pytest.approx(best, rel=1e-5)


def cp_worst_margin(plan):
    """The widest worst force margin over all states of a plan, with cvxpy and none of our builders."""
    import cvxpy as cp

    t, held = cp.Variable(), []
    states = [(plan.steps[0].start, 0)] + [(step.end, k) for k, step in enumerate(plan.steps)]
    for k, (state, step) in enumerate(states):
        used = [i for i, f in enumerate(state.forces) if f.any()]
        choices = plan.steps[step].record.choices
        limits = choices[0 if k == 0 else 1].force_limits
        grasp = state.grasp.subset(used)
        f = cp.Variable((len(used), 2))
        n, s = grasp.normals, grasp.tangents
        normal, across = cp.sum(cp.multiply(n, f), axis=1), cp.sum(cp.multiply(s, f), axis=1)
        held += [cp.sum(f, axis=0) + state.load.force == 0]
        held += [grasp.positions[:, 0] @ f[:, 1] - grasp.positions[:, 1] @ f[:, 0] == 0]
        held += [0.5 * normal - cp.abs(across) >= t * np.sqrt(1.25)]
        held += [cp.norm(f, axis=1) <= np.array(limits)]
    problem = cp.Problem(cp.Maximize(t), held)
    problem.solve(solver=cp.CLARABEL)
    return problem.value


def test_a_margin_asked_for_is_kept_or_its_bound_told():
    options = {"friction": 0.5, "orientations": 12}
    usual = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **options)
    safe = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, least_margin=0.9 * usual.margin, **options)
    assert safe.margin >= 0.9 * usual.margin
    with pytest.raises(rg.Infeasible, match="the widest worst margin on the sampled points") as refused:
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, least_margin=0.46, **options)
    widest = float(str(refused.value).split()[-2])
    plans = rg.plan_regrasps(ELLIPSE, START, GOAL, WEIGHT, extra=12, **options)
    assert widest == pytest.approx(plans[-1].margin, rel=1e-3)
    with pytest.raises(rg.InvalidInput, match="least_margin must be at least 0"):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, least_margin=-1.0, **options)
