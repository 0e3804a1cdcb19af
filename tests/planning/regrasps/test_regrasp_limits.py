"""What limits a regrasp: bottlenecks, arcs of fingers, single fingers, weights and bad options."""

from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from exhaustive import ends_of, least_cost, small_graph, trade_off
from regrasp.planning.holds.bottleneck import bottleneck
from regrasp.planning.holds.pairs import HoldGraph, evenly, named
from regrasp.planning.holds.sequences import MAX_TURN
from regrasp.planning.holds.weights import RegraspWeights
from regrasp.planning.regrasps.options import RegraspOptions
from regrasp.planning.regrasps.problem import RegraspProblem

pytestmark = pytest.mark.laws

WEIGHT = rg.Wrench([0, -3.0])
ELLIPSE = rg.Outline.ellipse(2, 1)


def grasp_on(outline, places, friction=0.5, prefix="A", max_force=None):
    return rg.Grasp(
        outline.contact_at(s * outline.length, friction=friction, name=f"{prefix}{i}", max_force=max_force)
        for i, s in enumerate(places, 1)
    )


START, GOAL = grasp_on(ELLIPSE, (0.02, 0.35, 0.7)), grasp_on(ELLIPSE, (0.2, 0.5, 0.85), prefix="B")


def without(graph, gone):
    """What exhaustive search reads of a graph, some pairs left out."""
    margins = np.where(gone, -1.0, graph.margins)
    return SimpleNamespace(contacts=graph.contacts, angles=graph.angles, pairs=graph.pairs, margins=margins)


@pytest.mark.parametrize("max_turn", [MAX_TURN, 1.3])
def test_bottlenecks_are_those_of_exhaustive_search(max_turn):
    rng = np.random.default_rng(8)
    seen = {"found": 0, "impossible": 0, "points": 0, "pairs": 0}
    for _ in range(15):
        graph = small_graph(rng, 8)
        o = int(rng.integers(len(graph.angles)))
        start, goal = ends_of(rng, graph, o)
        expected = trade_off(graph, start, goal, o, max_turn)
        found = bottleneck(graph, start, goal, o)
        seen["found" if found else "impossible"] += 1
        assert (found is None) == (not expected)
        if found is None:
            continue
        assert found.margin == pytest.approx(expected[-1][1], abs=1e-6)
        assert graph.margin(*found.hold) == found.margin
        first, second = graph.pairs

        def needed(gone):
            return least_cost(without(graph, gone), start, goal, o, max_turn) is None  # noqa: B023

        points = tuple(v for v in range(8) if needed((first == v) | (second == v)))
        pairs = tuple(
            (i, j) for i in range(8) for j in range(i + 1, 8) if needed((first == i) & (second == j))
        )
        assert (found.points, found.pairs) == (points, pairs)
        seen["points"] += bool(points)
        seen["pairs"] += bool(pairs)
    assert min(seen.values()) >= 1, seen


def test_a_problem_tells_its_bottleneck():
    problem = RegraspProblem(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, orientations=1, candidates=40)
    found = problem.bottleneck()
    widest = problem.plans(extra=12)[-1]
    assert found.margin == pytest.approx(widest.margin, abs=1e-6)
    i, j, _ = found.hold
    names = [problem.contacts[k].name for k in (i, j)]
    text = str(found)
    assert (
        f"keeps {np.degrees(found.margin):.2f} deg, limited by the hold of {names[0]} and {names[1]} at"
        in text
    )
    needed = ", ".join(problem.contacts[v].name for v in found.points)
    assert needed
    assert text.endswith(f"points that every way needs: {needed}\npairs that every way needs: none")
    with pytest.raises(rg.InvalidInput, match="leave arcs out"):
        RegraspProblem(
            ELLIPSE, START, GOAL, WEIGHT, friction=0.5, orientations=6, candidates=20, arcs=[None] * 3
        ).bottleneck()


def arc_options(arcs, **more):
    length = ELLIPSE.length
    scaled = arcs and [None if a is None else (np.array(a) * length).tolist() for a in arcs]
    return {"friction": 0.5, "orientations": 24, "candidates": 60, "arcs": scaled} | more


