"""The least work of limited forces, to fifty digits, never more than it; corners around loads of a turn."""

from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import product
from math import inf

import numpy as np
import pytest

from regrasp.verification.refusals.limited_work import corners, least_work, root

pytestmark = pytest.mark.oracle

AT = float(np.arctan2(4, 3))


def decimal(x: Fraction) -> Decimal:
    return Decimal(x.numerator) / Decimal(x.denominator)


def best(a: Decimal, b: Decimal, mu: Decimal, least: Decimal, most: Decimal | None) -> Decimal | float:
    """The least of n a + t b over n >= least, |t| <= mu n and n^2 + t^2 <= most^2."""
    b = abs(b)
    if most is None:
        return -inf if a < mu * b else least * (a - mu * b)
    if most < least:
        return inf
    aside = min(mu * least, (most * most - least * least).sqrt())
    found = [least * a - aside * b]
    if mu * least <= aside:  # the edge goes on to the circle
        end = most / (1 + mu * mu).sqrt()
        found.append(end * a - mu * end * b)
    speed = (a * a + b * b).sqrt()
    if speed > 0:
        push, slip = -most * a / speed, most * b / speed
        if push >= least and slip <= mu * push:
            found.append(-most * speed)
    return min(found)


@pytest.mark.parametrize("friction", [0.0, 0.3, 1.0, 3.0])
@pytest.mark.parametrize(
    ("least", "most"), [(0, 2), (0.5, 0.5), (0.5, 0.51), (0.5, 7), (1, 1.2), (0, None), (0.5, None), (1, 0.9)]
)
def test_works_are_the_least_and_never_above(friction, least, most) -> None:
    rng = np.random.default_rng(0)
    motions = [*rng.normal(size=(12, 2)), *([a, b] for a, b in product((-1.0, 0.0, 1.0), (0.0, 1.0, -0.5)))]
    for a, b in motions:
        for length in (3.0, float(rng.uniform(0.1, 2))):
            given = [Fraction(float(x)) for x in (a * length, b * length, length * length, friction, least)]
            found = least_work(*given, None if most is None else Fraction(most))
            with localcontext() as digits:
                digits.prec = 60
                size = decimal(given[2]).sqrt()
                up, along = decimal(given[0]) / size, decimal(given[1]) / size
                want = best(
                    up, along, Decimal(friction), Decimal(least), None if most is None else Decimal(most)
                )
                if isinstance(want, float) or isinstance(found, float):
                    assert found == want or (want == 0 == found)
                else:
                    assert -Decimal("1e-50") <= want - decimal(found) <= Decimal("1e-17"), (a, b, length)


def test_roots_are_rounded_one_way_or_exact() -> None:
    for square in (
        Fraction(2),
        Fraction(1, 3),
        Fraction(10**40 + 1),
        Fraction(3, 10**40),
        Fraction(0),
        Fraction(9, 4),
    ):
        low, high = root(square, up=False), root(square, up=True)
        assert low**2 <= square <= high**2
        assert high - low <= high / 2**63
        assert (low == high) == (square in (0, Fraction(9, 4)))


@pytest.mark.parametrize("angle", [0.3, 1.5, 3.0, -2.0])
def test_the_tangents_of_an_arc_meet_beyond_it(angle) -> None:
    one, other = (3.0, 4.0, 0.5), (5 * np.cos(angle + AT), 5 * np.sin(angle + AT), 0.5)
    first, last = ([Fraction(x) for x in w[:2]] for w in (one, other))
    found = corners(first, last)
    assert found[:2] == [first, last]
    meeting = np.array([float(x) for x in found[2]])
    exact = (np.array(one[:2]) + other[:2]) / (1 + np.cos(angle))
    assert meeting == pytest.approx(exact, rel=1e-9)
    assert np.hypot(*meeting) >= np.hypot(*exact) * (1 - 1e-12)
    middle = 5 * np.array([np.cos(AT + angle / 2), np.sin(AT + angle / 2)])
    assert meeting @ middle >= 25 * (1 - 1e-12)
    assert corners(first, first) == [first]
    assert corners(first, [-x for x in first]) == []
    longer = corners(first, [2 * x for x in last])  # the cosine is bounded by the longer, or the shorter
    cosine = 2 * 25 * np.cos(angle) / (100 if np.cos(angle) >= 0 else 25)
    if cosine <= -1:
        assert longer == []
    else:
        wide = (np.array(one[:2]) + 2 * np.array(other[:2])) / (1 + cosine)
        assert np.array([float(x) for x in longer[2]]) == pytest.approx(wide, rel=1e-9)


def test_a_root_is_rounded_up_where_its_square_is_cut_off() -> None:
    square = 1 + Fraction(1, 2**300)
    assert root(square, up=False) == 1
    assert root(square, up=True) ** 2 > square
    assert root(Fraction(9, 4), up=True) == Fraction(3, 2)
