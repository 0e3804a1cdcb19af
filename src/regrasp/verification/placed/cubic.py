"""The most that a finger does along a twist on parts of cubic curves, in rationals and in doubles.

The part from a to b of a cubic with polar form p is in the hull of p(a, a, a), p(a, a, b), p(a, b, b) and
p(b, b, b); its tangents lie between those of d(a, a), d(a, b) and d(b, b), d the polar form of the
derivative. With n_1 and n_2 the outermost of their normals, what a force of size 1 can be lies

    size |f|:   in the sector between the edges of the cones, the clockwise one of n_1 and the other of n_2
    size n . f: between 0 and the arcs of radius sqrt(1 + mu^2) from either edge of n_1 to the same of n_2

so that the most of v . f over these, with v at the four points, is an upper bound. It is off by the length of
the part; of one twist and forces without limits there is a bound that is off by its square
(``curves.along_parts``), which is less.
"""

from fractions import Fraction
from itertools import pairwise

import numpy as np

from regrasp.mechanics.checks import Array, Flags
from regrasp.verification.placed.curves.along_parts import most_on_part, roughly_on_part
from regrasp.verification.placed.forces.eroded import cone_edges, is_sector, most_eroded, roughly_eroded
from regrasp.verification.placed.protocol import Point, Proof, velocity
from regrasp.verification.placed.roots import root_above, root_below

_SHORTEST = 0.02  # of the longest leg: tangents of less are not judged in doubles


