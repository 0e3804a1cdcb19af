"""How large forces must be to make a wrench, for fingers anywhere on arcs of a boundary, bounded from below.

Fingers on given points, each with forces f_i in its cone K_i, make the wrenches

    W = { sum_i G_i f_i :  |(size_1(f_1), ..., size_k(f_k))|_p <= 1 },     size(f) = n . f  or  |f|

and gauge(b) = least T with b in T W is the least sum (p = 1), root of squares (2) or largest (infinity) of
sizes. Any twist y bounds it: gauge(b) >= b . y / H(y); H, the support function of W, is the dual norm of

    sigma_i(y) = max { v . f : f in K_i, size(f) <= 1 },     v = G_i' y.

Each sigma is convex in v, and v is affine along a straight side: the largest over an arc is at an end of one
of its sides. So the same formula with these largest values bounds every placement in a box of arcs. On curves
``cubic_arcs`` gives values that are no smaller.

The best y is found by the dual simplex method: three points of W whose planes g . y = 1 meet in y; the point
of W that is farthest along y takes the place of one of them, until none is beyond.
"""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.places.cubic_arcs import CONTROL, at_point, support_of_cubics
from regrasp.closed_form.compiled.places.eroded import add_middle, support_of_eroded

NORMAL, DISC, ERODED = 0, 1, 2
"""size(f): n . f, or |f|; |f| of forces that keep a distance from the edges of their cones (``eroded``)."""
SUM, SQUARES, LARGEST = 0, 1, 2
"""p = 1, 2 or infinity."""
FAR = 1e6
"""A gauge of b beyond this many times |b|_1 counts as infinite."""
_ARTIFICIAL = 1e9  # 1 / size of the rows to begin with, which no forces make
_CLOSE = 1e-11
_MOST = 80
_ROUNDING = 1e-13  # of the terms of a sum
_PIVOT = 1e-13  # of a row, by which another has to consist of it to take its place
_MISSED = 1e-7  # of a load, by which forces may be off it


@njit(**VIEWS)
def support_of_arc(sides, first, last, lo, hi, law, y, out):  # type: ignore[no-untyped-def]
    """Writes sigma, the side, u, f_x, f_y, the torque and n . f of the best force on an arc; 0 for none."""
    mu, size = law[0], law[1]
    if size == ERODED:
        support_of_eroded(sides, first, last, lo, hi, law, y, out)
        return
    if sides.shape[1] > CONTROL:
        support_of_cubics(sides, first, last, lo, hi, mu, size, y, out)
        return
    for c in range(7):
        out[c] = 0.0
    for j in range(first, last + 1):
        nx, ny = sides[j, 4], sides[j, 5]
        a = lo if j == first else sides[j, 6]
        b = hi if j == last else sides[j, 7]
        for end in range(2):
            if end == 1 and b == a:
                break
            u = a if end == 0 else b
            along = u - sides[j, 8]
            px, py = sides[j, 0] + along * sides[j, 2], sides[j, 1] + along * sides[j, 3]
            value, fx, fy, normal = at_point(nx, ny, px, py, mu, size, y)
            if value > out[0]:
                out[0], out[1], out[2] = value, j, u
                out[3], out[4], out[5], out[6] = fx, fy, px * fy - py * fx, normal


@njit(**VIEWS)
def _support_of_box(sides, arcs, ends, law, y, g, force, out):  # type: ignore[no-untyped-def]
    """H(y), and in ``g`` the point of W that reaches it; ``force`` (k, 5): n . f, side, u and f."""
    total, size, norm = 0.0, law[1], law[2]
    g[0] = g[1] = g[2] = 0.0
    for i in range(len(arcs)):
        force[i, 0] = force[i, 3] = force[i, 4] = 0.0
        support_of_arc(sides, arcs[i, 0], arcs[i, 1], ends[i, 0], ends[i, 1], law, y, out)
        s = out[0]
        if (s <= 0.0 and size != ERODED) or (norm == SUM and s <= total):
            continue
        weight = s if norm == SQUARES else 1.0
        if norm == SUM:
            total = s
            g[0] = g[1] = g[2] = 0.0
            for j in range(i):
                force[j, 0] = force[j, 3] = force[j, 4] = 0.0
        else:
            total += weight * s
        for c in range(3):
            g[c] += weight * out[3 + c]
        force[i, 0], force[i, 1], force[i, 2] = weight * out[6], out[1], out[2]
        force[i, 3], force[i, 4] = weight * out[3], weight * out[4]
    if norm == SQUARES and total > 0.0:
        total = sqrt(total)
        for c in range(3):
            g[c] /= total
        for i in range(len(arcs)):
            force[i, 0] /= total
            force[i, 3] /= total
            force[i, 4] /= total
    return total


