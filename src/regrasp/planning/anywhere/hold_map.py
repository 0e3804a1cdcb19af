"""The regions of the map of holds on an outline, and which of them regrasps join.

Two holds that share a finger are one exchange apart, so a connected region is one component, and two regions
are in one where their projections on a side overlap.
"""

from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.limits import NONE, Limits
from regrasp.planning.anywhere.polygons import Polygon, hold_polygons, sides_across
from regrasp.planning.anywhere.twists import excluding_twists

TIE = 1e-9
"""Fractions of a side, and of the square of two sides, nearer than this are not told apart."""

MOST_REGIONS, MOST_LINKS = 20_000, 2_000_000
"""Of a map, and pairs of regions that overlap on a side; beyond, the answer is open."""


class TooLarge(Exception):
    """A map of more regions, or of more that overlap, than are kept in memory."""


Place = tuple[int, float]
"""A side of the outline, and the fraction of it passed."""


class Region(NamedTuple):
    """Two fingers on two sides hold the load within a convex polygon of fractions.

    turn: the place of the load's force among those of the map.
    """

    sides: tuple[int, int]
    polygon: Polygon
    turn: int = 0

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
        kept = lengths > TIE  # rounding turns shorter ones
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
    """All regions of a polygon [any unit of length], one friction, and forces in some orientations.

    forces: (k, 2), seen from the object, by its turn. free: (n,) which sides fingers may touch. limits: of
    the fingers' forces, a force limit by ``parts`` tangents within each cone.
    """

    vertices: Array
    friction: float
    forces: Array
    free: np.ndarray
    regions: tuple[Region, ...]
    limits: Limits = NONE

    @classmethod
    def of(
        cls,
        vertices: Array,
        friction: float,
        forces: Array,
        free: np.ndarray | None = None,
        limits: Limits = NONE,
        parts: int = 0,
    ) -> "HoldMap":
        """The map, whose pairs of sides are looked at only where no twist excludes them whole.

        Raises ``TooLarge`` beyond ``MOST_REGIONS``.
        """
        forces = np.reshape(forces, (-1, 2))
        free = np.ones(len(vertices), dtype=np.bool_) if free is None else free
        size = float(np.hypot(*vertices.T).max())
        pairs = np.stack(np.triu_indices(len(vertices)), axis=1)
        pairs = pairs[free[pairs].all(axis=1)]
        none, _ = excluding_twists(
            vertices, friction, forces[[0, -1]], pairs, np.tile([0.0, 1.0, 0.0, 1.0], (len(pairs), 1))
        )
        found: list[Region] = []
        for turn, force in enumerate(forces):
            unit = float(np.hypot(*force))
            rows = partial(limits.per(unit).rows, friction=friction, parts=parts)
            sides = sides_across(vertices / size, friction, (force / unit).tolist(), rows)
            for i, j in pairs[~none].tolist():
                found += [Region((i, j), each, turn) for each in hold_polygons(sides[i], sides[j], TIE)]
                if len(found) > MOST_REGIONS:
                    raise TooLarge
        return cls(vertices, friction, forces, free, tuple(found), limits)

    def spans(self) -> list[tuple[int, float, float, int, int]]:
        """Side, least and largest fraction, region and finger, in rising order."""
        return sorted(
            (region.sides[axis], *region.span(axis), k, axis)
            for k, region in enumerate(self.regions)
            for axis in (0, 1)
        )

    def neighbours(self, overlap: float, turns: int | None = None) -> list[set[int]]:
        """Of every region those that share more than an overlap with it, on some side.

        turns: how many places of the forces the two may be apart; None for any number.

        Raises ``TooLarge`` beyond ``MOST_LINKS``.
        """
        links = 0
        result: list[set[int]] = [set() for _ in self.regions]
        spans = self.spans()
        for k, (side, _, hi, region, _) in enumerate(spans):
            for other_side, lo, top, other, _ in spans[k + 1 :]:
                if other_side != side or lo >= hi - overlap:
                    break
                if other != region and top > lo + overlap and self.is_near(region, other, turns):
                    result[region].add(other)
                    result[other].add(region)
                    links += 1
                    if links > MOST_LINKS:
                        raise TooLarge
        return result

    def is_near(self, region: int, other: int, turns: int | None) -> bool:
        """Whether the forces of two regions are at most so many places apart."""
        return turns is None or abs(self.regions[region].turn - self.regions[other].turn) <= turns

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
