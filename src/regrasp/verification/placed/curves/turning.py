"""Whether twists that turn with the fingers exclude a box of parts of cubics, in whole numbers.

Let t_i run from 0 to 1 as finger i goes along its part p_i(t_i), with tangent T_i and normal N_i = J T_i, J a
quarter of a turn. A motion of a load w has polynomials of degree 2 in all t: velocity v and angular velocity
omega; and for each finger s_i, of degree 2 in each place, by its Bernstein coefficients. A force of size 1 in
the cone is in the hull of 0, the edges n -+ mu t over r = sqrt(1 + mu^2), and r n. So where, with q_i at or
below the length of T_i,

    s_i >= 0,    s_i q_i r >= u . (N_i -+ mu T_i),    s_i q_i >= r u . N_i,    u = v + omega J p_i,

finger i does no more than s_i along the motion, and no placement holds all loads by forces of a limit where

    sum_l [ -w_l . y_l - limit sum_i s_il ] > 0.

All are polynomials in t. One is above zero for t from 0 to 1 where all its coefficients in t^a (1 - t)^b are;
products are convolutions of these. Doubles are whole numbers times a power of two, and so are their products.
"""

from fractions import Fraction
from itertools import combinations_with_replacement, pairwise
from math import isqrt
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.protocol import Point
from regrasp.verification.placed.roots import root_above, root_below

_ROUNDING = 3e-14  # of the terms of a sum of less than a hundred products of a few numbers
_PLAIN = 1e40  # of numbers from one over this to this, or 0, no such product is too large or loses digits
_MORE = 2**64  # by which lengths are finer than points
_POWERS = ((1, 2, 1), (0, 1, 1), (0, 0, 1))  # of 1, t and t^2

Numbers = np.ndarray[Any, Any]
"""Whole numbers of any size."""


def numbers_of(fingers: int) -> int:
    """How many a motion has, of ``fingers``.

    Three polynomials of degree 2, by terms: one, each place, each product of two in turn; then coefficients
    of one of degree 2 in each place for each finger.
    """
    return 3 * (fingers + 1) * (fingers + 2) // 2 + fingers * int(3**fingers)


def is_excluded_in_turn(
    motions: list[tuple[list[float], list[float]]], bound: Fraction, hulls: list[list[Point]], friction: float
) -> bool:
    """Whether motions of some loads exclude a box for forces below a bound.

    motions: of each load, the load; and terms of v_x, v_y and omega, then coefficients of each s_i.
    hulls: the control points of each finger's part, about the centre of mass.
    """
    if _is_clear(motions, float(bound), hulls, friction):
        return True
    k = len(hulls)
    values = _whole([Fraction(c) for _, motion in motions for c in motion])
    basis = np.array(_basis(k), dtype=object)
    values, terms = values.reshape(len(motions), -1), len(basis)
    twists = values[:, : 3 * terms].reshape(len(motions), 3, terms) @ basis.reshape(terms, -1)
    bounds = values[:, 3 * terms :].reshape(len(motions), k, -1) * basis[0].ravel()  # by the factors of 1
    limit, *numbers = _whole([bound, *(Fraction(c) for load, _ in motions for c in load)])
    loads = np.array(numbers, dtype=object).reshape(-1, 3)
    left: Any = 0
    for load, twist, most in zip(loads, twists, bounds, strict=True):
        left = left - load @ twist - limit * most.sum(axis=0)
    if not (left > 0).all() or not (bounds >= 0).all():
        return False
    square = 1 + Fraction(friction) ** 2
    mu, below, above, one = _whole([Fraction(friction), root_below(square), root_above(square), Fraction(1)])
    for i, hull in enumerate(hulls):
        points = _whole([c for p in hull for c in p] + [Fraction(1)]) * _MORE
        unit, points = points[-1], points[:-1].reshape(4, 2)
        tangent = [(int(b[0] - a[0]), int(b[1] - a[1])) for a, b in pairwise(points)]
        speed = _slowest(tangent)
        ways = [[(-y, x) for x, y in tangent], tangent]
        done = _raised(_product(_own(bounds[:, i], k, i), [speed[0], 2 * speed[1], speed[2]])) * unit
        own = [_own(twists[:, d], k, i) for d in range(3)]
        ahead, aside = (_work(own, unit, points, way) for way in ways)
        sharp = done * below - ahead * one
        if not all((room >= 0).all() for room in (sharp - mu * aside, sharp + mu * aside)):
            return False
        if not (done * one >= ahead * above).all():
            return False
    return True


