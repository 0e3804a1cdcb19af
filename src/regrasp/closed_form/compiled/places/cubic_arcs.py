"""The largest work of a finger's force along a twist, for fingers anywhere on arcs of cubic curves.

A cubic with control points P_0 ... P_3 has a polar form p(u, v, w), affine in each argument, the same in
any order and p(u, u, u) on the curve. Its part from a to b has the control points p(a, a, a), p(a, a, b),
p(a, b, b) and p(b, b, b), whose hull contains it, and along its tangent is the quadratic T of coefficients
d(a, a), d(a, b) and d(b, b), d the polar form of the derivative. With N the inward normal of length |T| and
v = G' y, of degree 3, a force on either edge of its cone with n . f = 1 does

    v . (N -+ mu T) / |T|  <=  the largest ratio of coefficients of v . (N -+ mu T) and of T . m,

both of degree 5, m the direction of d(a, b): as places and normals go together, what this is above the most
at a place falls with the square of the part's length.

Let T turn by an angle d. Forces of |f| = 1 are in the hull of s on the edges of cones, s on the edges of what
all cones have in common, and 1 within that, s = 1 / cos(d / 2); where that is nothing, in the hull of 0 and
sqrt(1 + mu^2) on the edges. Of what all have in common the most v . f is at a control point: v is affine.
"""

from math import inf, sqrt

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
def _derivative(sides, j, c, u, v):  # type: ignore[no-untyped-def]
    """Coordinate c of the polar form of a third of the derivative."""
    p0, p1 = sides[j, CONTROL + c], sides[j, CONTROL + 2 + c]
    p2, p3 = sides[j, CONTROL + 4 + c], sides[j, CONTROL + 6 + c]
    s, t = 1.0 - u, 1.0 - v
    return s * t * (p1 - p0) + (u * t + s * v) * (p2 - p1) + u * v * (p3 - p2)


@njit(**VIEWS)
def _tangent(sides, j, u, v):  # type: ignore[no-untyped-def]
    """The same of both, of length 1."""
    dx, dy = _derivative(sides, j, 0, u, v), _derivative(sides, j, 1, u, v)
    per = 1.0 / sqrt(dx * dx + dy * dy)
    return dx * per, dy * per


@njit(**VIEWS)
def _tangents(sides, j, c, a, b):  # type: ignore[no-untyped-def]
    """Coordinate c of the coefficients of the tangent of a part."""
    return _derivative(sides, j, c, a, a), _derivative(sides, j, c, a, b), _derivative(sides, j, c, b, b)


@njit(**VIEWS)
def fan(sides, j, a, b):  # type: ignore[no-untyped-def]
    """The outermost tangents of a part, the clockwise one first."""
    return _outermost(_tangents(sides, j, 0, a, b), _tangents(sides, j, 1, a, b))


@njit(**VIEWS)
def _outermost(x, y):  # type: ignore[no-untyped-def]
    """The clockwise one and the other of three vectors, of length 1."""
    low, high = 0, 0
    for k in range(1, 3):
        if x[low] * y[k] - y[low] * x[k] < 0.0:
            low = k
        if x[high] * y[k] - y[high] * x[k] > 0.0:
            high = k
    one, other = 1.0 / sqrt(x[low] ** 2 + y[low] ** 2), 1.0 / sqrt(x[high] ** 2 + y[high] ** 2)
    return one * x[low], one * y[low], other * x[high], other * y[high]


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
def at_point(nx, ny, px, py, mu, size, y):  # type: ignore[no-untyped-def]
    """Sigma, the best force of size 1 and its part along the normal n, at a point."""
    vx, vy = y[0] - y[2] * py, y[1] + y[2] * px
    ahead, across = nx * vx + ny * vy, ny * vx - nx * vy
    aside = abs(across)
    if size == DISC and ahead > 0.0 and aside <= mu * ahead:
        value = sqrt(ahead * ahead + aside * aside)
        per = 1.0 / value if value > 0.0 else 0.0
        normal, tangent = ahead * per, across * per
    else:
        value = ahead + mu * aside
        normal, tangent = 1.0, mu if across >= 0.0 else -mu
        if size == DISC:
            slant = sqrt(1.0 + mu * mu)
            value, normal, tangent = value / slant, normal / slant, tangent / slant
    return value, normal * nx + tangent * ny, normal * ny - tangent * nx, normal


