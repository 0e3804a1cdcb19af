"""The widest least angle margin of a pair under many loads: the answer of ``best``, for vector instructions.

What the load leaves alone comes from ``load_cone``; what remains has no branch, so a compiler does several
loads at a time. It is meant to be compiled: a quotient without meaning is infinite or NaN and is not chosen.
With y = -(x + phi) and each unit normal (c_i, s_i) along (u, p), the contacts are alike in their own numbers
(z, w) = (x, a) and (y, b):

    N = c z + s w,    T = c w - s z.

1. Bounds: each cone edge bounds z by a multiple of w.
2. Limits: forces stay within the contacts' own limits and ``ratio`` times the least peak, which is the least
   of max(|f_1|, |f_2|) at x = 0, at y = 0 and where both are as large, each moved into the bounds.
3. Upright: f turns with the sign of -w as z grows. So a contact is at its best where T = 0, or at the first
   end if T already has the sign that it turns to, or at the last if T does not have it even there.
4. Equal: as complex numbers, f_1 = x + i a and f_2 = y + i b have the angles delta_i = arg(f_i / n_i) to
   their normals, with signs sigma_i between the best x of one contact and that of the other. The margin of
   contact 1 is the lesser where |delta_1| - |delta_2| > alpha_1 - alpha_2, an angle whose tangent is d / k
   with d = mu_1 - mu_2, k = 1 + mu_1 mu_2. The left side is sigma_1 times the argument of f_1 conj(f_2) nu,
   nu = conj(n_1) n_2, for equal signs, and of f_1 f_2 nu, nu = conj(n_1 n_2), for different ones. These
   products of forces are, with e = b and e = -b,

       (-x^2 - phi x + a e)  -  i ((a + e) x + phi a),

   so that gap(x) = k sigma_1 Im(.) - d Re(.) is quadratic. The best x is that of contact 1 if gap >= 0 there,
   that of contact 2 if gap <= 0 there, and else the root between: it is known whether the gap rises or falls
   on the way, and so which of the two roots that is.
"""

from math import sqrt

from regrasp.closed_form.load_cone import Cone, Reach, Turned

NO_HOLD = -1.0
"""In the place of the margin of a pair that cannot hold the load."""
UNSURE = -2.0
"""In the place of a margin that rounding may decide: of a contact without force, or limits that just meet."""

_SURE = 1e-9
_HALF_PI = 1.5707963267948966


def turning_margin(
    fx: float, fy: float, turned: Turned, first: Cone, second: Cone, reach1: Reach, reach2: Reach,
    limited: bool, limit1: float, limit2: float, ratio: float, idle: float,
) -> float:  # fmt: skip
    """The margin [rad] to 1e-8, for a load inside the pair's cone; or ``NO_HOLD``, or ``UNSURE``.

    ratio: infinite if both contacts have limits. idle: of the load, below which a contact may carry nothing.
    """
    ux, uy, ax, ay, bx, by = turned
    phi, a, b = ux * fx + uy * fy, ax * fx + ay * fy, bx * fx + by * fy
    size = abs(fx) + abs(fy)
    # 1 and 2: bounds and limits
    lo1, hi1 = _own_interval(reach1, a)
    lo2, hi2 = _own_interval(reach2, b)
    room1, room2 = (limit1 - a) * (limit1 + a), (limit2 - b) * (limit2 + b)
    if limited:
        end1, end2 = sqrt(_larger(room1, 0.0)), sqrt(_larger(room2, 0.0))
        lo1, hi1, lo2, hi2 = (
            _larger(lo1, -end1),
            _smaller(hi1, end1),
            _larger(lo2, -end2),
            _smaller(hi2, end2),
        )
    lo, hi = _larger(lo1, -phi - hi2), _smaller(hi1, -phi - lo2)
    x, square = _least_peak(lo, hi, phi, a, b)
    square = ratio * ratio * square
    end1, end2 = sqrt(_larger(square - a * a, 0.0)), sqrt(_larger(square - b * b, 0.0))
    left = _smaller(_larger(lo, _larger(-end1, -phi - end2)), x)
    right = _larger(_smaller(hi, _smaller(end1, end2 - phi)), x)
    # 3 and 4: each contact's best, and where both are equal
    best1 = _upright(first, reach1, a, left, right)
    best2 = -phi - _upright(second, reach2, b, -phi - right, -phi - left)
    rises = 1.0 if best1 <= best2 else -1.0
    sigma = -rises if a > 0.0 else rises
    g2, g1, g0 = _gap(first, second, phi, a, b, sigma)
    x = _lesser_is_widest(best1, best2, rises, g2, g1, g0)
    margin = _lesser_margin(first, x, a, second, -(x + phi), b)
    # What is left to the formula of one grasp
    gap, terms = hi - lo, abs(lo) + abs(hi) + size
    unsure = (abs(a) < idle * size) | (abs(b) < idle * size) | (abs(gap) < _SURE * terms)
    if limited:
        meets1, meets2 = abs(room1) < _SURE * limit1 * limit1, abs(room2) < _SURE * limit2 * limit2
        unsure = unsure | meets1 | meets2
        margin = NO_HOLD if (gap < 0.0) | (room1 < 0.0) | (room2 < 0.0) else margin
    return UNSURE if unsure else margin


