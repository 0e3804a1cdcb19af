"""Which of many placements cannot hold loads, by weak duality: a few twists are tried on each.

Fingers at r_i hold a load w at a level only if, for every twist y (a velocity and a turn of the object), the
work of w is no more than the largest that forces within the level can take up:

    -w . y <= sum_i sigma_i(y)   (max_i for a limit on the sum),   sigma_i(y) = max { f . v_i },

v_i the velocity at r_i, over forces f of finger i. A twist that breaks it for one load rejects the placement.
They come from a pool
of random ones, the most useful first, and from random steps away from the one that came nearest. What is left
need not hold. Nothing of regrasp is used.
"""

from math import sqrt

import numpy as np
from numba import njit

Array = np.ndarray
NORMAL, DISC, ERODED = 0, 1, 2
POOL, AT_FIRST, STEPS = 160, 20_000, 60
SURE = 1e-9  # of the work, more than rounding


@njit(cache=True, error_model="numpy")
def _most(n, v, mu, size, limit, apex, corner):  # type: ignore[no-untyped-def]
    """The largest f . v of a finger of inward unit normal n."""
    ahead, across = n[0] * v[0] + n[1] * v[1], abs(n[1] * v[0] - n[0] * v[1])
    if size == NORMAL:
        return limit * max(ahead + mu * across, 0.0)
    whole = sqrt(ahead * ahead + across * across)
    if size == DISC:
        if across <= mu * ahead:
            return limit * whole
        return limit * max(ahead + mu * across, 0.0) / sqrt(1.0 + mu * mu)
    if limit * across <= mu * (limit * ahead - apex * whole):
        return limit * whole
    return max(apex * ahead, corner[0] * ahead + corner[1] * across)


@njit(cache=True, error_model="numpy")
def _work(loads, y):  # type: ignore[no-untyped-def]
    """Of the worst load."""
    work = -np.inf
    for w in range(len(loads)):
        work = max(work, -(loads[w, 0] * y[0] + loads[w, 1] * y[1] + loads[w, 2] * y[2]))
    return work


@njit(cache=True, error_model="numpy")
def _short(r, n, work, law, y):  # type: ignore[no-untyped-def]
    """How much of the work forces cannot take up under twist y."""
    mu, size, total, limit, apex, normal, tangent = law
    held = 0.0
    for i in range(len(r)):
        v = (y[0] - y[2] * r[i, 1], y[1] + y[2] * r[i, 0])
        most = _most(n[i], v, mu, size, limit, apex, (normal, tangent))
        held = max(held, most) if total else held + most
    return work - held - SURE * (abs(work) + abs(held))


@njit(cache=True, error_model="numpy")
def _reject(r, n, loads, law, pool, order, useful, reach, steps, rejected, found):  # type: ignore[no-untyped-def]
    """Notes the placements that are rejected, and the twists that did it after those of the pool did not."""
    y, at, works = np.zeros(3), 0, np.zeros(len(pool))
    for k in range(len(pool)):
        works[k] = _work(loads, pool[k])
    for p in range(len(r)):
        nearest, best = -np.inf, 0
        for k in order:
            short = _short(r[p], n[p], works[k], law, pool[k])
            if short > 0.0:
                rejected[p] = True
                useful[k] += 1
                break
            if short > nearest:
                nearest, best = short, k
        if rejected[p]:
            continue
        twist, step = pool[best].copy(), 0.3
        for tries in range(STEPS):
            drawn = steps[(p + tries) % len(steps)]
            for c in range(3):
                y[c] = twist[c] + step * drawn[c] / (reach if c == 2 else 1.0)
            size = sqrt(y[0] ** 2 + y[1] ** 2 + (reach * y[2]) ** 2)
            for c in range(3):
                y[c] /= size
            short = _short(r[p], n[p], _work(loads, y), law, y)
            if short <= nearest:
                step *= 0.85
                continue
            nearest, step = short, 1.5 * step
            twist[:] = y
            if short > 0.0:
                rejected[p] = True
                found[at % len(found)] = y
                at += 1
                break
    return at


class Rejection:
    """Of placements that cannot hold loads at a level.

    loads: (L, 3) about the centre of mass. level: of ``sum_normal``, ``peak_normal``, ``peak``,
    ``friction_use`` or ``force``; None for none. limit: of every force. reach: of the object.
    """

    def __init__(
        self, loads: Array, friction: float, objective: str, level: float | None, limit: float, reach: float,
        seed: int,
    ) -> None:  # fmt: skip
        mu, most, size, apex, corner = friction, min(limit, 1e12), DISC, 0.0, (0.0, 0.0)
        if level is not None and objective == "friction_use":
            mu = friction * level
        elif level is not None and objective == "force":
            size, slant = ERODED, sqrt(1.0 + mu * mu)
            apex = level * slant / mu
            along = sqrt(max(limit**2 - level**2, 0.0)) - apex / slant
            corner = apex + along / slant, along * mu / slant
        elif objective in ("sum_normal", "peak_normal", "peak"):
            most = most if level is None else min(most, level)
            size = DISC if objective == "peak" else NORMAL
        self.none = size == ERODED and apex > limit
        self._law = (mu, size, objective == "sum_normal", most, apex, *corner)
        rng, self._reach, self._loads = np.random.default_rng(seed), reach, loads
        pool, self._steps = rng.normal(size=(POOL, 3)), rng.normal(size=(997, 3))
        along = np.linspace(
            0, 2 * np.pi, 24, endpoint=False
        )  # without turning: nothing holds in these directions
        pool[:24] = np.column_stack([np.cos(along), np.sin(along), np.zeros(24)])
        pool /= np.linalg.norm(pool, axis=1)[:, None]
        self._pool = np.ascontiguousarray(pool / [1, 1, reach])
        self._useful = np.zeros(POOL, np.int64)

    def left(self, positions: Array, normals: Array) -> Array:
        """(m,) whether placements are not rejected, for positions and inward unit normals (m, k, 2)."""
        rejected = np.full(len(positions), self.none)
        for first in range(0, 0 if self.none else len(positions), AT_FIRST):
            part = slice(first, first + AT_FIRST)
            found = np.zeros((POOL // 8, 3))
            order = np.argsort(-self._useful, kind="stable")
            at = _reject(
                positions[part], normals[part], self._loads, self._law, self._pool, order, self._useful,
                self._reach, self._steps, rejected[part], found,
            )  # fmt: skip
            least = np.argsort(self._useful, kind="stable")[: min(at, len(found))]
            self._pool[least] = found[: len(least)]
            self._useful[least] = 0
        return ~rejected
