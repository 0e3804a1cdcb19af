"""The largest work of a finger's force along a twist, for fingers anywhere on arcs of cubic curves.

A cubic with control points P_0 ... P_3 has a polar form p(u, v, w), affine in each argument, the same in
any order and p(u, u, u) on the curve. Its part from a to b has the control points p(a, a, a), p(a, a, b),
p(a, b, b) and p(b, b, b), whose hull contains it, and its tangents lie between those of the quadratic of
derivatives, d(a, a), d(a, b) and d(b, b). So with n_1 and n_2 the inward normals of the outermost of these,
every force of size 1 or less that a finger may make on the part lies in

    |f| <= 1:      the sector between the clockwise edge of the cone of n_1 and the other one of n_2
    n . f <= 1:    the hull of 0 and the arcs of radius sqrt(1 + mu^2) from either edge of n_1 to that of n_2

and the most of v . f there, v = G' y at a control point, bounds the work: v is affine in the place. As a
and b meet, both become what a finger there can do.
"""

from math import sqrt

from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS

DISC = 1
"""size(f) = |f|; 0 is n . f."""
CONTROL = 9
"""The first of eight columns of a table of sides with their edges' control points."""


@njit(**VIEWS)
def polar(sides, j, c, u, v, w):  # type: ignore[no-untyped-def]
    """Coordinate c of the polar form of a side's edge at three fractions of it."""
    p0, p1 = sides[j, CONTROL + c], sides[j, CONTROL + 2 + c]
    p2, p3 = sides[j, CONTROL + 4 + c], sides[j, CONTROL + 6 + c]
    a, b, d = p0 + u * (p1 - p0), p1 + u * (p2 - p1), p2 + u * (p3 - p2)
    e, f = a + v * (b - a), b + v * (d - b)
    return e + w * (f - e)


@njit(**VIEWS)
def _tangent(sides, j, u, v):  # type: ignore[no-untyped-def]
    """The polar form of the derivative, of length 1."""
    x, y = CONTROL, CONTROL + 1
    s, t = 1.0 - u, 1.0 - v
    w0, w1, w2 = s * t, u * t + s * v, u * v
    dx = (
        w0 * (sides[j, x + 2] - sides[j, x])
        + w1 * (sides[j, x + 4] - sides[j, x + 2])
        + w2 * (sides[j, x + 6] - sides[j, x + 4])
    )
    dy = (
        w0 * (sides[j, y + 2] - sides[j, y])
        + w1 * (sides[j, y + 4] - sides[j, y + 2])
        + w2 * (sides[j, y + 6] - sides[j, y + 4])
    )
    per = 1.0 / sqrt(dx * dx + dy * dy)
    return dx * per, dy * per


@njit(**VIEWS)
def fan(sides, j, a, b):  # type: ignore[no-untyped-def]
    """The outermost tangents of a part, the clockwise one first."""
    lx, ly = _tangent(sides, j, a, a)
    hx, hy = lx, ly
    if a < b:
        for k in range(2):
            x, y = _tangent(sides, j, a if k == 0 else b, b)
            if lx * y - ly * x < 0.0:
                lx, ly = x, y
            if hx * y - hy * x > 0.0:
                hx, hy = x, y
    return lx, ly, hx, hy


@njit(**VIEWS)
def farthest(sides, i, a, b, j, c, d):  # type: ignore[no-untyped-def]
    """No two points of the part a to b of one side and c to d of another are farther apart."""
    most = 0.0
    for k in range(4):
        u, v, w = (a if k < 3 else b), (a if k < 2 else b), (a if k < 1 else b)
        px, py = polar(sides, i, 0, u, v, w), polar(sides, i, 1, u, v, w)
        for m in range(4):
            u, v, w = (c if m < 3 else d), (c if m < 2 else d), (c if m < 1 else d)
            qx, qy = polar(sides, j, 0, u, v, w), polar(sides, j, 1, u, v, w)
            most = max(most, (px - qx) ** 2 + (py - qy) ** 2)
    return sqrt(most)


