"""The least norm of forces that have limits, for fingers anywhere on arcs of a boundary, bounded from below.

Every finger pushes with n . f >= m, its force is at most F. Let N be the norm, c(f) what a finger adds to

    sum:      N = sum c(f_i),                c(f) = n . f
    squares:  N^2 / 2 = sum c(f_i),          c(f) = |f|^2 / 2

Forces that make b do the work b . y along any twist y, so that with v_i the velocities of the fingers

    sum c(f_i) >= b . y - sum_i h(v_i),      h(v) = max { v . f - c(f) : f in K, n . f >= m, |f| <= F }

and where N is the largest of sizes, N >= b . y - max over T of [ sum_i h_T(v_i) - T ], h_T(v) the most of
v . f over forces of size T or less (``limited``).

The best y is found by the simplex method as in ``wrench_gauge``, whose rows here have a cost, c, and with
their weights, which add up to 1, a fourth unknown.
"""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.places.limited import DISC, LARGEST, SQUARES, SUM, best_of_arc

FAR = 1e6
"""A norm beyond this many times |b|_1 and the least force counts as infinite."""
_ARTIFICIAL = 1e9  # the largest component of y to begin with
_MOST, _THIRDS = 240, 24
_ROUNDING = 1e-13  # of the terms of a sum
_PIVOT = 1e-12
_MISSED = 1e-7  # of a load, by which forces may be off it
_BEYOND = 1.0 + 1e-6


@njit(**VIEWS)
def _add(g, force, best, times):  # type: ignore[no-untyped-def]
    """Adds to g the wrench of the force found, so many times, and notes it in ``force``: n . f, side, u."""
    fx = times * (best[1] * best[3] + best[2] * best[5])
    fy = times * (best[1] * best[4] + best[2] * best[6])
    g[0] += fx
    g[1] += fy
    g[2] += best[9] * fy - best[10] * fx
    force[0], force[1], force[2] = max(times * best[1], 0.0), best[7], best[8]


@njit(**VIEWS)
def _column(sides, arcs, ends, law, top, y, g, force, kinks, out, best):  # type: ignore[no-untyped-def]
    """The most of g . y - cost over the forces of a box, or a bound of it; the wrench g (3,) and its cost.

    kinks: (k, 3) of ``LARGEST``: the most per size, the most within the limit, the least. The bound is of the
    smaller of the first two, which is more than h_T only where size and another limit hold a force back.
    """
    _, size, norm, limit, least = law
    k, total, cost = len(arcs), 0.0, 0.0
    g[0] = g[1] = g[2] = 0.0
    if norm != LARGEST:
        for i in range(k):
            best_of_arc(sides, arcs, ends, i, law, top, False, y, out, best)
            total += best[0]
            cost += best[1] if norm == SUM else 0.5 * (best[1] ** 2 + best[2] ** 2)
            _add(g, force[i], best, 1.0)
        return total, cost
    capped = size != DISC and limit < np.inf
    for i in range(k):
        best_of_arc(sides, arcs, ends, i, law, top, True, y, out, best)
        kinks[i, 0], kinks[i, 1], kinks[i, 2] = best[0], np.inf, 0.0
        if best[0] <= 0.0 or capped:
            best_of_arc(sides, arcs, ends, i, law, np.inf, False, y, out, best)
            kinks[i, 1 if kinks[i, 0] > 0.0 else 2] = best[0]
    # concave in T and linear between kinks
    most, size_of_all = -np.inf, least
    for n in range(-2, k):
        t = least if n == -2 else top
        if n >= 0:
            if not (kinks[n, 0] > 0.0 and kinks[n, 1] < np.inf):
                continue
            t = min(max(kinks[n, 1] / kinks[n, 0], least), top)
        value = -t
        for i in range(k):
            value += min(t * kinks[i, 0], kinks[i, 1]) if kinks[i, 0] > 0.0 else kinks[i, 2]
        if value > most:
            most, size_of_all = value, t
    exact = capped or _is_short(law, size_of_all)
    if not capped and exact:
        size_of_all = _best_short(sides, arcs, ends, law, top, y, out, best)
    for i in range(k):
        rising = kinks[i, 0] > 0.0 and not exact
        best_of_arc(sides, arcs, ends, i, law, size_of_all, rising, y, out, best)
        _add(g, force[i], best, size_of_all if rising else 1.0)
    return most, size_of_all


