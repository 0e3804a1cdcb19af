"""Least normal forces in regrasps: in every hold both fingers push enough, by states chosen one by one."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from regrasp.outline.parts import bracket
from regrasp.planning.holds.pairs import HoldGraph, evenly, named
from values import problem

pytestmark = pytest.mark.oracle

ELLIPSE, WEIGHT = rg.Outline.ellipse(2, 1), rg.Wrench([0, -3.0])


def grasp(*places):
    return rg.Grasp(ELLIPSE.contact_at(p * ELLIPSE.length, friction=0.5) for p in places)


START, GOAL = grasp(0.02, 0.35, 0.7), grasp(0.2, 0.5, 0.85)


@pytest.mark.parametrize("limit", [None, 5.0])
def test_margins_are_those_of_states_chosen_with_least_normals(limit):
    rng = np.random.default_rng(1)
    contacts = tuple(
        named(
            [ELLIPSE.contact_at(x, friction=0.4, max_force=limit) for x in rng.uniform(0, ELLIPSE.length, 7)],
            "c",
        )
    )
    graph = HoldGraph(contacts, WEIGHT, evenly(5), min_normal=0.8)
    free = HoldGraph(contacts, WEIGHT, evenly(5))
    moved = refused = 0
    for i, j in combinations(range(7), 2):
        for o in (0, 1, 3):
            load = WEIGHT.rotated(-float(graph.angles[o]))
            two = rg.Grasp([contacts[i], contacts[j]])
            most = limit if limit is not None else None
            if limit is None and free.margin(i, j, o) >= 0:  # the same limit for both
                most = 3.0 * rg.choose_state(two, load, "peak", reserve=0).value
            try:
                state = rg.choose_state(two, load, reserve=0, min_normal=0.8, max_force=most or 100.0)
            except rg.Infeasible:
                assert graph.margin(i, j, o) < 0
                refused += free.margin(i, j, o) >= 0
                continue
            assert graph.margin(i, j, o) == pytest.approx(state.value, abs=2e-5)
            moved += graph.margin(i, j, o) < free.margin(i, j, o) - 1e-4
    assert refused >= 1
    assert moved >= 1
    assert (graph.widest().margins == graph.margins.max(axis=0)).all()


@pytest.mark.parametrize("orientations", [None, 24, 1])
@pytest.mark.parametrize("objective", ["angle", "effort"])
def test_fingers_that_stay_push_with_the_least_normal(orientations, objective):
    plan = rg.plan_regrasp(
        ELLIPSE,
        START,
        GOAL,
        WEIGHT,
        friction=0.5,
        orientations=orientations,
        objective=objective,
        min_normal=0.5,
    )
    assert rg.verify(plan).ok
    for step in plan.steps:
        stay = [n for n in step.grasp.names if n not in (*step.leaving, *step.arriving)]
        rows = [step.grasp.names.index(name) for name in stay]
        t = np.linspace(0, step.duration, 21)
        normal = (step.forces(t) * step.grasp.normals).sum(axis=-1)
        assert normal[:, rows].min() >= 0.5 - 1e-9
        assert sorted(step.record.least_normals) == [0.0] * (len(step.grasp) - len(stay)) + [0.5] * len(stay)


def test_least_normals_too_large_are_refused():
    with pytest.raises(rg.Infeasible):
        rg.plan_regrasp(
            ELLIPSE, START, GOAL, WEIGHT, friction=0.5, orientations=1, min_normal=50.0, max_force=9.0
        )
    with pytest.raises(rg.InvalidInput, match="min_normal must be at least 0"):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, min_normal=-1.0)
    asked = rg.Criteria("angle", min_normal=0.3)
    plan = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, objective=asked)
    assert max(plan.steps[0].record.least_normals) == 0.3


def test_a_share_of_the_load_unless_it_takes_more_moves(monkeypatch):
    weak = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, min_normal=0.0)
    assert "less than 1% of the load" in weak.notes[0]
    assert str(weak).endswith(f"note: {weak.notes[0]}")
    usual = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5)
    assert not usual.notes
    assert len(usual.moves) == len(weak.moves)
    assert weak.margin - 0.01 <= usual.margin <= weak.margin
    for kind in ({"one_finger": True}, {"objective": rg.Criteria()}):
        assert rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, **kind).notes
    # a share that takes more moves, or that nothing has, is not asked for
    careful = {"friction": 0.5, "least_margin": 0.3}
    weak = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **careful, min_normal=0.0)
    strong = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **careful, min_normal=6.0)
    assert len(strong.moves) > len(weak.moves)
    for share in (2.0, 1e3):
        monkeypatch.setattr("regrasp.planning.regrasps.planned.LEAST_SHARE", share)
        assert rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **careful) == weak


def test_states_chosen_together_push_too():
    plan = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, states="joint", min_normal=0.7)
    assert rg.verify(plan).ok
    for step in plan.steps:
        stay = [step.grasp.index(n) for n in step.grasp.names if n not in (*step.leaving, *step.arriving)]
        for state in (step.start, step.end):
            assert (state.forces * step.grasp.normals).sum(axis=1)[stay].min() >= 0.7 - 1e-9


def test_a_squeeze_far_above_the_load_is_noted():
    pinched = rg.Outline([[0, 0], [3, 0], [3, 0.3], [0, 0.3]])
    ends = [
        rg.Grasp(pinched.contact_at(s, friction=0.5) for s in places)
        for places in ((0.4, 2.6, 4.8), (0.9, 2.2, 4.3))
    ]
    plan = rg.plan_regrasp(pinched, *ends, rg.Wrench([0, -3.0]), friction=0.5, orientations=1)
    most = max(np.linalg.norm(step.start.forces, axis=1).max() for step in plan.steps)
    assert any("times the load" in note for note in plan.notes) == (most > 30)


def test_one_finger_counts_no_cone_of_a_finger_without_force():
    a = 2.2928918565775236
    turn = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
    point, normal = turn @ [0.0, -1.0], turn @ [0.0, 1.0]
    rng = np.random.default_rng(0)
    contacts = [rg.Contact(point, normal, 0.5)]
    contacts += [rg.Contact([x, y], [-x, -y], 0.5) for x, y in rng.normal(size=(40, 2))]
    graph = HoldGraph(tuple(named(contacts, "c")), WEIGHT, np.array([a]), one_finger=True)
    assert graph.row(0, 0)[1:] == pytest.approx(np.arctan(0.5), abs=1e-6)
    assert graph.widest().margins[:40] == pytest.approx(np.arctan(0.5), abs=1e-6)


def test_fingers_side_by_side_press_by_no_squeeze():
    """Normals across the line of two contacts: squeezing changes neither normal force, and warns of none."""
    square = [rg.Contact([x, y], normal=[0, -y], friction=0.5) for y in (-1, 1) for x in (-1, 1)]
    graph = HoldGraph(tuple(named(square, "c")), WEIGHT, evenly(4), min_normal=50.0)
    for i, j in ((0, 1), (2, 3)):
        assert all(graph.margin(i, j, o) < 0 for o in range(4))


def test_holds_withstand_the_disturbance_of_criteria() -> None:
    loads = rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.2, torque=0.2)
    criteria = rg.Criteria("effort", disturbance=loads)
    least = {}
    for objective in ("effort", criteria):
        plan = replace(problem(), objective=objective).plans()[0]
        factors = []
        for step in plan.steps:
            for state in (step.start, step.end):
                used = [i for i, force in enumerate(state.forces) if force.any()]
                seen = rg.GraspState(state.grasp.subset(used), state.load, state.forces[used])
                factors.append(rg.Criteria("wrench", disturbance=loads).objective.value(seen))
        least[str(objective)] = min(factors)
    assert least["effort"] < 0.1
    assert least[str(criteria)] >= 1 - 1e-9
    with pytest.raises(rg.InvalidInput, match="joint' has one force margin for all states"):
        replace(problem(), objective="wrench", states="joint")


def test_asking_for_more_leaves_the_problem_as_it_was() -> None:
    asked = problem()
    pushed = asked.asking(0.1)
    assert (asked.min_normal, pushed.min_normal) == (None, 0.1)
    assert asked.graph is not pushed.graph


def test_a_share_of_the_load_is_not_asked_for_where_it_costs_the_margin() -> None:
    """On two sides in one line a finger's normal force is set by the angle: at 1 % no room is left."""
    part = bracket()
    start, goal = (
        rg.Grasp(part.contact_at(s * part.length, friction=0.5) for s in shares)
        for shares in ((0.316, 0.714, 0.619), (0.134, 0.437, 0.958))
    )
    given, none = (
        rg.plan_regrasp(part, start, goal, WEIGHT, friction=0.5, candidates=1, min_normal=least)
        for least in (None, 0.0)
    )
    assert given.margin >= 0.5 * none.margin > 0.05
    assert rg.verify(given).ok
