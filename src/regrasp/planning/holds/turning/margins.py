"""Margins of pairs of contacts, each at an angle of the object of its own.

Where the load's line passes through a contact, its finger can hold the object by itself, and the widest angle
margin is often the one of which the other finger has no part: a finger without force has no angle. Such a
state is no hold of two fingers, unless one may hold alone. In its place stands the state of the widest force
margin, in which both push; where even that leaves one of them without force there is no hold.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.batch import best_squeezes

# A load that passes a contact nearer than this fraction of its distance from the centre passes through it;
# a force below this fraction of the other one is none.
_THROUGH, _IDLE = 1e-11, 2.0**-39
_SPARE = 1e-9  # of limits and margins [rad] after a squeeze was moved

Pairs = tuple[NDArray[np.int64], NDArray[np.int64]]
"""Places (m,) of the first and the second contacts."""


def passes_through(points: Array, loads: Array) -> NDArray[np.bool_]:
    """(m,) whether forces through the origin, (2,) or (m, 2), pass through points (m, 2)."""
    across = abs(points[:, 0] * loads[..., 1] - points[:, 1] * loads[..., 0])
    limits: NDArray[np.bool_] = across <= _THROUGH * np.hypot(*points.T) * np.hypot(*loads.T)
    return limits


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
        self.limits = np.array([inf if c.max_force is None else c.max_force for c in contacts])
        self.load, self.peak_ratio, self.one_finger = load.force, peak_ratio, one_finger
        self.min_normal = min_normal

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
        result, _ = self._best(pairs, loads, "angle")
        if self.one_finger:
            return result
        through = np.zeros(angles.shape, dtype=np.bool_)
        for places in pairs:
            through |= passes_through(self.points[places], loads)
        if through.any():  # one finger could carry the load alone: both are to push
            some = (pairs[0][through], pairs[1][through])
            shared = np.full(int(through.sum()), -1.0)
            for objective in ("force", "angle"):
                widest, work = self._best(some, loads[through], objective)
                shared[work] = widest[work]
            result[through] = shared
        return result

    def _best(self, pairs: Pairs, loads: Array, objective: str) -> tuple[Array, NDArray[np.bool_]]:
        """(m,) margins of the states that are best for an objective, and whether both fingers push."""
        (r1, n1, mu1), (r2, n2, mu2) = (self.of(places) for places in pairs)
        limits = self.limits[pairs[0]], self.limits[pairs[1]]
        x = best_squeezes(
            r1, n1, mu1, r2, n2, mu2, loads, objective=objective, max_force=limits, peak_ratio=self.peak_ratio
        )
        line = r2 - r1
        length = np.hypot(*line.T)
        u = line / length[:, None]
        v = np.stack([-u[:, 1], u[:, 0]], axis=-1)
        b = (r1[:, 0] * loads[:, 1] - r1[:, 1] * loads[:, 0]) / length
        a = -(v * loads).sum(axis=-1) - b
        along = (u * loads).sum(axis=-1)
        if self.min_normal:
            each = [((n * u).sum(axis=-1), (n * v).sum(axis=-1)) for n in (n1, n2)]
            x = _pressing(x, along, a, b, each, self.min_normal)
        y = -x - along
        forces = x[:, None] * u + a[:, None] * v, y[:, None] * u + b[:, None] * v
        sizes = np.stack([np.hypot(*f.T) for f in forces])
        work = sizes > _IDLE * sizes.max(axis=0)
        margin = np.full(x.shape, inf)
        for n, mu, f, working in zip((n1, n2), (mu1, mu2), forces, work, strict=True):
            normal = (n * f).sum(axis=-1)
            across = abs(n[:, 0] * f[:, 1] - n[:, 1] * f[:, 0])
            angle = np.arctan(mu) - np.arctan2(across, normal)
            margin = np.where(working, np.minimum(margin, angle), margin)
        if self.min_normal:  # the best of all states was moved: it may have left the cones or the limits
            peak = self._peaks(pairs, loads)
            most = [np.where(np.isinf(limit), self.peak_ratio * peak, limit) for limit in limits]
            over = np.any(
                [size > limit * (1 + _SPARE) for size, limit in zip(sizes, most, strict=True)], axis=0
            )
            x = np.where(over | (margin < -_SPARE), np.nan, x)
        return np.where(np.isnan(x), -1.0, np.maximum(margin, 0.0)), work.all(axis=0) & ~np.isnan(x)

    def _peaks(self, pairs: Pairs, loads: Array) -> Array:
        """(m,) least peak forces [N], not a number where no state exists."""
        (r1, n1, mu1), (r2, n2, mu2) = (self.of(places) for places in pairs)
        limits = self.limits[pairs[0]], self.limits[pairs[1]]
        x = best_squeezes(r1, n1, mu1, r2, n2, mu2, loads, objective="peak", max_force=limits)
        line = r2 - r1
        length = np.hypot(*line.T)
        u = line / length[:, None]
        b = (r1[:, 0] * loads[:, 1] - r1[:, 1] * loads[:, 0]) / length
        a = u[:, 1] * loads[:, 0] - u[:, 0] * loads[:, 1] - b
        peaks: Array = np.maximum(np.hypot(x, a), np.hypot(x + (u * loads).sum(axis=-1), b))
        return peaks


def _pressing(
    x: Array, along: Array, a: Array, b: Array, normals: list[tuple[Array, Array]], least: float
) -> Array:
    """The squeezes nearest to x (m,) with which both normal forces are at least ``least``; NaN for none.

    The best margin has one peak over the squeeze, so it is there under the two bounds, c x + s a >= least and
    -c (x + along) + s b >= least, with the normals (c, s) along the line and across it.
    """
    (c1, s1), (c2, s2) = normals
    lo, hi = np.full(x.shape, -inf), np.full(x.shape, inf)
    for slope, rest in ((c1, least - s1 * a), (-c2, least + c2 * along - s2 * b)):
        with np.errstate(divide="ignore", invalid="ignore"):
            bound = rest / slope
        lo = np.where(slope > 0, np.maximum(lo, bound), lo)
        hi = np.where(slope < 0, np.minimum(hi, bound), hi)
        lo = np.where((slope == 0) & (rest > 0), inf, lo)
    return np.where((lo <= hi) & (lo < inf) & (hi > -inf), np.minimum(np.maximum(x, lo), hi), np.nan)
