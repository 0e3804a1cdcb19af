"""Turning paths, decided exactly.

Between two angles apart by Delta the forces are a f + b g with a = sin(Delta - theta) / sin(Delta) and
b = sin(theta) / sin(Delta), never negative for |Delta| < pi. With f and g in their cones so are they, and

    G (a f + b g) + w(theta) = a (G f + w_f) + b (G g + w_g) + (w(theta) - a w_f - b w_g):

residuals at the ends grow by a + b <= 1 / cos(Delta / 2) at most, and the last term is what w_g differs from
w_f turned by Delta. The load at each angle is the start's, turned by sines and cosines in rational
arithmetic. The largest |a f + b g|^2 is bounded by c + |(p, q)|, the crest of its sine wave in 2 theta.

All of the load must turn for that. A load with a still part s, a torque in the plane or what lies along the
axis in space, needs a middle state m between two angles, under w_m = s + (w(Delta / 2) - s) / cos(Delta / 2):
then w(theta) = a w_f + c w_m + b w_g with a = sin^2((Delta - theta) / 2) / sin^2(Delta / 2), b the same with
theta, and c = 1 - a - b = 2 cos(Delta / 2) sin(theta / 2) sin((Delta - theta) / 2) / sin^2(Delta / 2): all at
least 0 for |Delta| < pi and of sum 1, so that f, m and g decide everything between them, force limits too.
"""

from fractions import Fraction
from itertools import pairwise
from math import inf, isqrt

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.value import one_line
from regrasp.verification.exact import (
    RESOLUTION,
    Vector,
    arm2,
    check_forces,
    dot,
    exact,
    least_angle,
    load_size,
    root,
)
from regrasp.verification.float_filter import Checked
from regrasp.verification.protocols import Plan, Turn
from regrasp.verification.rotated_loads import TurningLoad, cosine_sine
from regrasp.verification.shapes import check_turn_form

# 314159 / 100000 is a little less than pi.
_BELOW_PI = Fraction(314159, 100000)


def check_turn(plan: Plan, turn: Turn) -> Checked:
    """Check the states at all angles, the load there, the steps between them and the force limits."""
    start, grasp = plan.start, plan.start.grasp
    broken = check_turn_form(plan, turn)
    if broken:
        return Checked(broken, inf, 0.0, -inf)
    angles = exact(turn.angles.tolist())
    turning = TurningLoad(start.load, turn.axis, arm2(grasp))
    steps = [b - a for a, b in pairwise(angles)]
    if angles[0] != 0 or not (all(s > 0 for s in steps) or all(s < 0 for s in steps)):
        return Checked(["the angles of a turn must go one way from 0"], inf, 0.0, -inf)
    if max(abs(s) for s in steps) > _BELOW_PI:
        broken.append("a step of the turn is pi or more: no combination of its ends holds the load between")
    if turn.middles is None and not turning.turns_whole:
        broken.append(
            "a part of the load does not turn with the object, and no states between angles hold it"
        )
    ends = ((plan.start, 0), (plan.end, -1))
    if any((state.forces != turn.forces[k]).any() for state, k in ends):
        broken.append("start and end are not the first and the last state of the turn")
    if turning.differs(plan.end.load, angles[-1]):
        broken.append("end: the load is not the start's, seen from the turned object")
    residuals, slacks, angle_margins = [0.0], [inf], [inf]
    states = [
        (f"angle {float(angle):.6g} rad", turning.at(angle), turn.forces[k]) for k, angle in enumerate(angles)
    ]
    if turn.middles is not None:
        states += [
            (f"between {float(a):.6g} and {float(b):.6g} rad", turning.between(a, b), turn.middles[k])
            for k, (a, b) in enumerate(pairwise(angles))
        ]
    asked = load_size(grasp, start.load.vector[None])
    for label, load, forces in states:
        residual, slack, violations = check_forces(grasp, forces, load, asked, label)
        residuals.append(residual)
        slacks.append(slack)
        angle_margins.append(least_angle(grasp, forces))
        broken += violations
    if turn.middles is None:  # convex combinations never exceed the limits of their ends
        for k, step in enumerate(steps):
            broken += _check_limits(plan, turn, k, step)
    return Checked(broken, max(residuals), min(angle_margins), min(slacks))


