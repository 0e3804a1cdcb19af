"""Climbing to the best level: placements found raise it, and boxes are excluded until none is left."""

from collections.abc import Callable, Sequence
from math import inf, nan

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.level import SURE, Level
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed, moved, one_by_one, slid

_STRICT = 1e-9  # of the limit, by which excluded boxes must be above it
_SETTLING, _NEARER = 24, 4  # how often the way to the top is halved, and the steps of each half
_LATE, _STARTS = 1024, 3  # boxes without a placement that holds, after which so many near to it slide
_FIRST, _LARGEST, _SHORTEST, _NEAR = 0.125, 0.5, 1e-5, 1e-4  # steps of slides, as parts of an edge
_GAPS = (0.03,)  # proven on the way, while less is asked; more of them cost half of the boxes again
_SLOW = 1e-5  # of a level, the least gain of one


def run_level(
    search: Search, level: Level, tolerance: float, most: int, progress: Progress | None
) -> tuple[float | None, float]:
    """The best level found, None where no placement was, and a level that no placement is beyond.

    ``search`` is left at that level, which its boxes exclude where it is ``closed``; where it was cut short
    it is the largest there is.
    """
    due, before = _LATE, 0
    best: float | None = None
    aim, top = level.start, level.top(search)
    gaps, passed = [t for t in _GAPS if t > tolerance], list[float]()
    fixed = level.max_force * (1 + _STRICT)
    level.put(search, aim)
    try:
        while not search.interrupted and (best is None or aim < top):
            if not (search.goes_on(fixed, 0.0, most) or search.best <= level.max_force):
                if best is None or not (search.closed and gaps):
                    break
                # nothing is that much better; boxes go on from there to what is left to be asked
                passed.append(aim)
                gaps.pop(0)
                aim = next_level(level, best, gaps, tolerance, top)
                level.put(search, aim)
                search.reopen()
            at = search.found if search.best <= level.max_force else None
            if at is None and search.count >= due:
                at = _slid_below(search, level.max_force, search.tried_since(before)[:_STARTS])
                due, before = search.count + max(_LATE, search.count // 4), search.tries
            if at is not None:
                due, before = search.count + _LATE, search.tries
                reached, places, u = improved(search, level, aim, *at)
                best = reached if best is None else max(best, reached)
                aim = next_level(level, best, gaps, tolerance, top)
                level.put(search, aim)
                search.forget(reached, places, u)
                if search.interrupted:
                    raise KeyboardInterrupt
                if aim >= top:
                    break
            if progress is not None:
                progress(level.value(top), nan if best is None else level.value(best))
    except KeyboardInterrupt:
        search.closed, search.interrupted = False, True
    if best is None:
        search.closed = search.closed and search.excluded(search.left, fixed) == len(search.left)
        return best, aim
    try:
        beyond = settled(search, level, aim, fixed, passed)
    except KeyboardInterrupt:
        search.closed, search.interrupted, beyond = False, True, top
    return best, beyond


def next_level(level: Level, best: float, gaps: list[float], tolerance: float, top: float) -> float:
    """The level to exclude, of the first gap that leaves one below the largest; others are dropped."""
    while gaps and level.beyond(best, gaps[0]) >= top:
        gaps.pop(0)
    return level.beyond(best, (*gaps, tolerance)[0])


def settled(search: Search, level: Level, aim: float, fixed: float, passed: Sequence[float] = ()) -> float:
    """A level at which boxes that are left, too small to be split or not looked at, are excluded, too.

    passed: levels that were closed, or nearly, before.
    """
    left, top = search.left, level.top(search)
    if aim >= top:
        return aim
    reached, search.closed = first_that_excludes(
        outward(aim, top, passed),
        left,
        lambda at: level.put(search, at),
        lambda boxes: search.excluded(boxes, fixed),
    )
    return reached


def outward(aim: float, top: float, passed: Sequence[float] = ()) -> list[float]:
    """Levels from an aim to the top, in steps that grow with the way, and those between that were passed."""
    steps = (1 + np.arange(_NEARER) / _NEARER) * 0.5 ** np.arange(_SETTLING, 0, -1)[:, None]
    return sorted({aim, *(p for p in passed if aim < p < top), *(aim + steps.ravel() * (top - aim)), top})


def first_that_excludes(
    levels: list[float],
    boxes: np.ndarray,
    put: Callable[[float], None],
    excluded: Callable[[np.ndarray], int],
) -> tuple[float, bool]:
    """The first of rising levels at which all boxes are excluded, else the last; and whether they are there.

    put: go to a level. excluded: how many boxes it excludes before one that it does not. What is excluded at
    a level is at those beyond it, too, by twists of its own: so each box is looked at once or twice.
    """
    done = below = 0
    for reached in levels:
        put(reached)
        below, done = done, done + excluded(boxes[done:])
        if done == len(boxes):
            break
    return reached, done == len(boxes) and excluded(boxes[:below]) == below


def improved(
    search: Search, level: Level, known: float, places: np.ndarray, u: Array
) -> tuple[float, np.ndarray, Array]:
    """The best level of a placement and of those that fingers find by sliding along the boundary.

    Not where forces are least: that may be beside a place where cones end, and the level with them. Ways to
    slide turn to where the last ones have led (Rosenbrock), since a ridge is along no finger alone. An
    interrupt ends it, and the search knows (``interrupted``).
    """
    best, step, ways = level.reached(search, known, places, u), _FIRST, np.eye(len(u))
    found = best, places, u
    try:
        while step > _SHORTEST:
            before = u
            for way in (sign * step * way for way in ways for sign in (-1, 1)):
                on, there = moved(search.sides, places, u, way)
                level.put(search, level.beyond(best, _SLOW))
                if not search.holds(on, there, level.max_force * (1 - SURE)):
                    continue
                reached = level.reached(search, best, on, there)
                if reached > best:
                    best, places, u = found = reached, on, there
            gone = u - before
            if np.count_nonzero(gone) > 1:
                ways = np.linalg.qr(np.column_stack([gone, np.eye(len(u))]))[0].T
            step = min(2 * step, _LARGEST) if gone.any() else 0.5 * step
    except KeyboardInterrupt:
        search.interrupted = True
    return found


def _slid_below(search: Search, norm: float, starts: list[Placed]) -> tuple[np.ndarray, Array] | None:
    """Where the first of some placements comes that reaches a norm by sliding; None where none does."""

    def less(places: np.ndarray, u: Array, than: float) -> float:
        found = search.norm_at(places, u, most=than)
        return found if found < than and search.are_apart(places, u) else inf

    for _, places, u in starts:
        start = search.norm_at(places, u), places, u
        found, *at = slid(search, start, less, _FIRST, _NEAR, one_by_one(len(u)))
        if found <= norm:
            return at[0], at[1]
    return None
