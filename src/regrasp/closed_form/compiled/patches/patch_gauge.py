"""The least forces that make a wrench in space by fingers that may push at corners of patches, and a twist.

A finger at p with inward normal n and force f in its cone K = { n.f >= 0, |f_t| <= mu n.f } does the work
v . f along a twist y = (v_0, omega), v = v_0 + omega x p. With sigma(v) the most of v . f over forces of K
of size 1, all fingers together do at most s(y) = N*(largest sigma of each), N* the dual of the norm of
the sizes: so forces that make w have the norm w . y / s(y) at least. The best y is found by the simplex
method in six unknowns, whose columns are made as they are needed: the wrenches at which s(y) is attained.
"""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.patches.patch_support import DEEP, largest

NEVER = 1e5
"""Norm, as a multiple of the wrench's, from which nothing is held: what columns cost that no finger makes."""
_MOST = 150  # columns made
_FINE = 1e-6  # of a norm, beyond which no bound is looked for
_TILT = 1e-10  # of the wrench, which keeps it off faces of the bodies that columns span
_MISSED = 1e-8  # of the wrench, by which forces may be off it


@njit(**VIEWS)
def support(surface, patches, y, mu, size, norm, work):  # type: ignore[no-untyped-def]
    """s(y), and the column at which it is attained: its wrench, and each finger's row and weight."""
    k = len(patches)
    column, at, weight, _, best, most = work[:6]
    stack, above, looked = work[13:16]
    rows, dual, top, squares = surface[0], 0.0, 0, 0.0
    for i in range(k):
        if i > 0 and patches[i] == patches[i - 1]:
            at[i], most[i] = at[i - 1], most[i - 1]
            for c in range(3):
                best[i, c] = best[i - 1, c]
        else:
            most[i], at[i] = largest(surface, patches[i], y, mu, size, best[i], stack, above, looked)
        if most[i] > most[top]:
            top = i
        dual += most[i]
        squares += most[i] * most[i]
    if norm == 0:
        dual = most[top]
    elif norm == 1:
        dual = sqrt(squares)
    for c in range(6):
        column[c] = 0.0
    for i in range(k):
        share = 1.0
        if norm == 0:
            share = 1.0 if i == top else 0.0
        elif norm == 1:
            share = most[i] / dual if dual > 0.0 else 0.0
        weight[i] = share if most[i] > 0.0 else 0.0
        if weight[i] > 0.0:
            p, fx, fy, fz = rows[at[i]], share * best[i, 0], share * best[i, 1], share * best[i, 2]
            column[0] += fx
            column[1] += fy
            column[2] += fz
            column[3] += p[1] * fz - p[2] * fy
            column[4] += p[2] * fx - p[0] * fz
            column[5] += p[0] * fy - p[1] * fx
    return dual


@njit(**VIEWS)
def bound_by(surface, patches, w, y, mu, size, norm, work):  # type: ignore[no-untyped-def]
    """What a twist proves of the norm of forces that make w; infinite where none do."""
    gain = 0.0
    for c in range(6):
        gain += w[c] * y[c]
    if gain <= 0.0:
        return 0.0
    dual = support(surface, patches, y, mu, size, norm, work)
    return gain / dual if dual > 0.0 else np.inf


@njit(**VIEWS)
def exchanged(inverse, x, d, column):  # type: ignore[no-untyped-def]
    """Takes a column into the basis for the one whose amount x ends first, which it returns; -1 for none."""
    leaving, least, n = -1, np.inf, len(x)
    for r in range(n):
        d[r] = 0.0
        for c in range(n):
            d[r] += inverse[r, c] * column[c]
        if d[r] > 1e-11 and x[r] < least * d[r]:
            leaving, least = r, x[r] / d[r]
    if leaving < 0:
        return leaving
    for c in range(n):
        inverse[leaving, c] /= d[leaving]
    for r in range(n):
        if r != leaving and d[r] != 0.0:
            x[r] = max(x[r] - least * d[r], 0.0)
            for c in range(n):
                inverse[r, c] -= d[r] * inverse[leaving, c]
    x[leaving] = least
    return leaving


@njit(**VIEWS)
def _resumed(w, scale, work):  # type: ignore[no-untyped-def]
    """Makes w, nearly, of the columns at hand; False where some would have to be less than nothing."""
    inverse, x = work[6], work[7]
    for r in range(6):
        x[r] = 0.0
        for c in range(6):
            x[r] += inverse[r, c] * (w[c] + _TILT * scale * (1.0 + 0.37 * c))
        if x[r] < 0.0:
            return False
    return True