@njit(**VIEWS)
def _points(sides, j, c, a, b):  # type: ignore[no-untyped-def]
    """Coordinate c of the control points of a part."""
    return (
        polar(sides, j, c, a, a, a), polar(sides, j, c, a, a, b),
        polar(sides, j, c, a, b, b), polar(sides, j, c, b, b, b),
    )  # fmt: skip


@njit(**VIEWS)
def _sum(a, p, b, q):  # type: ignore[no-untyped-def]
    """Of two multiples."""
    return a * p[0] + b * q[0], a * p[1] + b * q[1], a * p[2] + b * q[2], a * p[3] + b * q[3]


@njit(**VIEWS)
def _fifth(a, b, c):  # type: ignore[no-untyped-def]
    """Coefficients of degree 5, times binomials, from those of degree 3 that go with each of degree 2."""
    return (
        a[0], 3.0 * a[1] + 2.0 * b[0], 3.0 * a[2] + 6.0 * b[1] + c[0],
        a[3] + 6.0 * b[2] + 3.0 * c[1], 2.0 * b[3] + 3.0 * c[2], c[3],
    )  # fmt: skip


@njit(**VIEWS)
def _edges_of_cones(x, z, tx, tz, mu, y):  # type: ignore[no-untyped-def]
    """The most of n . f = 1 on edges of cones on a part, which coefficient it is, f and its torque.

    x, z: coordinates of control points. tx, tz: of the tangent's coefficients.
    """
    vx = (y[0] - y[2] * z[0], y[0] - y[2] * z[1], y[0] - y[2] * z[2], y[0] - y[2] * z[3])
    vz = (y[1] + y[2] * x[0], y[1] + y[2] * x[1], y[1] + y[2] * x[2], y[1] + y[2] * x[3])
    ahead = _fifth(_sum(tx[0], vz, -tz[0], vx), _sum(tx[1], vz, -tz[1], vx), _sum(tx[2], vz, -tz[2], vx))
    aside = _fifth(_sum(tx[0], vx, tz[0], vz), _sum(tx[1], vx, tz[1], vz), _sum(tx[2], vx, tz[2], vz))
    per = 1.0 / sqrt(tx[1] * tx[1] + tz[1] * tz[1])
    mx, mz = tx[1] * per, tz[1] * per
    a, b, c = mx * tx[0] + mz * tz[0], mx * tx[1] + mz * tz[1], mx * tx[2] + mz * tz[2]
    speed = (a, 3.0 * a + 2.0 * b, 3.0 * a + 6.0 * b + c, a + 6.0 * b + 3.0 * c, 2.0 * b + 3.0 * c, c)
    best, most = 0, -inf
    for r in range(6):
        value = (ahead[r] + mu * abs(aside[r])) / speed[r]
        if value > most:
            best, most = r, value
    fx = fz = torque = arm = 0.0  # of the tangent's coefficients, the torque of N and that of T
    for i in range(max(best - 3, 0), min(best, 2) + 1):
        k = best - i
        weight = (3.0 if 0 < k < 3 else 1.0) * (2.0 if i == 1 else 1.0)
        fx += weight * tx[i]
        fz += weight * tz[i]
        torque += weight * (x[k] * tx[i] + z[k] * tz[i])
        arm += weight * (x[k] * tz[i] - z[k] * tx[i])
    per = 1.0 / speed[best]
    side = mu if aside[best] >= 0.0 else -mu
    return most, best, per * (side * fx - fz), per * (side * fz + fx), per * (torque + side * arm)


