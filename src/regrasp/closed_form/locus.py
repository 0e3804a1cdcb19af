"""The equilibrium locus LS_B of two planar contacts: the interval of squeezes inside both cones.

Equilibrium f_1 + f_2 + F = 0, r_1 x f_1 + r_2 x f_2 + tau = 0 leaves one number free (frame of two
contacts in ``closed_form/__init__.py``):

    phi = F . u,    a = (tau - r_2 x F) / |P_1 P_2|,    b = -(tau - r_1 x F) / |P_1 P_2|

and each cone edge bounds that number linearly. In the plane the two half-planes are the friction cone.
"""

from math import inf, sqrt

# A cone edge within this angle [rad] of the line of contacts is parallel to it: the difference is rounding
# in somebody's coordinates, and a squeeze that starts at 1e12 times the load is no squeeze.
PARALLEL = 1e-12
_EPS = 2.0**-52
# Torque left after cancellation, and a gap between bounds, below these fractions of their terms are rounding.
_CANCELLED = 8 * _EPS
_CLOSED = 32 * _EPS


def pair_frame(
    x1: float, y1: float, x2: float, y2: float, fx: float, fy: float, tau: float
) -> tuple[float, float, float, float, float, float]:
    """(u_x, u_y, phi, a, b, parallel): the frame, the load in it, the sine that counts as parallel."""
    dx, dy = x2 - x1, y2 - y1
    per_length = 1.0 / sqrt(dx * dx + dy * dy)
    ux, uy = dx * per_length, dy * per_length
    across = fy * ux - fx * uy
    # The torque about each contact and the size of its terms. Only one of a and b is made from its torque,
    # the one with smaller terms; a + b + F . p = 0 gives the other, so that forces balance to their rounding.
    about1, terms1 = tau - (x1 * fy - y1 * fx), abs(tau) + abs(x1 * fy) + abs(y1 * fx)
    about2, terms2 = tau - (x2 * fy - y2 * fx), abs(tau) + abs(x2 * fy) + abs(y2 * fx)
    through1, through2 = abs(about1) <= _CANCELLED * terms1, abs(about2) <= _CANCELLED * terms2
    if through1 and through2 and abs(across) > _CANCELLED * (abs(fx) + abs(fy)):
        a = b = (
            -0.5 * across
        )  # across the line between contacts so near that both count as on the load's line
    elif through1 or through2:
        a = 0.0 if through2 else -across
        b = 0.0 if through1 else -across
    elif terms2 <= terms1:
        a = about2 * per_length
        b = -(a + across)
    else:
        b = -about1 * per_length
        a = -(b + across)
    # Coordinates far from the origin place the line less exactly.
    parallel = PARALLEL + _EPS * (abs(x1) + abs(y1) + abs(x2) + abs(y2)) * per_length
    return ux, uy, fx * ux + fy * uy, a, b, parallel


def cone_interval(c: float, s: float, mu: float, a: float, parallel: float) -> tuple[float, float]:
    """The interval of x with the force (x, a) inside the cone of normal (c, s), both along (u, p).

    The normal may have any length. Empty as (inf, -inf). Rows, with t the normal turned by 90 degrees:

        mu f.n - f.t >= 0:   (mu c + s) x + (mu s - c) a >= 0
        mu f.n + f.t >= 0:   (mu c - s) x + (mu s + c) a >= 0
    """
    small = parallel * parallel * (c * c + s * s) * (1.0 + mu * mu)
    slope, offset = mu * c + s, (mu * s - c) * a
    lo, hi = -inf, inf
    if slope * slope <= small:
        if offset < 0.0:
            lo, hi = inf, -inf
    elif slope > 0.0:
        lo = -offset / slope
    else:
        hi = -offset / slope
    slope, offset = mu * c - s, (mu * s + c) * a
    if slope * slope <= small:
        if offset < 0.0:
            lo, hi = inf, -inf
    elif slope > 0.0:
        bound = -offset / slope
        lo = bound if bound > lo else lo
    else:
        bound = -offset / slope
        hi = bound if bound < hi else hi
    if mu == 0.0 and s * s <= small:  # the two rows say f.t = 0; the normal lies along the line
        if c > 0.0:
            lo = 0.0 if lo < 0.0 else lo
        else:
            hi = 0.0 if hi > 0.0 else hi
    elif lo >= hi and hi > -inf and lo < inf:
        # Across the cone the rows never cross; across its negative, f.n < 0, they always do. The normal force
        # tells one from the other where rounding of a narrow cone does not.
        middle = 0.5 * (lo + hi)
        lo, hi = (middle, middle) if c * middle + s * a >= 0.0 else (inf, -inf)
    return lo, hi


def is_rounding(across: float, phi: float, other: float) -> bool:
    """Whether a force across the line of contacts is lost in the rounding of the load and the other one."""
    return abs(across) <= _CLOSED * (abs(phi) + abs(other))


def common_interval(
    lo1: float, hi1: float, lo2: float, hi2: float, phi: float, a: float, b: float
) -> tuple[float, float]:
    """Squeezes allowed by both contacts; ``lo2, hi2`` bound f_2 . u = -(x + phi). Empty as (inf, -inf)."""
    lo = lo1 if lo1 > -phi - hi2 else -phi - hi2
    hi = hi1 if hi1 < -phi - lo2 else -phi - lo2
    if lo <= hi:
        return lo, hi
    if lo < inf and hi > -inf and lo - hi <= _CLOSED * (abs(lo) + abs(hi) + abs(phi) + abs(a) + abs(b)):
        middle = 0.5 * (lo + hi)  # the interval is one point, and rounding crossed its ends
        return middle, middle
    return inf, -inf


def squeeze_interval(
    x1: float,
    y1: float,
    nx1: float,
    ny1: float,
    mu1: float,
    x2: float,
    y2: float,
    nx2: float,
    ny2: float,
    mu2: float,
    fx: float,
    fy: float,
    tau: float,
) -> tuple[float, float]:
    """(lo, hi) of the squeeze x for contacts (x_i, y_i), normals of any length, frictions and the load.

    Either end may be infinite; an empty locus is (inf, -inf).
    """
    ux, uy, phi, a, b, parallel = pair_frame(x1, y1, x2, y2, fx, fy, tau)
    lo1, hi1 = cone_interval(nx1 * ux + ny1 * uy, ny1 * ux - nx1 * uy, mu1, a, parallel)
    if lo1 > hi1 and is_rounding(a, phi, b):
        lo1, hi1 = cone_interval(nx1 * ux + ny1 * uy, ny1 * ux - nx1 * uy, mu1, 0.0, parallel)
    lo2, hi2 = cone_interval(nx2 * ux + ny2 * uy, ny2 * ux - nx2 * uy, mu2, b, parallel)
    if lo2 > hi2 and is_rounding(b, phi, a):
        lo2, hi2 = cone_interval(nx2 * ux + ny2 * uy, ny2 * ux - nx2 * uy, mu2, 0.0, parallel)
    return common_interval(lo1, hi1, lo2, hi2, phi, a, b)


def within_limit(lo: float, hi: float, across: float, limit: float) -> tuple[float, float]:
    """The part of (lo, hi) where a force (x, across) is no larger than ``limit``; empty as lo > hi."""
    room = limit * limit - across * across
    if room < 0.0:
        return inf, -inf
    reach = sqrt(room)
    return (lo if lo > -reach else -reach), (hi if hi < reach else reach)
