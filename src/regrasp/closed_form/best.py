"""The best squeeze on an equilibrium locus, for each objective.

Along the locus the normal and tangential force of contact i are linear in the squeeze x,

    N_i = p_i x + q_i,     T_i = g_i x + h_i     (p_i^2 + g_i^2 = 1),

and every objective is the worse of two functions of x, one per contact, each with a single best point.
So the best x is the best point of one contact where the other is no worse, or else the one place between
the two best points where both are equal: a root of a linear or quadratic equation.

``lo, hi`` bound x. For ``angle``, ``force`` and ``friction_use`` both must be finite (limit the forces
first); the others are bounded by themselves.
"""

from math import inf, sqrt

Line = tuple[float, float, float, float, float]
"""(p, q, g, h, mu) of a contact."""

# A force below this fraction of the other one is rounding: the contact carries no force.
IDLE = 2.0**-40


def contact_lines(
    ux: float,
    uy: float,
    phi: float,
    a: float,
    b: float,
    nx1: float,
    ny1: float,
    mu1: float,
    nx2: float,
    ny2: float,
    mu2: float,
) -> tuple[Line, Line]:
    """The lines of both contacts from their frame; normals of any length."""
    scale1, scale2 = 1.0 / sqrt(nx1 * nx1 + ny1 * ny1), 1.0 / sqrt(nx2 * nx2 + ny2 * ny2)
    c1, s1 = (nx1 * ux + ny1 * uy) * scale1, (ny1 * ux - nx1 * uy) * scale1
    c2, s2 = (nx2 * ux + ny2 * uy) * scale2, (ny2 * ux - nx2 * uy) * scale2
    return (c1, a * s1, -s1, a * c1, mu1), (-c2, b * s2 - phi * c2, s2, b * c2 + phi * s2, mu2)


def clamp(x: float, lo: float, hi: float) -> float:
    """The point of [lo, hi] nearest to x."""
    return lo if x < lo else (hi if x > hi else x)


def angle_margin(line: Line, x: float) -> float:
    """The tangent of atan(mu) less the angle of the contact's force at x, in its cone, to its normal."""
    p, q, g, h, mu = line
    return margin_tangent(p * x + q, abs(g * x + h), mu)


def margin_tangent(n: float, t: float, mu: float) -> float:
    """tan(atan(mu) - atan2(t, n)) of normal force n and tangential force t >= 0; mu for no force.

    It grows with the angle margin up to far outside the cone, where it is -inf, and is one division in place
    of two arctangents.
    """
    below = n + mu * t
    if below > 0.0:
        return (mu * n - t) / below
    return mu if n == 0.0 and t == 0.0 else -inf


def best_angle(lo: float, hi: float, phi: float, a: float, b: float, first: Line, second: Line) -> float:
    """The x of the widest least angle margin of the contacts that carry force.

    A contact without force has no angle, so the best state may leave one idle. Where neither force turns
    with x, the force margin decides.
    """
    x = _best_angle_of_both(lo, hi, a, b, first, second)
    x1, x2 = clamp(0.0, lo, hi), clamp(-phi, lo, hi)  # where each carries least
    idle1 = x1 * x1 + a * a < IDLE * IDLE * ((x1 + phi) * (x1 + phi) + b * b)
    idle2 = (x2 + phi) * (x2 + phi) + b * b < IDLE * IDLE * (x2 * x2 + a * a)
    if idle1 or idle2:
        least = min(angle_margin(first, x), angle_margin(second, x))
        if idle1 and angle_margin(second, x1) > least:
            x, least = x1, angle_margin(second, x1)
        if idle2 and angle_margin(first, x2) > least:
            x = x2
    return x


def _best_angle_of_both(lo: float, hi: float, a: float, b: float, first: Line, second: Line) -> float:
    """The x of the widest least angle margin of both contacts.

    The force direction atan2(T, N) turns one way only as x grows, with the sign of g q - p h: that is -a
    for contact 1 and b for contact 2. Where it is zero the force does not turn at all.
    """
    turn1, turn2 = -a, b
    if turn1 == 0.0 and turn2 == 0.0:
        return best_force(lo, hi, first, second)
    if turn1 == 0.0:
        return _upright(lo, hi, second, turn2)
    best1 = _upright(lo, hi, first, turn1)
    if turn2 == 0.0:
        return best1
    best2 = _upright(lo, hi, second, turn2)
    if best1 > best2:  # let the first contact be the one whose best point lies left
        best1, best2, turn1, turn2, first, second = best2, best1, turn2, turn1, second, first
    if angle_margin(first, best1) <= angle_margin(second, best1):
        return best1
    if angle_margin(second, best2) <= angle_margin(first, best2):
        return best2
    # Between them |delta_1| - |delta_2| = alpha_1 - alpha_2: the vector (N_1, |T_1|) is parallel to
    # (N_2, |T_2|) turned by alpha_1 - alpha_2, whose cosine and sine are as k to d.
    p1, q1, g1, h1, mu1 = first
    p2, q2, g2, h2, mu2 = second
    sign1 = 1.0 if turn1 > 0.0 else -1.0
    sign2 = -1.0 if turn2 > 0.0 else 1.0
    g1, h1, g2, h2 = sign1 * g1, sign1 * h1, sign2 * g2, sign2 * h2
    k, d = 1.0 + mu1 * mu2, mu1 - mu2
    n_slope, n_offset = k * p2 - d * g2, k * q2 - d * h2
    t_slope, t_offset = d * p2 + k * g2, d * q2 + k * h2
    return _root_between(
        best1,
        best2,
        n_slope * g1 - t_slope * p1,
        n_slope * h1 + n_offset * g1 - t_slope * q1 - t_offset * p1,
        n_offset * h1 - t_offset * q1,
    )


