"""Sequences of holds in space are the best there are, by exhaustive search on small graphs."""

from itertools import combinations, pairwise

import numpy as np
import pytest

import regrasp as rg
from exhaustive import least_cost, trade_off, turns
from regrasp.closed_form.compiled.hold_paths import others_of
from regrasp.planning.holds.cost_search import cheapest
from regrasp.planning.holds.sequences import as_sequence, preferred
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.triples import TripleGraph, directions
from regrasp.planning.holds.weights import RegraspWeights, triple_efforts

pytestmark = pytest.mark.oracle


def small_graph(rng, points, orientations, share):
    """Points on a sphere of which few triples hold, so that ways are long; one has a force limit."""
    at = rng.normal(size=(points, 3))
    at /= np.linalg.norm(at, axis=1)[:, None]
    contacts = [
        rg.Contact(p, -p + 0.3 * rng.normal(size=3), 0.6, name=f"c{i}", max_force=6.0 if i == 1 else None)
        for i, p in enumerate(at)
    ]

    def keep(first, second, third):
        return rng.random(len(first)) < share

    ways = directions(orientations, 3.0) if orientations > 1 else np.array([[0, 0, -3.0, 0, 0, 0]])
    return TripleGraph(tuple(contacts), ways, keep=keep)


def asked(rng, labelled):
    """A graph, its ends, the last orientation, and which finger may touch which point."""
    graph = small_graph(rng, 7, int(rng.integers(1, 5)), rng.uniform(0.2, 1.0))
    start, goal = (tuple(rng.choice(7, 4, replace=False).tolist()) for _ in range(2))
    allowed = None
    if labelled:
        allowed = rng.random((4, 7)) < 0.7
        allowed[range(4), start] = allowed[range(4), goal] = True
    return graph, start, goal, int(rng.integers(len(graph.loads))), allowed


def stances(graph, max_turn, allowed, least=0.0):
    ways = graph.loads[:, :3] / np.linalg.norm(graph.loads[:, :3], axis=1)[:, None]
    return Quads(graph, ways, max_turn, least, allowed=allowed)


def walked(graph, sequence, o, max_turn):
    """Steps beyond the removal and the addition, and the turning from the first orientation to the last."""
    places = [0, *(hold[-1] for hold in sequence.holds), o]
    angles = np.array([turns(graph)[a, b] for a, b in pairwise(places)])
    assert (angles < np.pi - 1e-7).all()
    return int(np.maximum(np.ceil(angles / max_turn - 1e-9), 1).sum()) - 2, angles.sum()


def check_sequence(graph, sequence, start, goal, allowed):
    """Four fingers can walk it, in as many moves."""
    able = [np.ones(7, dtype=bool)] * 4 if allowed is None else allowed
    held = [graph.margins[hold[-1], graph.triple(*hold[:-1])] for hold in sequence.holds]
    assert min(held) == pytest.approx(sequence.margin, abs=1e-7)
    assert min(held) >= 0
    assert set(sequence.holds[0][:-1]) <= set(start)
    at, moves = list(start), 0
    last = tuple(sequence.holds[-1][:-1])
    for (*before, _), (*after, _) in pairwise(sequence.holds):
        for new in set(after) - set(at):
            (free,) = (f for f, p in enumerate(at) if p not in before)
            at[free], moves = new, moves + 1
            assert able[free][new]
        assert set(after) <= set(at)
    for new in set(goal) - set(at):
        (free,) = (f for f, p in enumerate(at) if p not in last)
        at[free], moves = new, moves + 1
        assert able[free][new]
    assert set(at) == set(goal)
    assert moves == sequence.moves


