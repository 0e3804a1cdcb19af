"""Fingers that slide along the boundary to where a placement is better, by steps that are halved."""

from collections.abc import Callable
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sides import Sides

Placed = tuple[float, np.ndarray, Array]
"""The value of a placement, of which less is better, and the sides and u of its fingers."""
Value = Callable[[np.ndarray, Array, float], float]
"""Of a placement where it is better than a value given; infinite elsewhere."""
Move = Callable[[Sides, np.ndarray, Array, Array], tuple[np.ndarray, Array]]
"""Where fingers come from places and u some way (k,)."""
_STARTS, _GAINED = 8, 1e-6  # placements, and of a norm, what is worth a step
_WORK, _PLACEMENTS = 400_000, 2000  # norms for one load each, a second or two of a processor; on points
_FIRST, _LAST = 0.125, 1e-4  # steps, as parts of an edge


def slid(
    search: Search, placed: Placed, value: Value, step: float, last: float, ways: Callable[[], Array],
    move: Move | None = None,
) -> Placed:  # fmt: skip
    """The best placement that fingers come to, by steps that are halved where none helps.

    step, last: parts of what ``move`` counts in, of an edge unless given. ways: of all fingers, (w, k) at
    each step.
    """
    move = move or moved
    best, places, u = placed
    while step > last:
        helped = False
        for way in ways():
            on, at = move(search.sides, places, u, step * way)
            if np.array_equal(at, u):
                continue
            found = value(on, at, best)
            if found < inf:
                best, places, u, helped = found, on, at, True
        step *= 1.0 if helped else 0.5
    return best, places, u


def slide_best(search: Search, share: float = 1.0) -> None:
    """Let the best placements of a search that ended early, and of points, slide to where they are better.

    Boxes that are wide lead to placements near their middles, far from the best of each. An interrupt ends
    it, and the search knows (``interrupted``). share: of the work.
    """
    left = int(share * _WORK / len(search.loads))

    def less(places: np.ndarray, u: Array, than: float) -> float:
        nonlocal left
        left -= 1
        norm = search.norm_at(places, u) if left > 0 and search.are_apart(places, u) else inf
        return norm if norm < than * (1 - _GAINED) else inf

    try:
        starts = search.placements()[:_STARTS]
        if left > _PLACEMENTS:
            left -= _PLACEMENTS
            starts += search.on_points()[:_STARTS]
        for placed in sorted(starts, key=lambda placed: placed[0]):
            better = slid(search, placed, less, _FIRST, _LAST, one_by_one(search.fingers))
            if better[0] < search.best:
                search.note(*better)
    except KeyboardInterrupt:
        search.interrupted = True


def one_by_one(fingers: int) -> Callable[[], Array]:
    """Each finger alone, back and ahead."""
    ways: Array = np.repeat(np.eye(fingers), 2, axis=0) * np.tile([-1.0, 1.0], fingers)[:, None]
    return lambda: ways


def moved(sides: Sides, places: np.ndarray, u: Array, way: Array) -> tuple[np.ndarray, Array]:
    """Where fingers come some way along their sides, fractions of edges (k,)."""
    there = [
        sides.moved(int(on), float(at), float(by)) if by else (int(on), float(at))
        for on, at, by in zip(places, u, way, strict=True)
    ]
    return np.array([on for on, _ in there]), np.array([at for _, at in there])


def moved_past(sides: Sides, places: np.ndarray, u: Array, way: Array) -> tuple[np.ndarray, Array]:
    """Where fingers come some way past the ends of their sides, fractions of all of their length (k,)."""
    scale = sides.lengths[sides.edges]
    until = np.cumsum(np.ptp(sides.ends, axis=1) * scale)
    begin = np.append(0.0, until[:-1])
    at = begin[places] + (u - sides.ends[places, 0]) * scale[places] + way * until[-1]
    at %= until[-1]
    on = np.minimum(np.searchsorted(until, at, side="right"), len(until) - 1)
    return on, np.clip(sides.ends[on, 0] + (at - begin[on]) / scale[on], *sides.ends[on].T)
