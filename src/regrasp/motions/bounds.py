"""How near the points of segments and triangles come, by distances that change no faster than points move.

With |d(p) - d(q)| <= |p - q| a piece keeps at least d(c) - R, c a point and R the farthest of its points from
c.
"""

from collections.abc import Callable

import numpy as np

from regrasp.mechanics.checks import Array

Distance = Callable[[Array], Array]
"""(m,) distances [m] of points (m, d) from something."""

_PIECES = 200_000  # looked at before a bound is given up


def least(pieces: Array, distance: Distance, within: float) -> float:
    """A lower bound on the distance of pieces (m, 3, d), segments as triangles with two corners alike [m].

    No more than ``within`` [m] below the least distance; minus infinity where that takes too long.
    """
    best, seen = np.inf, 0
    while len(pieces):
        seen += len(pieces)
        if seen > _PIECES:
            return -np.inf
        centres, radii, halves = _halved(pieces)
        away = distance(centres)
        best = min(best, float(away.min()))
        open_ = away - radii < best - within
        pieces = np.concatenate([half[open_] for half in halves])
    return best - within


def keeps(pieces: Array, distance: Distance, needed: float, finest: float) -> bool:
    """Whether all of the pieces (m, 3, d) keep a distance [m]; no where ``finest`` pieces [m] do not tell."""
    while len(pieces):
        centres, radii, halves = _halved(pieces)
        away = distance(centres)
        if (away < needed).any():
            return False
        open_ = away - radii < needed
        if (radii[open_] < finest).any():
            return False
        pieces = np.concatenate([half[open_] for half in halves])
    return True


def segments(points: Array) -> Array:
    """(k - 1, 3, d) the parts of a polygon (k, d) as pieces."""
    return np.stack([points[:-1], points[1:], points[1:]], axis=1)


def _halved(pieces: Array) -> tuple[Array, Array, tuple[Array, Array]]:
    """The middle of each piece's longest side, the farthest corner from it, and both halves."""
    sides = np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=2)
    row, first = np.arange(len(pieces)), sides.argmax(axis=1)
    a, b, c = (pieces[row, (first + k) % 3] for k in range(3))
    middle = (a + b) / 2
    radii = np.maximum(np.linalg.norm(a - middle, axis=1), np.linalg.norm(c - middle, axis=1))
    halves = np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)
    return middle, radii, halves
