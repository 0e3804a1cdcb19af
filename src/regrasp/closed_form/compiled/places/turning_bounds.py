"""What a finger does at most along a twist of degree 2 in all places, as a polynomial in them.

On its part p of a cubic, t from 0 to 1 along it, with tangent T and normal N = J T, it does s or less where

    s >= 0,    s |T| >= (v + omega J p) . g,    g = (N -+ mu T) / r, r N,    r = sqrt(1 + mu^2)

by coefficients in t^a (1 - t)^b, with a polynomial of degree 2 below |T| in its place. In the places of other
fingers coefficients go along one by one: for each of them three numbers s of the least sum are sought.
"""

from math import comb, sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS

Array = np.ndarray[Any, np.dtype[np.float64]]

_ROUNDING = 1e-12  # of the largest coefficient, more than any sum of products of them is off by
_SHORT = 0.01  # of the size: ends of shorter legs are rounded by more of them
_NOTHING = 1e-12
_STEPS = 24  # to the least bound in one place of others


def binomials(n: int) -> Array:
    """(n + 1,) of degree n."""
    return np.array([comb(n, i) for i in range(n + 1)], dtype=float)


def _products(m: int, n: int) -> Array:
    """(m + n + 1, m + 1, n + 1) by which coefficients of two polynomials become those of their product."""
    found = np.zeros((m + n + 1, m + 1, n + 1))
    i, j = np.indices((m + 1, n + 1))
    found[i + j, i, j] = np.outer(binomials(m), binomials(n)) / binomials(m + n)[i + j]
    return found


# all to the degree 7 of what a finger does in its own place: of the twist 2, the point 3 and the normal 2
_CUBED, _OF_FIFTH = _products(3, 2), _products(2, 5)
_SQUARED = np.ascontiguousarray(np.tensordot(_products(4, 3).sum(axis=2), _products(2, 2), 1))


def room_to_follow() -> tuple[Any, ...]:
    """Memory for it."""
    return (
        np.zeros((2, 3)), np.zeros((2, 3, 8, 3)), np.zeros((8, 3)), np.zeros(8), np.zeros((3, 4)), np.zeros(3)
    )  # fmt: skip


@njit(**VIEWS)
def slowest(x, y):  # type: ignore[no-untyped-def]
    """Three coefficients of degree 2 at or below the length of vectors (3,), (3,); or 0."""
    a, c = sqrt(x[0] * x[0] + y[0] * y[0]), sqrt(x[2] * x[2] + y[2] * y[2])
    early, late = x[0] * x[1] + y[0] * y[1], x[2] * x[1] + y[2] * y[1]
    square = x[1] * x[1] + y[1] * y[1] + 0.5 * (x[0] * x[2] + y[0] * y[2] - a * c)
    if min(min(a, c), min(min(early, late), square)) <= 0.0:
        return 0.0, 0.0, 0.0
    return a, min(min(early / a, late / c), sqrt(square)), c


@njit(**VIEWS)
def follow(part, follows):  # type: ignore[no-untyped-def]
    """The length of a part's middle leg; writes what turns coefficients into others of degree 7.

    Those of a twist, in the place of the finger, into its velocity along the normal and the tangent (2, 3, 8,
    3), over that length, and those of a bound into it times the length of the tangent (8, 3).
    """
    (x, y), along, speed = follows[:3]
    length = sqrt((part[2, 0] - part[1, 0]) ** 2 + (part[2, 1] - part[1, 1]) ** 2)
    for b in range(3):
        x[b], y[b] = (part[b + 1, 0] - part[b, 0]) / length, (part[b + 1, 1] - part[b, 1]) / length
    slow = slowest(x, y)
    for r in range(8):
        for b in range(3):
            speed[r, b] = 0.0
            for a in range(3):
                speed[r, b] += _SQUARED[r, b, a] * slow[a]
    for way in range(2):
        for r in range(8):
            for b in range(3):
                vx, vy, turn = 0.0, 0.0, 0.0
                for a in range(3):
                    nx, ny = (-y[a], x[a]) if way == 0 else (x[a], y[a])
                    vx += _SQUARED[r, b, a] * nx
                    vy += _SQUARED[r, b, a] * ny
                for g in range(6):
                    around = 0.0
                    for d in range(max(0, g - 2), min(4, g + 1)):
                        a = g - d
                        nx, ny = (-y[a], x[a]) if way == 0 else (x[a], y[a])
                        around += _CUBED[g, d, a] * (part[d, 0] * ny - part[d, 1] * nx)
                    turn += _OF_FIFTH[r, b, g] * around
                along[way, 0, r, b], along[way, 1, r, b], along[way, 2, r, b] = vx, vy, turn
    return length


