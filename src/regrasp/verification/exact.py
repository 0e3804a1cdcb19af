"""Conditions on one state, decided in exact rational arithmetic.

Every double is a rational number, so the conditions are decided on the very numbers of the plan, without
rounding and, for cones and limits, with zero tolerance:

    cone         f.n >= 0   and   |f|^2 |n|^2 <= (1 + mu^2) (f.n)^2
    soft finger  f.n >= 0   and   e^2 (|f|^2 |n|^2 - (f.n)^2) + mu^2 m^2 |n|^2 <= mu^2 e^2 (f.n)^2
    limit        |f|^2 <= max_force^2, of a soft finger |f|^2 + (mu m / e)^2
    equilibrium  |sum f_i + F|^2 <= eps^2 s^2   and   |sum r_i x f_i + tau|^2 <= eps^2 s^2 l^2

with s the largest of |F|, |tau| / l and |f_i|, l the largest |r_i|, and eps = 2^-40: forces in doubles cannot
cancel to nothing. Friction below 2^-40 counts as 2^-40, for the same reason: a double cannot express a
direction more finely.
"""

from collections.abc import Sequence
from fractions import Fraction
from math import inf, sqrt

from regrasp.mechanics.state import GraspState

RESOLUTION = Fraction(1, 2**40)
"""eps above: largest residual relative to the forces, and the least friction told from none."""

Vector = list[Fraction]


def check_state(state: GraspState, label: str) -> tuple[float, float, list[str]]:
    """(residual, least cone slack, violations) of one state; ``label`` names it in the violations."""
    residual, violations = _check_equilibrium(state, label)
    slacks = [inf]
    for i, name in enumerate(state.grasp.names):
        slack, broken = _check_force(state, i, f"{label}: force of {name}")
        slacks.append(slack)
        violations += broken
    return residual, min(slacks), violations


def _check_force(state: GraspState, i: int, what: str) -> tuple[float, list[str]]:
    contact = state.grasp.contacts[i]
    d = contact.dimension
    (*f, m), n = [*exact(state.forces[i, :d].tolist()), _torque(state, i)], exact(contact.normal.tolist())
    normal, ff, nn = dot(f, n), dot(f, f), dot(n, n)
    mu = max(Fraction(contact.friction), RESOLUTION)
    limit = contact.max_force
    if contact.torsion is not None:  # as much friction as the torque uses, in the place of a tangential force
        ff += (mu * m / Fraction(contact.torsion)) ** 2
    elif m:
        return -inf, [f"{what}: a point contact makes no torque about its normal, got {float(m):.3g}"]
    broken = []
    if normal < 0:
        broken.append(f"{what} pulls: normal component {float(normal):.3g}")
    elif ff * nn > (1 + mu * mu) * normal * normal:
        use = sqrt(max(ff * nn - normal * normal, Fraction(0))) / float(mu * normal) if normal else inf
        broken.append(f"{what} is outside its friction cone: it uses {use:.12g} of the friction available")
    if limit is not None and ff > Fraction(limit) ** 2:
        broken.append(f"{what} is {sqrt(ff):.12g}, above its limit {limit:.12g}")
    slack = float((1 + mu * mu) - ff * nn / (normal * normal)) if normal > 0 else (inf if ff == 0 else -inf)
    return slack, broken


def _check_equilibrium(state: GraspState, label: str) -> tuple[float, list[str]]:
    d = state.grasp.dimension
    load = exact(state.load.vector.tolist())
    force, torque = load[:d], load[d:]
    positions = [exact(c.position.tolist()) for c in state.grasp.contacts]
    forces = [exact(f[:d]) for f in state.forces.tolist()]
    for i, contact in enumerate(state.grasp.contacts):
        if _torque(state, i):
            about = [_torque(state, i) * x for x in exact(contact.normal.tolist())]
            torque = [a + b for a, b in zip(torque, about, strict=True)]
    for r, f in zip(positions, forces, strict=True):
        force = [a + b for a, b in zip(force, f, strict=True)]
        torque = [a + b for a, b in zip(torque, cross(r, f), strict=True)]
    arm2 = max(dot(r, r) for r in positions) or Fraction(1)
    scale2 = max(dot(load[:d], load[:d]), dot(load[d:], load[d:]) / arm2, *(dot(f, f) for f in forces))
    residual2 = max(dot(force, force), dot(torque, torque) / arm2)
    if scale2 == 0:
        return 0.0, []
    relative = sqrt(residual2 / scale2)
    if residual2 > RESOLUTION**2 * scale2:
        return relative, [
            f"{label}: not in equilibrium, G f + w_ext is {relative:.3g} of the largest force "
            f"(allowed {float(RESOLUTION):.1e})"
        ]
    return relative, []


def _torque(state: GraspState, i: int) -> Fraction:
    """The torque of a soft finger about its normal; 0 where none is."""
    return Fraction(float(state.forces[i, 3])) if state.forces.shape[1] == 4 else Fraction(0)


def exact(values: Sequence[float]) -> Vector:
    """Doubles as the rationals they are."""
    return [Fraction(value) for value in values]


def dot(a: Vector, b: Vector) -> Fraction:
    """The product of two vectors."""
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def cross(r: Vector, f: Vector) -> Vector:
    """The product r x f: one number in the plane, three in space."""
    if len(r) == 2:
        return [r[0] * f[1] - r[1] * f[0]]
    return [r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]]
