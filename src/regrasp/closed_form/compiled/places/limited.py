"""The most work of a finger whose force has limits, anywhere on an arc of a boundary, less what it costs.

A finger at a place of normal n and tangent t pushes with f = p n + q t of p >= m, |q| <= mu p and |f| <= F.
Along v it does a p + c q at most, with a = n . v and c = |t . v|. The most of this, or of this less a cost
c(f), is convex in v, so the largest on a side is at an end of it. It grows with a and c: on a part of a curve
the largest of each, over all its normals and control points, bound it.
"""

from math import sqrt

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.places.cubic_arcs import CONTROL, fan, most_on_arc, polar

SUM, SQUARES, LARGEST = 0, 1, 2
DISC = 1


@njit(**VIEWS)
def _parts(sides, j, at, to, k, y, out):  # type: ignore[no-untyped-def]
    """Writes to ``out`` a, its direction, c, its direction, and point k of a part of side j."""
    if sides.shape[1] > CONTROL:
        p, q, r = (at if k < 3 else to), (at if k < 2 else to), (at if k < 1 else to)
        px, py = polar(sides, j, 0, p, q, r), polar(sides, j, 1, p, q, r)
        lx, ly, hx, hy = fan(sides, j, at, to)
    else:
        along = at if k == 0 else to
        px, py = sides[j, 0] + along * sides[j, 2], sides[j, 1] + along * sides[j, 3]
        lx, ly = sides[j, 5], -sides[j, 4]
        hx, hy = lx, ly
    vx, vy = y[0] - y[2] * py, y[1] + y[2] * px
    out[7], out[8] = px, py
    if sides.shape[1] <= CONTROL:
        ahead, across = vy * lx - vx * ly, vx * lx + vy * ly
        out[0], out[1], out[2] = ahead, -ly, lx
        side = 1.0 if across >= 0.0 else -1.0
        out[3], out[4], out[5] = side * across, side * lx, side * ly
        return
    out[0], out[1], out[2] = most_on_arc(-ly, lx, -hy, hx, vx, vy)
    out[3], out[4], out[5] = most_on_arc(lx, ly, hx, hy, vx, vy)
    other, tx, ty = most_on_arc(-lx, -ly, -hx, -hy, vx, vy)
    if other > out[3]:
        out[3], out[4], out[5] = other, tx, ty


@njit(**VIEWS)
def _most_work(a, c, mu, least, cap, limit):  # type: ignore[no-untyped-def]
    """The most of a p + c q, c >= 0, over least <= p <= cap, 0 <= q <= mu p, p^2 + q^2 <= limit^2; p, q."""
    s, p = a + mu * c, least
    if s > 0.0:
        p = cap
        if limit < np.inf:
            p = limit * a / sqrt(a * a + c * c) if c <= mu * a else limit / sqrt(1.0 + mu * mu)
        p = min(max(p, least), cap)
    q = mu * p
    if limit < np.inf:
        q = min(q, sqrt(max(limit * limit - p * p, 0.0)))
    return a * p + c * q, p, q


@njit(**VIEWS)
def _most_less_half_square(a, c, mu, least, limit):  # type: ignore[no-untyped-def]
    """The most of a p + c q - (p^2 + q^2) / 2 there, without a cap; p, q."""
    s = a + mu * c
    p = q = 0.0
    if a > 0.0 and c <= mu * a:
        p, q = a, c
    elif s > 0.0:
        p = s / (1.0 + mu * mu)
        q = mu * p
    size = sqrt(p * p + q * q)
    if size > limit:
        p, q = p * limit / size, q * limit / size
    if p < least:
        p, q = least, min(c, mu * least)
        if limit < np.inf:
            q = min(q, sqrt(max(limit * limit - p * p, 0.0)))
    return a * p + c * q - 0.5 * (p * p + q * q), p, q


@njit(**VIEWS)
def best_of_arc(sides, arcs, ends, i, law, cap, rising, y, out, best):  # type: ignore[no-untyped-def]
    """Writes the most of a finger on its arc, p, q, the directions of both, side, u and the point.

    cap: of every size. rising: of ``LARGEST``, the most per size, without a cap.
    """
    mu, size, norm, limit, least = law
    slant, curved = sqrt(1.0 + mu * mu), sides.shape[1] > CONTROL
    best[0] = -np.inf
    for j in range(arcs[i, 0], arcs[i, 1] + 1):
        at = (ends[i, 0] if j == arcs[i, 0] else sides[j, 6]) - sides[j, 8]
        to = (ends[i, 1] if j == arcs[i, 1] else sides[j, 7]) - sides[j, 8]
        for k in range((4 if curved else 2) if at < to else 1):
            _parts(sides, j, at, to, k, y, out)
            a, c = out[0], max(out[3], 0.0)
            if norm == SQUARES:
                value, p, q = _most_less_half_square(a, c, mu, least, min(limit, cap))
            elif norm == SUM:
                value, p, q = _most_work(a - 1.0, c, mu, least, cap, limit)
            elif not rising:
                if size == DISC:
                    value, p, q = _most_work(a, c, mu, least, np.inf, min(limit, cap))
                else:
                    value, p, q = _most_work(a, c, mu, least, cap, limit)
            else:
                if size == DISC and a > 0.0 and c <= mu * a:
                    value = sqrt(a * a + c * c)
                    per = 1.0 / value if value > 0.0 else 0.0
                    p, q = a * per, c * per
                else:
                    p = 1.0 / slant if size == DISC else 1.0
                    value, q = p * (a + mu * c), mu * p
            if value > best[0]:
                best[0], best[1], best[2] = value, p, q
                best[3], best[4], best[5], best[6] = out[1], out[2], out[4], out[5]
                best[7], best[8] = j, sides[j, 8] + at + (to - at) * k / (3.0 if curved else 1.0)
                best[9], best[10] = out[7], out[8]
