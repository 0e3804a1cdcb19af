"""Twists that show of placements that they hold no load by forces below a limit."""

from itertools import product
from math import inf, sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.laws import LAWS
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sides import Sides

_CLEAR = 1e-7  # of the work of a load, by which a placement fails, so that rationals agree


class Cuts:
    """Which placements on some sides were seen to fail, and by which twist.

    A finger at p of size 1 does at most sigma along a twist; where a load does more than the limit times the
    sum of all sigmas, no forces of fingers at these places balance it.
    """

    def __init__(self, sides: Sides, on: np.ndarray, friction: float, loads: Array, limit: float) -> None:
        self.sides, self.on, self.mu, self.loads, self.limit = sides, on, friction, loads, limit
        self._exact = _Exact(sides, len(on), friction, loads, LAWS["peak"], 0.0, 0.0)
        self.twists, self.numbers = np.zeros((0, 3)), np.zeros(0, int)
        self._work = np.zeros(0)

    def known(self, box: Array) -> tuple[Array, int] | None:
        """A corner of a box (k, 2) that a twist excludes, and the twist's number; None where none does."""
        if not len(self.twists):
            return None
        ends = self._sigma(self.twists, box)  # (m, k, 2)
        # of all corners the one where fingers do least
        over = self._work * (1 - _CLEAR) - self.limit * ends.min(axis=2).sum(axis=1)
        cut = int(over.argmax())
        return (box[np.arange(len(box)), ends[cut].argmin(axis=1)], cut) if over[cut] > 0 else None

    def fails(self, box: Array) -> bool:
        """Whether a corner of a box fails, by a twist so far or by a new one."""
        if self.known(box) is not None:
            return True
        new = [self.add(np.array(corner)) for corner in product(*box)]  # all, for others
        return any(new)

    def add(self, at: Array) -> bool:
        """Whether a placement fails, by a twist of its own, which is kept."""
        norm, number, twist = self._exact.at(self.on, at)
        if not norm > self.limit:
            return False
        work = float(-twist @ self.loads[number])
        most = self._sigma(twist[None], at[:, None])[0, :, 0].sum()
        if not work * (1 - _CLEAR) > self.limit * most:
            return False
        self.twists = np.vstack([self.twists, twist])
        self.numbers, self._work = np.append(self.numbers, number), np.append(self._work, work)
        return True

    def _sigma(self, twists: Array, u: Array) -> Array:
        """(m, k, e) of fingers at (k, e)."""
        edges = self.sides.edges[self.on]
        along = self.sides.vectors[edges]
        t = along / self.sides.lengths[edges][:, None]
        p = self.sides.vertices[edges][:, None] + (u - edges[:, None])[..., None] * along[:, None]
        vx = twists[:, 0, None, None] - twists[:, 2, None, None] * p[..., 1]
        vy = twists[:, 1, None, None] + twists[:, 2, None, None] * p[..., 0]
        tx, ty = t[:, 0, None], t[:, 1, None]
        ahead, aside = tx * vy - ty * vx, np.abs(tx * vx + ty * vy)
        edge = np.maximum(ahead + self.mu * aside, 0.0) / sqrt(1 + self.mu**2)
        result: Array = np.where(aside < self.mu * ahead, np.hypot(vx, vy), edge)
        return result


class _Exact(Search):
    """What single placements need, with the twist that shows it."""

    def at(self, places: np.ndarray, u: Array) -> tuple[float, int, Array]:
        """The norm that a placement needs at least [N], for which load, and the twist."""
        from regrasp.closed_form.compiled.places.placement_search import search, spare

        k = len(u)
        boxes = (
            np.zeros((1, k, 2), np.int64), np.zeros((1, k, 2)), np.zeros(1), np.zeros((1, 3)),
            np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros((1, 2), np.int64),
            np.zeros((1, k, 8)), np.zeros((1, 3)), np.full(1, -1), np.zeros((1, 3)),
        )  # fmt: skip
        boxes[0][0], boxes[1][0] = places[:, None], u[:, None]
        search(
            self._table, self._wanted, self._law(self.friction, self.friction, self.law), inf, 0.0, 0.0, 0.0,
            boxes, np.zeros(8, np.int64), np.array([1, 1, 0]), np.full(1 + 2 * k, inf),
            np.zeros((1, 1 + 2 * k)), 0, spare(k, len(self._wanted)),
        )  # fmt: skip
        twist = boxes[3][0] / [1.0, 1.0, self.sides.size]
        return float(boxes[2][0]) * self.unit, int((-self.loads @ twist).argmax()), twist
