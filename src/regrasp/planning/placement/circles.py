"""Circles under loads of all directions, where every turn of a placement is as good as it is.

One finger then stays at the beginning of the boundary. Bounds have room for what that is off a circle;
``verify`` says why (``verification.placed.curves.circles``).
"""

from math import comb, inf, sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.curves.curved_sides import CurvedSides
from regrasp.planning.placement.search import Search

_SAME = 1e-12  # of loads
_ROUNDING = 1e-14
_MOST, _LOST = 0.1, 8.0  # of a tolerance, that a boundary is off a circle; of that, what bounds lose


class TurnedSearch(Search):
    """A search whose first finger stays.

    play: by which turns change the boundary, as a fraction of its size.
    """

    turned = True

    def __init__(self, search: Search, play: float) -> None:
        super().__init__(
            search.sides, search.fingers, search.friction, search.loads, search.law, search.apart,
            search.narrow,
        )  # fmt: skip
        self.play = play
        arcs, ends = self._boxes[:2]
        arcs[0, 0], ends[0, 0] = 0, self.sides.ends[0, 0]
        self._least = max(self._least - 2 * play, 0.0)

    def anew(self, friction: float | None = None) -> Search:
        """Of the same first finger."""
        return TurnedSearch(super().anew(friction), self.play)

    def _proven(self, bounds: Array, boxes: np.ndarray) -> Array:
        """What twists prove of all circles that are so near."""
        y = self._boxes[3][boxes]
        fingers = {"sum": 1.0, "largest": self.fingers, "squares": sqrt(self.fingers)}[self.law.norm]
        more = fingers * self.play * (1 + self.friction) * np.abs(y).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = 1 / (1 / bounds + more / (self._wanted[self._boxes[4][boxes]] * y).sum(axis=1))
        return np.where(bounds > 0, found, 0.0)


def up_to_turns(search: Search, load: Wrench | LoadSet, tolerance: float) -> tuple[Search, float]:
    """A search whose first finger stays, and its tolerance, where all turns are alike; else as they were."""
    play = _play(search, load)
    if not play < _MOST * tolerance:
        return search, tolerance
    return TurnedSearch(search, play), tolerance - _LOST * play


def _play(search: Search, load: Wrench | LoadSet) -> float:
    """By how much turns change the boundary, infinite where they change loads; as ``verify`` has it."""
    sides, loads = search.sides, search.loads
    whole = isinstance(sides, CurvedSides) and float(np.diff(sides.ends).sum()) == len(sides.vertices)
    if not whole or not isinstance(load, LoadSet) or load.vertices is not None:
        return inf
    forces = np.hypot(loads[:, 0], loads[:, 1])
    if not np.ptp(forces) <= _SAME * forces.max() or np.ptp(loads[:, 2]) or len(loads) < 3:
        return inf
    control = sides.control / sides.size  # type: ignore[attr-defined]
    legs = np.diff(control, axis=1)
    squares, along = _product(control, control, False), _product(control, legs, False)
    across, least = _product(control, legs, True).min(), squares.min()
    if not (across > 0 and least > 0):
        return inf
    play = np.ptp(squares) / (2 * least) + 2 * np.abs(along).max() / across
    return float(play) + _ROUNDING / float(across)


def _product(ps: Array, qs: Array, across: bool) -> Array:
    """The Bernstein coefficients of scalar products of curves (e, m, 2) and (e, n, 2), or of vector ones."""
    m, n = ps.shape[1] - 1, qs.shape[1] - 1
    found = np.zeros((len(ps), m + n + 1))
    for i in range(m + 1):
        for j in range(n + 1):
            p, q = ps[:, i], qs[:, j]
            value = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] if across else (p * q).sum(axis=1)
            found[:, i + j] += comb(m, i) * comb(n, j) / comb(m + n, i + j) * value
    return found