def best_friction_use(
    lo: float, hi: float, phi: float, a: float, b: float, first: Line, second: Line
) -> float:
    """The x of the least larger friction use |T| / (mu N) of the contacts that carry force.

    With T / mu in the place of T all cones are equally wide, and the least use is the widest angle margin.
    A contact without friction uses none.
    """
    p1, q1, g1, h1, mu1 = first
    p2, q2, g2, h2, mu2 = second
    w1, w2 = 1.0 / mu1 if mu1 > 0.0 else 0.0, 1.0 / mu2 if mu2 > 0.0 else 0.0
    return best_angle(lo, hi, phi, a, b, (p1, q1, w1 * g1, w1 * h1, 1.0), (p2, q2, w2 * g2, w2 * h2, 1.0))


def best_force(lo: float, hi: float, first: Line, second: Line) -> float:
    """The x of the widest least force margin: the top of the lower envelope of four lines.

    Each contact has two, its distances (mu N -+ T) / sqrt(1 + mu^2) to the edges of its cone.
    """
    p1, q1, g1, h1, mu1 = first
    p2, q2, g2, h2, mu2 = second
    w1, w2 = 1.0 / sqrt(1.0 + mu1 * mu1), 1.0 / sqrt(1.0 + mu2 * mu2)
    lines = (
        (w1 * (mu1 * p1 - g1), w1 * (mu1 * q1 - h1)),
        (w1 * (mu1 * p1 + g1), w1 * (mu1 * q1 + h1)),
        (w2 * (mu2 * p2 - g2), w2 * (mu2 * q2 - h2)),
        (w2 * (mu2 * p2 + g2), w2 * (mu2 * q2 + h2)),
    )
    rise, height = lines[0]  # the lowest line at lo
    for slope, offset in lines:
        below = slope * lo + offset - (rise * lo + height)
        if below < 0.0 or (below == 0.0 and slope < rise):
            rise, height = slope, offset
    x = lo
    while rise > 0.0:  # climb the lowest line to where a flatter one crosses under it
        crossing, flatter, level = hi, rise, height
        for slope, offset in lines:
            if slope < rise:
                at = (offset - height) / (rise - slope)
                if at < crossing:
                    crossing, flatter, level = at, slope, offset
        if flatter == rise:
            return hi
        x, rise, height = clamp(crossing, x, hi), flatter, level
    return x


def best_effort(lo: float, hi: float, phi: float) -> float:
    """The x of the least sum of squares |f_1|^2 + |f_2|^2."""
    return clamp(-0.5 * phi, lo, hi)


def best_peak(lo: float, hi: float, phi: float, a: float, b: float) -> float:
    """The x of the least larger force, max(|f_1|, |f_2|)."""
    x1, x2 = clamp(0.0, lo, hi), clamp(-phi, lo, hi)  # each force's own least
    if x1 * x1 + a * a >= (x1 + phi) * (x1 + phi) + b * b:
        return x1
    if x2 * x2 + a * a <= (x2 + phi) * (x2 + phi) + b * b:
        return x2
    return clamp(0.5 * ((a - b) * (a + b) / phi - phi), min(x1, x2), max(x1, x2))


def best_peak_normal(lo: float, hi: float, phi: float, first: Line, second: Line) -> float:
    """The x of the least larger normal force, max(N_1, N_2)."""
    p1, q1 = first[0], first[1]
    p2, q2 = second[0], second[1]
    if p1 == 0.0 and p2 == 0.0:
        return best_effort(lo, hi, phi)
    x1 = lo if p1 > 0.0 else hi  # each normal force's own least
    x2 = lo if p2 > 0.0 else hi
    if p1 == 0.0:
        return x2
    if p2 == 0.0 or x1 == x2:
        return x1
    if p1 * x1 + q1 >= p2 * x1 + q2:
        return x1
    if p1 * x2 + q1 <= p2 * x2 + q2:
        return x2
    return clamp((q2 - q1) / (p1 - p2), lo, hi)


def best_sum_normal(lo: float, hi: float, phi: float, first: Line, second: Line) -> float:
    """The x of the least N_1 + N_2, a line in x: an end of the locus; where it is level the least effort."""
    rise = first[0] + second[0]
    end = lo if rise > 0.0 else hi
    if abs(rise) <= IDLE or abs(end) == inf:
        return best_effort(lo, hi, phi)
    return end


def _upright(lo: float, hi: float, line: Line, turn: float) -> float:
    """The x of [lo, hi] where a force inside its cone is nearest to the normal (T = 0)."""
    g, h = line[2], line[3]
    at_lo, at_hi = g * lo + h, g * hi + h
    if turn < 0.0:
        at_lo, at_hi = -at_lo, -at_hi
    if at_lo >= 0.0:  # it turns away from the normal all the way
        return lo
    if at_hi <= 0.0:
        return hi
    return clamp(-h / g, lo, hi)


def _root_between(lo: float, hi: float, c2: float, c1: float, c0: float) -> float:
    """The root of c2 x^2 + c1 x + c0 in [lo, hi], where the polynomial is known to change sign."""
    discriminant = c1 * c1 - 4.0 * c2 * c0
    root = sqrt(discriminant) if discriminant > 0.0 else 0.0
    t = -0.5 * (c1 + root if c1 >= 0.0 else c1 - root)  # no cancellation
    first = t / c2 if c2 != 0.0 else lo
    second = c0 / t if t != 0.0 else first
    miss1, miss2 = abs(first - clamp(first, lo, hi)), abs(second - clamp(second, lo, hi))
    if c2 != 0.0 and miss1 <= miss2:
        return clamp(first, lo, hi)
    return clamp(second, lo, hi)
