"""Holds by the million: margins of every pair of points under every load direction, and steps between holds.

Compiled by Numba from the formulas of ``best`` and ``choice``. Margins are laid out (orientations, pairs), so
that each thread writes one stretch of memory at a time.
"""

from math import atan, atan2
from typing import Any

import numpy as np
from numba import njit, prange

from regrasp.closed_form.choice import ANGLE
from regrasp.closed_form.compiled import _best_squeeze, _digest

# Pairs whose geometry stays in the cache while the orientations go by.
_BLOCK = 512
NO_HOLD = -1.0
"""In the place of the margin of a pair that cannot hold the load."""


@njit(error_model="numpy", forceinline=True)
def _margin(nx, ny, mu, fx, fy):  # type: ignore[no-untyped-def]
    return atan(mu) - atan2(abs(nx * fy - ny * fx), nx * fx + ny * fy)


def _loops(digest: str) -> Any:
    @njit(error_model="numpy", parallel=True, cache=True)
    def margins(first, second, points, normals, mu, loads, limits, ratio, result):  # type: ignore[no-untyped-def]
        """Widest least angle margin of each pair under each load; ``NO_HOLD`` where there is none."""
        _ = digest
        for block in prange((first.size + _BLOCK - 1) // _BLOCK):
            begin = block * _BLOCK
            end = min(begin + _BLOCK, first.size)
            for o in range(len(loads)):
                for p in range(begin, end):
                    i, j = first[p], second[p]
                    _, f, _ = _best_squeeze(
                        points[i, 0], points[i, 1], normals[i, 0], normals[i, 1], mu[i],
                        points[j, 0], points[j, 1], normals[j, 0], normals[j, 1], mu[j],
                        loads[o, 0], loads[o, 1], 0.0, ANGLE, limits[i], limits[j], ratio,
                    )  # fmt: skip
                    if f[0] == f[0]:
                        a = _margin(normals[i, 0], normals[i, 1], mu[i], f[0], f[1])
                        b = _margin(normals[j, 0], normals[j, 1], mu[j], f[2], f[3])
                        result[o, p] = max(min(a, b), 0.0)
                    else:
                        result[o, p] = NO_HOLD

    return margins


hold_margins = _loops(_digest)


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