def _check_limits(plan: Plan, turn: Turn, k: int, step: Fraction) -> list[str]:
    """Whether no force exceeds its limit between two angles."""
    broken = []
    c, s = cosine_sine(step)
    for i, contact in enumerate(plan.start.grasp.contacts):
        broken += _check_rows(contact, turn.forces[k, i], turn.forces[k + 1, i], c, s)
        if contact.max_force is None:
            continue
        limit = Fraction(contact.max_force)
        f, g = (_measured(contact, turn.forces[at, i].tolist()) for at in (k, k + 1))
        peak2 = _peak(f, g, c, s)
        if peak2 > limit**2:
            broken.append(
                f"force of {one_line(str(contact.name))} reaches {root(peak2):.12g} between two angles, "
                f"above its limit {contact.max_force:.12g}"
            )
    return broken


def _check_rows(contact: Contact, first: Array, last: Array, c: Fraction, s: Fraction) -> list[str]:
    """Which linear limits a force breaks between two angles.

    Its work p along a row runs on a sine wave from p_1 to p_2, of amplitude^2 (p_1^2 + p_2^2 - 2 p_1 p_2 c) /
    s^2, whose crest is between if it rises from the first and falls to the second; and a + b <= 1 / cos(Delta
    / 2), whose square is 2 / (1 + c).
    """
    broken: list[str] = []
    if contact.limits is None or contact.limit_rows is None:
        return broken
    for k, (a, b) in enumerate(zip(contact.limit_rows.tolist(), contact.limits.bounds.tolist(), strict=True)):
        row, most = exact(a), Fraction(b)
        p, q = (dot(row, exact(force.tolist()[: len(row)])) for force in (first, last))
        if not (q - p * c > 0 and p - q * c > 0):
            continue  # the highest is at an end, which is checked by itself
        crest2 = min((p * p + q * q - 2 * p * q * c) / (s * s), max(p, q) ** 2 * 2 / (1 + c))
        if crest2 > most**2:
            broken.append(
                f"force of {one_line(str(contact.name))} breaks its linear limit {k} between two angles: "
                f"{root(crest2):.12g}, above {b:.12g}"
            )
    return broken


def _measured(contact: Contact, force: list[float]) -> Vector:
    """A force as its limit measures it: a soft finger's torque as the tangential force mu m / e."""
    measured = exact(force)
    if contact.torsion is not None:
        measured[3] *= max(Fraction(contact.friction), RESOLUTION) / Fraction(contact.torsion)
    return measured


def _peak(f: Vector, g: Vector, c: Fraction, s: Fraction) -> Fraction:
    """An upper bound of |a f + b g|^2 over a step with cosine c and sine s, tight to 2^-60."""
    aa, ab, bb = dot(f, f), dot(f, g), dot(g, g)
    # The weights a + b never exceed 1 / cos(Delta / 2): for small steps the finer bound, where s^2 vanishes.
    highest = max(aa, bb) * 2 / (1 + c)
    # The slope of |.|^2 at both ends, times sin^2: it rises from the first and falls to the second end if the
    # crest lies between them; else an end is the highest.
    first, second = 2 * s * (ab - aa * c), 2 * s * (bb * c - ab)
    sign = 1 if s > 0 else -1
    if sign * first <= 0 or sign * second >= 0:
        return max(aa, bb)
    middle = (aa - 2 * ab * c + bb) / 2
    p, q = (aa * (c * c - s * s) - 2 * ab * c + bb) / -2, s * (ab - aa * c)
    return min(highest, max(aa, bb, (middle + _root_above(p * p + q * q)) / (s * s)))


def _root_above(value: Fraction) -> Fraction:
    """The square root, rounded up by less than 2^-60 of it."""
    shift = 64 + (value.denominator.bit_length() - value.numerator.bit_length()) // 2
    scaled = value * Fraction(4) ** shift
    return (isqrt(scaled.numerator // scaled.denominator) + 1) / Fraction(2) ** shift