@njit(**VIEWS)
def solved(g, b, y, x):  # type: ignore[no-untyped-def]
    """The y with g_j . y = 1 and x with sum x_j g_j = b; False for rows on a plane through the origin."""
    p0, p1, p2 = (
        g[1, 1] * g[2, 2] - g[1, 2] * g[2, 1],
        g[1, 2] * g[2, 0] - g[1, 0] * g[2, 2],
        g[1, 0] * g[2, 1] - g[1, 1] * g[2, 0],
    )
    q0, q1, q2 = (
        g[2, 1] * g[0, 2] - g[2, 2] * g[0, 1],
        g[2, 2] * g[0, 0] - g[2, 0] * g[0, 2],
        g[2, 0] * g[0, 1] - g[2, 1] * g[0, 0],
    )
    r0, r1, r2 = (
        g[0, 1] * g[1, 2] - g[0, 2] * g[1, 1],
        g[0, 2] * g[1, 0] - g[0, 0] * g[1, 2],
        g[0, 0] * g[1, 1] - g[0, 1] * g[1, 0],
    )
    determinant = g[0, 0] * p0 + g[0, 1] * p1 + g[0, 2] * p2
    if determinant == 0.0:
        return False
    per = 1.0 / determinant
    y[0], y[1], y[2] = (p0 + q0 + r0) * per, (p1 + q1 + r1) * per, (p2 + q2 + r2) * per
    x[0] = (b[0] * p0 + b[1] * p1 + b[2] * p2) * per
    x[1] = (b[0] * q0 + b[1] * q1 + b[2] * q2) * per
    x[2] = (b[0] * r0 + b[1] * r1 + b[2] * r2) * per
    return True


def workspace(k: int) -> tuple[Any, ...]:
    """Memory for boxes of k fingers: rows g, weights x and forces of four, scratch, and a twist."""
    return (
        np.zeros((3, 3)), np.zeros(4), np.zeros((5, k, 5)),
        np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(7), np.zeros(3),
        np.zeros(3), np.zeros(3),
    )  # fmt: skip


@njit(**VIEWS)
def proven(b, y, done, h, mu, k, most):  # type: ignore[no-untyped-def]
    """The bound b . y / H(y), less what rounding of both may have added; infinite beyond ``most``."""
    h += _ROUNDING * k * (1.0 + mu) * (abs(y[0]) + abs(y[1]) + abs(y[2]))
    done -= _ROUNDING * (abs(b[0] * y[0]) + abs(b[1] * y[1]) + abs(b[2] * y[2]))
    if not (done > 0.0 and h >= 0.0):  # rounding, or no number
        return 0.0
    return done / h if h * most > done else np.inf


@njit(**VIEWS)
def seen_from_middle(sides, arcs, ends, law, b, middle, target):  # type: ignore[no-untyped-def]
    """Writes b as seen from a wrench in W where 0 is none, and that wrench; returns what 1 of it is worth."""
    for c in range(3):
        target[c], middle[c] = b[c], 0.0
    if law[1] != ERODED:
        return 1.0
    for i in range(len(arcs)):
        add_middle(sides, arcs[i, 0], arcs[i, 1], ends[i, 0], ends[i, 1], law, middle)
    for c in range(3):
        target[c] -= middle[c]
    return law[3]


