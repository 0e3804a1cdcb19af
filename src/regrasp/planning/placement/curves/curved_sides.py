"""A smooth boundary as cubic sides on which fingers may be."""

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.outline.curve import CurveBoundary
from regrasp.outline.outline import Outline
from regrasp.planning.placement.sides import Sides

MOST_TURN = 0.3
"""Outermost tangents of a side differ by no more [rad]."""
_MOST_SIDES = 20_000


@dataclass(frozen=True, eq=False)
class CurvedSides(Sides):
    """Stretches of the cubic pieces of a smooth outline, each with little turn.

    Args:
        control: (k, 4, 2) control points of the edges, which are cubics [m].
        outline: whose boundary they are.
    """

    control: Array
    outline: Outline

    @cached_property
    def lengths(self) -> Array:
        """(k,) of the edges [m]."""
        return _speeds_at(self.control, np.polynomial.legendre.leggauss(12))

    @cached_property
    def size(self) -> float:
        """The largest distance of a control point from the centre of mass [m]."""
        return float(np.hypot(*self.control.reshape(-1, 2).T).max())

    def control_points(self) -> Array:
        """(k, 3, 2) of cubic edges, each but the last, which begins the next one."""
        return self.control[:, :3]

    def table(self) -> Array:
        """(m, 17) as the compiled search takes them, lengths in units of ``size``."""
        ends = self.ends - self.edges[:, None]
        control = self.control[self.edges] / self.size
        start, stop = (_at(control, u) for u in ends.T)
        along = (stop - start) / np.diff(ends, axis=1)
        unit = along / np.hypot(*along.T)[:, None]
        at = start - ends[:, :1] * along
        normals = np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        shown = [at, along, normals, self.ends, self.edges.astype(float), control.reshape(-1, 8)]
        return np.column_stack(shown)

    def arc_length(self, side: int, u: float) -> float:
        """Along the boundary, from its start [m]."""
        point = self.points(np.array([side]), np.array([u]))[0]
        return self.outline.nearest(point + self.outline.centre_of_mass)

    def u_at(self, s: float) -> float:
        """The place at an arc length from 0 to the length of the outline [m]."""
        knots, at = self._knots, float(self._boundary.parameter(s))
        edge = min(int(np.searchsorted(knots, at, "right")), len(knots) - 1) - 1
        t = np.array([(at - knots[edge]) / (knots[edge + 1] - knots[edge])])
        control, point = self.control[edge : edge + 1], self.outline.points(s)
        for _ in range(2):  # the pieces of an ellipse are not at its pace
            slope = 3 * _velocity(control, t)[0]
            t = np.clip(t - (_at(control, t)[0] - point) @ slope / (slope @ slope), 0.0, 1.0)
        return edge + float(t[0])

    def moved(self, place: int, u: float, way: float) -> tuple[int, float]:
        """A place some way along the boundary, a fraction of half of it, or at the end of a stretch."""
        there = (u + 0.5 * way * len(self.control)) % len(self.control)
        on = max(int(np.searchsorted(self.ends[:, 0], there, "right")) - 1, 0)
        return on, min(max(there, self.ends[on, 0]), self.ends[on, 1])

    @property
    def _boundary(self) -> CurveBoundary:
        return cast(CurveBoundary, self.outline.boundary)

    @cached_property
    def _knots(self) -> Array:
        return self._boundary.cubics()[0]

    def hull(self, lo: float, hi: float) -> tuple[Array, Array]:
        """(m, 2) points whose hull contains a part, and (m, 2) tangents between whose directions its own are.

        The u may run past the start.
        """
        return self._hull(np.arange(np.floor(lo), max(np.ceil(hi), np.floor(lo) + 1)), lo, hi)

    def part(self, side: int, lo: float, hi: float) -> tuple[Array, Array]:
        """(h, 2) points whose hull contains a part, and (t, 2) unit tangents between which its own are."""
        points, tangents = self._hull(self.edges[side : side + 1], lo, hi)
        return points if lo < hi else points[:1], tangents

    def _hull(self, edges: np.ndarray, lo: float, hi: float) -> tuple[Array, Array]:
        a, b = np.clip(lo - edges, 0.0, 1.0), np.clip(hi - edges, 0.0, 1.0)
        control = self.control[edges.astype(int) % len(self.control)]
        at = ((a, a, a), (a, a, b), (a, b, b), (b, b, b))
        points = np.concatenate([_blossom(control, u, v, w) for u, v, w in at])
        tangents = np.concatenate([_polar(control, u, v) for u, v in ((a, a), (a, b), (b, b))])
        return points, tangents / np.hypot(*tangents.T)[:, None]

    def frames(self, u: Array) -> tuple[Array, Array, Array]:
        """(m, 2) points at places, (m, 2) inward normals, (m,) curvatures, above 0 where convex [1/m]."""
        edge = np.minimum(u.astype(int), len(self.control) - 1)
        control, t = self.control[edge], u - edge
        first = 3 * _velocity(control, t)
        second = 6 * (np.diff(control, n=2, axis=1) * np.stack([1 - t, t], axis=1)[..., None]).sum(axis=1)
        speed = np.hypot(*first.T)
        turning = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        return (
            _at(control, t),
            np.stack([-first[:, 1], first[:, 0]], axis=1) / speed[:, None],
            turning / speed**3,
        )

    def points(self, places: np.ndarray, u: Array) -> Array:
        """(k, 2) of places on sides [m]."""
        edges = self.edges[places]
        return _at(self.control[edges], u - edges)

    def contact(self, side: int, u: float, friction: float, name: str) -> Contact:
        """A finger on a side."""
        edge = int(self.edges[side])
        control, t = self.control[edge : edge + 1], np.array([u - edge])
        tangent = _velocity(control, t)[0]
        return Contact(_at(control, t)[0], [-tangent[1] + 0.0, tangent[0]], friction, name=name)