@njit(**VIEWS)
def _begun(surface, patches, w, scale, work):  # type: ignore[no-untyped-def]
    """Makes w, nearly, of columns that no finger makes."""
    inverse, x, made, shares, pushes = work[6], work[7], work[10], work[11], work[12]
    for r in range(6):
        for c in range(6):
            inverse[r, c] = 0.0
        push = w[r] + _TILT * scale * (1.0 + 0.37 * r)
        inverse[r, r] = NEVER if push >= 0.0 else -NEVER
        x[r] = abs(push) * NEVER
        for i in range(len(patches)):
            shares[r, i] = 0.0
            made[r, i] = surface[1][patches[i], 0]
            for c in range(3):
                pushes[r, i, c] = 0.0


@njit(**VIEWS)
def gauge(surface, patches, w, mu, size, norm, level, enough, precision, best, work, again=False):  # type: ignore[no-untyped-def]
    """A bound of the norm of forces that make w, and its twist.

    It ends where that is not below ``level``, where forces make w whose norm is, and is at most ``enough`` or
    within ``precision`` of the bound, and where no better bound is to be had.
    again: the columns that are at hand are of these patches, and may do to begin with.

    surface: as of ``largest``. patches: (k,) of the fingers. best: (6,) the twist. In ``work`` stay the
    columns that make w: their amounts x (6,), and of each finger its rows (6, k), weights (6, k) and forces
    of size 1 (6, k, 3).
    """
    column, at, weight, _, pushed, _, inverse, x, y, d, made, shares, pushes = work[:13]
    k = len(patches)
    scale = 0.0
    for c in range(6):
        scale += abs(w[c])
        best[c] = 0.0
    if not (again and scale > 0.0 and _resumed(w, scale, work)):
        _begun(surface, patches, w, scale, work)
    if scale == 0.0:  # columns of others are not left for the next
        return 0.0
    proven = 0.0
    for _ in range(_MOST):
        value = 0.0
        for c in range(6):
            y[c] = 0.0
            for r in range(6):
                y[c] += inverse[r, c]
            value += w[c] * y[c]
        dual = support(surface, patches, y, mu, size, norm, work)
        bound = 0.0
        if value > 0.0:
            bound = value / dual if dual > 0.0 else np.inf
        if bound > proven:
            proven = bound
            for c in range(6):
                best[c] = y[c]
        if proven >= level or dual <= 1.0 + _FINE:
            break
        total = 0.0
        for r in range(6):
            total += x[r]
        if total <= enough or (total < level and total - proven <= precision * total):
            break
        leaving = exchanged(inverse, x, d, column)
        if leaving < 0:
            break
        for i in range(k):
            made[leaving, i], shares[leaving, i] = at[i], weight[i]
            for c in range(3):
                pushes[leaving, i, c] = pushed[i, c]
    return proven


@njit(**VIEWS)
def reached(w, k, work):  # type: ignore[no-untyped-def]
    """The norm of forces that make w of the columns that ``gauge`` left; infinite where they miss it.

    Columns of no finger, and of less than nothing, are what they miss.
    """
    inverse, shares = work[6], work[11]
    total, missed, scale = 0.0, 0.0, 0.0
    for r in range(6):
        amount, there = 0.0, False
        scale += abs(w[r])
        for c in range(6):
            amount += inverse[r, c] * w[c]
        for i in range(k):
            there = there or shares[r, i] > 0.0
        total += max(amount, 0.0)
        if not there:
            missed = max(missed, abs(amount) / NEVER)
        elif amount < 0.0:
            missed = max(missed, -amount)
    return total if missed <= _MISSED * scale else np.inf


def workspace(k: int) -> tuple[Any, ...]:
    """Memory for ``gauge`` and what it leaves there, for k fingers; the last is how much it has looked at."""
    return (
        np.zeros(6), np.zeros(k, np.int64), np.zeros(k), np.zeros(3), np.zeros((k, 3)), np.zeros(k),
        np.zeros((6, 6)), np.zeros(6), np.zeros(6), np.zeros(6), np.zeros((6, k), np.int64), np.zeros((6, k)),
        np.zeros((6, k, 3)), np.zeros(DEEP, np.int64), np.zeros(DEEP), np.zeros(1, np.int64),
    )  # fmt: skip
