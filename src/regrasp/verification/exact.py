"""Conditions on one state, decided in exact rational arithmetic.

Every double is a rational number, so the conditions are decided on the very numbers of the plan, without
rounding and, for cones and limits, with zero tolerance:

    cone         f.n >= 0   and   |f|^2 |n|^2 <= (1 + mu^2) (f.n)^2
    soft finger  f.n >= 0   and   e^2 (|f|^2 |n|^2 - (f.n)^2) + mu^2 m^2 |n|^2 <= mu^2 e^2 (f.n)^2
    limit        |f|^2 <= max_force^2, of a soft finger |f|^2 + (mu m / e)^2
    linear ones  A f <= b, A the contact's rows in the object's frame, as doubles (``Contact.limit_rows``)
    equilibrium  |sum f_i + F|^2 <= a^2   and   |sum r_i x f_i + tau|^2 <= a^2 l^2
    with         a = min(2^-40 s, 2^-10 w)

where s is the largest of |F|, |tau| / l and |f_i|, l the largest |r_i|: forces in doubles cannot cancel to
nothing. w is the largest |F| or |tau| / l that the plan has to hold at any time: forces 2^30 times the load
and more, which round to a part of it, must hold it to a thousandth all the same. Where a plan has no load at
all only s counts. Friction below 2^-40 counts as 2^-40: a double cannot express a direction more finely.
"""

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import inf, isnan, ldexp, sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import one_line

RESOLUTION = Fraction(1, 2**40)
"""eps above: largest residual relative to the forces, and the least friction told from none."""

HELD = Fraction(1, 2**10)
"""The largest residual relative to the load, however large the forces."""

Vector = list[Fraction]


def check_state(state: GraspState, label: str) -> tuple[float, float, list[str]]:
    """(residual, least cone slack, violations) of one state; ``label`` names it in the violations."""
    asked = load_size(state.grasp, state.load.vector[None])
    return check_forces(state.grasp, state.forces, exact(state.load.vector.tolist()), asked, label)


def check_forces(
    contacts: Iterable[Contact], forces: Array, load: Vector, asked: float, label: str
) -> tuple[float, float, list[str]]:
    """The same of finite forces (n, d), or (n, 4) where a finger is soft, under a load (3,) or (6,).

    ``asked`` is w above [N]; 0 for a plan without load.
    """
    rows = [_Force(contact, force) for contact, force in zip(contacts, forces.tolist(), strict=True)]
    residual, violations = _check_equilibrium(rows, load, asked, label)
    slacks = [inf]
    for row in rows:
        slack, broken = _check_force(row, f"{label}: force of {one_line(str(row.contact.name))}")
        slacks.append(slack)
        violations += broken
    return residual, min(slacks), violations


_LEAST, _MOST = 5e-324, float(np.finfo(float).max)


class _Force:
    """A force f of a contact, and a soft finger's torque m about its normal; 0 where none is."""

    def __init__(self, contact: Contact, numbers: list[float]) -> None:
        d = contact.dimension
        self.contact, self.f = contact, exact(numbers[:d])
        self.m = sum(exact(numbers[d:]), start=Fraction(0))
        self.r, self.n = exact(contact.position.tolist()), exact(contact.normal.tolist())


def _check_force(row: _Force, what: str) -> tuple[float, list[str]]:
    contact, f, m, n = row.contact, row.f, row.m, row.n
    normal, ff, nn = dot(f, n), dot(f, f), dot(n, n)
    mu = max(Fraction(contact.friction), RESOLUTION)
    limit = contact.max_force
    if contact.torsion is not None:  # as much friction as the torque uses, in the place of a tangential force
        ff += (mu * m / Fraction(contact.torsion)) ** 2
    elif m:
        return -inf, [f"{what}: a point contact makes no torque about its normal, got {float(m):.3g}"]
    broken = []
    if normal < 0:
        broken.append(f"{what} pulls: normal component {rounded(normal):.3g}")
    elif ff * nn > (1 + mu * mu) * normal * normal:
        use = root((ff * nn - normal * normal) / (mu * normal) ** 2) if normal else inf
        broken.append(f"{what} is outside its friction cone: it uses {use:.12g} of the friction available")
    if limit is not None and ff > Fraction(limit) ** 2:
        broken.append(f"{what} is {root(ff):.12g}, above its limit {limit:.12g}")
    broken += _check_rows(row, what)
    slack = rounded((1 + mu * mu) - ff * nn / (normal * normal)) if normal > 0 else (-inf if ff else inf)
    return slack, broken


