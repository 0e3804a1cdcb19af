"""The straight path of Eq. 1-3 and the least time it takes.

    w(t) = w^B + (w^A - w^B) T(t) = T(t) w^A + (1 - T(t)) w^B,    T falling from 1 to 0,

for the forces as for their wrenches. With contacts and load fixed, the equilibrium forces inside the cones
form a convex set, so the path is safe when both ends are.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def straight_path(start: Array, end: Array, scaling: Array) -> Array:
    """Eq. 1-3 from ``start`` to ``end`` (n, k) at every T of ``scaling`` (...): (..., n, k).

    One matrix product of the rows (T, 1 - T) with both ends, so both ends are met exactly.
    """
    weights = np.empty((*scaling.shape, 2))
    weights[..., 0], weights[..., 1] = scaling, 1 - scaling
    ends = np.concatenate([start.reshape(1, -1), end.reshape(1, -1)])
    path: Array = weights @ ends
    return path.reshape(*scaling.shape, *start.shape)


def fastest_duration(changes: Iterable[float], rates: Iterable[float], steepest: float) -> float:
    """Least duration with |f_i'(t)| <= rate_i: max_i |f_i^A - f_i^B| max|T'| / rate_i.

    ``changes`` are the |f_i^A - f_i^B|, ``steepest`` is max|T'| of the scaling at duration 1.
    """
    return max(change * steepest / rate for change, rate in zip(changes, rates, strict=True))
