"""The most on parts of cubics: never below what a place does, and off by the square of a part."""

from fractions import Fraction
from itertools import pairwise, product

import numpy as np
import pytest

from regrasp.verification.placed.curves.along_parts import most_on_part, roughly_on_part
from regrasp.verification.placed.protocol import Point, velocity

pytestmark = pytest.mark.oracle

CURVES = {
    "any": [(0, 0), (3, 1), (2, 4), (-1, 3)],
    "inflection": [(0, 0), (1, Fraction(1, 3)), (2, Fraction(-1, 2)), (3, 0)],
    "straight": [(0, 0), (1, 2), (3, 6), (4, 8)],
    "cusp at its end": [(0, 0), (0, 0), (2, 1), (3, 4)],
}


def dot(a: Point, b: Point) -> Fraction:
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Point, b: Point) -> Fraction:
    return a[0] * b[1] - a[1] * b[0]


def polar(points: list[Point], *at: Fraction) -> Point:
    for t in at:
        points = [(p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])) for p, q in pairwise(points)]
    return points[0]


def part(name: str, lo: Fraction, hi: Fraction, scale: Fraction = Fraction(1)):
    """Control points of a curve and its legs; of a part the hull, the tangents and the outermost of them."""
    curve = [(Fraction(x) * scale, Fraction(y) * scale) for x, y in CURVES[name]]
    legs = [(q[0] - p[0], q[1] - p[1]) for p, q in pairwise(curve)]
    hull = [polar(curve, *at) for at in ((lo, lo, lo), (lo, lo, hi), (lo, hi, hi), (hi, hi, hi))]
    tangents = [polar(legs, *at) for at in ((lo, lo), (lo, hi), (hi, hi))]
    first = next(d for d in tangents if all(cross(d, e) >= 0 for e in tangents))
    return (
        curve,
        legs,
        hull,
        tangents,
        (first, next(d for d in tangents if all(cross(d, e) <= 0 for e in tangents))),
    )


def done2(curve, legs, t: Fraction, y, mu: Fraction, force: bool) -> Fraction:
    """The square of the most that a finger does at a place."""
    v, along = velocity(y, polar(curve, t, t, t)), polar(legs, t, t)
    ahead, aside = cross(along, v), abs(dot(along, v))
    if force and ahead > 0 and aside <= mu * ahead:
        return dot(v, v)
    edge = max(ahead + mu * aside, Fraction(0))
    return edge**2 / dot(along, along) / ((1 + mu**2) if force else 1)


def drawn(rng: np.random.Generator, scale: Fraction = Fraction(1)) -> list[Fraction]:
    x, z, turn = (Fraction(int(c), 100) for c in rng.integers(-300, 301, 3))
    return [x, z, turn / scale]


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("scale", [Fraction(1), Fraction(10) ** 150, 1 / Fraction(10) ** 300])
def test_no_place_does_more(name: str, scale: Fraction) -> None:
    rng, seen = np.random.default_rng(1), 0
    for mu, width in product(
        [Fraction(0), Fraction(1, 10), Fraction(3, 2)], [Fraction(1, 3), Fraction(1, 50)]
    ):
        lo = Fraction(int(rng.integers(20, 60)), 100) * (1 - width)
        curve, legs, hull, tangents, ends = part(name, lo, lo + width, scale)
        y = drawn(rng, scale)
        for force in False, True:
            most = most_on_part(hull, tangents, ends, mu, force, y)
            if most is None:
                continue
            seen += most > 0
            for k in range(13):
                assert done2(curve, legs, lo + width * k / 12, y, mu, force) <= most**2
    assert seen > 3


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("mu", [Fraction(0), Fraction(1, 100), Fraction(3, 5)])
def test_what_it_is_above_falls_with_the_square_of_a_part(mu: Fraction, force: bool) -> None:
    """Parts of a tenth of the length: a hundredth of the error, of a twist that turns."""
    y = [Fraction(-1), Fraction(1, 2), Fraction(1)]
    above = []
    for width in Fraction(1, 10), Fraction(1, 100), Fraction(1, 1000):
        lo = Fraction(2, 5)
        curve, legs, hull, tangents, ends = part("any", lo, lo + width)
        most = most_on_part(hull, tangents, ends, mu, force, y)
        assert most is not None
        places = [done2(curve, legs, lo + width * k / 50, y, mu, force) for k in range(51)]
        above.append(float(most) - float(max(places)) ** 0.5)
    assert above[0] < 0.2
    assert 0 <= above[1] < 0.02 * above[0] + 1e-9
    assert 0 <= above[2] < 0.02 * above[1] + 1e-9


@pytest.mark.parametrize("name", ["any", "inflection", "straight"])
def test_doubles_say_the_same_however_small_a_curve_is(name: str) -> None:
    """Of 1e-140 products of three lengths are less than any double."""
    rng = np.random.default_rng(2)
    lo, hi = Fraction(2, 5), Fraction(1, 2)
    for scale, force in product([1.0, 1e-138, 1e138], [False, True]):
        _, _, hull, tangents, ends = part(name, lo, hi, Fraction(scale))
        y = [Fraction(float(c)) for c in drawn(rng, Fraction(scale))]
        if scale < 1:
            y = [Fraction(float(c) * 1e-120) for c in y[:2]] + [Fraction(float(y[2]) * 1e-120)]
        most = most_on_part(hull, tangents, ends, Fraction(1, 2), force, y)
        assert most is not None
        unit = [np.array([[float(c) for c in d]]) for d in ends]
        rough = roughly_on_part(
            [np.array([[float(c) for c in p]]) for p in hull],
            [np.array([[float(c) for c in t]]) for t in tangents],
            (unit[0] / np.hypot(*unit[0][0]), unit[1] / np.hypot(*unit[1][0])),
            0.5, force, np.array([[float(c) for c in y]]),
        )  # fmt: skip
        assert rough[0] == pytest.approx(float(most), rel=1e-10, abs=0)


def test_of_parts_that_turn_by_a_quarter_or_have_no_tangent_nothing_is_said() -> None:
    y = [Fraction(0), Fraction(1), Fraction(0)]
    nothing: list[Point] = [(Fraction(0), Fraction(0))] * 4
    turned = [(Fraction(1), Fraction(0)), (Fraction(1), Fraction(1)), (Fraction(0), Fraction(1))]
    still = [(Fraction(1), Fraction(0)), (Fraction(0), Fraction(0)), (Fraction(1), Fraction(0))]
    for tangents in turned, still:
        assert most_on_part(nothing, tangents, (tangents[0], tangents[2]), Fraction(1), True, y) is None
