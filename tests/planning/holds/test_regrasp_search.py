"""Sequences of holds are the best there are, by exhaustive search on small graphs."""

from itertools import combinations, pairwise

import numpy as np
import pytest

import regrasp as rg
from exhaustive import ends_of, least_cost, small_graph, trade_off
from regrasp.planning.holds.cost_search import Costs, cheapest
from regrasp.planning.holds.planar_stances import Fingering
from regrasp.planning.holds.sequences import MAX_TURN, as_sequence, sequences
from regrasp.planning.holds.weights import RegraspWeights, efforts

pytestmark = pytest.mark.oracle


def arcs_of(rng, points, start):
    """Which finger may touch which point: a run of neighbours, and where it starts."""
    allowed = np.zeros((3, points), dtype=bool)
    for finger, place in enumerate(start):
        first, size = int(rng.integers(points)), int(rng.integers(2, points))
        allowed[finger, (first + np.arange(size)) % points] = True
        allowed[finger, place] = True
    return allowed


def walked(graph, sequence, o, max_turn):
    """Steps beyond the removal and the addition, and the turning from the first orientation to the last."""
    ways = graph.angles[[0, *(h[2] for h in sequence.holds), o]]
    turns = abs((np.diff(ways) + np.pi) % (2 * np.pi) - np.pi)
    assert (turns < np.pi + 1e-9).all()
    pieces = np.maximum(np.ceil(turns / max_turn - 1e-9), 1)
    return int(pieces.sum()) - 2, turns.sum()


def check_sequence(graph, sequence, start, goal, allowed=None):
    """A way of three fingers that can be walked; returns its moves."""
    at, moves = list(start), 0
    assert set(sequence.holds[0][:2]) <= set(start)
    assert min(graph.margin(*h) for h in sequence.holds) == pytest.approx(sequence.margin, abs=1e-9)
    for a, b in pairwise(sequence.holds):
        new = set(b[:2]) - set(a[:2])
        assert len(new) <= 1
        if new - set(at):
            (free,) = (f for f, p in enumerate(at) if p not in a[:2])
            (at[free],) = new
            moves += 1
            assert allowed is None or allowed[free, at[free]]
    if set(at) != set(goal):
        (free,) = (f for f, p in enumerate(at) if p not in sequence.holds[-1][:2])
        (at[free],) = set(goal) - set(at)
        moves += 1
        assert allowed is None or allowed[free, at[free]]
    assert set(at) == set(goal)
    assert moves == sequence.moves


@pytest.mark.parametrize("labelled", [False, True])
@pytest.mark.parametrize("max_turn", [MAX_TURN, 1.3])
def test_no_sequence_has_fewer_moves_or_is_safer(labelled, max_turn):
    rng = np.random.default_rng(3)
    seen = {"found": 0, "impossible": 0, "traded": 0, "more": 0}
    for _ in range(30):
        graph = small_graph(rng, 8)
        o = int(rng.integers(len(graph.angles)))
        start, goal = ends_of(rng, graph, o)
        allowed = arcs_of(rng, 8, start) if labelled else None
        expected = trade_off(graph, start, goal, o, max_turn, allowed)
        found = sequences(graph, start, goal, o, max_turn=max_turn, allowed=allowed, extra=20)
        assert [(s.moves, pytest.approx(s.margin, abs=1e-6)) for s in found] == expected
        seen["found" if found else "impossible"] += 1
        seen["traded"] += len(found) > 1
        for sequence in found:
            check_sequence(graph, sequence, start, goal, allowed)
            seen["more"] += sequence.moves > 3
            # of these, the fewest steps, then the least turning
            counted = {"threshold": sequence.margin - 1e-7, "move": 1e3, "step": 1.0, "turn": 1e-4}
            cost = least_cost(graph, start, goal, o, max_turn, allowed, **counted)
            steps, turning = walked(graph, sequence, o, max_turn)
            mine = 1e3 * sequence.moves + steps + 1e-4 * turning
            assert mine == pytest.approx(cost, abs=1e-5)
    assert min(seen.values()) >= 1, seen


def test_ends_that_no_two_fingers_hold_are_left_and_reached_just_where_brute_force_does():
    """With turns, three fingers take the object to where two hold it; without, they cannot."""
    rng = np.random.default_rng(1)
    seen = set()
    for k in range(90):
        graph = small_graph(
            rng, 7, 1 if k % 4 == 0 else int(rng.integers(2, 6)), rng.choice([0.06, 0.2, 0.4])
        )
        o = int(rng.integers(len(graph.angles)))
        start, goal = (tuple(rng.choice(7, 3, replace=False).tolist()) for _ in range(2))
        if k % 4 == 1:  # both held, and often nothing between
            start, goal = ends_of(rng, graph, o)
        able = [
            any(graph.margins[at, graph.pair(i, j)] >= 0 for i, j in combinations(sorted(end), 2))
            for end, at in ((start, 0), (goal, o))
        ]
        expected = least_cost(graph, start, goal, o, MAX_TURN)
        found = sequences(graph, start, goal, o)
        assert [s.moves for s in found] == ([] if expected is None else [round(expected)])
        seen.add((len(graph.angles) > 1, *able, bool(found)))
    turning = {(True, a, b, found) for a in (True, False) for b in (True, False) for found in (True, False)}
    fixed = {(False, a, b, False) for a, b in ((True, False), (False, True), (False, False))}
    assert turning | fixed <= seen, turning | fixed - seen


