"""Twists that exclude boxes where only forces within limits count.

A finger anywhere on a stretch of a side makes only sums of what it makes at both ends. With corners v and
rays e of its forces there, a twist y excludes the box of two fingers under loads w_k (and all between) if

    y . e >= 0   for all rays,      min_1 y . v + min_2 y . v + min_k y . w_k > 0.

The shortest miss of the equations sum v + sum e + sum w = 0, with weights of both fingers' corners and of
the loads that sum to one each, is such a y, and not zero where no forces solve them.
"""

from math import cos, hypot, inf, sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.hold_map import HoldMap
from regrasp.planning.anywhere.limits import Limits
from regrasp.planning.anywhere.twists import excluding_twists

# Stretches and cones are this much wider where twists are looked for, so that these stand rounding. Room that
# a proof must have, of the load.
_WIDER, _ROOM = 1e-9, 1e-12
_CORNERS = 12
"""Of the outer polygon in the place of an arc where twists are looked for; they are judged with the arc."""


def excluded(holds: HoldMap, sides: np.ndarray, boxes: Array) -> tuple[np.ndarray, Array]:
    """Which boxes (m, 4) of fractions on sides (m, 2) are excluded, (m,), and their twists (m, 3)."""
    sure, twists = excluding_twists(holds.vertices, holds.friction, holds.forces[[0, -1]], sides, boxes)
    if holds.limits:
        finder = _Finder(holds)
        for k in np.flatnonzero(~sure).tolist():
            twist = finder.twist(sides[k].tolist(), boxes[k].tolist())
            if twist is not None:
                sure[k], twists[k] = True, twist
    return sure, twists


class _Finder:
    """In units of the outline's size and of the load."""

    def __init__(self, holds: HoldMap) -> None:
        self.size = float(np.hypot(*holds.vertices.T).max())
        unit = float(np.hypot(*holds.forces[0]))
        self.limits: Limits = holds.limits.per(unit)
        self.mu = holds.friction
        self.vertices = holds.vertices / self.size
        self.loads = np.pad(_around(holds.forces[[0, -1]] / unit), ((0, 0), (0, 1)))
        self.forces, self.rays = _corners(self.limits, self.mu * (1 + _WIDER))

    def twist(self, sides: list[int], box: list[float]) -> Array | None:
        """(3,) that excludes a box; None where none is found."""
        from scipy.optimize import nnls

        columns = [np.hstack([self.loads, np.tile([0.0, 0.0, 1.0], (len(self.loads), 1))])]
        for k, side in enumerate(sides):
            for end, wider in ((box[2 * k], -_WIDER), (box[2 * k + 1], _WIDER)):
                for forces, weight in ((self.forces, 1.0), (self.rays, 0.0)):
                    sums = np.zeros((len(forces), 3))
                    sums[:, k] = weight
                    columns.append(np.hstack([self.wrenches(side, end + wider, forces), sums]))
        table, right = np.concatenate(columns).T, np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
        weights, miss = nnls(table, right)
        if miss <= _ROOM:
            return None
        twist = (table @ weights - right)[:3]
        twist /= np.linalg.norm(twist) or 1.0
        least = sum(
            min(self.least_work(side, end, twist) for end in box[2 * k : 2 * k + 2])
            for k, side in enumerate(sides)
        )
        if least + float((self.loads @ twist).min()) <= _ROOM:
            return None
        result: Array = twist / [1.0, 1.0, self.size]
        return result

    def axes(self, side: int, end: float) -> tuple[Array, Array, Array]:
        """The place, the normal and the tangent."""
        p, q = self.vertices[side], self.vertices[(side + 1) % len(self.vertices)]
        t = (q - p) / hypot(*(q - p))
        return p + end * (q - p), np.array([-t[1], t[0]]), t

    def wrenches(self, side: int, end: float, forces: Array) -> Array:
        """(k, 3) of forces (k, 2) along the normal and the tangent."""
        place, n, t = self.axes(side, end)
        f = forces @ np.array([n, t])
        return np.column_stack([f, place[0] * f[:, 1] - place[1] * f[:, 0]])

    def least_work(self, side: int, end: float, twist: Array) -> float:
        """Of a finger's forces there, along a twist; minus infinity where there is no least."""
        place, n, t = self.axes(side, end)
        way = twist[:2] + twist[2] * np.array([-place[1], place[0]])
        along, aside = float(way @ n), abs(float(way @ t))
        least, most = self.limits
        edge = along - self.mu * aside  # the least along (1, +-mu)
        if most == inf:
            return least * edge if edge >= 0 else -inf
        if most < least * sqrt(1 + self.mu**2):  # the arc ends at the least normal force
            values = [least * along - sqrt(max(most**2 - least**2, 0.0)) * aside]
            on_arc = -most * along >= least * hypot(along, aside)
        else:
            values = [least * edge, most * edge / sqrt(1 + self.mu**2)]
            on_arc = aside <= -self.mu * along
        return min([*values, -most * hypot(along, aside)] if on_arc else values)


def _around(forces: Array) -> Array:
    """Corners around the arc of a load that turns: its ends, and where the tangents there meet."""
    one, other = forces
    if (one == other).all():
        return forces[:1]
    between = (one + other) / (1 + one @ other / (hypot(*one) * hypot(*other)))
    result: Array = np.array([one, other, between])
    return result


def _corners(limits: Limits, mu: float) -> tuple[Array, Array]:
    """Corners (k, 2) and rays (r, 2) around all forces of a finger, along its normal and tangent."""
    least, most = limits
    edges = np.array([[1.0, mu], [1.0, -mu]])
    if most == inf:
        return least * edges, edges
    half = np.arctan(mu)
    if most < least * sqrt(1 + mu**2):
        half = np.arccos(min(least / most, 1.0))
    angles = np.linspace(-half, half, _CORNERS + 1)
    around = most / cos(half / _CORNERS)
    middles = 0.5 * (angles[1:] + angles[:-1])
    arc = np.concatenate(
        [
            most * np.column_stack([np.cos(angles[[0, -1]]), np.sin(angles[[0, -1]])]),
            around * np.column_stack([np.cos(middles), np.sin(middles)]),
        ]
    )
    chord = least * edges if most >= least * sqrt(1 + mu**2) else np.empty((0, 2))
    return np.concatenate([chord, arc]), np.empty((0, 2))
