"""Margins of pairs of contacts, each at an angle of the object of its own (``pair_margin``)."""

import sys
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.closed_form.pairs.pair_margin import pair_margin
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench

PATIENCE = 100_000
"""Margins of a process that are interpreted, 5 us each: then loading the compiled function pays."""
_asked = 0
_COMPILED = "regrasp.closed_form.compiled.pair_margins"

Pairs = tuple[NDArray[np.int64], NDArray[np.int64]]
"""Places (m,) of the first and the second contacts."""


class Candidates:
    """Contacts as arrays, the load that two of them are to hold, and what limits their forces."""

    def __init__(
        self,
        contacts: tuple[Contact, ...],
        load: Wrench,
        peak_ratio: float,
        one_finger: bool,
        min_normal: float = 0.0,
    ) -> None:
        self.points = np.array([c.position for c in contacts])
        self.normals = np.array([c.normal for c in contacts])
        self.mu = np.array([c.friction for c in contacts])
        self.load, self.peak_ratio, self.one_finger = load.force, float(peak_ratio), one_finger
        self.min_normal = float(min_normal)
        limits = [inf if c.max_force is None else c.max_force for c in contacts]
        self._fingers = np.column_stack([self.points, self.normals, self.mu, limits])

    @property
    def direction(self) -> float:
        """Of the load before the object turns [rad]."""
        return float(np.arctan2(self.load[1], self.load[0]))

    def of(self, places: NDArray[np.int64]) -> tuple[Array, Array, Array]:
        """Positions, normals and frictions of contacts."""
        return self.points[places], self.normals[places], self.mu[places]

    def margins(self, pairs: Pairs, angles: Array) -> Array:
        """(m,) widest least angle margins [rad] with the object at ``angles`` (m,) [rad]; -1 for no hold."""
        c, s = np.cos(angles), np.sin(angles)
        loads = np.stack([c * self.load[0] + s * self.load[1], c * self.load[1] - s * self.load[0]], axis=-1)
        ratio, least, alone = self.peak_ratio, self.min_normal, self.one_finger
        if _is_interpreted(angles.size):
            first, second = (self._fingers[places].tolist() for places in pairs)
            each = zip(first, second, loads.tolist(), strict=True)
            return np.array(
                [pair_margin(one, two, fx, fy, ratio, least, alone) for one, two, (fx, fy) in each]
            )
        from regrasp.closed_form.compiled.pair_margins import pair_margins

        return pair_margins(*pairs, loads, self._fingers, ratio, least, alone)


def _is_interpreted(count: int) -> bool:
    """Whether so many margins more are, by all that the process asked for."""
    global _asked
    _asked += count
    return _asked <= PATIENCE and _COMPILED not in sys.modules
