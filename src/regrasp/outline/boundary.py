"""A closed curve by arc length: what an outline asks of its boundary."""

from typing import Protocol

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike


class Boundary(Protocol):
    """A closed curve run counter-clockwise, by arc length s modulo its length; it compares and hashes."""

    @property
    def length(self) -> float:
        """[m]."""

    @property
    def corners(self) -> Array:
        """(k,) arc lengths where the tangent jumps."""

    @property
    def moments(self) -> tuple[float, Array]:
        """Area [m^2] and centroid (2,) [m] of the region inside."""

    @property
    def second_moment(self) -> float:
        """The integral of the squared distance to the centroid over the region inside [m^4]."""

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths."""

    def tangents(self, s: ArrayLike) -> Array:
        """(..., 2) unit tangents; at a corner that of the stretch after it."""

    def nearest(self, point: Array) -> float:
        """The arc length of the point nearest to ``point`` (2,)."""

    def polygon(self, tolerance: float) -> Array:
        """(k, 2) vertices on the curve, whose chords are nowhere farther than ``tolerance`` [m] from it."""


def check_arcs(arcs: Array, length: float, what: str) -> None:
    """``InvalidInput`` unless arc lengths (k, 2) are of an outline of a length, once around at most.

    Arcs may begin before the first vertex and end past it; one of 99 on an outline of 4 is in another unit.
    """
    beyond = arcs[(np.abs(arcs - length / 2) > 1.5 * length * (1 + 1e-9)).any(axis=1)]
    if len(beyond):
        lo, hi = beyond[0].tolist()
        raise InvalidInput(
            f"{what} must be arc lengths of an outline of length {length:.6g}, from {-length:.6g} to "
            f"{2 * length:.6g}, got ({lo:.6g}, {hi:.6g}); are they in its unit?"
        )
    longer = arcs[arcs[:, 1] - arcs[:, 0] > length * (1 + 1e-9)]
    if len(longer):
        lo, hi = longer[0].tolist()
        raise InvalidInput(
            f"{what} must go once around at most, {length:.6g}, got ({lo:.6g}, {hi:.6g}), {hi - lo:.6g} long"
        )
