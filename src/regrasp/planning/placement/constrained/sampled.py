"""Placements of points spread over the sides that may keep constraints, and ways to slide from there."""

from collections.abc import Callable, Iterator
from itertools import combinations
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array, Flags
from regrasp.planning.placement.laws import Law
from regrasp.planning.placement.search import ANY_FORCE, Search
from regrasp.planning.placement.sliding import Placed

May = Callable[[Array, Array], Flags]
"""Which of two points (m, 2) and (m, 2) fingers may be at."""
_POINTS = {2: 160, 3: 48, 4: 20}  # of so many fingers: 5,000 to 17,000 placements
_OF_SAME_EDGES = 2
_GROWING, _MORE = 24, 60  # placements of fewer fingers, and points beside them
_DRAWN = 3  # ways for all fingers at once, drawn at each step, a finger

LARGEST = Law("force", "largest")


def sampled(search: Search, may: May, leaving: float | None) -> list[Placed]:
    """Placements of points that hold the loads, the best first; few of the same edges.

    Fingers are on a few points each, or one more, anywhere on many, beside the best of one finger less.

    Args:
        search: its sides, loads and law.
        may: which of two points (m, 2) and (m, 2) fingers may be at.
        leaving: limit on the forces of those that must hold the loads without some finger [N]; None where
            none has to leave.
    """
    k = search.fingers
    on, u = _points(search, _POINTS[k])
    norms: dict[tuple[int, ...], float] = {}

    def largest(few: tuple[int, ...]) -> float:
        if few not in norms:
            norms[few] = search.norm_at(on[list(few)], u[list(few)], LARGEST)
        return norms[few]

    found: list[Placed] = []
    try:
        for few in _cliques(_allowed(search, may, on, u), k):
            at = list(few)
            if leaving is not None and all(largest(rest) > leaving for rest in combinations(few, k - 1)):
                continue
            found.append((search.norm_at(on[at], u[at]), on[at], u[at]))
        if k > 2:
            found.extend(_grown(search, may, leaving))
    except KeyboardInterrupt:
        search.interrupted = True
    found = sorted((placed for placed in found if placed[0] < inf), key=lambda placed: placed[0])
    taken: dict[tuple[int, ...], int] = {}
    first: list[Placed] = []
    for norm, places, u in found:
        edges = tuple(places)
        taken[edges] = taken.get(edges, 0) + 1
        if taken[edges] <= _OF_SAME_EDGES:
            first.append((norm, places, u))
    return first


def drawn(fingers: int) -> Callable[[], Array]:
    """Ways of each finger alone, ahead and back, and of all at once, drawn at each step."""
    rng, alone = np.random.default_rng(0), np.vstack([np.eye(fingers), -np.eye(fingers)])
    return lambda: np.vstack([alone, rng.uniform(-1, 1, (_DRAWN * fingers, fingers))])


def _grown(search: Search, may: May, leaving: float | None) -> Iterator[Placed]:
    """Placements of one finger more than the best of fewer, where it is allowed beside them."""
    law, limits = (search.law, search.limits) if leaving is None else (LARGEST, ANY_FORCE)
    fewer = Search(
        search.sides, search.fingers - 1, search.friction, search.loads, law, search.apart, search.narrow,
        limits,
    )  # fmt: skip
    on, u = _points(search, _MORE)
    begun = sampled(fewer, may, None)[:_GROWING]
    if fewer.interrupted:
        raise KeyboardInterrupt
    for norm, places, at in begun:
        if leaving is not None and norm > leaving:
            break
        for side, where in zip(on, u, strict=True):
            both_u = np.append(at, where)
            order = np.argsort(both_u, kind="stable")
            both_on, both_u = np.append(places, side)[order], both_u[order]
            points = search.sides.points(both_on, both_u)
            first, second = np.array(list(combinations(range(len(order)), 2))).T
            if search.are_apart(both_on, both_u) and may(points[first], points[second]).all():
                yield search.norm_at(both_on, both_u), both_on, both_u


def _points(search: Search, count: int) -> tuple[np.ndarray, Array]:
    """Sides and u of so many points, evenly spread; of few sides the ends are among them."""
    ends = search.sides.ends
    if 2 * ends.size > count:
        return search.sides.spread(count)
    on, u = search.sides.spread(count - ends.size)
    on, u = np.concatenate([on, np.repeat(np.arange(len(ends)), 2)]), np.concatenate([u, ends.ravel()])
    order = np.argsort(u, kind="stable")
    return on[order], u[order]


def _allowed(search: Search, may: May, on: np.ndarray, u: Array) -> Flags:
    """(n, n) which two points fingers may be at, the first before the second."""
    points = search.sides.points(on, u)
    first, second = np.triu_indices(len(u), 1)
    apart = np.hypot(*(points[first] - points[second]).T) >= search.apart
    first, second = first[apart], second[apart]
    allowed = np.zeros((len(u), len(u)), bool)
    allowed[first, second] = may(points[first], points[second])
    return allowed


def _cliques(allowed: Flags, k: int) -> Iterator[tuple[int, ...]]:
    """Every k points of which each two are allowed."""

    def longer(few: tuple[int, ...], more: Flags) -> Iterator[tuple[int, ...]]:
        if len(few) == k:
            yield few
            return
        for i in map(int, np.flatnonzero(more)):
            yield from longer((*few, i), more & allowed[i])

    return longer((), np.ones(len(allowed), bool))