def _check_rows(row: _Force, what: str) -> list[str]:
    """Which of its linear limits a force breaks."""
    contact, force, broken = row.contact, [*row.f, row.m], []
    if contact.limits is None or contact.limit_rows is None:
        return []
    for k, (a, b) in enumerate(zip(contact.limit_rows.tolist(), contact.limits.bounds.tolist(), strict=True)):
        used = dot(exact(a), force[: len(a)])
        if used > Fraction(b):
            broken.append(f"{what} breaks its linear limit {k}: {rounded(used):.12g}, above {b:.12g}")
    return broken


def _check_equilibrium(rows: list[_Force], load: Vector, asked: float, label: str) -> tuple[float, list[str]]:
    d = len(rows[0].f)
    force, torque = load[:d], load[d:]
    for row in rows:
        force = [a + b for a, b in zip(force, row.f, strict=True)]
        torque = [a + b for a, b in zip(torque, cross(row.r, row.f), strict=True)]
        if row.m:
            torque = [a + row.m * b for a, b in zip(torque, row.n, strict=True)]
    length2 = max(dot(row.r, row.r) for row in rows) or Fraction(1)
    sizes2 = [dot(load[:d], load[:d]), dot(load[d:], load[d:]) / length2]
    sizes2 += [dot(row.f, row.f) for row in rows]
    scale2, residual2 = max(sizes2), max(dot(force, force), dot(torque, torque) / length2)
    if residual2 == 0:
        return 0.0, []
    if scale2 == 0:
        return inf, [f"{label}: not in equilibrium, torques of soft fingers balance no load"]
    relative = root(residual2 / scale2)
    if residual2 > RESOLUTION**2 * scale2:
        return relative, [
            f"{label}: not in equilibrium, G f + w_ext is {relative:.3g} of the largest force "
            f"(allowed {float(RESOLUTION):.1e})"
        ]
    if asked and residual2 > (HELD * Fraction(asked)) ** 2:
        return relative, [
            f"{label}: the load is not held, G f + w_ext is {root(residual2) / asked:.3g} of it (allowed "
            f"{float(HELD):.1e}): forces {root(scale2) / asked:.3g} times the load round to more than that"
        ]
    return relative, []


@np.errstate(all="ignore")
def load_size(grasp: Grasp, loads: Array) -> float:
    """The largest |F| and |tau| / l of loads (m, 3) or (m, 6) [N]; 0 only where all of them are 0."""
    d, arm = grasp.dimension, float(np.hypot.reduce(grasp.positions, axis=1).max()) or 1.0
    size = float(max(np.hypot.reduce(part, axis=1).max() for part in (loads[:, :d], loads[:, d:] / arm)))
    return min(max(size, _LEAST), _MOST) if loads.any() else 0.0


@np.errstate(all="ignore")
def least_angle(grasp: Grasp, forces: Array) -> float:
    """The least angle margin of the contacts that carry force [rad], in doubles; infinite where none does."""
    size = abs(forces).max()  # which angles do not depend on
    cones = grasp.cones
    found = margins(cones.measured(forces / size), cones.normals, grasp.frictions).least_angle
    return inf if isnan(found) else found


def arm2(grasp: Grasp) -> Fraction:
    """The square of the largest distance of a contact from the centre of mass [m^2]; 1 where it is 0."""
    return max(dot(r, r) for r in map(exact, grasp.positions.tolist())) or Fraction(1)


def rounded(value: Fraction) -> float:
    """The nearest double, infinite where there is none."""
    try:
        return float(value)
    except OverflowError:
        return inf if value > 0 else -inf


def root(value: Fraction) -> float:
    """The square root as a double at every scale: neither the value nor its root need be one."""
    if value <= 0:
        return 0.0
    half = (value.numerator.bit_length() - value.denominator.bit_length()) // 2
    try:
        return ldexp(sqrt(value / Fraction(4) ** half), half)
    except OverflowError:
        return inf


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
