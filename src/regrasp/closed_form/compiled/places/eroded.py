"""The largest work along a twist of forces that keep a distance from the edges of their cones and a limit.

Forces of at most F at a distance d or more from both edges A and B of a sector (A the clockwise one) fill a
region with a corner on the bisector, d / sin of half the angle from its tip, and two more on the circle,
d m + sqrt(F^2 - d^2) A with m across the edge. The most of v . f there is F |v| where F v / |v| is inside,
else at one of the three. On a part of a curve all cones are in one sector, and what keeps a distance from
their edges keeps it from those of the sector. It is convex in v, so the largest is at an end of a side, or at
a control point.
"""

from math import sqrt

from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.places.cubic_arcs import CONTROL, fan, polar

_ROUNDING = 1e-13


@njit(**VIEWS)
def _most(ax, ay, bx, by, limit, margin, vx, vy):  # type: ignore[no-untyped-def]
    """The most of v . f, and the force; of sectors of half a turn or more without the distance."""
    speed = sqrt(vx * vx + vy * vy)
    across, wide = ax * by - ay * bx, 0.0
    if across <= 1e-9 and ax * bx + ay * by < 0.0:
        margin, wide = 0.0, 1.0
    one, two = ax * vy - ay * vx, vx * by - vy * bx
    if limit * one >= margin * speed and limit * two >= margin * speed:
        per = limit / speed if speed > 0.0 else 0.0
        return limit * speed, per * vx, per * vy
    if wide > 0.0 and (one >= 0.0 or two >= 0.0):
        return limit * speed, limit * vx / speed, limit * vy / speed
    along = sqrt(max(limit * limit - margin * margin, 0.0))
    px, py = along * ax - margin * ay, along * ay + margin * ax
    qx, qy = along * bx + margin * by, along * by - margin * bx
    # the corner: margin (A + B) / (A x B)
    per = margin / across if wide == 0.0 else 0.0
    fx, fy = per * (ax + bx), per * (ay + by)
    best = fx * vx + fy * vy
    if px * vx + py * vy > best:
        best, fx, fy = px * vx + py * vy, px, py
    if qx * vx + qy * vy > best:
        best, fx, fy = qx * vx + qy * vy, qx, qy
    return best, fx, fy


@njit(**VIEWS)
def support_of_eroded(sides, first, last, lo, hi, law, y, out):  # type: ignore[no-untyped-def]
    """Writes the most work, the side, u, f_x, f_y, the torque and n . f of the best force on an arc.

    law: mu, size, norm, limit, margin.
    """
    mu, _, _, limit, margin = law
    slant = sqrt(1.0 + mu * mu)
    cosine, sine = 1.0 / slant, mu / slant
    turn = abs(y[0]) + abs(y[1]) + abs(y[2])
    for j in range(first, last + 1):
        edge = sides[j, 8]
        a = (lo if j == first else sides[j, 6]) - edge
        b = (hi if j == last else sides[j, 7]) - edge
        curved = sides.shape[1] > CONTROL
        if curved:
            lx, ly, hx, hy = fan(sides, j, a, b)
        else:
            lx, ly = sides[j, 5], -sides[j, 4]
            hx, hy = lx, ly
        ax, ay = sine * lx - cosine * ly, sine * ly + cosine * lx
        bx, by = -sine * hx - cosine * hy, -sine * hy + cosine * hx
        nx, ny = -0.5 * (ly + hy), 0.5 * (lx + hx)
        for k in range((4 if curved else 2) if a < b else 1):
            if curved:
                p, q, r = (a if k < 3 else b), (a if k < 2 else b), (a if k < 1 else b)
                px, py = polar(sides, j, 0, p, q, r), polar(sides, j, 1, p, q, r)
                at = a + (b - a) * k / 3.0
            else:
                at = a if k == 0 else b
                px, py = sides[j, 0] + at * sides[j, 2], sides[j, 1] + at * sides[j, 3]
            vx, vy = y[0] - y[2] * py, y[1] + y[2] * px
            value, fx, fy = _most(ax, ay, bx, by, limit, margin, vx, vy)
            if value > out[0] or (j == first and k == 0):
                out[0], out[1], out[2] = value, j, edge + at
                out[3], out[4], out[5] = fx, fy, px * fy - py * fx
                out[6] = max(nx * fx + ny * fy, 1e-3 * limit)
    out[0] += _ROUNDING * limit * turn


@njit(**VIEWS)
def add_middle(sides, first, last, lo, hi, law, r):  # type: ignore[no-untyped-def]
    """Adds to r the wrench of a force inside the region, at the middle of an arc's first side."""
    mu, _, _, limit, margin = law
    size = 0.5 * (limit + margin * sqrt(1.0 + mu * mu) / mu) if mu > 0.0 else limit
    a = lo - sides[first, 8]
    b = (hi if last == first else sides[first, 7]) - sides[first, 8]
    m = 0.5 * (a + b)
    if sides.shape[1] > CONTROL:
        tx, ty, _, _ = fan(sides, first, m, m)
        px, py = polar(sides, first, 0, m, m, m), polar(sides, first, 1, m, m, m)
        nx, ny = -ty, tx
    else:
        nx, ny = sides[first, 4], sides[first, 5]
        px, py = sides[first, 0] + m * sides[first, 2], sides[first, 1] + m * sides[first, 3]
    r[0] += size * nx
    r[1] += size * ny
    r[2] += size * (px * ny - py * nx)
