"""Placements of points spread over the sides that may keep constraints, and ways to slide from there."""

from collections.abc import Callable, Iterator
from itertools import combinations
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array, Flags
from regrasp.planning.placement.laws import Law
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sliding import Placed

May = Callable[[Array, Array], Flags]
"""Which of two points (m, 2) and (m, 2) fingers may be at."""
_POINTS = {2: 160, 3: 48, 4: 20}  # of so many fingers: 5,000 to 17,000 placements
_OF_SAME_EDGES = 2
_DRAWN = 3  # ways for all fingers at once, drawn at each step, a finger

LARGEST = Law("force", "largest")
_POWER = {"sum": 1.0, "squares": 0.5, "largest": 0.0}  # of k, the norm of k ones


def sampled(
    search: Search,
    may: May,
    limit: float,
    min_normal: float,
    leaving: float | None,
) -> list[Placed]:
    """Placements of points that hold the loads with forces of at most ``limit``, what may be best first.

    Few of the same edges are given. Their norms are about what forces reach that push with ``min_normal`` and
    what friction it allows, and as little as possible on top; those that cannot come last.

    Args:
        search: its sides, loads and law.
        may: which of two points (m, 2) and (m, 2) fingers may be at.
        limit: of every force [N], perhaps infinite.
        min_normal: with which every finger pushes at the least [N].
        leaving: the same of those that must hold the loads without some finger; None where none has to leave.
    """
    k = search.fingers
    on, u = _points(search, _POINTS[k])
    norms: dict[tuple[int, ...], float] = {}

    def largest(few: tuple[int, ...]) -> float:
        if few not in norms:
            norms[few] = search.norm_at(on[list(few)], u[list(few)], LARGEST)
        return norms[few]

    squeezing, (along, across) = search.anew(), min_normal * _pushes(search, on, u)
    found: list[tuple[float, float, np.ndarray, Array]] = []
    for few in _cliques(_allowed(search, may, on, u), k):
        at = list(few)
        if leaving is not None and all(largest(rest) > leaving for rest in combinations(few, k - 1)):
            continue
        norm = search.norm_at(on[at], u[at])
        if norm == inf or (limit < inf and largest(few) > limit):
            continue
        reached = norm
        if min_normal:
            squeezing.under(_pressed(search.loads + along[at].sum(axis=0), across[at].T, search))
            reached = min_normal * k ** _POWER[search.law.norm] + squeezing.norm_at(on[at], u[at])
        found.append((reached, norm, on[at], u[at]))
    found.sort(key=lambda one: one[:2])
    taken: dict[tuple[int, ...], int] = {}
    first: list[Placed] = []
    for reached, _, places, u in found:
        edges = tuple(places)
        taken[edges] = taken.get(edges, 0) + 1
        if taken[edges] <= _OF_SAME_EDGES:
            first.append((reached, places, u))
    return first


def drawn(fingers: int) -> Callable[[], Array]:
    """Ways of each finger alone, ahead and back, and of all at once, drawn at each step."""
    rng, alone = np.random.default_rng(0), np.vstack([np.eye(fingers), -np.eye(fingers)])
    return lambda: np.vstack([alone, rng.uniform(-1, 1, (_DRAWN * fingers, fingers))])


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


def _pushes(search: Search, on: np.ndarray, u: Array) -> Array:
    """(2, n, 3) wrenches of unit forces along the normals of places, and across [N, N m]."""
    contacts = [search.sides.contact(int(side), float(at), 0.0, "F") for side, at in zip(on, u, strict=True)]
    p, n = np.array([c.position for c in contacts]), np.array([c.normal for c in contacts])
    t = n[:, ::-1] * [-1, 1]
    result: Array = np.array([np.column_stack([f, p[:, 0] * f[:, 1] - p[:, 1] * f[:, 0]]) for f in (n, t)])
    return result


def _pressed(loads: Array, across: Array, search: Search) -> Array:
    """Loads (L, 3) after the friction of fingers that push has taken up as much as it may, roughly.

    across: (3, k) wrenches of forces across the normals.
    """
    scale = np.array([1, 1, 1 / search.sides.size])
    shares = np.linalg.lstsq(scale[:, None] * across, -(scale * loads).T, rcond=None)[0]
    result: Array = loads + (across @ np.clip(shares, -search.friction, search.friction)).T
    return result