def _is_clear(
    motions: list[tuple[list[float], list[float]]], bound: float, hulls: list[list[Point]], friction: float
) -> bool:
    """The same in doubles, where all is by more than what rounding adds: with signs, then without."""
    k = len(hulls)
    basis = np.array(_basis(k), dtype=float).reshape(-1, 3**k)
    loads, values = np.array([w for w, _ in motions]), np.array([motion for _, motion in motions])
    points = np.array(hulls, dtype=float)
    tangents = np.array(
        [[(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(hull)] for hull in hulls], dtype=float
    )
    if not all(map(_is_plain, (loads, values, points, tangents, np.array([bound, friction])))):
        return False
    terms = 3 * len(basis)
    polynomials = values[:, :terms].reshape(len(values), 3, -1)
    both = [polynomials @ basis, np.abs(polynomials) @ basis]
    bounds = values[:, terms:].reshape(len(values), k, -1) * basis[0]
    work, size = (np.einsum("ld,ldc->c", *each) for each in ((-loads, both[0]), (np.abs(loads), both[1])))
    done, lost = bound * bounds.sum(axis=(0, 1)), _ROUNDING * len(values)
    if not (bounds >= 0).all() or not (work - done > lost * (size + done)).all():
        return False
    slant = float(np.hypot(1.0, friction))
    for i, tangent in enumerate(tangents):
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
        speed = _slowest_clear(tangent) * [1, 2, 1]
        each = [(points[i], normal, tangent), (np.abs(points[i]) * [1, -1], np.abs(normal), np.abs(tangent))]
        above = slant * _raised(_product(_own(bounds[:, i], k, i), speed.tolist()))
        found = []
        for polynomial, (at, *ways) in zip(both, each, strict=True):
            own = [_own(polynomial[:, d], k, i) for d in range(3)]
            found += [_work(own, 1, at, way.tolist()) for way in ways]
        ahead, aside, far, wide = found
        edge = np.maximum(ahead + friction * np.abs(aside), slant**2 * ahead)
        if not (above - edge >= _ROUNDING * (above + slant**2 * far + friction * wide)).all():
            return False
    return True


def _is_plain(numbers: Array) -> bool:
    sizes = np.abs(numbers[numbers != 0])
    return bool(((sizes >= 1 / _PLAIN) & (sizes <= _PLAIN)).all())


def _slowest_clear(tangent: Array) -> Array:
    """The same as ``_slowest`` in doubles, lower by more than rounding."""
    a, b, c = tangent
    first, middle, last = np.hypot(*tangent.T)
    early, late = a @ b - _ROUNDING * first * middle, b @ c - _ROUNDING * middle * last
    square = 2 * b @ b + a @ c - first * last - _ROUNDING * (middle**2 + first * last)
    if min(first, last, early, late, square) <= 0:
        return np.zeros(3)
    slow = [first, min(early / first, late / last, np.sqrt(square / 2)), last]
    return np.array(slow) * (1 - _ROUNDING)


def _whole(values: list[Fraction]) -> Numbers:
    """The numbers times one power of two that makes all of them whole."""
    unit = max(value.denominator for value in values)
    return np.array([value.numerator * (unit // value.denominator) for value in values], dtype=object)


def _basis(k: int) -> list[Numbers]:
    """Coefficients of each term, of degree 2 in each place."""
    terms = [(), *((i,) for i in range(k)), *combinations_with_replacement(range(k), 2)]
    made = []
    for term in terms:
        found: Numbers = np.array(1, dtype=object)
        for i in range(k):
            found = np.multiply.outer(found, np.array(_POWERS[term.count(i)], dtype=object))
        made.append(found)
    return made


def _own(coefficients: Numbers, k: int, i: int) -> Numbers:
    """(3, ...) those of loads (L, 3^k), in the place of finger i first."""
    return np.moveaxis(coefficients.reshape((-1,) + (3,) * k), 1 + i, 0).reshape(3, -1)


def _work(own: list[Numbers], unit: int, points: Numbers, way: list[tuple[int, int]]) -> Numbers:
    """Coefficients of u . N or u . T times the unit, of degree 7 in the finger's own place."""
    scaled = [(x * c, y * c) for (x, y), c in zip(way, (1, 2, 1), strict=True)]
    arm = [(-y * c, x * c) for (x, y), c in zip(points, (1, 3, 3, 1), strict=True)]
    around = [0] * 6
    for a, (x, y) in enumerate(arm):
        for b, (n, m) in enumerate(scaled):
            around[a + b] += x * n + y * m
    moved = _product(own[0], [x for x, _ in scaled]) + _product(own[1], [y for _, y in scaled])
    return _raised(moved) * unit + _product(own[2], around)


def _product(a: Numbers, b: list[int]) -> Numbers:
    """Of coefficients (n, ...) and those of a polynomial in the first place."""
    made = np.zeros((len(a) + len(b) - 1, a.shape[1]), dtype=a.dtype)
    for i, factor in enumerate(b):
        made[i : i + len(a)] += a * factor
    return made


def _raised(a: Numbers) -> Numbers:
    """The same polynomial, of degree 3 more: times (t + 1 - t)^3."""
    return _product(a, [1, 3, 3, 1])


def _slowest(tangent: list[tuple[int, int]]) -> list[int]:
    """Bernstein coefficients of a q of which q^2 is at or below |T|^2, by coefficients of degree 4.

    Those of |T|^2 are T_0.T_0, T_0.T_1, (T_0.T_2 + 2 T_1.T_1) / 3, T_1.T_2 and T_2.T_2.
    """
    (ax, ay), (bx, by), (cx, cy) = tangent
    first, last = isqrt(ax * ax + ay * ay), isqrt(cx * cx + cy * cy)
    early, late = ax * bx + ay * by, bx * cx + by * cy
    square = 2 * (bx * bx + by * by) + ax * cx + ay * cy - first * last
    if min(first, last, early, late, square) <= 0:
        return [0, 0, 0]
    return [first, min(early // first, late // last, isqrt(square // 2)), last]
