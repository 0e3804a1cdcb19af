"""How much a finger in a friction cone can oppose a motion, in exact rational arithmetic."""

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp

# Roundings of a product with the grasp matrix and what follows, each of at most 2^-53 of the terms.
_ROUNDING = 64 * 2.0**-53


def oppositions(
    grasp: Grasp, frictions: Sequence[float], twist: Array, duals: Sequence[float] = ()
) -> tuple[Fraction, ...]:
    """For each contact an upper bound of the work against ``twist`` that one newton in its cone can do.

    duals: (m,) of the grasp's linear limits a . f <= b: velocities are then v + sum l a.

    It is zero exactly where a contact cannot oppose at all, and tight to 2^-100 elsewhere.

    Pushing with 1 N against v = v_n n + v_t t does the work (mu |v_t| - v_n) / sqrt(1 + mu^2) on the
    nearer edge of the cone, or |v| where -v lies inside the cone. At most |v_n| + |v_t| mu, scaled by n.
    """
    w, motion = grasp.width, exact(twist)
    added = _added(grasp, duals)
    columns = [exact(column) for column in grasp.matrix.T]
    result = []
    for i, (contact, mu_float) in enumerate(zip(grasp, frictions, strict=True)):
        v = [dot(motion, column) for column in columns[i * w : i * w + w]]
        n, mu = exact(contact.normal), Fraction(mu_float)
        if w > grasp.dimension:  # the turn about the normal, by the arm e / mu of the torque (``cones``)
            arm = Fraction(contact.torsion or 0) / (Fraction(contact.friction) or 1)
            v[3], n = v[3] * arm, [*n, Fraction(0)]
        if added:
            v = [a + b for a, b in zip(v, added[i], strict=True)]
        nn, vn, vv = dot(n, n), dot(v, n), dot(v, v)
        tangential = vv * nn - vn * vn  # |v_t|^2 |n|^2
        if vn <= 0 and tangential <= mu * mu * vn * vn:
            result.append(_sqrt_above(vv))
        elif vn >= 0 and mu * mu * tangential <= vn * vn:
            result.append(Fraction(0))
        else:
            result.append((mu * _sqrt_above(tangential) - vn) * _sqrt_above(1 / (nn * (1 + mu * mu))))
    return tuple(result)


def _added(grasp: Grasp, duals: Sequence[float]) -> list[list[Fraction]]:
    """What linear limits with these duals add to the velocity of each contact; nothing without any."""
    rows = grasp.limit_rows
    if rows is None or not len(duals):
        return []
    result = [[Fraction(0)] * grasp.width for _ in range(len(grasp))]
    for i, row, dual in zip(rows.contacts.tolist(), rows.rows, duals, strict=True):
        if dual:
            result[i] = [a + Fraction(dual) * b for a, b in zip(result[i], exact(row), strict=True)]
    return result


def surely_wins(
    grasp: Grasp, load: Array, twist: Array, frictions: Sequence[float], limits: Sequence[float]
) -> bool:
    """Whether a load does more work along a motion than forces within finite limits can oppose, for sure.

    In doubles, with room for their rounding; where this cannot tell, ``oppositions`` decides.
    """
    cones, mu, limit = grasp.cones, np.array(frictions), np.array(limits)
    velocities = (twist @ cones.matrix).reshape(len(grasp), -1)
    sizes = (np.abs(twist) @ np.abs(cones.matrix)).reshape(velocities.shape)
    work = limit * opposed(*parts(velocities, cones.normals), mu)
    terms = float(np.abs(load) @ np.abs(twist) + (limit * np.add.reduce(sizes, axis=1)) @ (1 + mu))
    return bool(load @ twist - np.add.reduce(work) > _ROUNDING * terms)


def parts(velocities: Array, normals: Array) -> tuple[Array, Array]:
    """(n,) v_n and |v_t| of velocities (n, w)."""
    along = np.einsum("ij,ij->i", velocities, normals)
    across = velocities - along[:, None] * normals
    return along, np.sqrt(np.einsum("ij,ij->i", across, across))


def opposed(along: Array, across: Array, frictions: Array) -> Array:
    """(n,) the most work that one newton in each cone can do against v_n (n,) and |v_t| (n,)."""
    edge = np.maximum(frictions * across - along, 0.0) / np.sqrt(1 + frictions * frictions)
    whole: Array = np.where(across <= -frictions * along, np.hypot(along, across), edge)
    return whole


def exact(values: Array) -> list[Fraction]:
    """The rationals that doubles are."""
    return [Fraction(value) for value in values.tolist()]


def dot(a: list[Fraction], b: list[Fraction]) -> Fraction:
    """The inner product of two vectors of rationals."""
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def _sqrt_above(value: Fraction) -> Fraction:
    """An upper bound of the square root, tight to 2^-100 of it; exactly 0 for 0."""
    if value == 0:
        return Fraction(0)
    shift = max(0, 200 - (value.numerator.bit_length() - value.denominator.bit_length()))
    shift += shift % 2
    return Fraction(isqrt((value.numerator << shift) // value.denominator) + 1, 1 << (shift // 2))
