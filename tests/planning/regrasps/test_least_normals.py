"""Least normal forces in regrasps: in every hold both fingers push enough, by states chosen one by one."""

from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.holds.pairs import HoldGraph, evenly, named

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
    with pytest.raises(rg.InvalidInput, match="states='joint' takes no min_normal"):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, min_normal=0.1, states="joint")
    with pytest.raises(rg.InvalidInput, match="min_normal must be at least 0"):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, min_normal=-1.0)
    asked = rg.Criteria("angle", min_normal=0.3)
    plan = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, objective=asked)
    assert max(plan.steps[0].record.least_normals) == 0.3


def test_fingers_side_by_side_press_by_no_squeeze():
    """Normals across the line of two contacts: squeezing changes neither normal force, and warns of none."""
    square = [rg.Contact([x, y], normal=[0, -y], friction=0.5) for y in (-1, 1) for x in (-1, 1)]
    graph = HoldGraph(tuple(named(square, "c")), WEIGHT, evenly(4), min_normal=50.0)
    for i, j in ((0, 1), (2, 3)):
        assert all(graph.margin(i, j, o) < 0 for o in range(4))
