"""Square roots of rationals, rounded to one side."""

from fractions import Fraction
from math import isqrt

_BITS = 96


def root_above(value: Fraction) -> Fraction:
    """A rational at or above the root, nearly equal to it."""
    if value == 0:
        return value
    root, scale = _root(value)
    return (root + 1) / scale


def root_below(value: Fraction) -> Fraction:
    """A rational at or below the root of a positive value, nearly equal to it."""
    root, scale = _root(value)
    return root / scale


def _root(value: Fraction) -> tuple[Fraction, Fraction]:
    """(r, s) with r / s at or just below the root of a positive value: r an integer of many bits."""
    shift = _BITS - (value.numerator.bit_length() - value.denominator.bit_length()) // 2
    scale = Fraction(2) ** shift
    return Fraction(isqrt(int(value * scale * scale))), scale
