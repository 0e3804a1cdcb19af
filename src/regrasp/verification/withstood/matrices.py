"""Rational linear algebra: products, solutions, and whether a symmetric matrix is positive semidefinite."""

from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.exact import Vector, dot, exact, rounded

Matrix = list[Vector]

_BITS = 100
"""To how many digits answers are rounded: what the doubles of a plan say is coarser by far."""


def rational(rows: list[list[float]]) -> Matrix:
    """Doubles as the rationals they are."""
    return [exact(row) for row in rows]


def doubles(x: Vector) -> Array:
    """Rationals as the nearest doubles, infinite where there is none."""
    return np.array([rounded(value) for value in x])


def in_doubles(a: Matrix) -> Array:
    """The same of a matrix."""
    return np.array([doubles(row) for row in a])


def times(a: Matrix, x: Vector) -> Vector:
    """A x."""
    return [dot(row, x) for row in a]


def product(a: Matrix, b: Matrix) -> Matrix:
    """A B."""
    columns = transposed(b)
    return [[dot(row, column) for column in columns] for row in a]


def transposed(a: Matrix) -> Matrix:
    """A'."""
    return [list(column) for column in zip(*a, strict=True)]


def solved(a: Matrix, b: Matrix) -> Matrix | None:
    """X with A X = B, by elimination; None where A is singular."""
    n = len(a)
    table = [list(row) + list(right) for row, right in zip(a, b, strict=True)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(table[i][k]))
        if table[pivot][k] == 0:
            return None
        table[k], table[pivot] = table[pivot], table[k]
        head = table[k][k]
        table[k] = [x / head for x in table[k]]
        for i in range(n):
            if i != k:
                factor = table[i][k]
                table[i] = [x - factor * y for x, y in zip(table[i], table[k], strict=True)]
    return [row[n:] for row in table]


def coarse(a: Matrix) -> Matrix:
    """Each entry rounded to 2^-100 of itself, in whatever units."""
    return [[_short(x) for x in row] for row in a]


def _short(x: Fraction) -> Fraction:
    scale = Fraction(2) ** (_BITS - x.numerator.bit_length() + x.denominator.bit_length())
    return round(x * scale) / scale


def is_semidefinite(a: Matrix) -> bool:
    """Whether x'A x >= 0 for all x, by symmetric elimination: a pivot 0 needs a row of zeros."""
    table = [list(row) for row in a]
    n = len(table)
    for k in range(n):
        pivot = table[k][k]
        if pivot < 0 or (pivot == 0 and any(table[k][j] for j in range(k + 1, n))):
            return False
        if pivot == 0:
            continue
        for i in range(k + 1, n):
            factor = table[i][k] / pivot
            for j in range(k + 1, n):
                table[i][j] -= factor * table[k][j]
    return True
