"""Holds by the million: margins of every pair of points under every load direction, and steps between holds.

Compiled by Numba from the formulas of ``best`` and ``choice``. The orientations are the inner loop: what does
not depend on them is then computed once per pair, and the sixteen pairs of one block share cache lines of a
table that is laid out (orientations, pairs).
"""

from math import atan
from typing import Any

import numpy as np
from numba import njit, prange

from regrasp.closed_form.choice import ANGLE
from regrasp.closed_form.compiled import _best_squeeze, _digest, _margin_tangent

_BLOCK = 16  # pairs whose margins share a cache line
STRETCH = 4096
"""Pairs that a thread takes at a time where only the widest margin of each is kept."""
NO_HOLD = -1.0
"""In the place of the margin of a pair that cannot hold the load."""


@njit(error_model="numpy", forceinline=True)
def _side(nx, ny, mu, fx, fy):  # type: ignore[no-untyped-def]
    return _margin_tangent(nx * fx + ny * fy, abs(nx * fy - ny * fx), mu)


@njit(error_model="numpy", forceinline=True)
def _margin(candidates, i, j, fx, fy):  # type: ignore[no-untyped-def]
    """Widest least angle margin of a pair under a force through the origin, or ``NO_HOLD``."""
    points, normals, mu, limits, ratio = candidates
    _, f, _ = _best_squeeze(
        points[i, 0], points[i, 1], normals[i, 0], normals[i, 1], mu[i],
        points[j, 0], points[j, 1], normals[j, 0], normals[j, 1], mu[j],
        fx, fy, 0.0, ANGLE, limits[i], limits[j], ratio,
    )  # fmt: skip
    if f[0] != f[0]:
        return np.float32(NO_HOLD)
    a = _side(normals[i, 0], normals[i, 1], mu[i], f[0], f[1])
    b = _side(normals[j, 0], normals[j, 1], mu[j], f[2], f[3])
    return np.float32(atan(max(min(a, b), 0.0)))


def _loops(digest: str) -> tuple[Any, Any]:
    @njit(error_model="numpy", parallel=True, cache=True)
    def margins(first, second, loads, candidates, result):  # type: ignore[no-untyped-def]
        """The margin of each pair under each load; candidates as ``_margin`` takes them."""
        _ = digest
        for block in prange((first.size + _BLOCK - 1) // _BLOCK):
            for p in range(block * _BLOCK, min((block + 1) * _BLOCK, first.size)):
                i, j = first[p], second[p]
                for o in range(len(loads)):
                    result[o, p] = _margin(candidates, i, j, loads[o, 0], loads[o, 1])

    @njit(error_model="numpy", parallel=True, cache=True)
    def widest(  # type: ignore[no-untyped-def]
        first, second, loads, candidates, allowed, place, best, where, counts
    ):
        """Widens the best margins of allowed pairs by these loads, the first of them number ``place``.

        counts (stretches, loads): how many pairs of a stretch hold, to be summed over the stretches.
        """
        _ = digest
        for stretch in prange(len(counts)):
            for p in range(stretch * STRETCH, min((stretch + 1) * STRETCH, first.size)):
                i, j = first[p], second[p]
                for o in range(len(loads) if allowed[p] else 0):
                    m = _margin(candidates, i, j, loads[o, 0], loads[o, 1])
                    counts[stretch, o] += m >= 0.0
                    if m > best[p]:
                        best[p], where[p] = m, place + o

    return margins, widest


hold_margins, widest_margins = _loops(_digest)


@njit(error_model="numpy", parallel=True, cache=True)
def relaxed(first, second, margins, reach, result):  # type: ignore[no-untyped-def]
    """Widest least margin of a path that ends in a hold with each point, one exchange further.

    reach (orientations, points): of a path to a hold with that point, from which the object may turn to that
    orientation. A hold is entered over either of its points, and lends its value to both.
    """
    for o in prange(len(margins)):
        for p in range(first.size):
            m = margins[o, p]
            if m >= 0.0:
                i, j = first[p], second[p]
                value = min(max(reach[o, i], reach[o, j]), m)
                if value > result[o, i]:
                    result[o, i] = value
                if value > result[o, j]:
                    result[o, j] = value


def pairs_of(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Every pair i < j of ``count`` points, (count (count - 1) / 2,) each, by i and then by j."""
    first, second = np.triu_indices(count, 1)
    return first.astype(np.int32), second.astype(np.int32)