def curved_sides(outline: Outline, control: Array) -> CurvedSides:
    """All of a smooth outline, its cubics halved until each part turns by ``MOST_TURN`` at most."""
    edges = np.arange(len(control))
    ends = np.stack([edges, edges + 1.0], axis=1)
    while True:
        wide = _turns(control[edges], *(ends - edges[:, None]).T) > MOST_TURN
        if not wide.any():
            break
        if len(edges) > _MOST_SIDES:
            raise InvalidInput("the outline turns too sharply somewhere to be made of sides that turn little")
        middle = ends.mean(axis=1)
        halves = np.stack([ends[:, 0], middle, middle, ends[:, 1]], axis=1).reshape(-1, 2, 2)
        kept = np.where(wide, 2, 1)
        ends = np.concatenate([h if w else e[None] for h, w, e in zip(halves, wide, ends, strict=True)])
        edges = np.repeat(edges, kept)
    return CurvedSides(control[:, 0], edges, ends, control, outline)


def _at(control: Array, t: Array) -> Array:
    """(m, 2) points of cubics (m, 4, 2)."""
    s, t = (1 - t)[:, None], t[:, None]
    p, q, r, e = (control[:, i] for i in range(4))
    result: Array = s**3 * p + 3 * s**2 * t * q + 3 * s * t**2 * r + t**3 * e
    return result


def _blossom(control: Array, u: Array, v: Array, w: Array) -> Array:
    """(m, 2) the polar form of cubics."""
    points = np.moveaxis(control, 1, 0)
    for t in (u, v, w):
        points = points[:-1] + t[:, None] * (points[1:] - points[:-1])
    result: Array = points[0]
    return result


def _velocity(control: Array, t: Array) -> Array:
    """(m, 2) a third of the derivatives of cubics (m, 4, 2)."""
    return _polar(control, t, t)


def _polar(control: Array, u: Array, v: Array) -> Array:
    """(m, 2) the polar form of a third of the derivative."""
    legs = np.diff(control, axis=1)
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v) + v * (1 - u), u * v], axis=1)
    result: Array = (weights[..., None] * legs).sum(axis=1)
    return result


def _speeds_at(control: Array, rule: tuple[Array, Array]) -> Array:
    """(k,) lengths of cubics, by a rule of Gauss and Legendre."""
    total = np.zeros(len(control))
    for at, weight in zip(*rule, strict=True):
        velocity = 3 * _velocity(control, np.full(len(control), 0.5 + 0.5 * at))
        total += 0.5 * weight * np.hypot(*velocity.T)
    return total


def _turns(control: Array, a: Array, b: Array) -> Array:
    """(m,) the angle between the outermost tangents of parts a to b of cubics; pi for more [rad]."""
    tangents = np.stack([_polar(control, u, v) for u, v in ((a, a), (a, b), (b, b))], axis=1)
    middle = tangents.sum(axis=1, keepdims=True)
    across = middle[..., 0] * tangents[..., 1] - middle[..., 1] * tangents[..., 0]
    angles = np.arctan2(across, (middle * tangents).sum(axis=2))
    none = (np.hypot(tangents[..., 0], tangents[..., 1]) == 0.0).any(axis=1)
    result: Array = np.where(none | (abs(angles) > 1.5).any(axis=1), np.pi, np.ptp(angles, axis=1))
    return result