@njit(**VIEWS)
def most_on_arc(ax, ay, bx, by, vx, vy):  # type: ignore[no-untyped-def]
    """The unit vector of most work from one to another that is less than half a turn counter-clockwise."""
    first, second = ax * vx + ay * vy, bx * vx + by * vy
    if ax * vy - ay * vx >= 0.0 and vx * by - vy * bx >= 0.0 and first + second > 0.0:
        length = sqrt(vx * vx + vy * vy)
        return length, vx / length, vy / length
    if first >= second:
        return first, ax, ay
    return second, bx, by


@njit(**VIEWS)
def _most_on_sector(ax, ay, bx, by, vx, vy):  # type: ignore[no-untyped-def]
    """The same from one to another that is less than three quarters of a turn away."""
    if ax * by - ay * bx > 0.0 or ax * bx + ay * by > 0.0:
        return most_on_arc(ax, ay, bx, by, vx, vy)
    if ax * vy - ay * vx >= 0.0 or vx * by - vy * bx >= 0.0:
        length = sqrt(vx * vx + vy * vy)
        per = 1.0 / length if length > 0.0 else 0.0
        return length, vx * per, vy * per
    first, second = ax * vx + ay * vy, bx * vx + by * vy
    if first >= second:
        return first, ax, ay
    return second, bx, by


@njit(**VIEWS)
def support_of_cubics(sides, first, last, lo, hi, mu, size, y, out):  # type: ignore[no-untyped-def]
    """Writes sigma, the side, u, f_x, f_y, the torque and n . f of the best force on an arc; 0 for none."""
    for c in range(7):
        out[c] = 0.0
    slant = sqrt(1.0 + mu * mu)
    cosine, sine = 1.0 / slant, mu / slant
    for j in range(first, last + 1):
        edge = sides[j, 8]
        a = (lo if j == first else sides[j, 6]) - edge
        b = (hi if j == last else sides[j, 7]) - edge
        lx, ly, hx, hy = fan(sides, j, a, b)
        # n = (-t_y, t_x); clockwise edge of the first cone n + mu t, the other one of the last n - mu t
        ax, ay = sine * lx - cosine * ly, sine * ly + cosine * lx
        bx, by = -sine * hx - cosine * hy, -sine * hy + cosine * hx
        nx, ny = -0.5 * (ly + hy), 0.5 * (lx + hx)
        for k in range(4 if a < b else 1):
            p, q, r = (a if k < 3 else b), (a if k < 2 else b), (a if k < 1 else b)
            px, py = polar(sides, j, 0, p, q, r), polar(sides, j, 1, p, q, r)
            vx, vy = y[0] - y[2] * py, y[1] + y[2] * px
            if size == DISC:
                value, fx, fy = _most_on_sector(ax, ay, bx, by, vx, vy)
            else:
                cx, cy = sine * hx - cosine * hy, sine * hy + cosine * hx
                value, fx, fy = most_on_arc(ax, ay, cx, cy, vx, vy)
                dx, dy = -sine * lx - cosine * ly, -sine * ly + cosine * lx
                other, ox, oy = most_on_arc(dx, dy, bx, by, vx, vy)
                if other > value:
                    value, fx, fy = other, ox, oy
                value, fx, fy = slant * value, slant * fx, slant * fy
            if value > out[0]:
                out[0], out[1], out[2] = value, j, edge + a + (b - a) * k / 3.0
                out[3], out[4], out[5] = fx, fy, px * fy - py * fx
                out[6] = max(nx * fx + ny * fy, 1e-3)


@njit(**VIEWS)
def bend(sides, j, a, b):  # type: ignore[no-untyped-def]
    """The sine by which the outermost tangents of a part of a side differ, at u from a to b."""
    lx, ly, hx, hy = fan(sides, j, a - sides[j, 8], b - sides[j, 8])
    return max(lx * hy - ly * hx, 0.0) if lx * hx + ly * hy > 0.0 else 1.0