def test_start_and_goal_of_the_same_contacts_need_no_move():
    graph = small_graph(np.random.default_rng(1), 9, 4, 1.0)
    for o in range(4):
        expected = least_cost(graph, (0, 3, 6), (6, 0, 3), o, MAX_TURN)
        found = sequences(graph, (0, 3, 6), (6, 0, 3), o)
        assert (found[0].moves if found else None) == expected
    assert sequences(graph, (0, 3, 6), (6, 0, 3))[0].moves == 0


def test_fewer_moves_come_before_fewer_steps():
    """Turning in a hold, or among the three points, is a step but no move."""
    rng = np.random.default_rng(0)
    longer = 0
    for _ in range(60):
        graph = small_graph(rng, 8, 6)
        start, goal = ends_of(rng, graph, 3)
        best = sequences(graph, start, goal, 3, max_turn=1.1)
        fewest = least_cost(graph, start, goal, 3, 1.1, move=1e-3, step=1.0)
        if best:
            steps, _ = walked(graph, best[0], 3, 1.1)
            assert steps >= int(fewest)
            longer += steps > int(fewest)
    assert longer >= 1


@pytest.mark.parametrize("labelled", [False, True])
@pytest.mark.parametrize(
    "weights",
    [
        RegraspWeights(moves=1, turning=0.3),
        RegraspWeights(moves=0.2, time=1.0),
        RegraspWeights(moves=0.5, turning=1.0, effort=0.4),
        RegraspWeights(moves=0, turning=1.0),
        RegraspWeights(moves=0, effort=2.0, time=0.1),
    ],
)
def test_no_sequence_costs_less(weights, labelled):
    rng = np.random.default_rng(11)
    seen = {"found": 0, "impossible": 0}
    for _ in range(15):
        graph = small_graph(rng, 6, share=rng.uniform(0.06, 0.4))
        o, least = int(rng.integers(len(graph.angles))), float(rng.choice([0.0, 0.05]))
        start, goal = ends_of(rng, graph, o)
        allowed = arcs_of(rng, 6, start) if labelled else None
        fingers = Fingering(graph, MAX_TURN, least, allowed)
        effort = efforts(graph, graph.margins.T >= 0)
        expected = least_cost(
            graph, start, goal, o, MAX_TURN, allowed, least, weights.moves, weights.turning,
            2.0 * weights.time, weights.effort * effort,
        )  # fmt: skip
        found = cheapest(fingers, weights.costs(graph, fingers.margins, 2.0), start, goal, o)
        seen["found" if found else "impossible"] += 1
        assert (found is None) == (expected is None)
        if found:
            assert found.cost == pytest.approx(expected, abs=1e-6)
            sequence = as_sequence(fingers, found)
            check_sequence(graph, sequence, start, goal, allowed)
            steps, turning = walked(graph, sequence, o, MAX_TURN)
            paid = weights.moves * sequence.moves + weights.turning * turning
            paid += weights.time * 2.0 * steps
            paid += weights.effort * sum(effort[graph.pair(i, j), k] for i, j, k in sequence.holds)
            assert paid == pytest.approx(expected, abs=1e-6)
            assert sequence.margin >= least
    assert min(seen.values()) >= 3, seen


def test_efforts_are_those_of_chosen_states():
    graph = small_graph(np.random.default_rng(2), 9, 5, 1.0)
    found = efforts(graph, graph.margins.T >= 0)
    held = 0
    for p, (i, j) in enumerate(zip(*graph.pairs, strict=True)):
        for o, load in enumerate(graph.loads):
            if graph.margins[o, p] < 0:
                assert found[p, o] == 0
                continue
            grasp = rg.Grasp([graph.contacts[i], graph.contacts[j]])
            state = rg.choose_state(grasp, rg.Wrench(load), "peak", reserve=0)
            assert found[p, o] == pytest.approx(state.value / 3.0, rel=1e-9)
            held += 1
    assert held > 20


def test_one_step_of_cost_alone_is_one_hold():
    graph = small_graph(np.random.default_rng(4), 9, 1, 1.0)
    fingers = Fingering(graph, MAX_TURN, 0.0, None)
    worth = np.where(fingers.margins >= 0, 0.0, np.inf)
    found = cheapest(fingers, Costs(worth, 1.0, 0.0, 0.1), (0, 3, 6), (0, 3, 6), 0)
    assert (found.cost, found.moves, len(found.way)) == (0.0, 0, 1)
