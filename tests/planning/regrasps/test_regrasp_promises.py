"""What is asked of a regrasp is kept or refused, whatever else is asked with it."""

import numpy as np
import pytest

import regrasp as rg
from box import BOX, GOAL, MU, START
from box import WEIGHT as DOWN
from regrasp.planning.holds.pairs import HoldGraph, evenly, named

pytestmark = pytest.mark.contract

OUTLINE, WEIGHT = rg.Outline.ellipse(2, 1), rg.Wrench([0, -3.0])


def grasp(*places):
    return rg.Grasp(OUTLINE.contact_at(p * OUTLINE.length, friction=0.5) for p in places)


FIRST, LAST = grasp(0.02, 0.35, 0.7), grasp(0.2, 0.5, 0.85)


def planned(**options):
    options = {"friction": 0.5, "orientations": 24, "goal_orientation": -np.pi / 2} | options
    return rg.plan_regrasp(OUTLINE, FIRST, LAST, WEIGHT, **options)


def hold_margins(plan):
    most = plan.steps[0].start.grasp.dimension  # fingers that hold while one is free
    ends = [step.end for step in plan.steps[:-1] if len(step.end.in_use) <= most]
    return [state.margins.least_angle for state in ends]


@pytest.mark.parametrize("objective", ["angle", "force", "effort", "peak"])
@pytest.mark.parametrize("states", ["each", "joint"])
def test_a_least_margin_is_kept_whatever_states_are_chosen_for(objective, states):
    plan = planned(least_margin=0.2, objective=objective, states=states)
    assert min(hold_margins(plan)) >= 0.2 - 1e-6
    assert plan.margin == min(hold_margins(plan))
    assert rg.verify(plan).ok


@pytest.mark.parametrize("states", ["each", "joint"])
def test_a_least_margin_is_kept_in_space(states):
    plan = rg.plan_regrasp(
        BOX, START, GOAL, DOWN, friction=MU, orientations=1, candidates=16,
        objective="effort", states=states, least_margin=0.25,
    )  # fmt: skip
    assert min(hold_margins(plan)) >= 0.25 - 1e-6
    assert rg.verify(plan).ok


@pytest.mark.parametrize("angle", [0.4, -1.0, 7.0])
def test_the_object_ends_at_the_very_angle(angle):
    plan = planned(orientations=12, goal_orientation=angle)
    off = (plan.orientations[-1] - angle + np.pi) % (2 * np.pi) - np.pi
    assert abs(off) < 1e-12
    with pytest.raises(rg.InvalidInput, match="orientations=1 forbids turning, but goal_orientation is"):
        planned(orientations=1, goal_orientation=angle)


def test_contacts_off_the_shape_are_refused():
    inside = rg.Grasp([rg.Contact([0, -0.5], normal=[0, 1], friction=0.5), *list(FIRST)[1:]])
    with pytest.raises(rg.InvalidInput, match="away from the outline, whose nearest point is"):
        rg.plan_regrasp(OUTLINE, inside, LAST, WEIGHT, friction=0.5)
    floating = rg.Grasp([rg.Contact([0, 0, 0.5], normal=[0, 0, -1], friction=0.5), *list(START)[1:]])
    with pytest.raises(rg.InvalidInput, match="away from the mesh"):
        rg.plan_regrasp(BOX, floating, GOAL, DOWN, friction=MU)


@pytest.mark.parametrize(
    ("keep", "words"),
    [
        (3, "keep must be a function"),
        (lambda a, b, t: None, "keep must return which of"),
        (lambda a, b, t: np.ones(3, dtype=bool), "keep must return which of"),
    ],
)
def test_filters_that_are_none(keep, words):
    with pytest.raises(rg.InvalidInput, match=words):
        planned(keep=keep)


def test_queries_of_a_hold_graph():
    places = OUTLINE.sample(20)
    contacts = tuple(named([OUTLINE.contact_at(float(s), friction=0.5) for s in places], "c"))
    graph = HoldGraph(contacts, WEIGHT, evenly(12))
    labels = graph.components()
    i, j = (int(ends[graph.margins.max(axis=0).argmax()]) for ends in graph.pairs)
    expected = labels == labels[i]
    assert (graph.reachable((i, j)) == expected).all()
    assert not graph.reachable(()).any()
    with pytest.raises(rg.InvalidInput, match="start must be a whole number of at least 0, got Contact"):
        rg.bottleneck(graph, FIRST, LAST)
    with pytest.raises(rg.InvalidInput, match="goal must be three contacts by their places"):
        rg.bottleneck(graph, (0, 1, 2), (0, 1, 99))


def test_only_public_names_are_listed():
    assert set(dir(rg)) == {*rg.__all__, "__version__"}
    assert all(hasattr(rg, name) for name in rg.__all__)
