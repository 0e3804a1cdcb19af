"""Duals of all loads together that were found for some boxes, and which other boxes they exclude."""

from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.tied import Ties
from regrasp.planning.placement.levels.tied_boxes import Corners

_SAFE = 1e-9
_FIRST = 256  # duals that there is room for at the start
_NEAREST = 24  # that are tried


class KnownDuals:
    """Duals, with the places of the boxes that they were found for."""

    def __init__(self, ties: Ties) -> None:
        from regrasp.closed_form.compiled.places.tied_boxes import most_at_corners

        k, loads = ties.fingers, len(ties.deviations) + 1
        self.ties = ties
        self.rows: list[Array] = []
        self._table = (
            np.zeros((_FIRST, loads, k, k, 2, 2)), np.zeros((_FIRST, loads, 2)), np.zeros((_FIRST, 2)),
            np.zeros((_FIRST, 2 * k)),
        )  # fmt: skip
        self._spare = np.zeros((k + 1, k, loads, 2)), np.zeros(k, np.int64), np.zeros(k, np.int64)
        self._search = most_at_corners

    def add(self, duals: Array, places: Array) -> int:
        """Keep duals of a box about these places (k, 2); their number."""
        n = len(self.rows)
        if n == len(self._table[0]):
            self._table = tuple(np.concatenate([a, np.zeros_like(a)]) for a in self._table)  # type: ignore[assignment]
        moves, stills, worked, at = self._table
        moves[n], stills[n] = self.ties.motions(duals)
        worked[n], at[n] = self.ties.worked(duals), places.ravel()
        self.rows.append(duals)
        return n

    def excluding(self, corners: Corners, factor: float) -> int:
        """Duals, of a box near by, by which no places of a box withstand more than a factor; -1 for none."""
        n = len(self.rows)
        away = np.abs(self._table[3][:n] - corners.middle.ravel()).sum(axis=1)
        near = np.argpartition(away, _NEAREST)[:_NEAREST] if n > _NEAREST else np.arange(n)
        near = near[np.argsort(away[near], kind="stable")]
        work, gained = self._table[2][:n].T
        # the most m such that m - work + safe (m + |work|) is the factor times what is gained
        limits = (work + factor * gained - _SAFE * np.abs(work)) / (1 + _SAFE)
        return int(self._run(corners, np.where(gained > 0, limits, -inf), near)[0])

    def factor(self, corners: Corners, n: int) -> tuple[float, np.ndarray]:
        """More than this no places of a box withstand by duals ``n``, and the corner (k,) that tells."""
        work, gained = self._table[2][n].tolist()
        if gained <= 0:
            return inf, np.zeros(len(corners.counts), np.int64)
        _, most = self._run(corners, np.full(len(self.rows), inf), np.array([n]))
        return (most - work + _SAFE * (most + abs(work))) / gained, self._spare[2].copy()

    def _run(self, corners: Corners, limits: Array, some: np.ndarray) -> tuple[int, float]:
        moves, stills, _, _ = self._table
        given = corners.points, corners.rays, corners.counts
        found: tuple[int, float] = self._search(moves, stills, limits, some, *given, *self._spare)
        return found