@njit(**VIEWS)
def _best_short(sides, arcs, ends, law, top, y, out, best):  # type: ignore[no-untyped-def]
    """The T that makes sum h_T - T most, of those at which a force may push with too little at an edge.

    It is concave in T, rising as a root from where forces go along normals: thirds are of their other part.
    """
    mu, _, _, _, least = law
    lo, hi = 0.0, min(mu * least, sqrt(max(top * top - least * least, 0.0)))
    for _ in range(_THIRDS):
        third = (hi - lo) / 3.0
        first, second = lo + third, hi - third
        difference = sqrt(least * least + first * first) - sqrt(least * least + second * second)
        for i in range(len(arcs)):
            for q in (first, second):
                best_of_arc(sides, arcs, ends, i, law, sqrt(least * least + q * q), False, y, out, best)
                difference += best[0] if q == second else -best[0]
        if difference > 0.0:
            lo = first
        else:
            hi = second
    q = hi if difference > 0.0 else lo
    return sqrt(least * least + q * q)


@njit(**VIEWS)
def _is_short(law, size):  # type: ignore[no-untyped-def]
    """Whether a force of a length may push with too little at the edge of its cone."""
    return law[1] == DISC and size < law[4] * sqrt(1.0 + law[0] * law[0])


@njit(**VIEWS)
def _is_above(sides, arcs, ends, law, top, y, done, forces, out, best):  # type: ignore[no-untyped-def]
    """Whether forces of size ``top`` or less do less than ``done``, where bounds of h_T are not close."""
    if law[2] != LARGEST or not ((law[1] != DISC and law[3] < np.inf) or _is_short(law, top)):
        return False
    for i in range(len(arcs)):
        best_of_arc(sides, arcs, ends, i, law, top, False, y, out, best)
        done -= best[0]
    return done > 0.0


@njit(**VIEWS)
def _solve(rows, turned, right, low):  # type: ignore[no-untyped-def]
    """Solves rows . x = right, or of turned rows; x takes the place of ``right`` (4,). False for none.

    low: (4, 4) scratch.
    """
    for i in range(4):
        for j in range(4):
            low[i, j] = rows[j, i] if turned else rows[i, j]
    for c in range(4):
        at = c
        for i in range(c + 1, 4):
            if abs(low[i, c]) > abs(low[at, c]):
                at = i
        if low[at, c] == 0.0:
            return False
        if at != c:
            for j in range(4):
                low[c, j], low[at, j] = low[at, j], low[c, j]
            right[c], right[at] = right[at], right[c]
        for i in range(c + 1, 4):
            factor = low[i, c] / low[c, c]
            for j in range(c, 4):
                low[i, j] -= factor * low[c, j]
            right[i] -= factor * right[c]
    for c in range(3, -1, -1):
        for j in range(c + 1, 4):
            right[c] -= low[c, j] * right[j]
        right[c] /= low[c, c]
    return True


@njit(**VIEWS)
def is_limited(law):  # type: ignore[no-untyped-def]
    """Whether forces have a limit or a least normal part."""
    return law[1] <= DISC and (law[3] < np.inf or law[4] > 0.0)


@njit(**VIEWS)
def _top(law, b, enough):  # type: ignore[no-untyped-def]
    """The largest force that is looked at, and the norm that counts as infinite."""
    far = FAR * (abs(b[0]) + abs(b[1]) + abs(b[2]) + law[4])
    return max(min(min(enough, law[3]), far), law[4]), far


@njit(**VIEWS)
def _norm(cost, k, law, enough, top, far):  # type: ignore[no-untyped-def]
    """The norm that a cost proves: at most what was looked at; infinite where no forces are that large."""
    norm, limit = law[2], law[3]
    if top == limit:
        every = limit if norm == LARGEST else (k * limit if norm == SUM else 0.5 * k * limit * limit)
        if cost >= every * _BEYOND:
            return np.inf
    found = sqrt(2.0 * max(cost, 0.0)) if norm == SQUARES else max(cost, 0.0)
    if found >= far > 0.0:
        return np.inf
    return min(found, enough)


@njit(**VIEWS)
def _lost(b, y, k, mu, forces):  # type: ignore[no-untyped-def]
    """What rounding may have added to a cost."""
    pushed = 1.0
    for i in range(k):
        pushed += forces[i, 0]
    turn = abs(y[0]) + abs(y[1]) + abs(y[2])
    load = abs(b[0] * y[0]) + abs(b[1] * y[1]) + abs(b[2] * y[2])
    return _ROUNDING * (load + (1.0 + mu) * pushed * (1.0 + turn))