@pytest.mark.parametrize(
    "arcs",
    [
        [(0.8, 0.25), (0.1, 0.55), (0.5, 0.95)],  # the first passes the first vertex
        [[(0.0, 0.1), (0.45, 0.55)], (0.15, 0.4), (0.6, 0.9)],
        [None, (0.3, 1.3), (0.6, 0.25)],
        [(0.9, 0.21), (0.1, 0.51), (0.4, 0.9)],
    ],
)
def test_fingers_stay_on_their_arcs(arcs):
    plan = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **arc_options(arcs))
    assert rg.verify(plan).ok
    assert plan.moves
    places = {c.name: c.position for step in plan.steps for c in step.grasp}
    touched = [{row[finger] for row in plan.fingers} - {None} for finger in range(3)]
    assert touched[0] >= {"start A1"}
    for arc, names in zip(arcs, touched, strict=True):
        for name in names:
            s = ELLIPSE.nearest(places[name] + ELLIPSE.centre_of_mass) / ELLIPSE.length
            ranges = [(0.0, 1.0)] if arc is None else np.atleast_2d(arc).tolist()
            assert any(hi - lo >= 1 or (s - lo + 1e-6) % 1 <= (hi - lo) % 1 + 2e-6 for lo, hi in ranges)


def test_arcs_of_the_whole_outline_change_nothing():
    free = rg.plan_regrasps(ELLIPSE, START, GOAL, WEIGHT, extra=2, **arc_options(None))
    whole = rg.plan_regrasps(ELLIPSE, START, GOAL, WEIGHT, extra=2, **arc_options([None, (0, 1), (0.3, 1.3)]))
    assert [len(p.moves) for p in free] == [len(p.moves) for p in whole]
    assert [p.margin for p in free] == pytest.approx([p.margin for p in whole], abs=1e-6)


@pytest.mark.parametrize(
    ("arcs", "words"),
    [
        ([(0.1, 0.3), None, None], r"start A1 is not on the arc of finger 1, \[.*\], which touches it"),
        ([(0.0, 0.1), (0.3, 0.4), (0.6, 0.8)], "goal B1 is on no finger's arc"),
        ([(0.0, 0.6), (0.3, 0.4), (0.6, 0.9)],
         "three fingers cannot take the contacts of the goal: goal B1 is on the arc of finger 1; goal B2"),
        ([None, (0, 99), None], r"arcs: finger 2 must be arc lengths .* are they in its unit"),
        ([(0, 1), (0, 1)], "arcs must have an entry for each of three fingers, got"),
        ([(0, 1), (0, 1, 2), None], r"arcs: finger 2 must have shape \(2,\)"),
        ([[(0, 1), (1, 2, 3)], None, None], "arcs: finger 1 must be numbers of shape"),
        ([[], None, None], "arcs: finger 1 "),
        ([(0, np.nan), None, None], "arcs: finger 1 must be finite"),
    ],
)  # fmt: skip
def test_bad_arcs(arcs, words):
    ragged = any(a and np.iterable(a[0]) for a in arcs)
    options = arc_options(None) | {"arcs": arcs} if ragged else arc_options(arcs)
    with pytest.raises(rg.InvalidInput, match=words):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **options)


def test_arcs_that_keep_the_ends_apart_are_named():
    arcs = [
        [(0.02, 0.02), (0.5, 0.5)],
        [(0.35, 0.35), (0.2, 0.2)],
        [(0.7, 0.7), (0.85, 0.85)],
    ]  # one move each
    options = arc_options(arcs, orientations=1, candidates=30)
    with pytest.raises(rg.Infeasible, match="both ends have points in component 0, but the arcs") as error:
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **options)
    assert str(error.value).endswith("instead of 0.5, or without arcs")
    needed = error.value.certificate.friction
    ends = [grasp_on(ELLIPSE, p, needed, n) for p, n in (((0.02, 0.35, 0.7), "A"), ((0.2, 0.5, 0.85), "B"))]
    plan = rg.plan_regrasp(ELLIPSE, *ends, WEIGHT, **options | {"friction": needed})
    assert rg.verify(plan).ok
    assert [set(names) - {None} for names in zip(*plan.fingers, strict=True)] == [
        {"start A1", "goal B2"}, {"start A2", "goal B1"}, {"start A3", "goal B3"},
    ]  # fmt: skip


