"""Sequences that avoid barred moves are the best there are, by exhaustive search on small graphs."""

from itertools import combinations, pairwise

import numpy as np
import pytest

from exhaustive import least_cost, small_graph, turns
from regrasp.planning.holds.barred import Barred, BarredSearch
from regrasp.planning.holds.cost_search import Costs
from regrasp.planning.holds.planar_stances import Fingering
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.triples import TripleGraph, directions
from regrasp.planning.holds.weights import RegraspWeights

pytestmark = pytest.mark.oracle
POINTS, TURN = 6, 1.5


def asked(rng, fingers, labelled):
    """Stances of few points, their ends, and moves that are barred: some by their target alone."""
    share, orientations = rng.choice([0.5, 1.0]), int(rng.integers(1, 4))
    start, goal = (tuple(rng.choice(POINTS, fingers, replace=False).tolist()) for _ in range(2))
    allowed = None
    if labelled:
        allowed = rng.random((fingers, POINTS)) < 0.7
        allowed[range(fingers), start] = allowed[range(fingers), goal] = True
    if fingers == 3:
        graph = small_graph(rng, POINTS, orientations, share)
        stances = Fingering(graph, TURN, allowed=allowed)
    else:
        contacts = small_solid(rng)
        loads = directions(orientations, 3.0)

        def keep(first, second, third):
            return rng.random(len(first)) < share

        graph = TripleGraph(contacts, loads, keep=keep)
        ways = loads[:, :3] / np.linalg.norm(loads[:, :3], axis=1)[:, None]
        stances = Quads(graph, ways, TURN, allowed=allowed)
    closed, lifts = rng.choice([0.1, 0.5]), rng.choice([0.0, 0.05])
    moves = set()
    for held in map(frozenset, combinations(range(POINTS), fingers - 1)):
        rest = [p for p in range(POINTS) if p not in held]
        moves |= {(frozenset(ends), held) for ends in combinations(rest, 2) if rng.random() < closed}
        moves |= {(frozenset([p]), frozenset([min(held)])) for p in rest if rng.random() < lifts}
    return graph, stances, start, goal, int(rng.integers(len(graph.loads))), allowed, moves


def small_solid(rng):
    import regrasp as rg

    at = rng.normal(size=(POINTS, 3))
    at /= np.linalg.norm(at, axis=1)[:, None]
    return tuple(rg.Contact(p, -p + 0.3 * rng.normal(size=3), 0.6, name=f"c{i}") for i, p in enumerate(at))


def walked(graph, sequence, o):
    """Steps beyond the removal and the addition, and the turning."""
    places = [0, *(hold[-1] for hold in sequence.holds), o]
    angles = np.array([turns(graph)[a, b] for a, b in pairwise(places)])
    return int(np.maximum(np.ceil(angles / TURN - 1e-9), 1).sum()) - 2, angles.sum()


def moves_of(sequence, start, goal):
    """From where to where a finger goes while others hold, of each move."""
    at, found = set(start), []
    holds = [frozenset(hold[:-1]) for hold in sequence.holds]
    for held, after in pairwise([*holds, frozenset(goal)]):
        if new := set(after) - at:
            (origin,), (target,) = at - held, new
            found.append((origin, target, held))
            at = {*held, target}
    assert at == set(goal)
    return found


@pytest.mark.parametrize("labelled", [False, True])
@pytest.mark.parametrize("fingers", [3, 4])
def test_the_best_without_barred_moves_is_found(fingers, labelled):
    rng = np.random.default_rng(2 * fingers + labelled)
    seen = {"found": 0, "impossible": 0, "longer": 0, "narrower": 0}
    for _ in range(40):
        graph, stances, start, goal, o, allowed, moves = asked(rng, fingers, labelled)

        def goes(a, b, held, moves=moves):
            return not any(ends <= {a, b} and few <= held for ends, few in moves)

        def least(threshold, goes=goes, **prices):
            return least_cost(graph, start, goal, o, TURN, allowed, threshold, goes=goes, **prices)  # noqa: B023

        free = BarredSearch(stances, start, goal, o, Barred()).preferred()
        found = BarredSearch(stances, start, goal, o, Barred(moves=frozenset(moves))).preferred()
        fewest = least(0.0)
        assert [s.moves for s in found] == ([] if fewest is None else [fewest])
        seen["found" if found else "impossible"] += 1
        for best in found:
            assert all(goes(*move) for move in moves_of(best, start, goal))
            assert len(moves_of(best, start, goal)) == best.moves
            wider = least(best.margin + 2e-6)
            assert wider is None or wider > fewest
            steps, turning = walked(graph, best, o)
            cost = least(best.margin - 1e-7, move=1e3, step=1.0, turn=1e-4)
            assert 1e3 * best.moves + steps + 1e-4 * turning == pytest.approx(cost, abs=1e-5)
            seen["longer"] += best.moves > free[0].moves
            seen["narrower"] += best.moves == free[0].moves and best.margin < free[0].margin - 1e-6
    assert min(seen.values()) >= 1, seen


@pytest.mark.parametrize("fingers", [3, 4])
def test_no_sequence_without_barred_moves_costs_less(fingers):
    rng = np.random.default_rng(9 + fingers)
    weights, seen = RegraspWeights(moves=0.3, turning=0.5, time=0.2), set()
    for _ in range(12):
        graph, stances, start, goal, o, allowed, moves = asked(rng, fingers, False)

        def goes(a, b, held, moves=moves):
            return not any(ends <= {a, b} and few <= held for ends, few in moves)

        stances.look_at_all()
        costs: Costs = weights.costs(graph, stances.margins, 1.0)
        found = BarredSearch(stances, start, goal, o, Barred(moves=frozenset(moves))).cheapest(costs)
        cost = least_cost(graph, start, goal, o, TURN, allowed, 0.0, 0.3, 0.5, costs.step, goes=goes)
        assert bool(found) == (cost is not None)
        seen.add(bool(found))
        for best in found:
            assert all(goes(*move) for move in moves_of(best, start, goal))
            steps, turning = walked(graph, best, o)
            assert 0.3 * best.moves + costs.step * steps + 0.5 * turning == pytest.approx(cost, abs=1e-6)
    assert seen == {True, False}


def test_contacts_that_are_not_together_are_in_no_stance():
    rng = np.random.default_rng(4)
    graph = small_graph(rng, POINTS, 1, 1.0)
    stances = Fingering(graph, TURN)
    free = BarredSearch(stances, (0, 2, 4), (1, 3, 5), 0, Barred()).preferred()[0]
    apart = frozenset((next(iter({*free.holds[1][:2]} & {1, 3, 5})), 4))
    found = BarredSearch(stances, (0, 2, 4), (1, 3, 5), 0, Barred(frozenset([apart]))).preferred()
    for best in found:
        at = {0, 2, 4}
        for origin, target, _ in moves_of(best, (0, 2, 4), (1, 3, 5)):
            at = at - {origin} | {target}
            assert not apart <= at
    never = Barred(frozenset([frozenset([0])]))
    assert BarredSearch(stances, (0, 2, 4), (1, 3, 5), 0, never).preferred() == []
