"""The best two-finger state of one grasp, from contact numbers to squeeze, in one call."""

from math import inf, nan, sqrt

from regrasp.closed_form.best import (
    best_angle,
    best_effort,
    best_force,
    best_peak,
    best_peak_normal,
    contact_lines,
)
from regrasp.closed_form.locus import common_interval, cone_interval, limited_interval, pair_frame

ANGLE, FORCE, EFFORT, PEAK, PEAK_NORMAL = range(5)
OBJECTIVES = ("angle", "force", "effort", "peak", "peak_normal")
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
) -> tuple[float, float, float]:
    """(x, limit1, limit2): the best squeeze and the force limits it was chosen under; x is NaN if none is.

    The widest angle or force margin may lie at infinite force, so for these objectives a contact without a
    limit (infinite) is limited to ``peak_ratio`` (at least 1) times the least peak force of the grasp.
    """
    ux, uy, phi, a, b, parallel = pair_frame(x1, y1, x2, y2, fx, fy, tau)
    lo1, hi1 = cone_interval(nx1 * ux + ny1 * uy, ny1 * ux - nx1 * uy, mu1, a, parallel)
    lo2, hi2 = cone_interval(nx2 * ux + ny2 * uy, ny2 * ux - nx2 * uy, mu2, b, parallel)
    lo, hi = common_interval(lo1, hi1, lo2, hi2, phi, a, b)
    if limit1 < inf or limit2 < inf:
        lo, hi = limited_interval(lo, hi, phi, a, b, limit1, limit2)
    if lo > hi:
        return nan, limit1, limit2
    if objective == EFFORT:
        return best_effort(lo, hi, phi), limit1, limit2
    if objective == PEAK:
        return best_peak(lo, hi, phi, a, b), limit1, limit2
    p1, q1, g1, h1, p2, q2, g2, h2 = contact_lines(ux, uy, phi, a, b, nx1, ny1, nx2, ny2)
    if objective == PEAK_NORMAL:
        return best_peak_normal(lo, hi, phi, p1, q1, p2, q2), limit1, limit2
    if limit1 == inf or limit2 == inf:
        x = best_peak(lo, hi, phi, a, b)
        limit = peak_ratio * sqrt(max(x * x + a * a, (x + phi) * (x + phi) + b * b))
        limit1, limit2 = min(limit1, limit), min(limit2, limit)
        lo, hi = limited_interval(lo, hi, phi, a, b, limit1, limit2)
        if lo > hi:  # a ratio of 1 leaves the point itself, up to rounding
            lo = hi = x
    if objective == ANGLE:
        return best_angle(lo, hi, phi, a, b, p1, q1, g1, h1, mu1, p2, q2, g2, h2, mu2), limit1, limit2
    return best_force(lo, hi, p1, q1, g1, h1, mu1, p2, q2, g2, h2, mu2), limit1, limit2
