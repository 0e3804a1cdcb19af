"""Answers judged in rational arithmetic, from the definitions. Imports nothing of the project."""

from collections.abc import Sequence
from fractions import Fraction
from math import inf, isqrt

import numpy as np

Array = np.ndarray
RESOLUTION = Fraction(1, 2**40)
"""Largest residual relative to the forces, and the least friction told from none."""
NEVER = 10**9
"""Forces so many times the load hold nothing."""

Vector = list[Fraction]


def exact(values: Sequence[float]) -> Vector:
    """Doubles as the rationals they are."""
    return [Fraction(float(value)) for value in values]


def dot(a: Vector, b: Vector) -> Fraction:
    """The inner product."""
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def cross(r: Vector, f: Vector) -> Vector:
    """The torque of a force."""
    if len(r) == 2:
        return [r[0] * f[1] - r[1] * f[0]]
    return [r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]]


def state_faults(
    positions: Array, normals: Array, frictions: Array, limits: Array, load: Array, forces: Array
) -> list[str]:
    """What is wrong with forces that should hold a load; empty for a state."""
    d, faults = positions.shape[1], []
    r, n, f, w = ([exact(row) for row in rows.tolist()] for rows in (positions, normals, forces, load[None]))
    total, torque = w[0][:d], w[0][d:]
    for p, x in zip(r, f, strict=True):
        total = [a + b for a, b in zip(total, x, strict=True)]
        torque = [a + b for a, b in zip(torque, cross(p, x), strict=True)]
    arm2 = max(dot(p, p) for p in r) or Fraction(1)
    scale2 = max(dot(w[0][:d], w[0][:d]), dot(w[0][d:], w[0][d:]) / arm2, *(dot(x, x) for x in f))
    if max(dot(total, total), dot(torque, torque) / arm2) > RESOLUTION**2 * scale2:
        faults.append("not in equilibrium")
    for i, (x, normal) in enumerate(zip(f, n, strict=True)):
        mu, along = max(Fraction(float(frictions[i])), RESOLUTION), dot(x, normal)
        if along < 0:
            faults.append(f"{i} pulls")
        elif dot(x, x) * dot(normal, normal) > (1 + mu * mu) * along * along:
            faults.append(f"{i} is outside its cone")
        if limits[i] < inf and dot(x, x) > Fraction(float(limits[i])) ** 2:
            faults.append(f"{i} is above its limit")
    return faults


def is_escape(
    positions: Array, normals: Array, frictions: Array, limits: Array, load: Array, twist: Array
) -> bool:
    """Whether the load does more work along a motion than fingers oppose with less than ``NEVER`` loads."""
    d = positions.shape[1]
    motion, w = exact(twist.tolist()), exact(load.tolist())
    power, free = dot(motion, w), Fraction(0)
    for i, (r, n) in enumerate(zip(positions.tolist(), normals.tolist(), strict=True)):
        least = _most_opposed(_velocity(motion, exact(r)), exact(n), Fraction(float(frictions[i])))
        if limits[i] < inf:
            power -= Fraction(float(limits[i])) * least
        else:
            free = max(free, least)
    arm = _root_above(max(dot(exact(r), exact(r)) for r in positions.tolist())) or Fraction(1)
    size = _root_above(dot(w[:d], w[:d])) + _root_above(dot(w[d:], w[d:])) / arm
    return power > 0 and power > free * NEVER * size * Fraction(999, 1000)


def _velocity(motion: Vector, r: Vector) -> Vector:
    d = len(r)
    if d == 2:
        return [motion[0] - motion[2] * r[1], motion[1] + motion[2] * r[0]]
    return [a + b for a, b in zip(motion[:3], cross(motion[3:], r), strict=True)]


def _most_opposed(u: Vector, n: Vector, mu: Fraction) -> Fraction:
    """An upper bound, tight to 1e-30, of the work against u of forces of length 1 in the cone."""
    nn, un, uu = dot(n, n), dot(u, n), dot(u, u)
    across2 = uu - un * un / nn
    if un <= 0 and across2 * nn <= mu * mu * un * un:
        return _root_above(uu)
    if un >= 0 and mu * mu * across2 * nn <= un * un:
        return Fraction(0)
    return (mu * _root_above(across2 * nn) - un) * _root_above(1 / (nn * (1 + mu * mu)))


def _root_above(value: Fraction) -> Fraction:
    if value <= 0:
        return Fraction(0)
    shift = max(0, 240 - value.numerator.bit_length() + value.denominator.bit_length())
    shift += shift % 2
    return Fraction(isqrt((value.numerator << shift) // value.denominator) + 1, 1 << (shift // 2))


def is_held(
    positions: Array, normals: Array, frictions: Array, load: Array, *, most: int | None = NEVER
) -> bool:
    """Whether planar forces hold a load, exactly: whether -w is a sum of edges of cones.

    Of ``most`` loads at most: rounding of a contact that stands still holds any load by forces of 1e16
    times it. None is without limit.
    """
    edges = []
    for r, n, mu in zip(positions.tolist(), normals.tolist(), frictions.tolist(), strict=True):
        (x, y), (a, b), m = exact(r), exact(n), Fraction(mu)
        for s in (1, -1) if m else (1,):
            fx, fy = a - s * m * b, b + s * m * a
            edges.append([fx, fy, x * fy - y * fx, Fraction(1)])
    target = [-x for x in exact(load.tolist())]
    size = max(abs(x) for x in target[:2]) or abs(target[2]) / max(abs(Fraction(x)) for x in positions.flat)
    spare = [Fraction(0), Fraction(0), Fraction(0), Fraction(1)]
    if not any(target):
        return True
    if most is None:
        return _in_cone([edge[:3] for edge in edges], target)
    return _in_cone([*edges, spare], [*target, most * size])


def _in_cone(edges: list[Vector], target: Vector) -> bool:
    """By the simplex method's first phase with Bland's rule, which cannot cycle, in rationals."""
    rows = [
        [(-1 if t < 0 else 1) * x for x in row]
        for row, t in zip(zip(*edges, strict=True), target, strict=True)
    ]
    table = [
        [*row, *[Fraction(int(i == j)) for j in range(len(target))], abs(t)]
        for i, (row, t) in enumerate(zip(rows, target, strict=True))
    ]
    count, basis = len(edges), [len(edges) + i for i in range(len(target))]
    while True:
        price = [
            sum((table[i][j] for i in range(len(target)) if basis[i] >= count), start=Fraction(0))
            for j in range(count)
        ]
        enter = next((j for j in range(count) if price[j] > 0 and j not in basis), None)
        if enter is None:
            return all(table[i][-1] == 0 for i in range(len(target)) if basis[i] >= count)
        ratios = [
            (table[i][-1] / table[i][enter], basis[i], i) for i in range(len(target)) if table[i][enter] > 0
        ]
        if not ratios:
            return True
        leave = min(ratios)[2]
        pivot = table[leave][enter]
        table[leave] = [x / pivot for x in table[leave]]
        for i in range(len(target)):
            if i != leave and table[i][enter]:
                factor = table[i][enter]
                table[i] = [x - factor * y for x, y in zip(table[i], table[leave], strict=True)]
        basis[leave] = enter