@njit(**VIEWS)
def _take(value, j, u, fx, fy, torque, out):  # type: ignore[no-untyped-def]
    """Writes a wrench that does more than what there is."""
    if value > out[0]:
        out[0], out[1], out[2], out[3], out[4], out[5] = value, j, u, fx, fy, torque


@njit(**VIEWS)
def _push(fx, fy, vx, vy, j, u, px, py, out):  # type: ignore[no-untyped-def]
    """The same of a force at a point of velocity v."""
    _take(fx * vx + fy * vy, j, u, fx, fy, px * fy - py * fx, out)


@njit(**VIEWS)
def support_of_cubics(sides, first, last, lo, hi, mu, size, y, out):  # type: ignore[no-untyped-def]
    """Writes sigma, the side, u, f_x, f_y, the torque and n . f of the best force on an arc; 0 for none."""
    for c in range(7):
        out[c] = 0.0
    slant = sqrt(1.0 + mu * mu)
    for j in range(first, last + 1):
        edge, before = sides[j, 8], out[0]
        a = (lo if j == first else sides[j, 6]) - edge
        b = (hi if j == last else sides[j, 7]) - edge
        if a == b:
            px, py = polar(sides, j, 0, a, a, a), polar(sides, j, 1, a, a, a)
            dx, dy = _tangent(sides, j, a, a)
            value, fx, fy, normal = at_point(-dy, dx, px, py, mu, size, y)
            _take(value, j, edge + a, fx, fy, px * fy - py * fx, out)
            if out[0] > before:
                out[6] = normal
            continue
        x, z = _points(sides, j, 0, a, b), _points(sides, j, 1, a, b)
        tx, tz = _tangents(sides, j, 0, a, b), _tangents(sides, j, 1, a, b)
        most, r, fx, fy, torque = _edges_of_cones(x, z, tx, tz, mu, y)
        scale, common = 1.0, False
        if size == DISC:
            lx, ly, hx, hy = _outermost(tx, tz)
            # the clockwise edge of the last cone n + mu t, n = (-t_y, t_x), and the other of the first
            cx, cy, dx, dy = mu * hx - hy, mu * hy + hx, -mu * lx - ly, -mu * ly + lx
            common = cx * dy - cy * dx > 0.0
            scale = sqrt(2.0 / (1.0 + lx * hx + ly * hy)) / slant if common else 1.0
        _take(scale * most, j, edge + a + (b - a) * r / 5.0, scale * fx, scale * fy, scale * torque, out)
        if common:
            for k in range(4):
                vx, vy, at = y[0] - y[2] * z[k], y[1] + y[2] * x[k], edge + a + (b - a) * k / 3.0
                _push(scale * cx, scale * cy, vx, vy, j, at, x[k], z[k], out)
                _push(scale * dx, scale * dy, vx, vy, j, at, x[k], z[k], out)
                inside = cx * vy - cy * vx > 0.0 and vx * dy - vy * dx > 0.0
                if inside and vx * (cx + dx) + vy * (cy + dy) > 0.0:
                    speed = sqrt(vx * vx + vy * vy)
                    _push(vx / speed, vy / speed, vx, vy, j, at, x[k], z[k], out)
        if out[0] > before:
            along = sqrt(tx[1] * tx[1] + tz[1] * tz[1])
            out[6] = max((tx[1] * out[4] - tz[1] * out[3]) / along, 1e-3)


@njit(**VIEWS)
def bend(sides, j, a, b):  # type: ignore[no-untyped-def]
    """The sine by which the outermost tangents of a part of a side differ, at u from a to b."""
    lx, ly, hx, hy = fan(sides, j, a - sides[j, 8], b - sides[j, 8])
    return max(lx * hy - ly * hx, 0.0) if lx * hx + ly * hy > 0.0 else 1.0