def _own_interval(reach: Reach, w: float) -> tuple[float, float]:
    bound1, lower1, upper1, bound2, lower2, upper2, _ = reach
    z1, z2 = bound1 * w, bound2 * w
    return _larger(z1 + lower1, z2 + lower2), _smaller(z1 + upper1, z2 + upper2)


def _least_peak(lo: float, hi: float, phi: float, a: float, b: float) -> tuple[float, float]:
    """(x, square) of the least peak force."""
    x1, x2 = _smaller(_larger(0.0, lo), hi), _smaller(_larger(-phi, lo), hi)
    x3 = 0.5 * ((a - b) * (a + b) / phi - phi)
    x3 = _smaller(_larger(x3, _smaller(x1, x2)), _larger(x1, x2))
    square1 = _larger(x1 * x1 + a * a, (x1 + phi) * (x1 + phi) + b * b)
    square2 = _larger(x2 * x2 + a * a, (x2 + phi) * (x2 + phi) + b * b)
    square3 = _larger(x3 * x3 + a * a, (x3 + phi) * (x3 + phi) + b * b)
    x, square = x2 if square2 < square1 else x1, _smaller(square2, square1)
    return x3 if square3 < square else x, _smaller(square3, square)


def _upright(cone: Cone, reach: Reach, w: float, lo: float, hi: float) -> float:
    """The z of [lo, hi] where the contact's force is nearest to its normal."""
    c, s, _ = cone
    at_lo, at_hi = w * (s * lo - c * w), w * (s * hi - c * w)  # T in the sense in which the force turns
    between = hi if at_hi <= 0.0 else reach[6] * w
    return lo if at_lo >= 0.0 else between


def _gap(
    first: Cone, second: Cone, phi: float, a: float, b: float, sigma: float
) -> tuple[float, float, float]:
    """Coefficients of the gap, by falling power."""
    c1, s1, mu1 = first
    c2, s2, mu2 = second
    k, d = sigma * (1.0 + mu1 * mu2), mu1 - mu2
    same = a * b > 0.0
    e = b if same else -b
    re = c1 * c2 + s1 * s2 if same else c1 * c2 - s1 * s2  # of nu
    im = c1 * s2 - s1 * c2 if same else -(c1 * s2 + s1 * c2)
    of_re, of_im = k * im - d * re, k * re + d * im
    return -of_re, -(of_re * phi + of_im * (a + e)), a * (of_re * e - of_im * phi)


def _lesser_is_widest(best1: float, best2: float, rises: float, g2: float, g1: float, g0: float) -> float:
    """The x where the lesser margin is widest, ``rises`` being the sign of best2 - best1."""
    root = rises * sqrt(_larger(g1 * g1 - 4.0 * g2 * g0, 0.0))
    cancels = rises * g1 > 0.0  # -g1 + root would: take the other form of the same root
    x = (2.0 * g0 if cancels else root - g1) / (-g1 - root if cancels else 2.0 * g2)
    x = _smaller(_larger(x, _smaller(best1, best2)), _larger(best1, best2))
    x = best2 if (g2 * best2 + g1) * best2 + g0 <= 0.0 else x
    return best1 if (g2 * best1 + g1) * best1 + g0 >= 0.0 else x


def _lesser_margin(first: Cone, z1: float, w1: float, second: Cone, z2: float, w2: float) -> float:
    """The lesser of both contacts' margins [rad], at least 0: tan(margin) = (mu N - |T|) / (N + mu |T|)."""
    c1, s1, mu1 = first
    c2, s2, mu2 = second
    n1, t1 = c1 * z1 + s1 * w1, abs(c1 * w1 - s1 * z1)
    n2, t2 = c2 * z2 + s2 * w2, abs(c2 * w2 - s2 * z2)
    above1, below1 = mu1 * n1 - t1, n1 + mu1 * t1
    above2, below2 = mu2 * n2 - t2, n2 + mu2 * t2
    first_is = above1 * below2 <= above2 * below1
    return arc_tangent(_larger(above1 if first_is else above2, 0.0), below1 if first_is else below2)


def arc_tangent(above: float, below: float) -> float:
    """atan(above / below) of above >= 0 and below > 0, to 6e-9: odd powers to 17, fitted for least error."""
    z = _smaller(above, below) / _larger(above, below)
    t = z * z
    r = 0.002456724036654465
    r = r * t - 0.014401355591465654
    r = r * t + 0.03978121948440049
    r = r * t - 0.07234856984343108
    r = r * t + 0.10498945869147748
    r = r * t - 0.1416122912851719
    r = r * t + 0.19985906755084268
    r = r * t - 0.333325970272429
    r = r * t + 0.9999998863827911
    return _HALF_PI - z * r if above > below else z * r


def _larger(a: float, b: float) -> float:
    """The larger; b if a is NaN."""
    return a if a > b else b


def _smaller(a: float, b: float) -> float:
    """The smaller; b if a is NaN."""
    return a if a < b else b
