"""The smooth boundaries: periodic splines and ellipses."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.splines.periodic import PeriodicSpline
from regrasp.outline.curve import CurveBoundary

_PIECES = 160  # the best cubic is off a circle by 2.7e-4 (4 / pieces)^6


@dataclass(frozen=True, eq=False)
class SplineBoundary(CurveBoundary):
    """The periodic cubic spline through ``through`` (k, 2) [m], its knots apart as the points are."""

    through: Array

    @cached_property
    def breaks(self) -> Array:
        """(k + 1,) lengths of the polygon of points [m]."""
        chords = np.hypot(*(np.roll(self.through, -1, axis=0) - self.through).T)
        return np.concatenate([[0.0], np.cumsum(chords)])

    @cached_property
    def _spline(self) -> PeriodicSpline:
        return PeriodicSpline(self.breaks, self.through)

    def at(self, u: Array, order: int = 0) -> Array:
        """(..., 2) the derivative of x of an order 0, 1 or 2."""
        result: Array = self._spline(u, order)
        return result

    def cubics(self) -> tuple[Array, Array]:
        """The pieces between points."""
        return self.breaks, _from_ends(self, self.breaks, np.diff(self.breaks) / 3)


@dataclass(frozen=True, eq=False)
class EllipseBoundary(CurveBoundary):
    """The ellipse of half axes ``axes`` (2,) along x and y about ``centre`` (2,) [m], begun at its +x end."""

    axes: Array
    centre: Array

    @property
    def breaks(self) -> Array:
        """(9,) angles [rad]."""
        return np.linspace(0, 2 * np.pi, 9)

    def at(self, u: Array, order: int = 0) -> Array:
        """(..., 2) the derivative of x of an order 0, 1 or 2."""
        turned = np.asarray(u) + order * np.pi / 2
        around = self.axes * np.stack([np.cos(turned), np.sin(turned)], axis=-1)
        result: Array = around if order else self.centre + around
        return result

    def cubics(self) -> tuple[Array, Array]:
        """160 pieces, off the ellipse by less than 1e-13 of the larger half axis."""
        angles: Array = np.linspace(0, 2 * np.pi, _PIECES + 1)
        arms: Array = np.full(_PIECES, 4 / 3 * np.tan(np.pi / (2 * _PIECES)))
        return angles, _from_ends(self, angles, arms)


def _from_ends(curve: CurveBoundary, u: Array, arm: Array) -> Array:
    """(k, 4, 2) control points of cubics between curve points at u (k + 1,), of velocities times ``arm``."""
    points, velocities = curve.at(u), curve.at(u, 1)
    points[-1] = points[0]
    out, back = arm[:, None] * velocities[:-1], arm[:, None] * velocities[1:]
    return np.stack([points[:-1], points[:-1] + out, points[1:] - back, points[1:]], axis=1)