class CubicEdges:
    """The edges of a smooth boundary."""

    def __init__(self, proof: Proof) -> None:
        assert proof.control is not None
        self.force, self.mu = proof.size == "force", Fraction(proof.friction)
        self.eroded, self.limit, self.margin = proof.size == "margin", proof.bound, proof.margin
        centre = [Fraction(c) for c in proof.centre_of_mass.tolist()]
        self.control: list[list[Point]] = [
            [(Fraction(x) - centre[0], Fraction(y) - centre[1]) for x, y in edge]
            for edge in proof.control.tolist()
        ]
        self.slant = root_above(1 + self.mu**2)
        self._friction = proof.friction
        self._control = np.asarray(proof.control - proof.centre_of_mass)
        self._legs = np.diff(proof.control, axis=1)

    @property
    def count(self) -> int:
        """How many edges."""
        return len(self.control)

    def lengths(self) -> Array:
        """(k,) of the longest leg of all edges, in doubles [m]."""
        return np.asarray(np.hypot(self._legs[..., 0], self._legs[..., 1]).max(axis=1))

    def turns_little(self, edge: int, lo: Fraction, hi: Fraction) -> bool:
        """Whether tangents of a stretch are all less than a quarter of a turn from one another."""
        found = self._tangents(edge, lo, hi)
        return all(_dot(a, b) > 0 for a in found for b in found)

    def hull(self, edge: int, lo: Fraction, hi: Fraction) -> list[Point]:
        """Points whose hull contains a stretch, from fraction to fraction of an edge."""
        control = self.control[edge]
        return [_polar(control, at) for at in ((lo, lo, lo), (lo, lo, hi), (lo, hi, hi), (hi, hi, hi))]

    def most(self, edge: int, lo: Fraction, hi: Fraction, y: list[Fraction]) -> Fraction:
        """An upper bound of sigma on a stretch, 0 or more."""
        hull = self.hull(edge, lo, hi)
        most = self.most_along(edge, lo, hi, [velocity(y, p) for p in hull])
        if self.eroded:
            return most
        ends = self._outermost(edge, lo, hi)
        other = most_on_part(hull, self._tangents(edge, lo, hi), ends, self.mu, self.force, y)
        return most if other is None else min(most, other)

    def most_along(self, edge: int, lo: Fraction, hi: Fraction, along: list[Point]) -> Fraction:
        """The same of the most v . f along any of some v."""
        first, last = self._outermost(edge, lo, hi)
        a, b = cone_edges(first, self.mu), cone_edges(last, self.mu)
        limit = Fraction(self.limit) if self.eroded else Fraction(1)
        if self.eroded and is_sector(a[0], b[1]):
            return max(most_eroded(a[0], b[1], limit, Fraction(self.margin), v) for v in along)
        if self.eroded or self.force:
            return limit * max(_on_sector(a[0], b[1], v) for v in along)
        return self.slant * max(max(_on_sector(a[0], b[0], v), _on_sector(a[1], b[1], v)) for v in along)

    def parts(self, edge: int, lo: Fraction, hi: Fraction, y: list[Fraction]) -> list[Point]:
        """Of velocities at the points of the hull the most along any normal, and the most across one."""
        first, last = self._outermost(edge, lo, hi)
        left, right = ((-d[1], d[0]) for d in (first, last))
        back = (-first[0], -first[1]), (-last[0], -last[1])
        return [
            (_most_on_arc(left, right, v), max(_most_on_arc(*arc, v) for arc in ((first, last), back)))
            for v in (velocity(y, p) for p in self.hull(edge, lo, hi))
        ]

    def _outermost(self, edge: int, lo: Fraction, hi: Fraction) -> tuple[Point, Point]:
        """The tangents of a stretch that all others are between, the clockwise one first."""
        found = self._tangents(edge, lo, hi)
        first = next(d for d in found if all(_cross(d, e) >= 0 for e in found))
        return first, next(d for d in found if all(_cross(d, e) <= 0 for e in found))

    def _tangents(self, edge: int, lo: Fraction, hi: Fraction) -> list[Point]:
        control = self.control[edge]
        legs = [(q[0] - p[0], q[1] - p[1]) for p, q in pairwise(control)]
        return [_polar(legs, at) for at in ((lo, lo), (lo, hi), (hi, hi))]

    def roughly(self, edges: np.ndarray, lo: Array, hi: Array, y: Array) -> Array:
        """(m,) the same, of twists (m, 3), in doubles; infinite where rounding may be more."""
        plain, first, last = self._roughly_outermost(edges, lo, hi)
        (a, c), (e, b) = _unit_edges(first, self._friction), _unit_edges(last, self._friction)
        control = np.moveaxis(self._control[edges], 1, 0)
        hull = [polar_at(control, at) for at in ((lo, lo, lo), (lo, lo, hi), (lo, hi, hi), (hi, hi, hi))]
        most = np.full(len(lo), -np.inf if self.eroded else 0.0)
        for p in hull:
            v = np.stack([y[:, 0] - y[:, 2] * p[:, 1], y[:, 1] + y[:, 2] * p[:, 0]], axis=1)
            if self.eroded:
                value = roughly_eroded(a, b, self.limit, self.margin, v)
            elif self.force:
                value = _roughly_on_sector(a, b, v)
            else:
                slant = np.sqrt(1 + self._friction**2)
                value = slant * np.maximum(_roughly_on_sector(a, e, v), _roughly_on_sector(c, b, v))
            most = np.maximum(most, value)
        if not self.eroded:
            ends = first, last
            other = roughly_on_part(
                hull, self._roughly_tangents(edges, lo, hi), ends, self._friction, self.force, y
            )
            most = np.minimum(most, other)
        return np.where(plain, most, np.inf)

    def roughly_parts(self, edges: np.ndarray, lo: Array, hi: Array, y: Array) -> list[tuple[Array, Array]]:
        """Of the points of hulls the ``parts`` along twists (m, 3), in doubles."""
        plain, first, last = self._roughly_outermost(edges, lo, hi)
        left, right = (np.stack([-t[:, 1], t[:, 0]], axis=1) for t in (first, last))
        control = np.moveaxis(self._control[edges], 1, 0)
        found = []
        for at in ((lo, lo, lo), (lo, lo, hi), (lo, hi, hi), (hi, hi, hi)):
            p = polar_at(control, at)
            v = np.stack([y[:, 0] - y[:, 2] * p[:, 1], y[:, 1] + y[:, 2] * p[:, 0]], axis=1)
            ahead = _roughly_on_sector(left, right, v)
            aside = np.maximum(_roughly_on_sector(first, last, v), _roughly_on_sector(-first, -last, v))
            found.append((np.where(plain, ahead, np.inf), np.where(plain, aside, np.inf)))
        return found

    def outlined(self, edge: int, lo: float, hi: float) -> tuple[Array, Array] | None:
        """(4, 2) points whose hull contains a stretch, and (2, 2) clockwise and other edge of all its cones.

        In doubles, the edges of length 1; None where rounding may be more.
        """
        a, b = np.array([lo]), np.array([hi])
        plain, first, last = self._roughly_outermost(np.array([edge]), a, b)
        if not plain[0]:
            return None
        control = self._control[edge][:, None]
        points = [polar_at(control, at)[0] for at in ((a, a, a), (a, a, b), (a, b, b), (b, b, b))]
        (clockwise, _), (_, other) = _unit_edges(first, self._friction), _unit_edges(last, self._friction)
        return np.array(points), np.concatenate([clockwise, other])

    def _roughly_outermost(self, edges: np.ndarray, lo: Array, hi: Array) -> tuple[Flags, Array, Array]:
        """Whether tangents of stretches are far from 0, and the outermost of them, of length 1."""
        d = np.stack(self._roughly_tangents(edges, lo, hi))
        size = np.hypot(d[..., 0], d[..., 1])
        longest = np.hypot(*np.moveaxis(self._legs[edges], -1, 0)).max(axis=1)
        plain = (size > _SHORTEST * longest).all(axis=0)
        unit = d / size[..., None]
        middle = unit.sum(axis=0)
        angle = np.arctan2(_cross_of(middle, unit), (middle * unit).sum(axis=-1))
        rows = np.arange(len(lo))
        first, last = unit[angle.argmin(axis=0), rows], unit[angle.argmax(axis=0), rows]
        return plain, first, last

    def _roughly_tangents(self, edges: np.ndarray, lo: Array, hi: Array) -> list[Array]:
        legs = np.moveaxis(self._legs[edges], 1, 0)
        return [polar_at(legs, pair) for pair in ((lo, lo), (lo, hi), (hi, hi))]


