"""Least works of limited forces along a motion, in rationals from below.

A finger with a least normal force N and a force limit M moves by a along its unit normal and by b along its
tangent. Of the forces |f_t| <= mu f_n the least work f . (a, b) is the least of

    N (a - mu |b|),  and with M:  M (a - mu |b|) / sqrt(1 + mu^2),  -M sqrt(a^2 + b^2) where that is inside,

or without M there is none where a < mu |b|. Where N is beyond the ends of the arc, M^2 < N^2 (1 + mu^2), the
corners are N a - sqrt(M^2 - N^2) |b|. Roots are rounded so that works only become less.
"""

from fractions import Fraction
from math import inf, isqrt

from regrasp.verification.exact import Vector, dot

_BITS = 128


def root(square: Fraction, *, up: bool) -> Fraction:
    """A square root, rounded up or down to 64 bits or better."""
    shift = max(_BITS - square.numerator.bit_length() + square.denominator.bit_length(), 0)
    shift += shift % 2
    scaled = (square.numerator << shift) // square.denominator
    exact = isqrt(scaled)
    whole = exact * exact == scaled and scaled * square.denominator == square.numerator << shift
    return Fraction(exact + (up and not whole), 1 << shift // 2)


def least_work(
    normal: Fraction,
    tangent: Fraction,
    squared: Fraction,
    friction: Fraction,
    least: Fraction,
    most: Fraction | None,
) -> Fraction | float:
    """The least work of a finger's forces, or a little less; infinite where no force is within its limits.

    normal, tangent: the motion along them, times their length, whose square is given.
    """
    aside = abs(tangent)
    edge = normal - friction * aside
    if least == 0 and edge >= 0:
        return Fraction(0)
    if most is None:
        return least * edge / root(squared, up=True) if edge >= 0 else -inf
    if most < least:
        return inf
    over = 1 + friction * friction
    speed = root((normal * normal + tangent * tangent) / squared, up=True)
    length = root(squared, up=edge >= 0)
    if most * most < least * least * over:
        aside_most = root(most * most - least * least, up=True)
        along, across = root(squared, up=normal >= 0), root(squared, up=False)
        corners = [least * normal / along - aside_most * aside / across]
        on_arc = normal < 0 and most * most * normal * normal >= least * least * (
            normal * normal + tangent * tangent
        )
    else:
        corners = [force * edge / length for force in (least, most / root(over, up=edge >= 0))]
        on_arc = normal < 0 and aside <= -friction * normal
    return min([*corners, -most * speed] if on_arc else corners)


def corners(one: Vector, other: Vector) -> list[list[Fraction]]:
    """Corners around all loads of a turn between two: these, and where the tangents of their arc meet.

    That corner is added a little farther out, for the cosine is rounded down. None where it is at infinity.
    """
    if list(one) == list(other):
        return [list(one)]
    squares = [dot(each, each) for each in (one, other)]
    product = dot(one, other)
    cosine = product / (max(squares) if product >= 0 else min(squares))
    if cosine <= -1:
        return []
    scale = 1 / (1 + cosine)
    return [list(one), list(other), [scale * (x + y) for x, y in zip(one, other, strict=True)]]
