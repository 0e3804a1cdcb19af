"""Forces inside friction cones as rational numbers, and their wrenches.

A force of a soft finger is (f, g) with the torque g e / mu about the normal (``regrasp.mechanics.cones``),
so that every cone is |f_t| <= mu f_n, of one tangent more.
"""

from collections.abc import Sequence
from fractions import Fraction
from math import cos, frexp, pi, sin

import numpy as np

from regrasp.measures.rationals import Vector
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.opposition import dot, exact

BITS = 48
"""Bits of the tangential part of a force; mostly 2^-44 of the friction is kept back for rounding."""


def normal_of(contact: Contact) -> Vector:
    """The normal, with a zero for the torque of a soft finger."""
    return exact(contact.normal) + ([Fraction(0)] if contact.torsion is not None else [])


def ray(contact: Contact, direction: Sequence[float]) -> Vector:
    """A force n + mu t at the edge of the cone, along a unit tangent ``direction``; in space just inside."""
    n, mu = normal_of(contact), Fraction(contact.friction)
    if contact.dimension == 2:
        side = 1 if n[0] * Fraction(direction[1]) - n[1] * Fraction(direction[0]) >= 0 else -1
        return [n[0] - side * mu * n[1], n[1] + side * mu * n[0]]
    t = [Fraction(float(value)) for value in direction]
    along = dot(t, n)
    _, exponent = frexp(min(contact.friction, 1.0))
    grid = Fraction(2) ** (exponent - BITS)  # few bits, all of one denominator: small whole numbers
    for kept in (4, 20, 36):  # a large coefficient makes more of the rounding
        share = mu * (1 - Fraction(2**kept, 2**BITS))
        force = [a + round(share * (b - along * a) / grid) * grid for a, b in zip(n, t, strict=True)]
        if is_inside(contact, force):
            return force
    return n


def rays(contact: Contact, tangents: Array, facets: int) -> list[Vector]:
    """Forces whose combinations fill the cone in the plane, and much of it in space."""
    if contact.friction == 0:
        return [normal_of(contact)]
    if contact.dimension == 2:
        return [ray(contact, sign * tangents[0]) for sign in (-1, 1)]
    angles = [2 * pi * k / facets for k in range(facets)]
    around = [cos(a) * tangents[0] + sin(a) * tangents[1] for a in angles]
    if contact.torsion is not None:
        around += [tangents[2], -tangents[2]]
    size = len(normal_of(contact))
    return [ray(contact, np.asarray(direction)[:size].tolist()) for direction in around]


def is_inside(contact: Contact, force: Vector) -> bool:
    """Whether a force lies in the friction cone, decided exactly."""
    n, mu = normal_of(contact), Fraction(contact.friction)
    along = dot(force, n)
    return along >= 0 and dot(force, force) * dot(n, n) <= (1 + mu * mu) * along * along


def wrench(contact: Contact, force: Vector) -> Vector:
    """The wrench (f, r x f + g e n / mu) of a force."""
    r = exact(contact.position)
    if contact.dimension == 2:
        return [*force, r[0] * force[1] - r[1] * force[0]]
    (x, y, z), (fx, fy, fz) = r, force[:3]
    torque = [y * fz - z * fy, z * fx - x * fz, x * fy - y * fx]
    if contact.torsion is not None:
        arm = force[3] * Fraction(contact.torsion) / Fraction(contact.friction)
        torque = [t + arm * n for t, n in zip(torque, exact(contact.normal), strict=True)]
    return [*force[:3], *torque]
