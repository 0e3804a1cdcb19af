"""The most that a finger does along a twist on stretches of straight edges, in rationals and in doubles."""

from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.forces.eroded import cone_edges, most_eroded, roughly_eroded
from regrasp.verification.placed.protocol import Point, Proof, after_each, velocity
from regrasp.verification.placed.roots import root_above, root_below


class StraightEdges:
    """The edges of a polygon.

    The most of v . f over forces f of size 1, sigma, is convex in v, and v is affine along an edge: the
    largest on a stretch is at one of its ends. 1 / |edge| and roots are rounded up.
    """

    def __init__(self, proof: Proof) -> None:
        self.force, self.mu = proof.size == "force", Fraction(proof.friction)
        self.eroded, self.limit, self.margin = proof.size == "margin", proof.bound, proof.margin
        centre = [Fraction(c) for c in proof.centre_of_mass.tolist()]
        self.points = [
            [Fraction(x) - c for x, c in zip(p, centre, strict=True)] for p in proof.vertices.tolist()
        ]
        ends = after_each(len(self.points), proof.rings)
        self.along: list[list[Fraction]] = [
            [b - a for a, b in zip(p, self.points[q], strict=True)]
            for p, q in zip(self.points, ends.tolist(), strict=True)
        ]
        self.per = [1 / root_below(x * x + y * y) for x, y in self.along]
        self.slant = 1 / root_below(1 + self.mu**2)
        # for what rounding cannot decide
        self._start = np.asarray(proof.vertices - proof.centre_of_mass)
        # of the vertices: less the centre of mass they are rounded, which short sides would not stand
        self._along = np.asarray(proof.vertices)[ends] - proof.vertices
        self._lengths: Array = np.hypot(*self._along.T)
        self._unit = self._along / self._lengths[:, None]
        self._friction = proof.friction

    @property
    def count(self) -> int:
        """How many edges."""
        return len(self.points)

    def lengths(self) -> Array:
        """(k,) of all edges, in doubles [m]."""
        return self._lengths

    def turns_little(self, edge: int, lo: Fraction, hi: Fraction) -> bool:
        """Whether a bound of a stretch is one."""
        return True

    def hull(self, edge: int, lo: Fraction, hi: Fraction) -> list[Point]:
        """Points whose hull contains a stretch, from fraction to fraction of an edge."""
        (ax, ay), (dx, dy) = self.points[edge], self.along[edge]
        return [(ax + t * dx, ay + t * dy) for t in (lo, hi)]

    def outlined(self, edge: int, lo: float, hi: float) -> tuple[Array, Array] | None:
        """(2, 2) the ends of a stretch, and (2, 2) unit clockwise and other edge of its cone, in doubles."""
        (tx, ty), mu = self._unit[edge], self._friction
        edges = np.array([[-ty + mu * tx, tx + mu * ty], [-ty - mu * tx, tx - mu * ty]])
        points = self._start[edge] + np.array([[lo], [hi]]) * self._along[edge]
        return points, edges / np.sqrt(1 + mu * mu)

    def most(self, edge: int, lo: Fraction, hi: Fraction, y: list[Fraction]) -> Fraction:
        """An upper bound of sigma on a stretch, 0 or more."""
        return self.most_along(edge, lo, hi, [velocity(y, p) for p in self.hull(edge, lo, hi)])

    def parts(self, edge: int, lo: Fraction, hi: Fraction, y: list[Fraction]) -> list[Point]:
        """Velocities at the ends of a stretch: the part along the normal, and the size of that across."""
        dx, dy = self.along[edge]
        found = []
        for vx, vy in (velocity(y, p) for p in self.hull(edge, lo, hi)):
            ahead, aside = dx * vy - dy * vx, abs(dx * vx + dy * vy)
            back = ahead / root_above(dx * dx + dy * dy)
            found.append((max(ahead * self.per[edge], back), aside * self.per[edge]))
        return found

    def most_along(self, edge: int, lo: Fraction, hi: Fraction, along: list[Point]) -> Fraction:
        """The same of the most v . f along any of some v."""
        return max(self._sigma(edge, v) for v in along)

    def _sigma(self, edge: int, v: Point) -> Fraction:
        (dx, dy), (vx, vy) = self.along[edge], v
        if self.eroded:
            edges = cone_edges((dx, dy), self.mu)
            return most_eroded(*edges, Fraction(self.limit), Fraction(self.margin), (vx, vy))
        ahead, aside = dx * vy - dy * vx, abs(dx * vx + dy * vy)  # times |edge|
        if self.force and aside < self.mu * ahead:
            return root_above(vx * vx + vy * vy)
        value = max(ahead + self.mu * aside, Fraction(0))
        return value * self.per[edge] * (self.slant if self.force else 1)

    def roughly(self, edges: np.ndarray, lo: Array, hi: Array, y: Array) -> Array:
        """(m,) the largest sigma on stretches along twists (m, 3), 0 or more, in doubles."""
        unit, slant, mu = self._unit[edges], np.sqrt(1 + self._friction**2), self._friction
        tx, ty = unit.T
        if self.eroded:
            inward = np.stack([-ty, tx], axis=1)
            a, b = (inward + mu * unit) / slant, (inward - mu * unit) / slant
            ends = [np.stack(self._moved(edges, t, y), axis=1) for t in (lo, hi)]
            return np.max([roughly_eroded(a, b, self.limit, self.margin, v) for v in ends], axis=0)  # type: ignore[no-any-return]
        vx, vy = self._moved(edges, lo, y)
        # along an edge the part of v ahead is affine, and that aside is the same
        ahead = tx * vy - ty * vx + np.maximum(y[:, 2] * ((hi - lo) * self._lengths[edges]), 0.0)
        aside = np.abs(tx * vx + ty * vy)
        most = ahead + mu * aside
        if self.force:
            most /= slant
            inside = aside < mu * ahead  # and a little around the cone: the whole of v
            most[inside] = np.hypot(ahead[inside], aside[inside])
        return np.maximum(most, 0.0)  # type: ignore[no-any-return]

    def _moved(self, edges: np.ndarray, t: Array, y: Array) -> tuple[Array, Array]:
        """(m,) both velocities of points of edges along twists (m, 3)."""
        px, py = (self._start[edges] + t[:, None] * self._along[edges]).T
        return y[:, 0] - y[:, 2] * py, y[:, 1] + y[:, 2] * px

    def roughly_parts(self, edges: np.ndarray, lo: Array, hi: Array, y: Array) -> list[tuple[Array, Array]]:
        """Of the ends of stretches (m,) the ``parts`` along twists (m, 3), in doubles."""
        tx, ty = self._unit[edges].T
        found = []
        for t in (lo, hi):
            vx, vy = self._moved(edges, t, y)
            found.append((tx * vy - ty * vx, np.abs(tx * vx + ty * vy)))
        return found