@njit(**VIEWS)
def bound_by(sides, arcs, ends, law, b, y, work):  # type: ignore[no-untyped-def]
    """What the twist y proves: b . y / H(y), infinite beyond ``FAR`` |b|_1."""
    _, _, forces, _, _, new, _, out, _, middle, target = work
    per = seen_from_middle(sides, arcs, ends, law, b, middle, target)
    b, mu = target, law[0]
    most = FAR * (abs(b[0]) + abs(b[1]) + abs(b[2]))
    done = b[0] * y[0] + b[1] * y[1] + b[2] * y[2]
    if not done > 0.0:
        return 0.0
    h = _support_of_box(sides, arcs, ends, law, y, new, forces[3], out)
    h -= middle[0] * y[0] + middle[1] * y[1] + middle[2] * y[2]
    return per * proven(b, y, done, h, mu, len(arcs), most)


@njit(**VIEWS, forceinline=True)
def row_that_leaves(g, new, x, spare, d):  # type: ignore[no-untyped-def]
    """The row of g (3, 3) in whose place another comes: of those with shares x the first to vanish; or -1.

    new = sum d_j g_j, which is written to d.
    """
    if not solved(g, new, spare, d):
        return -1
    leaving, ratio = -1, np.inf
    least = _PIVOT * (abs(new[0]) + abs(new[1]) + abs(new[2]))
    for c in range(3):
        part = d[c] * (abs(g[c, 0]) + abs(g[c, 1]) + abs(g[c, 2]))
        if part > least and max(x[c], 0.0) < ratio * d[c]:
            leaving, ratio = c, max(x[c], 0.0) / d[c]
    return leaving


@njit(**VIEWS)
def gauge(sides, arcs, ends, law, b, enough, precision, best, work):  # type: ignore[no-untyped-def]
    """A lower bound of the gauge of b on a box, its twist in ``best``, and what its forces reach.

    Ends early at ``enough``. Where rounding ends it, on a knife's edge, the two are apart, the second
    infinite where forces miss the load: the first is no value of a placement then.

    sides: (m, 9) of straight sides: a point, its direction per u, unit normal, least and largest u, and the u
    of the point; (m, 17) of sides of cubics with their control points, too. arcs: (k, 2) first and last side
    of each finger. ends: (k, 2) least and largest u. law: mu, size, norm; limit and distance of ``ERODED``.
    What ``work`` holds at the end are forces that reach the bound, but for ``precision``: finger i has
    x_j forces[j, i, 0] at forces[j, i, 2], j = 0, 1, 2, which is x_j forces[j, i, 3:] in x and y.
    """
    g, x, forces, y, d, new, spare, out, _, middle, target = work
    per = seen_from_middle(sides, arcs, ends, law, b, middle, target)
    b, mu = target, law[0]
    best[0] = best[1] = best[2] = 0.0
    most = FAR * (abs(b[0]) + abs(b[1]) + abs(b[2]))
    for c in range(3):
        x[c] = 0.0
        for i in range(len(arcs)):
            forces[c, i, 0] = forces[c, i, 3] = forces[c, i, 4] = 0.0
    if most == 0.0:
        return 0.0, 0.0
    for c in range(3):
        for e in range(3):
            g[c, e] = 0.0
        g[c, c] = (1.0 if b[c] >= 0.0 else -1.0) / _ARTIFICIAL
    lower = 0.0
    for _ in range(_MOST):
        if not solved(g, b, y, x):
            break
        upper = b[0] * y[0] + b[1] * y[1] + b[2] * y[2]
        h = _support_of_box(sides, arcs, ends, law, y, new, forces[3], out)
        for c in range(3):
            h -= middle[c] * y[c]
            new[c] -= middle[c]
        value = per * proven(b, y, upper, h, mu, len(arcs), most)
        if value > lower:
            lower = value
            best[0], best[1], best[2] = y[0], y[1], y[2]
        if lower >= enough or h <= 1.0 + _CLOSE or lower >= per * upper * (1.0 - precision):
            break
        leaving = row_that_leaves(g, new, x, spare, d)
        if leaving < 0:
            break
        for c in range(3):
            g[leaving, c] = new[c]
        for i in range(len(arcs)):
            for c in range(5):
                forces[leaving, i, c] = forces[3, i, c]
    upper = 0.0
    for j in range(3):
        upper += max(x[j], 0.0)
    for c in range(3):
        missed = b[c]
        for j in range(3):
            missed -= max(x[j], 0.0) * g[j, c]
        if not abs(missed) <= _MISSED * (abs(b[0]) + abs(b[1]) + abs(b[2])):
            upper = np.inf
    return lower, per * upper
