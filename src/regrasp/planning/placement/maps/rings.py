"""The closed curves that fingers may be on, one after the other: an outline and perhaps its holes."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import ArrayValue
from regrasp.outline.boundary import Boundary
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.placement.reachable import hole_rings

_AT_CORNER = 1e-9  # of the length


@dataclass(frozen=True, eq=False)
class Rings(ArrayValue):
    """The boundary of an outline, and with ``in_holes`` those of its holes, whose arc lengths go on after it.

    Args:
        shape: the outline.
        in_holes: whether its holes, which are polygons then, count.
    """

    shape: Outline
    in_holes: bool = False

    @cached_property
    def _rings(self) -> tuple[Boundary, ...]:
        holes = hole_rings(self.shape) if self.in_holes else []
        return (self.shape.boundary, *map(PolygonBoundary, holes))

    @cached_property
    def starts(self) -> Array:
        """(r + 1,) arc lengths at which each begins, and where the last ends [m]."""
        return np.cumsum([0.0, *(ring.length for ring in self._rings)])

    @property
    def length(self) -> float:
        """Of all together [m]."""
        return float(self.starts[-1])

    def sample(self, count: int) -> Array:
        """(m,) arc lengths evenly spread, those nearer to a corner than a quarter of the spacing left out."""
        spacing = self.length / count
        s: Array = (np.arange(count, dtype=np.float64) + 0.5) * spacing
        return s[self._to_corners(s) >= max(spacing / 4, 2 * _AT_CORNER * self.length)]

    def at_corner(self, s: Array) -> np.ndarray:
        """(m,) whether arc lengths are those of corners, where no normal is defined."""
        result: np.ndarray = self._to_corners(s) <= _AT_CORNER * self.length
        return result

    def points(self, s: Array, off: Array) -> Array:
        """(m, n, 2) points some ways ``off`` (m, n) from arc lengths (m,) along their rings [m]."""
        on, at = self._on(s), np.zeros((*off.shape, 2))
        for number, ring in enumerate(self._rings):
            here = on == number
            at[here] = ring.points((s[here] - self.starts[number])[:, None] + off[here])
        return at - self.shape.centre_of_mass

    def _on(self, s: Array) -> np.ndarray:
        found: np.ndarray = np.searchsorted(self.starts[:-1], s, "right") - 1
        return found

    def _to_corners(self, s: Array) -> Array:
        """(m,) arc length to the nearest corner of the same ring; infinite where it has none."""
        on, away = self._on(s), np.full(len(s), np.inf)
        for number, ring in enumerate(self._rings):
            here, corners = on == number, ring.corners
            if corners.size:
                at = s[here] - self.starts[number]
                around = np.concatenate([[corners[-1] - ring.length], corners, [corners[0] + ring.length]])
                i = np.searchsorted(around, at)
                last = len(around) - 1
                away[here] = np.minimum(at - around[i - 1], around[np.minimum(i, last)] - at)
        return away
