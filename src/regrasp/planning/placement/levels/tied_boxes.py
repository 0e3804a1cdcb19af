"""Boxes of groups of edges as corners: where each finger may be, and between which rays its forces are."""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import prod

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.curves.curved_sides import CurvedSides
from regrasp.planning.placement.sides import Sides

MOST_CORNERS = 4096
"""Of a box that is bounded."""
MOST_CUTS = 8
"""Parts of sides on curves, if there is room for their corners."""
_HULL = 4  # control points of an arc of a curve
_OPEN = 1e-9


@dataclass(frozen=True)
class Corners:
    """Where each finger may be: points whose hull contains an edge, or a part of one, with its rays.

    Args:
        points: (k, T, 2) in units of the size.
        rays: (k, T, 2, 2) clockwise and other edge of all forces there, of length 1.
        u: (k, T) about where that is.
        counts: (k,) how many of them count.
    """

    points: Array
    rays: Array
    u: Array
    counts: np.ndarray

    def at(self, places: np.ndarray) -> tuple[Array, Array, Array]:
        """(C, k, 2) points, (C, k, 2, 2) rays and (C, k) u of corners (C, k)."""
        fingers = np.arange(len(self.counts))
        return self.points[fingers, places], self.rays[fingers, places], self.u[fingers, places]

    @property
    def middle(self) -> Array:
        """(k, 2)."""
        result: Array = self.points.sum(axis=1) / self.counts[:, None]
        return result

    @property
    def outermost(self) -> np.ndarray:
        """(2^k, k) the corners at the ends of all arcs."""
        ends = np.indices([2] * len(self.counts)).reshape(len(self.counts), -1).T
        result: np.ndarray = ends * (self.counts - 1)
        return result


class Boxes:
    """What boxes of a search are in corners.

    friction: of all fingers.
    """

    def __init__(self, sides: Sides, friction: float) -> None:
        self.sides, self.friction = sides, friction
        self._kept = lru_cache(maxsize=4096)(self._edge)

    def stretches(self, arc: np.ndarray, ends: Array) -> list[tuple[int, float, float]]:
        """Side, least and largest u of each side of an arc."""
        first, last = arc.tolist()
        found = [(j, *self.sides.ends[j].tolist()) for j in range(first, last + 1)]
        found[0] = first, float(ends[0]), found[0][2]
        found[-1] = last, found[-1][1], float(ends[1])
        return found

    def corners(self, arcs: np.ndarray, ends: Array) -> Corners | None:
        """Those of a box; None for too many, and where forces are in half of all directions and more."""
        k, many = len(arcs), prod((arcs[:, 1] - arcs[:, 0] + 1).tolist())
        curved = isinstance(self.sides, CurvedSides)
        room = MOST_CORNERS / many / (_HULL if curved else 2) ** k
        if room < 1:
            return None
        cuts = min(int(room ** (1 / k) * (1 + _OPEN)), MOST_CUTS) if curved else 1
        on = [self.stretches(*each) for each in zip(arcs, ends, strict=True)]
        parts = [[self._kept(*each) for side in sides for each in _cut(side, cuts)] for sides in on]
        counts = np.array([sum(len(points) for points, _, _ in each) for each in parts])
        most = int(counts.max())
        points, rays, u = np.zeros((k, most, 2)), np.zeros((k, most, 2, 2)), np.zeros((k, most))
        for i, each in enumerate(parts):
            for values, own in zip((points, rays, u), zip(*each, strict=True), strict=True):
                values[i, : counts[i]] = np.concatenate(own)
        first, last = rays[:, :, 0], rays[:, :, 1]
        across = first[..., 0] * last[..., 1] - first[..., 1] * last[..., 0]
        wide = (across <= 0) & ((first * last).sum(axis=2) <= 0)
        if (wide & (np.arange(most) < counts[:, None])).any():
            return None
        return Corners(points, rays, u, counts)

    def _edge(self, side: int, lo: float, hi: float) -> tuple[Array, Array, Array]:
        points, tangents = self.sides.part(side, lo, hi)
        count = len(points)
        rays = np.broadcast_to(_rays(tangents, self.friction), (count, 2, 2))
        return points / self.sides.size, rays, np.linspace(lo, hi, count)


def _cut(side: tuple[int, float, float], cuts: int) -> list[tuple[int, float, float]]:
    j, lo, hi = side
    if lo == hi:
        return [side]
    at = np.linspace(lo, hi, cuts + 1).tolist()
    return [(j, a, b) for a, b in pairwise(at)]


def _rays(tangents: Array, friction: float) -> Array:
    """(2, 2) clockwise and other edge of all cones between those of some tangents."""
    x, y = tangents.sum(axis=0)
    turned = np.arctan2(x * tangents[:, 1] - y * tangents[:, 0], tangents @ [x, y])
    outer = tangents[[turned.argmin(), turned.argmax()]]
    edges = outer[:, ::-1] * [-1, 1] + outer * [[friction], [-friction]]
    result: Array = edges / np.hypot(*edges.T)[:, None]
    return result