@njit(**VIEWS)
def least_above(speed, edge, basis, s):  # type: ignore[no-untyped-def]
    """Writes s >= 0 of the least sum with speed s >= edge, (8, 3) and (8,): the dual simplex method.

    basis: (3, 4) memory for the inverse of the three rows that are equations, column by column, and for their
    right sides; at first they are s = 0. What steps leave is made up for by raising all three.
    """
    for j in range(3):
        for d in range(4):
            basis[j, d] = 1.0 if d == j else 0.0
    for _ in range(_STEPS):
        size = 0.0
        for d in range(3):
            s[d] = 0.0
            for j in range(3):
                s[d] += basis[j, 3] * basis[j, d]
            size += abs(s[d])
        row, lack = -1, _NOTHING * size
        for r in range(11):  # the last are s >= 0
            short = (
                edge[r] - speed[r, 0] * s[0] - speed[r, 1] * s[1] - speed[r, 2] * s[2] if r < 8 else -s[r - 8]
            )
            if short > lack:
                row, lack = r, short
        if row < 0:
            break
        out, ratio, pivot = -1, np.inf, 1.0
        for j in range(3):
            part = _along_row(speed, basis, row, j)
            price = basis[j, 0] + basis[j, 1] + basis[j, 2]
            if part > _NOTHING and price < ratio * part:
                out, ratio, pivot = j, price / part, part
        if out < 0:
            break
        for d in range(3):
            basis[out, d] /= pivot
        basis[out, 3] = edge[row] if row < 8 else 0.0
        for j in range(3):
            if j != out:
                part = _along_row(speed, basis, row, j)
                for d in range(3):
                    basis[j, d] -= part * basis[out, d]
    more = 0.0
    for d in range(3):
        s[d] = max(s[d], 0.0)
    for r in range(8):
        lack = edge[r] - speed[r, 0] * s[0] - speed[r, 1] * s[1] - speed[r, 2] * s[2]
        more = max(more, lack / (speed[r, 0] + speed[r, 1] + speed[r, 2]))
    for d in range(3):
        s[d] += more


@njit(**VIEWS)
def _along_row(speed, basis, row, j):  # type: ignore[no-untyped-def]
    if row >= 8:
        return basis[j, row - 8]
    return speed[row, 0] * basis[j, 0] + speed[row, 1] * basis[j, 1] + speed[row, 2] * basis[j, 2]


@njit(**VIEWS)
def bounds_along(own, i, mu, length, follows, found):  # type: ignore[no-untyped-def]
    """Writes (3^k,) coefficients of a bound of what finger i does along a twist (3, 3^k).

    False where there is none.
    """
    _, along, speed, edge, basis, s = follows
    slant, step, large, least = sqrt(1.0 + mu * mu), own.shape[1] // 3 ** (1 + i), 0.0, np.inf
    for d in range(3):
        for c in range(own.shape[1]):
            large = max(large, abs(own[d, c]))
    for r in range(8):
        least = min(least, speed[r, 0] + speed[r, 1] + speed[r, 2])
    if not least > 0.0:
        return False
    room = _ROUNDING * (1.0 + _SHORT / length) * large
    for x in range(own.shape[1]):
        if (x // step) % 3 == 0:
            for r in range(8):
                ahead, aside = 0.0, 0.0
                for d in range(3):
                    for b in range(3):
                        ahead += along[0, d, r, b] * own[d, x + b * step]
                        aside += along[1, d, r, b] * own[d, x + b * step]
                edge[r] = max((ahead + mu * abs(aside)) / slant, slant * ahead)
            least_above(speed, edge, basis, s)
            for b in range(3):
                found[x + b * step] = s[b] + room / least
    return True