def _polar(points: list[Point], at: tuple[Fraction, ...]) -> Point:
    """The polar form of a polynomial curve with these control points, one parameter after the other."""
    for t in at:
        points = [(p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])) for p, q in pairwise(points)]
    return points[0]


def polar_at(points: Array, at: tuple[Array, ...]) -> Array:
    """The same in doubles, of control points (c, m, 2) at parameters (m,)."""
    for t in at:
        points = points[:-1] + t[:, None] * (points[1:] - points[:-1])
    result: Array = points[0]
    return result


def _dot(a: Point, b: Point) -> Fraction:
    return a[0] * b[0] + a[1] * b[1]


def _cross(a: Point, b: Point) -> Fraction:
    return a[0] * b[1] - a[1] * b[0]


def _along(a: Point, v: Point) -> Fraction:
    """The part of v along a, rounded up, or 0 if that is more."""
    return max(_dot(a, v), Fraction(0)) / root_below(_dot(a, a))


def _most_on_arc(a: Point, b: Point, v: Point) -> Fraction:
    """The most of v . f over f of length 1 from a to b, less than a quarter of a turn, 0 or less too."""
    if _cross(a, v) > 0 and _cross(v, b) > 0 and _dot(a, v) > 0:
        return root_above(_dot(v, v))
    found = []
    for d in (a, b):
        most, size2 = _dot(d, v), _dot(d, d)
        found.append(most / (root_below(size2) if most > 0 else root_above(size2)))
    return max(found)


def _on_sector(a: Point, b: Point, v: Point) -> Fraction:
    """The most of v . f over f of length 1 from a counter-clockwise to b, less than 3/4 of a turn; or 0."""
    narrow = _cross(a, b) > 0 or _dot(a, b) > 0  # less than half a turn
    if (all if narrow else any)((_cross(a, v) > 0, _cross(v, b) > 0)):
        return root_above(_dot(v, v))
    return max(_along(a, v), _along(b, v))


def _cross_of(a: Array, b: Array) -> Array:
    result: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return result


def _unit_edges(t: Array, mu: float) -> tuple[Array, Array]:
    n = np.stack([-t[:, 1], t[:, 0]], axis=1)
    slant = np.sqrt(1 + mu * mu)
    return (n + mu * t) / slant, (n - mu * t) / slant


def _roughly_on_sector(a: Array, b: Array, v: Array) -> Array:
    narrow = (_cross_of(a, b) > 0) | ((a * b).sum(axis=1) > 0.5)  # 1 where it is no turn at all
    after, before = _cross_of(a, v) > 0, _cross_of(v, b) > 0
    edge = np.maximum((a * v).sum(axis=1), (b * v).sum(axis=1))
    inside = np.where(narrow, after & before, after | before)
    result: Array = np.where(inside, np.hypot(*v.T), edge)
    return result
