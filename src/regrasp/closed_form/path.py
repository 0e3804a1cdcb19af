"""The straight path of Eq. 1-3 and the least time it takes.

    w(t) = w^B + (w^A - w^B) T(t),    T falling from 1 to 0,

for the forces as for their wrenches. With contacts and load fixed, the equilibrium forces inside the cones
form a convex set, so the path is safe when both ends are.
"""

from collections.abc import Iterable
from math import inf
from typing import Any


def straight_path(start: Any, end: Any, scaling: Any) -> Any:
    """Eq. 1-3: ``end + (start - end) T``; numbers, or arrays that broadcast."""
    return end + (start - end) * scaling


def fastest_duration(changes: Iterable[float], rates: Iterable[float], steepest: float) -> float:
    """Least duration with |f_i'(t)| <= rate_i: max_i |f_i^A - f_i^B| max|T'| / rate_i.

    ``changes`` are the |f_i^A - f_i^B|, ``steepest`` is max|T'| of the scaling at duration 1.
    """
    return max(
        change * steepest / rate if rate < inf else 0.0 for change, rate in zip(changes, rates, strict=True)
    )
