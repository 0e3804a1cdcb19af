"""Words beside points that keep clear of one another."""

from math import cos, radians, sin

import numpy as np

from regrasp.mechanics.checks import Array, ArrayLike

# Other directions that are tried, from the one wanted [deg].
_ASIDE = (0, 35, -35, 70, -70, 110, -110, 150, -150)
# Width of a letter and height of a line, as fractions of the font size.
_LETTER, _LINE = 0.58, 1.25

Box = tuple[float, float, float, float]
"""Left, bottom, right and top [pt]."""


class Labels:
    """Directions for labels in one panel, so that none covers another one or a point.

    points_per_unit: [pt] on paper of a unit of the data. gap: between a point and its label [pt].
    """

    def __init__(self, points_per_unit: float, gap: float) -> None:
        self.scale, self.gap, self.taken = points_per_unit, gap, list[Box]()

    def occupy(self, at: ArrayLike, radius: float) -> None:
        """Keep labels away from a disc of a radius, both in units of the data."""
        x, y = self.scale * np.asarray(at, dtype=float)
        r = self.scale * radius
        self.taken.append((x - r, y - r, x + r, y + r))

    def direction(self, text: str, at: ArrayLike, wanted: Array, size: float) -> Array:
        """(2,) the direction nearest to the one wanted where a text of this size [pt] is clear of others.

        Where none is, the one that covers least. The place is then taken.
        """
        unit = wanted / (np.hypot(*wanted) or 1.0)
        ways = [
            np.array([cos(a) * unit[0] - sin(a) * unit[1], sin(a) * unit[0] + cos(a) * unit[1]])
            for a in map(radians, _ASIDE)
        ]
        boxes = [self._box(text, at, way, size) for way in ways]
        covered = [sum(_overlap(box, other) for other in self.taken) for box in boxes]
        best = covered.index(min(covered))
        self.taken.append(boxes[best])
        return ways[best]

    def _box(self, text: str, at: ArrayLike, way: Array, size: float) -> Box:
        """Where ``note`` draws a text: beside the point, above or below it."""
        width, height = _LETTER * size * len(text), _LINE * size
        x, y = self.scale * np.asarray(at, dtype=float) + self.gap * way
        left = x if way[0] > 0.4 else x - width if way[0] < -0.4 else x - width / 2
        bottom = y if way[1] > 0.4 else y - height if way[1] < -0.4 else y - height / 2
        return left, bottom, left + width, bottom + height


def _overlap(a: Box, b: Box) -> float:
    """The common area of two boxes [pt^2]."""
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    return max(width, 0.0) * max(height, 0.0)
