"""The regions of the map of holds on an outline, and which of them regrasps join.

Two holds that share a finger are one exchange apart, so a connected region is one component, and two regions
are in one where their projections on a side overlap.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.polygons import Polygon, hold_polygons, sides_across
from regrasp.planning.anywhere.twists import excluding_twists

TIE = 1e-9
"""Fractions of a side, and of the square of two sides, nearer than this are not told apart."""

Place = tuple[int, float]
"""A side of the outline, and the fraction of it passed."""


class Region(NamedTuple):
    """Two fingers on two sides hold the load within a convex polygon of fractions."""

    sides: tuple[int, int]
    polygon: Polygon

    def span(self, axis: int) -> tuple[float, float]:
        """The projection on one of the sides."""
        values = [p[axis] for p in self.polygon]
        return min(values), max(values)

    def room(self, at: tuple[float, float]) -> float:
        """The distance of a point to the polygon's boundary, negative outside."""
        points = np.array(self.polygon)
        along = np.roll(points, -1, axis=0) - points
        lengths = np.hypot(*along.T)
        away = np.array(at) - points
        kept = lengths > 0
        distance = (along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0])[kept] / lengths[kept]
        return float(distance.min())

    def chord(self, axis: int, value: float) -> tuple[float, float]:
        """The other finger's ends where one finger is at a fraction."""
        found = []
        for p, q in zip(self.polygon, [*self.polygon[1:], self.polygon[0]], strict=True):
            a, b = p[axis], q[axis]
            if a != b and min(a, b) <= value <= max(a, b):
                found.append(p[1 - axis] + (value - a) / (b - a) * (q[1 - axis] - p[1 - axis]))
        return min(found), max(found)


@dataclass(frozen=True)
class HoldMap:
    """All regions of a polygon [any unit of length], one friction and one force."""

    vertices: Array
    friction: float
    force: Array
    regions: tuple[Region, ...]

    @classmethod
    def of(cls, vertices: Array, friction: float, force: Array) -> "HoldMap":
        """The map, whose pairs of sides are looked at only where no twist excludes them whole."""
        size = float(np.hypot(*vertices.T).max())
        pairs = np.stack(np.triu_indices(len(vertices)), axis=1)
        none, _ = excluding_twists(
            vertices, friction, force, pairs, np.tile([0.0, 1.0, 0.0, 1.0], (len(pairs), 1))
        )
        sides = sides_across(vertices / size, friction, (force / np.hypot(*force)).tolist())
        found = [
            Region((i, j), polygon)
            for i, j in pairs[~none].tolist()
            for polygon in hold_polygons(sides[i], sides[j], TIE)
        ]
        return cls(vertices, friction, force, tuple(found))

    def spans(self) -> list[tuple[int, float, float, int, int]]:
        """Side, least and largest fraction, region and finger, in rising order."""
        return sorted(
            (region.sides[axis], *region.span(axis), k, axis)
            for k, region in enumerate(self.regions)
            for axis in (0, 1)
        )

    def neighbours(self, overlap: float) -> list[set[int]]:
        """Of every region those that share more than an overlap with it, on some side."""
        result: list[set[int]] = [set() for _ in self.regions]
        spans = self.spans()
        for k, (side, _, hi, region, _) in enumerate(spans):
            for other_side, lo, top, other, _ in spans[k + 1 :]:
                if other_side != side or lo >= hi - overlap:
                    break
                if other != region and top > lo + overlap:
                    result[region].add(other)
                    result[other].add(region)
        return result

    def at(self, one: Place, other: Place, room: float) -> list[tuple[int, tuple[float, float]]]:
        """Regions that a pair of places is in by more than a room, and where."""
        found = []
        for k, region in enumerate(self.regions):
            for (i, f), (j, g) in ((one, other), (other, one)):
                if region.sides == (i, j) and region.room((f, g)) > room:
                    found.append((k, (f, g)))
                    break
        return found


def flooded(neighbours: list[set[int]], start: set[int]) -> dict[int, int | None]:
    """Regions that are reached, in the order of exchanges, each with the one before it."""
    before: dict[int, int | None] = dict.fromkeys(sorted(start))
    queue = list(before)
    for region in queue:
        for further in sorted(neighbours[region] - before.keys()):
            before[further] = region
            queue.append(further)
    return before
