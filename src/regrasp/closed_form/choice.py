"""The best two-finger state of one grasp, from contact numbers to forces, in one call."""

from math import inf, nan, sqrt

from regrasp.closed_form.best import (
    best_angle,
    best_effort,
    best_force,
    best_friction_use,
    best_peak,
    best_peak_normal,
    best_sum_normal,
    clamp,
    contact_lines,
)
from regrasp.closed_form.locus import common_interval, cone_interval, is_rounding, pair_frame, within_limit

ANGLE, FORCE, EFFORT, PEAK, PEAK_NORMAL, FRICTION_USE, SUM_NORMAL = range(7)
OBJECTIVES = ("angle", "force", "effort", "peak", "peak_normal", "friction_use", "sum_normal")
"""Names of the objectives; the place of a name is its code."""


def best_squeeze(
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
    objective: int,
    limit1: float,
    limit2: float,
    peak_ratio: float,
) -> tuple[float, tuple[float, float, float, float], tuple[float, float]]:
    """The best squeeze, the forces (f_1x, f_1y, f_2x, f_2y) and the limits they were chosen under.

    Squeeze and forces are NaN where no state exists. The widest angle or force margin and the least friction
    use may lie at infinite force, so for these objectives a contact without a limit (infinite) is limited to
    ``peak_ratio`` (at least 1) times the least peak force of the grasp.
    """
    ux, uy, phi, a, b, parallel = pair_frame(x1, y1, x2, y2, fx, fy, tau)
    lo1, hi1 = cone_interval(nx1 * ux + ny1 * uy, ny1 * ux - nx1 * uy, mu1, a, parallel)
    if lo1 > hi1 and is_rounding(a, phi, b):  # only the apex is left: nothing across
        a = 0.0
        lo1, hi1 = cone_interval(nx1 * ux + ny1 * uy, ny1 * ux - nx1 * uy, mu1, a, parallel)
    lo2, hi2 = cone_interval(nx2 * ux + ny2 * uy, ny2 * ux - nx2 * uy, mu2, b, parallel)
    if lo2 > hi2 and is_rounding(b, phi, a):
        b = 0.0
        lo2, hi2 = cone_interval(nx2 * ux + ny2 * uy, ny2 * ux - nx2 * uy, mu2, b, parallel)
    if limit1 < inf:
        lo1, hi1 = within_limit(lo1, hi1, a, limit1)
    if limit2 < inf:
        lo2, hi2 = within_limit(lo2, hi2, b, limit2)
    lo, hi = common_interval(lo1, hi1, lo2, hi2, phi, a, b)
    if lo > hi:
        return nan, (nan, nan, nan, nan), (limit1, limit2)
    if objective == EFFORT:
        x = best_effort(lo, hi, phi)
    elif objective == PEAK:
        x = best_peak(lo, hi, phi, a, b)
    else:
        first, second = contact_lines(ux, uy, phi, a, b, nx1, ny1, mu1, nx2, ny2, mu2)
        if objective == PEAK_NORMAL:
            x = best_peak_normal(lo, hi, phi, first, second)
        elif objective == SUM_NORMAL:
            x = best_sum_normal(lo, hi, phi, first, second)
        else:
            if limit1 == inf or limit2 == inf:
                x = best_peak(lo, hi, phi, a, b)
                square1, square2 = x * x + a * a, (x + phi) * (x + phi) + b * b
                limit = peak_ratio * sqrt(square1 if square1 > square2 else square2)
                limit1 = limit if limit < limit1 else limit1
                limit2 = limit if limit < limit2 else limit2
                left1, right1 = within_limit(lo1, hi1, a, limit1)
                left2, right2 = within_limit(lo2, hi2, b, limit2)
                lo, hi = common_interval(left1, right1, left2, right2, phi, a, b)
                if lo > hi:  # a ratio of 1 leaves the point itself, up to rounding
                    lo = hi = x
            if objective == ANGLE:
                x = best_angle(lo, hi, phi, a, b, first, second)
            elif objective == FRICTION_USE:
                x = best_friction_use(lo, hi, phi, a, b, first, second)
            else:
                x = best_force(lo, hi, first, second)
    # Each force by its own bounds: rounding of a large force would carry a small one out of its cone.
    y = clamp(-(x + phi), lo2, hi2)
    x = clamp(x, lo1, hi1)
    return x, (x * ux - a * uy, x * uy + a * ux, y * ux - b * uy, y * uy + b * ux), (limit1, limit2)
