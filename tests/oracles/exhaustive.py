"""Regrasps by exhaustive search: fingers with their points, one of them free, one event at a time.

A state is (points of all fingers; which finger is free; orientation). The free finger moves to another point,
or it presses and another one is freed while the object may turn, or only the object turns. A turn of less
than pi takes as many steps as it has pieces of the largest turn; at both ends all fingers turn it. Three
fingers of pairs in the plane, four of triples in space.
"""

from heapq import heappop, heappush
from itertools import permutations

import numpy as np

import regrasp as rg
from regrasp.planning.holds.pairs import HoldGraph, evenly, named

WEIGHT = rg.Wrench([0, -3.0])


def least_cost(
    graph, start, goal, o, max_turn, allowed=None, threshold=0.0, move=1.0, turn=0.0, step=0.0, worth=None,
    goes=None,
):  # fmt: skip
    """The least cost of a way from a hold of the start to one of the goal; None where there is none.

    worth: (P, O) price of each hold passed. goes: whether a finger may go from a point to another while
    others hold; one that goes presses before it goes on.
    """
    fingers, points, orientations = map(range, (len(start), len(graph.contacts), len(graph.margins)))
    alike = allowed is None
    allowed = np.ones((len(start), len(points)), dtype=bool) if alike else allowed
    among = zip(*graph.pairs, strict=True) if hasattr(graph, "pairs") else graph.triples
    numbers = {frozenset(int(v) for v in hold): p for p, hold in enumerate(among)}
    table = graph.margins.T.tolist()
    prices = None if worth is None else worth.tolist()
    apart = turns(graph).tolist()
    reach = 3.15 if hasattr(graph, "angles") else 3.1415  # half a turn in the plane
    near = [[m for m in orientations if apart[k][m] < reach] for k in orientations]

    def turned(k, m, first=1.0):  # steps and angle of a turn; the first step may be free
        pieces = max(np.ceil(apart[k][m] / max_turn - 1e-9), 1.0)
        return step * (pieces - 1 + first) + turn * apart[k][m]

    def hold(at, free):  # all fingers but the free one
        return numbers[frozenset((*at[:free], *at[free + 1 :]))]

    def holds(at, free, k):
        margin = table[hold(at, free)][k]
        return margin >= threshold and margin >= 0

    def price(at, free, k):
        return 0.0 if prices is None else prices[hold(at, free)][k]

    def named(at, free):  # where it does not matter which finger is which, the free one comes first
        return ((at[free], *sorted(at[:free] + at[free + 1 :])), 0) if alike else (at, free)

    goals = {way for way in permutations(goal) if all(allowed[f, v] for f, v in enumerate(way))}
    queue = [
        (price(start, f, k) + turned(0, k, 0.0), *named(start, f), k)
        for f in fingers
        for k in near[0]
        if holds(start, f, k)
    ]
    queue = [(*state, False) for state in queue]  # whether the free finger has not pressed since it moved
    best = {state[1:]: state[0] for state in queue}
    queue.sort()
    while queue:
        cost, at, free, k, aloft = heappop(queue)
        if cost > best[at, free, k, aloft]:
            continue
        if not at:
            return cost
        following = [(cost + turned(k, o, 0.0), (), free, o, False)] if at in goals and k in near[o] else []
        held = frozenset((*at[:free], *at[free + 1 :]))
        for p in () if aloft else points:
            if allowed[free, p] and p not in at and (goes is None or goes(at[free], p, held)):
                there = (*at[:free], p, *at[free + 1 :])
                following.append((cost + move, *named(there, free), k, goes is not None))
        for next_free in fingers:
            for m in near[k]:
                if (next_free, m) != (free, k) and holds(at, next_free, m):
                    paid = turned(k, m) + price(at, next_free, m)
                    following.append((cost + paid, *named(at, next_free), m, aloft and next_free == free))
        for state in following:
            if state[0] < best.get(state[1:], np.inf):
                best[state[1:]] = state[0]
                heappush(queue, state)
    return None


def turns(graph):
    """(O, O) how far the object turns between orientations, by the directions in which it sees the load."""
    if hasattr(graph, "angles"):
        return abs((graph.angles[:, None] - graph.angles + np.pi) % (2 * np.pi) - np.pi)
    ways = graph.loads[:, :3] / np.linalg.norm(graph.loads[:, :3], axis=1)[:, None]
    half = np.linalg.norm(ways[:, None] - ways, axis=-1), np.linalg.norm(ways[:, None] + ways, axis=-1)
    return 2 * np.arctan2(*half)


def trade_off(graph, start, goal, o, max_turn, allowed=None):
    """[(moves, widest margin)] of the fewest moves, and of more wherever the margin is wider."""
    levels = np.unique(graph.margins[graph.margins >= 0])
    found, low = [], 0
    while low < levels.size:
        threshold = float(levels[low])
        moves = least_cost(graph, start, goal, o, max_turn, allowed, threshold)
        if moves is None:
            break
        high = levels.size  # the last level with as few moves
        while high - low > 1:
            middle = (low + high) // 2
            same = least_cost(graph, start, goal, o, max_turn, allowed, float(levels[middle])) == moves
            low, high = (middle, high) if same else (low, middle)
        found.append((round(moves), float(levels[low])))
        low += 1
    return found


def small_graph(rng, points, orientations=None, share=None):
    outline = rg.Outline.ellipse(1.0, rng.uniform(0.3, 1.0))
    s = np.sort(rng.uniform(0, outline.length, points))
    contacts = named([outline.contact_at(x, friction=rng.uniform(0.4, 3.0)) for x in s.tolist()], "c")
    share = share or rng.uniform(0.15, 0.5)

    def keep(first, second, angle):  # few pairs, so that ways are long
        return rng.random(len(first)) < share

    return HoldGraph(tuple(contacts), WEIGHT, evenly(orientations or int(rng.integers(1, 6))), keep=keep)


def ends_of(rng, graph, o):
    """Three contacts of which two hold at first, and three of which two hold at ``o``, where any do."""
    ends, every = [], range(len(graph.contacts))
    for k in (0, o):
        pairs = np.flatnonzero(graph.margins[k] >= 0)
        held = [int(side[pair]) for pair in rng.choice(pairs, min(pairs.size, 1)) for side in graph.pairs]
        others = [v for v in every if v not in held]
        places = [*held, *rng.choice(others, 3 - len(held), replace=False).tolist()]
        ends.append(tuple(rng.permutation(places).tolist()))
    return ends