@njit(**VIEWS)
def bound_within(sides, arcs, ends, law, b, y, enough, work, room):  # type: ignore[no-untyped-def]
    """The norm that the twist y proves."""
    _, _, forces, _, _, new = work[:6]
    top, far = _top(law, b, enough)
    most, _ = _column(sides, arcs, ends, law, top, y, new, forces[4], room[5], room[6], room[7])
    cost = b[0] * y[0] + b[1] * y[1] + b[2] * y[2] - most - _lost(b, y, len(arcs), law[0], forces[4])
    return _norm(cost, len(arcs), law, enough, top, far)


@njit(**VIEWS)
def gauge_within(sides, arcs, ends, law, b, enough, precision, best, work, room):  # type: ignore[no-untyped-def]
    """As ``wrench_gauge.gauge``, of forces within limits. law: mu, size, norm, F or infinite, m."""
    _, x, forces, _, _, new = work[:6]
    rows, costs, low, y, d, kinks, out, one = room
    k, mu, squares = len(arcs), law[0], law[2] == SQUARES
    top, far = _top(law, b, enough)
    if far == 0.0:
        best[0] = best[1] = best[2] = 0.0
        for c in range(4):
            x[c] = 0.0
        return 0.0, 0.0
    for c in range(4):
        for i in range(k):
            forces[c, i, 0] = 0.0
        y[c] = x[c] = costs[c] = 0.0
        for e in range(4):
            rows[c, e] = 0.0
    best[0] = best[1] = best[2] = 0.0
    # forces that press as little as they may, and the components of what is missing
    least, cost = _column(sides, arcs, ends, law, top, y, new, forces[3], kinks, out, one)
    lower, upper = max(-least, 0.0), np.inf
    for c in range(3):
        rows[c, c] = 1.0 if b[c] >= new[c] else -1.0
        costs[c] = _ARTIFICIAL
        rows[3, c] = new[c]
    rows[3, 3], costs[3] = -1.0, cost
    for _ in range(_MOST):
        for c in range(4):
            y[c], x[c] = costs[c], (b[c] if c < 3 else -1.0)
        if not (_solve(rows, False, y, low) and _solve(rows, True, x, low)):
            break
        work_done = b[0] * y[0] + b[1] * y[1] + b[2] * y[2]
        upper = work_done - y[3]
        most, cost = _column(sides, arcs, ends, law, top, y, new, forces[4], kinks, out, one)
        lost = _lost(b, y, k, mu, forces[4])
        proven = work_done - most - lost
        if _is_above(sides, arcs, ends, law, top, y, work_done - lost, forces, out, one):
            proven = max(proven, top * _BEYOND)
        if proven > lower:
            lower = proven
            best[0], best[1], best[2] = y[0], y[1], y[2]
        close = precision * (2.0 if squares else 1.0) * upper
        if _norm(lower, k, law, enough, top, far) >= enough or upper - lower <= close:
            break
        if new[0] * y[0] + new[1] * y[1] + new[2] * y[2] - cost <= y[3]:
            break
        for c in range(3):
            d[c] = new[c]
        d[3] = -1.0
        if not _solve(rows, True, d, low):
            break
        leaving, ratio = -1, np.inf
        for c in range(4):
            if d[c] > _PIVOT and max(x[c], 0.0) < ratio * d[c]:
                leaving, ratio = c, max(x[c], 0.0) / d[c]
        if leaving < 0:
            break
        for c in range(3):
            rows[leaving, c] = new[c]
        rows[leaving, 3], costs[leaving] = -1.0, cost
        for i in range(k):
            for c in range(3):
                forces[leaving, i, c] = forces[4, i, c]
    reached, short = 0.0, 0.0
    for j in range(4):
        if rows[j, 3] == 0.0:
            short += abs(x[j])
        else:
            reached += max(x[j], 0.0) * costs[j]
    found = _norm(lower, k, law, enough, top, far)
    if not short <= _MISSED * (abs(b[0]) + abs(b[1]) + abs(b[2])):
        return found, np.inf
    return found, sqrt(2.0 * reached) if squares else reached


def room_for_limits(k: int) -> tuple[Any, ...]:
    """Memory for it: rows, costs, scratch, y and its fourth unknown, shares, and what columns are made of."""
    return (
        np.zeros((4, 4)), np.zeros(4), np.zeros((4, 4)), np.zeros(4), np.zeros(4), np.zeros((k, 3)),
        np.zeros(9), np.zeros(11),
    )  # fmt: skip
