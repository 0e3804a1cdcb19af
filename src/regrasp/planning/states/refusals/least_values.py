"""The least value with which something is possible, to three digits, where more only ever helps."""

from collections.abc import Callable
from math import ceil, floor, log10

MOST_FRICTION = 16.0
"""Friction coefficients are tried up to this one, a cone of 86 degrees."""
_DIGITS = 3


def least_value(possible: Callable[[float], bool], now: float, most: float) -> float | None:
    """The least value above ``now``, to three digits, with which it is possible; None up to ``most``."""
    if not possible(most):
        return None
    low, high = now, most
    while high - low > 10.0 ** (floor(log10(high)) - _DIGITS) and high > 1e-6 * most:
        middle = (low + high) / 2 if low > high / 4 else max(high / 4, 2 * low)
        low, high = (low, middle) if possible(middle) else (middle, high)
    rounded = rounded_up(high)
    return rounded if possible(rounded) else high


def rounded_up(value: float) -> float:
    """A value above 0 with three digits, not below it but for rounding."""
    unit = 10.0 ** (floor(log10(value)) + 1 - _DIGITS)
    return float(f"{ceil(value / unit - 1e-9) * unit:.{_DIGITS + 1}g}")


def largest_share(possible: Callable[[float], bool]) -> float | None:
    """The largest share below 1, to three digits, with which it is possible; None where 0 is not."""
    if not possible(0.0):
        return None
    steps = 1000
    low, high = 0, steps
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if possible(middle / steps) else (low, middle)
    return low / steps
