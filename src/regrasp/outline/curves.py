"""The smooth boundaries: periodic splines and ellipses."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.outline.curve import CurveBoundary


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
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.breaks, np.vstack([self.through, self.through[:1]]), bc_type="periodic")

    def at(self, u: Array, order: int = 0) -> Array:
        """(..., 2) the derivative of x of an order 0, 1 or 2."""
        result: Array = self._spline(u, order)
        return result


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
