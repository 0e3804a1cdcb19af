"""A bound from all loads at once, each with a twist, where forces are limited one by one.

A twist for each load alone bounds a box as if fingers could be elsewhere for each. For twists y_l of all
wrenches w_l to make, any placement p, and T the largest size of a force under any of them,

    sum_l w_l . y_l <= sum_l sum_i sigma(v_l(p_i)) T <= sum_i max_p [ sum_l sigma(v_l(p)) ] T

and each bracket is convex in p, so it is largest at a corner of the patch, the same for all loads. The best
twists are found as those of one load are (``patch_gauge``), in six unknowns for each load.
"""

from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.patches.patch_gauge import exchanged
from regrasp.closed_form.compiled.patches.patch_support import sigma, work

ROWS = 128
"""Corners of all patches together, of which there may be so many."""
LOADS = 12
"""Loads that are taken together, at most: each costs six unknowns."""
_MOST = 20  # columns made for each unknown
_NEVER = 1e4  # what columns cost that no finger makes, where norms of wrenches are about 1
_FINE = 1e-6  # of a norm, beyond which no bound is looked for
_TILT = 1e-9  # of the wrenches, which keeps them off faces of the body that columns span


@njit(**VIEWS)
def _different(rows, first, count, few):  # type: ignore[no-untyped-def]
    """Writes the rows of a patch whose places or normals differ, and returns how many they are."""
    many = 0
    for r in range(first, first + count):
        known = False
        for j in range(many):
            same = True
            for c in range(6):
                same = same and rows[r, c] == rows[few[j], c]
            known = known or same
        if not known:
            few[many] = r
            many += 1
    return many


@njit(**VIEWS)
def _together(rows, ends, few, mu, size, y, column, force):  # type: ignore[no-untyped-def]
    """The sum over fingers of the most that all twists y (L, 6) do at one corner; its column (6 L,).

    few: rows, of finger i between ``ends`` i and i + 1; where there are none those of the one before.
    """
    loads, dual, top, at = len(y), 0.0, 0.0, -1
    for c in range(6 * loads):
        column[c] = 0.0
    for i in range(len(ends) - 1):
        if ends[i] < ends[i + 1]:
            top, at = 0.0, -1
        for j in range(ends[i], ends[i + 1]):
            done = 0.0
            for n in range(loads):
                done += work(rows[few[j]], y[n], mu, size)
            if done > top:
                top, at = done, few[j]
        dual += top
        if at < 0:
            continue
        p = rows[at]
        for n in range(loads):
            if sigma(p, y[n], mu, size, force) > 0.0:
                fx, fy, fz = force[0], force[1], force[2]
                column[6 * n] += fx
                column[6 * n + 1] += fy
                column[6 * n + 2] += fz
                column[6 * n + 3] += p[1] * fz - p[2] * fy
                column[6 * n + 4] += p[2] * fx - p[0] * fz
                column[6 * n + 5] += p[0] * fy - p[1] * fx
    return dual


@njit(**VIEWS)
def bound_together(rows, first, count, wanted, mu, size, level, best, room):  # type: ignore[no-untyped-def]
    """A bound of the largest force that makes the worst of all wrenches, and twists (L, 6) that prove it.

    It ends at ``level``, and where forces are less at places that differ by the load. first, count: (k,) rows
    of each patch. room: of ``room_together``; its last number becomes what was looked at.
    """
    inverse, x, y, column, d, force, ends, few, looked = room
    loads = len(wanted)
    size_of, n = 0.0, 6 * loads
    for load in range(loads):
        for c in range(6):
            size_of += abs(wanted[load, c])
    for r in range(n):
        w = wanted[r // 6, r % 6]
        for c in range(n):
            inverse[r, c] = 0.0
        push = w + (_TILT if w >= 0.0 else -_TILT) * size_of * (1.0 + 0.37 * r)
        inverse[r, r] = _NEVER if push >= 0.0 else -_NEVER
        x[r] = abs(push) * _NEVER
    ends[0] = 0
    for i in range(len(first)):
        ends[i + 1] = ends[i]
        if i == 0 or first[i] != first[i - 1] or count[i] != count[i - 1]:
            ends[i + 1] += _different(rows, first[i], count[i], few[ends[i] :])
    corners = ends[len(first)]
    proven = 0.0
    most = _MOST * n
    for _ in range(most):
        value, total = 0.0, 0.0
        for c in range(n):
            y[c // 6, c % 6] = 0.0
        for r in range(n):
            total += x[r]
            for c in range(n):
                y[c // 6, c % 6] += inverse[r, c]
        for c in range(n):
            value += wanted[c // 6, c % 6] * y[c // 6, c % 6]
        looked[0] += corners * loads + n * n // 14  # which take as long
        dual = _together(rows, ends, few, mu, size, y, column, force)
        bound = 0.0
        if value > 0.0:
            bound = value / dual if dual > 0.0 else np.inf
        if bound > proven:
            proven = bound
            for load in range(loads):
                for c in range(6):
                    best[load, c] = y[load, c]
        if proven >= level or dual <= 1.0 + _FINE or total < level:
            break
        if exchanged(inverse, x, d, column) < 0:
            break
    return proven


def room_together(loads: int, k: int) -> tuple[Any, ...]:
    """Memory for it, of k fingers."""
    n = 6 * loads
    return (
        np.zeros((n, n)), np.zeros(n), np.zeros((loads, 6)), np.zeros(n), np.zeros(n), np.zeros(3),
        np.zeros(k + 1, np.int64), np.zeros(ROWS, np.int64), np.zeros(1, np.int64),
    )  # fmt: skip