def test_no_hold_rests_on_one_finger():
    below = rg.Contact([0, -1], [0, 1], 0.5)  # the load passes through it
    others = [ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5) for s in np.linspace(0.02, 0.98, 24)]
    contacts = tuple(named([below, *others], "c"))
    graph = HoldGraph(contacts, WEIGHT, evenly(1))
    loose = HoldGraph(contacts, WEIGHT, evenly(1), one_finger=True)
    alone = shared = 0
    for j in range(1, len(contacts)):
        assert graph.margin(0, j, 0) <= loose.margin(0, j, 0)
        grasp = rg.Grasp([contacts[0], contacts[j]])
        widest = rg.choose_state(grasp, WEIGHT, reserve=0)
        idle = widest.magnitudes.min() < 1e-9 * widest.magnitudes.max()
        assert loose.margin(0, j, 0) == pytest.approx(widest.value, abs=1e-6)
        if not idle:
            assert graph.margin(0, j, 0) == loose.margin(0, j, 0)
            continue
        both = rg.choose_state(grasp, WEIGHT, "force", reserve=0)
        if both.magnitudes.min() > 1e-9 * both.magnitudes.max():
            assert graph.margin(0, j, 0) == pytest.approx(both.margins.least_angle, abs=1e-6)
            shared += 1
        else:
            assert graph.margin(0, j, 0) < 0
            alone += 1
    assert alone >= 5
    assert shared >= 1
    found, table = graph.widest(), graph.margins
    assert (found.margins == table.max(axis=0)).all()
    assert found.holding.tolist() == (table >= 0).sum(axis=1).tolist()


@pytest.mark.parametrize("objective", ["angle", "effort", "peak"])
def test_both_fingers_push_in_every_hold_of_a_plan(objective):
    goal = grasp_on(ELLIPSE, (0.2, 0.75, 0.85), prefix="B")  # its second finger can carry the load alone
    options = {"friction": 0.5, "orientations": 12, "candidates": 40, "objective": objective}
    for allowed in (False, True):
        plan = rg.plan_regrasp(ELLIPSE, START, goal, WEIGHT, one_finger=allowed, **options)
        assert rg.verify(plan).ok
        pushing = [
            (np.hypot(*step.end.forces.T) > 1e-9 * np.hypot(*step.end.forces.T).max()).sum()
            for step in plan.steps[:-1]
        ]
        assert allowed or set(pushing) <= {2, 3}


def turning(plan):
    return float(abs(np.diff(plan.orientations)).sum())


def test_weights_trade_turning_and_effort_against_moves():
    options = {"friction": 0.5, "orientations": 24, "candidates": 60, "goal_orientation": np.pi}
    usual = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, **options)
    for weights in (RegraspWeights(moves=0.1, turning=1.0), RegraspWeights(moves=0.01, effort=1.0)):
        plan = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, weights=weights, least_margin=0.05, **options)
        assert rg.verify(plan).ok
        assert plan.margin >= 0.05 - 1e-6
        assert len(plan.moves) >= len(usual.moves)
    lazy = rg.plan_regrasp(
        ELLIPSE, START, GOAL, WEIGHT, weights=RegraspWeights(moves=0, turning=1), **options
    )
    assert turning(lazy) <= turning(usual) + 1e-9
    assert turning(lazy) == pytest.approx(np.pi)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"weights": 3.0}, "weights must be RegraspWeights, got 3.0"),
        ({"one_finger": "no"}, "one_finger must be True or False, got 'no'"),
        ({"min_distance": -1.0}, "min_distance must be at least 0"),
        ({"step_duration": 0.0}, "step_duration must be greater than 0"),
    ],
)
def test_bad_options(change, words):
    with pytest.raises(rg.InvalidInput, match=words):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, **change)


def test_bad_weights_and_extra():
    with pytest.raises(rg.InvalidInput, match="weights: turning must be at least 0"):
        RegraspWeights(turning=-1.0)
    with pytest.raises(rg.InvalidInput, match="weights: at least one must be greater than 0"):
        RegraspWeights(moves=0)
    problem = RegraspProblem(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, weights=RegraspWeights())
    with pytest.raises(rg.InvalidInput, match="extra trades moves against margin"):
        problem.plans(extra=1)
    for extra in (-1, 1.0, True):
        with pytest.raises(rg.InvalidInput, match="extra must be a whole number of at least 0"):
            problem.plans(extra=extra)


def test_the_options_are_those_of_the_problem():
    fields = list(RegraspProblem.__dataclass_fields__)
    assert fields[:4] == ["outline", "start", "goal", "load"]
    assert set(fields[4:]) <= set(RegraspOptions.__annotations__)
    with pytest.raises(rg.InvalidInput, match="friction is missing"):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT)
    with pytest.raises(rg.InvalidInput, match="unknown option 'colour'"):
        rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, friction=0.5, colour="red")
