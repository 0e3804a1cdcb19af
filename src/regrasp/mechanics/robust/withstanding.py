"""By how much a set of load deviations may be scaled before a finger slips, opens or exceeds its limit.

Forces f change by R d (``stiffness``). With e scaled by s beside members d of a set that stays, f + R (d + s
e) is inside the cone of friction mu and within the limit L for all members exactly where, for unit vectors u,

    g . f >= sigma(-R' g)        with g = mu n - u, u across n, besides
    L - u . f >= sigma(R' u)     for all u,
    b - a . f >= sigma(R' a)     for each linear limit a . f <= b,

sigma(y) = sigma_D(y) + s sigma_S(y) the most work of members along y. The factor is the least ratio.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.cones import Cones
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import LimitRows
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.spheres import least_over
from regrasp.mechanics.wrench import Wrench

SLIPS, OPENS, EXCEEDS = "slips", "opens", "exceeds its limit"

_OPEN = 1e-6  # of the normal force before: what is left counts as none
_NOTHING = 1e-14
_STARTS = 8  # a ratio may be least at several twists
_LEAST_FRICTION = 2.0**-40
"""Doubles do not express a direction more finely: less friction than that is none."""


class Worst(NamedTuple):
    """The least ratio of each contact (n,), the deviation that reaches it, and how the finger then fails."""

    factors: Array
    deviations: list[Wrench | None]
    hows: list[str]

    @property
    def first(self) -> int:
        """Whose is least."""
        return int(self.factors.argmin())


@dataclass(frozen=True)
class Withstanding:
    """Forces that answer with stiffness.

    forces: (n, w) and responses: (n, w, q) as the cones measure them. frictions, limits: (n,), infinite for
    none. rows: linear limits. base: a set that is withstood besides, whatever else is scaled; None for none.
    """

    cones: Cones
    forces: Array
    responses: Array
    frictions: Array
    limits: Array
    base: LoadSet | None = None
    rows: LimitRows | None = None

    def factors(self, scaled: LoadSet) -> Worst:
        """How far ``scaled``, around no load, may be scaled; below 0 where ``base`` fails."""

        def ratio(room: Array, twists: Array) -> Array:
            work = scaled.support(twists)
            known = work > _NOTHING * (np.abs(twists) @ _reach(scaled))
            most: Array = np.divide(room, work, out=np.full(room.shape, inf), where=known)
            most[~known & (room < -_NOTHING * np.abs(self.forces).max())] = -inf
            return most

        def member(twist: Array, factor: float) -> Array:
            result: Array = factor * scaled.extreme(twist).vector
            return result

        return self.worst(ratio, member, _STARTS)

    def worst(
        self,
        measure: Callable[[Array, Array], Array],
        member: Callable[[Array, float], Array],
        starts: int = 1,
    ) -> Worst:
        """The least ``measure`` of room (n, m) and twists (n, m, q) along which deviations work, by contact.

        member: the deviation (q,) that reaches a measure along a twist. starts: as of ``least_over``.
        """
        n, w = self.forces.shape
        across = np.einsum("nkw,nw->nk", self.cones.tangents, self.forces)
        own = _directions(across)  # where a force at its cone's edge is, which a grid misses
        least, where = least_over(lambda u: self._slipping(u, measure), n, w - 1, starts, own)
        gs = self._edges(where[:, None])[:, 0]
        twists = [-self.responses[i].T @ gs[i] for i in range(n)]
        hows = [SLIPS] * n
        limited = np.flatnonzero(self.limits < inf)
        if limited.size:
            some = replace(
                self,
                forces=self.forces[limited],
                responses=self.responses[limited],
                limits=self.limits[limited],
                rows=None,
            )
            reached, us = least_over(
                lambda u: some._exceeding(u, measure), limited.size, w, starts, _directions(some.forces)
            )
            for k, i in enumerate(limited.tolist()):
                if reached[k] < least[i]:
                    least[i], hows[i] = reached[k], EXCEEDS
                    twists[i] = self.responses[i].T @ us[k]
        if self.rows is not None:
            reached = measure(self._row_room(self.rows)[None], self._row_twists(self.rows)[None])[0]
            for k, i in enumerate(self.rows.contacts.tolist()):
                if reached[k] < least[i]:
                    least[i], hows[i] = reached[k], EXCEEDS
                    twists[i] = self._row_twists(self.rows)[k]
        deviations = [self._deviation(y, m, member) for y, m in zip(twists, least.tolist(), strict=True)]
        hows = [self._how(i, how, deviations[i]) for i, how in enumerate(hows)]
        return Worst(least, deviations, hows)

    def spare(self) -> Array:
        """(n,) the least distance of forces to the edge of the cone and to the limit over ``base`` [N]."""
        n, w = self.forces.shape
        still = np.zeros((n, 1))
        slack = 1 / np.sqrt(1 + self.frictions**2)
        least, _ = least_over(lambda u: self._room(self._edges(u), still) * slack[:, None], n, w - 1)
        if (self.limits < inf).any():
            ample = np.where(self.limits < inf, self.limits, 0.0)[:, None]
            reached, _ = least_over(lambda u: self._room(-u, ample), n, w)
            least = np.where(self.limits < inf, np.minimum(least, reached), least)
        if self.rows is not None:
            least = np.minimum(least, self.rows.least(self._row_room(self.rows)))
        return least

    def _row_room(self, rows: LimitRows) -> Array:
        """(m,) b - a . f - sigma_base(R' a)."""
        room: Array = rows.bounds - np.einsum("mw,mw->m", rows.rows, self.forces[rows.contacts])
        return room if self.base is None else room - self.base.support(self._row_twists(rows))

    def _row_twists(self, rows: LimitRows) -> Array:
        """(m, q) R' a."""
        result: Array = np.einsum("mw,mwq->mq", rows.rows, self.responses[rows.contacts])
        return result

    def _room(self, g: Array, constant: Array) -> Array:
        """(n, m) constant + g . f - sigma_base(-R' g)."""
        room: Array = constant + np.einsum("nmw,nw->nm", g, self.forces)
        if self.base is None:
            return room
        return room - self.base.support(self._twists(g))

    def _edges(self, u: Array) -> Array:
        """(n, m, w) g = mu n - u for u (n, m, w - 1) by the cones' tangents."""
        across = np.einsum("nmk,nkw->nmw", u, self.cones.tangents)
        friction = np.maximum(self.frictions, _LEAST_FRICTION)[:, None]
        result: Array = (friction * self.cones.normals)[:, None] - across
        return result

    def _slipping(self, u: Array, measure: Callable[[Array, Array], Array]) -> Array:
        g = self._edges(u)
        return measure(self._room(g, np.zeros((1, 1))), self._twists(g))

    def _exceeding(self, u: Array, measure: Callable[[Array, Array], Array]) -> Array:
        return measure(self._room(-u, self.limits[:, None]), self._twists(-u))

    def _twists(self, g: Array) -> Array:
        result: Array = -np.einsum("nmw,nwq->nmq", g, self.responses)
        return result

    def _deviation(
        self, twist: Array, measure: float, member: Callable[[Array, float], Array]
    ) -> Wrench | None:
        if not np.isfinite(measure):
            return None
        total = member(twist, measure)
        if self.base is not None:
            total = total + self.base.extreme(twist).vector
        return Wrench.from_vector(total)

    def _how(self, i: int, how: str, deviation: Wrench | None) -> str:
        if deviation is None:
            return ""
        after = self.forces[i] + self.responses[i] @ deviation.vector
        left = float(after @ self.cones.normals[i])
        return OPENS if left <= _OPEN * abs(float(self.forces[i] @ self.cones.normals[i])) else how


def around_center(loads: LoadSet) -> tuple[LoadSet | None, LoadSet]:
    """What of a set stays when it is scaled, None for nothing, and the deviations from it that are scaled."""
    stays = LoadSet.hull([loads.center]) if loads.center.vector.any() else None
    return stays, loads.deviations


def measured_response(grasp: Grasp, response: Array) -> Array:
    """R (n w, q) as (n, w, q), as the cones measure forces."""
    columns = response.T.reshape(-1, len(grasp), grasp.width)
    return np.moveaxis(grasp.cones.measured(columns), 0, -1)


def _directions(vectors: Array) -> Array:
    """(n, k) of length 1; of vectors that vanish any."""
    lengths = np.sqrt((vectors * vectors).sum(axis=1, keepdims=True))
    some = np.eye(vectors.shape[1])[:1]
    result: Array = np.divide(vectors, lengths, out=np.repeat(some, len(vectors), axis=0), where=lengths > 0)
    return result


def _reach(loads: LoadSet) -> Array:
    """(3,) or (6,) the largest work along each axis."""
    axes = np.eye(loads.center.vector.size)
    result: Array = np.maximum(loads.support(axes), loads.support(-axes))
    return result
