"""The angle margin of the state that two contacts choose under a load through the origin, both pushing.

Where the load's line passes through a contact, its finger can hold the object by itself, and the widest angle
margin is often the one of which the other finger has no part: a finger without force has no angle. Such a
state is no hold of two fingers, unless one may hold alone. In its place stands the state of the widest force
margin, in which both push; where even that leaves one of them without force there is no hold.
"""

from math import atan, atan2, hypot, inf, isnan, nan, sqrt
from typing import Any

from regrasp.closed_form.choice import ANGLE, FORCE, PEAK, best_squeeze

Finger = tuple[float, float, float, float, float, float]
"""(x, y, nx, ny, mu, limit) of a contact, its normal of length one, the limit infinite for none."""

NO_STATE = -1.0

# A load that passes a contact nearer than this fraction of its distance from the centre passes through it;
# a force below this fraction of the other one is none.
_THROUGH, _IDLE = 1e-11, 2.0**-39
_SPARE = 1e-9  # of limits and margins [rad] after a squeeze was moved


def pair_margin(
    first: Finger, second: Finger, fx: float, fy: float, ratio: float, least: float, alone: bool
) -> float:
    """The margin [rad], ``NO_STATE`` for none.

    ratio: limit on forces without one, as a multiple of the least peak. least: of normal forces. alone:
    whether one finger may hold without the other.
    """
    margin, _ = _chosen(first, second, fx, fy, ratio, least, ANGLE)
    through = passes_through(first[0], first[1], fx, fy) or passes_through(second[0], second[1], fx, fy)
    if alone or not through:
        return margin
    by_force, both_push = _chosen(first, second, fx, fy, ratio, least, FORCE)
    by_angle, both = _chosen(first, second, fx, fy, ratio, least, ANGLE)
    if both:
        return by_angle
    return by_force if both_push else NO_STATE


def passes_through(x: Any, y: Any, fx: Any, fy: Any) -> Any:
    """Whether a force through the origin passes through a point; of arrays, too."""
    torque = x * fy - y * fx
    return torque * torque <= _THROUGH * _THROUGH * (x * x + y * y) * (fx * fx + fy * fy)


def _chosen(
    first: Finger, second: Finger, fx: float, fy: float, ratio: float, least: float, objective: int
) -> tuple[float, bool]:
    """The margin of the state that is best for an objective, and whether both fingers push."""
    x1, y1, nx1, ny1, mu1, limit1 = first
    x2, y2, nx2, ny2, mu2, limit2 = second
    x, _, _ = best_squeeze(
        x1, y1, nx1, ny1, mu1, x2, y2, nx2, ny2, mu2, fx, fy, 0.0, objective, limit1, limit2, ratio
    )
    length = hypot(x2 - x1, y2 - y1)
    ux, uy = (x2 - x1) / length, (y2 - y1) / length
    b = (x1 * fy - y1 * fx) / length
    a = -(ux * fy - uy * fx) - b
    along = ux * fx + uy * fy
    if least > 0.0:
        c1, s1, c2, s2 = nx1 * ux + ny1 * uy, ny1 * ux - nx1 * uy, nx2 * ux + ny2 * uy, ny2 * ux - nx2 * uy
        x = _pressing(x, along, a, b, c1, s1, c2, s2, least)
    if isnan(x):
        return NO_STATE, False
    y = -x - along
    f1x, f1y, f2x, f2y = x * ux - a * uy, x * uy + a * ux, y * ux - b * uy, y * uy + b * ux
    size1, size2 = hypot(f1x, f1y), hypot(f2x, f2y)
    larger = max(size1, size2)
    margin = inf
    if size1 > _IDLE * larger:
        margin = atan(mu1) - atan2(abs(nx1 * f1y - ny1 * f1x), nx1 * f1x + ny1 * f1y)
    if size2 > _IDLE * larger:
        margin = min(margin, atan(mu2) - atan2(abs(nx2 * f2y - ny2 * f2x), nx2 * f2x + ny2 * f2y))
    if least > 0.0:  # the best of all states was moved: it may have left the cones or the limits
        if limit1 == inf or limit2 == inf:
            peak = _peak(first, second, fx, fy, along, a, b)
            limit1 = ratio * peak if limit1 == inf else limit1
            limit2 = ratio * peak if limit2 == inf else limit2
        over = size1 > limit1 * (1 + _SPARE) or size2 > limit2 * (1 + _SPARE)
        if over or margin < -_SPARE:
            return NO_STATE, False
    return max(margin, 0.0), size1 > _IDLE * larger and size2 > _IDLE * larger


def _peak(first: Finger, second: Finger, fx: float, fy: float, along: float, a: float, b: float) -> float:
    """The least peak force [N]."""
    x1, y1, nx1, ny1, mu1, limit1 = first
    x2, y2, nx2, ny2, mu2, limit2 = second
    x, _, _ = best_squeeze(
        x1, y1, nx1, ny1, mu1, x2, y2, nx2, ny2, mu2, fx, fy, 0.0, PEAK, limit1, limit2, 1.0
    )
    return sqrt(max(x * x + a * a, (x + along) * (x + along) + b * b))


def _pressing(
    x: float, along: float, a: float, b: float, c1: float, s1: float, c2: float, s2: float, least: float
) -> float:
    """The squeeze nearest to x with which both normal forces are at least ``least``; NaN for none.

    The best margin has one peak over the squeeze, so it is there under the two bounds, c x + s a >= least and
    -c (x + along) + s b >= least, with the normals (c, s) along the line and across it.
    """
    lo, hi = -inf, inf
    for slope, rest in ((c1, least - s1 * a), (-c2, least + c2 * along - s2 * b)):
        if slope > 0.0:
            lo = max(lo, rest / slope)
        elif slope < 0.0:
            hi = min(hi, rest / slope)
        elif rest > 0.0:
            lo = inf
    if isnan(x) or not (lo <= hi and lo < inf and hi > -inf):
        return nan
    return min(max(x, lo), hi)