@pytest.mark.parametrize("labelled", [False, True])
def test_fewest_moves_widest_margin_fewest_steps_least_turning(labelled):
    rng = np.random.default_rng(21 + labelled)
    seen = {"found": 0, "impossible": 0, "traded": 0, "turned": 0}
    for _ in range(24):
        graph, start, goal, o, allowed = asked(rng, labelled)
        max_turn = float(rng.choice([1.0, 2.0]))
        expected = trade_off(graph, start, goal, o, max_turn, allowed)
        found = preferred(stances(graph, max_turn, allowed), start, goal, o, 20)
        assert [(s.moves, pytest.approx(s.margin, abs=2e-6)) for s in found] == expected
        seen["found" if found else "impossible"] += 1
        seen["traded"] += len(found) > 1
        for sequence in found:
            check_sequence(graph, sequence, start, goal, allowed)
            counted = {"threshold": sequence.margin - 1e-7, "move": 1e3, "step": 1.0, "turn": 1e-4}
            cost = least_cost(graph, start, goal, o, max_turn, allowed, **counted)
            steps, turning = walked(graph, sequence, o, max_turn)
            seen["turned"] += turning > 0
            assert 1e3 * sequence.moves + steps + 1e-4 * turning == pytest.approx(cost, abs=1e-5)
    assert min(seen.values()) >= 1, seen


@pytest.mark.parametrize("labelled", [False, True])
@pytest.mark.parametrize(
    "weights",
    [
        RegraspWeights(moves=0.2, time=1.0, turning=0.3),
        RegraspWeights(moves=0.5, turning=1.0, effort=0.4),
        RegraspWeights(moves=0, effort=2.0, time=0.1),
    ],
)
def test_no_sequence_costs_less(weights, labelled):
    rng = np.random.default_rng(5)
    seen = {"found": 0, "impossible": 0}
    for _ in range(8):
        graph, start, goal, o, allowed = asked(rng, labelled)
        least = float(rng.choice([0.0, 0.05]))
        fingers = stances(graph, 1.5, allowed, least)
        fingers.look_at_all()
        effort = triple_efforts(graph, graph.margins.T >= 0)
        expected = least_cost(
            graph, start, goal, o, 1.5, allowed, least, weights.moves, weights.turning,
            2.0 * weights.time, weights.effort * effort,
        )  # fmt: skip
        found = cheapest(fingers, weights.costs(graph, fingers.margins, 2.0), start, goal, o)
        seen["found" if found else "impossible"] += 1
        assert (found is None) == (expected is None)
        if found:
            assert found.cost == pytest.approx(expected, abs=1e-6)
            sequence = as_sequence(fingers, found)
            check_sequence(graph, sequence, start, goal, allowed)
            steps, turning = walked(graph, sequence, o, 1.5)
            paid = weights.moves * sequence.moves + weights.turning * turning + weights.time * 2.0 * steps
            paid += weights.effort * sum(effort[graph.triple(*three), k] for *three, k in sequence.holds)
            assert paid == pytest.approx(expected, abs=1e-6)
            assert sequence.margin >= least
    assert min(seen.values()) >= 1, seen


def test_efforts_are_those_of_chosen_states():
    graph = small_graph(np.random.default_rng(2), 6, 3, 1.0)
    found = triple_efforts(graph, graph.margins.T >= 0)
    held = 0
    for t, three in enumerate(combinations(range(6), 3)):
        for o in range(3):
            if graph.margins[o, t] < 0:
                assert found[t, o] == 0
                continue
            grasp = rg.Grasp(graph.contacts[i] for i in three)
            state = rg.choose_state(grasp, rg.Wrench.from_vector(graph.loads[o]), "peak", reserve=0)
            assert found[t, o] == pytest.approx(state.value / 3.0, rel=1e-6)
            held += 1
    assert held >= 8


def test_the_holds_of_a_stance_are_found_without_compiling_too():
    fingers = stances(small_graph(np.random.default_rng(3), 7, 1, 1.0), 1.0, None)
    assert fingers.moves.others is not None  # its module enters what is called here
    corners = fingers.holds[1].tolist()
    for hold in range(0, len(corners), 3):
        for point in set(range(7)) - set(corners[hold]):
            others = others_of(fingers.holds, hold, point)
            expected = set(combinations(sorted([*corners[hold], point]), 3)) - {tuple(corners[hold])}
            assert {tuple(corners[h]) for h in others} == expected
