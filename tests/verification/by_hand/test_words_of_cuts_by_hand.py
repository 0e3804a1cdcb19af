"""Tangents from below to the last digit, and what verdicts on cuts say of components, turns and limits."""

from fractions import Fraction
from math import factorial, inf
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.refusals.cuts import _asked, _components, _Holds, _listed, _tangent_below
from regrasp.verification.refusals.limited_work import corners, least_work, root
from regrasp.verification.refusals.outline_cuts import _covered, _Cut, _in_words

pytestmark = pytest.mark.oracle


def tangent(x: Fraction) -> Fraction:
    """By the series of sine and cosine, to forty digits."""
    sine = sum(((-1) ** k * x ** (2 * k + 1) / factorial(2 * k + 1) for k in range(22)), Fraction(0))
    return sine / sum(((-1) ** k * x ** (2 * k) / factorial(2 * k) for k in range(22)), Fraction(0))


@pytest.mark.parametrize("angle", [0.0, 0.01, 0.7, 1.2, 1.4, 1.5])
def test_tangents_are_below_by_less_than_they_say(angle) -> None:
    below = tangent(Fraction(angle)) - _tangent_below(Fraction(angle))
    assert -Fraction(1, 10**30) <= below <= Fraction(1, 10**18)
    assert _tangent_below(Fraction(3, 2) + Fraction(1, 10**9)) == 14
    assert _tangent_below(Fraction(3, 2)) > 14


def cut(contacts, start=(0, 1, 2), goal=(3, 4, 5), margin=0.0, apart=0.0):
    more = {"reached": (0, 1, 2), "least_margin": margin, "min_distance": apart}
    return SimpleNamespace(contacts=tuple(contacts), start=start, goal=goal, **more)


def test_components_in_words() -> None:
    """Those whose forces turn left hold with those that turn right, and none with their own."""
    left, right = (
        [rg.Contact([x, -1], [0, 1], 0.1) for x in (3, 4, 5)],
        [rg.Contact([-x, -1], [0, 1], 0.1) for x in (3, 4, 5)],
    )
    made = cut([*left, *right])
    assert _components(made, _Holds(made)) == (
        "9 of 15 pairs may hold, in 1 component of 6 contacts; no two fingers of the start do, no two "
        "fingers of the goal do"
    )
    mixed = cut([*left, *right], start=(0, 1, 3), goal=(2, 4, 5))
    words = _components(mixed, _Holds(mixed))
    assert words.endswith("; those of the start in one of 6, those of the goal in one of 6")
    fake = SimpleNamespace(may=lambda i, j: (i, j) in {(0, 1), (2, 3), (3, 4), (5, 6), (8, 9), (6, 9)})
    made = cut([*left, *right, *left, *right], start=(0, 1, 7), goal=(2, 3, 4))
    assert _components(made, fake) == (
        "6 of 66 pairs may hold, in 3 components of 4, 3, 2 contacts; those of the start in one of 2, "
        "those of the goal in one of 3"
    )
    several = cut(made.contacts, start=(0, 1, 2), goal=(3, 4, 2))
    fake = SimpleNamespace(may=lambda i, j: (i, j) in {(0, 1), (3, 4), (2, 4)})
    assert "those of the goal in one of 3" in _components(several, fake)
    both = cut(made.contacts, start=(0, 1, 2), goal=(3, 4, 5))
    fake = SimpleNamespace(may=lambda i, j: (i, j) in {(1, 2), (0, 9), (3, 4), (4, 8)} or (i, j) == (0, 1))
    assert "those of the start in one of 4, those of the goal in one of 3" in _components(both, fake)
    for count in (500, 501):
        many = SimpleNamespace(contacts=(left[0],) * count, start=(0, 1, 2), goal=(3, 4, 5))
        assert (_components(many, SimpleNamespace(may=lambda i, j: False)) == "") == (count > 500)
    assert _listed([5, 4, 3, 2]) == "5, 4, 3, 2"
    assert _listed([6, 5, 4, 3, 2]) == "6, 5, 4, 3 and fewer"
    assert _asked(cut([], margin=0.1)) == " with angle margins of 0.1 rad"
    assert _asked(cut([], apart=0.5)) == " with fingers 0.5 apart"
    assert _asked(cut([], margin=0.1, apart=0.5)) == " with angle margins of 0.1 rad and fingers 0.5 apart"
    assert _asked(cut([])) == ""


def test_limits_in_words() -> None:
    assert _in_words(0.0, None) == ""
    assert _in_words(0.5, None) == ", with normal forces of at least 0.5 N in every hold"
    assert _in_words(0.0, 3.0) == ", with forces of at most 3 N in every hold"
    both = ", with normal forces of at least 0.5 N and forces of at most 3 N in every hold"
    assert _in_words(0.5, 3.0) == both


def outline(force=(0.0, -1.0), turned=None, **more):
    none = np.zeros((0, 6))
    given = {
        "vertices": np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float), "friction": 0.5,
        "force": np.array(force), "turned": None if turned is None else np.array(turned),
        "forbidden": np.array([]), "min_normal": 0.0, "max_force": None, "start": np.zeros((0, 2)),
        "goal": np.zeros((0, 2)), "reached": np.zeros((0, 3)), "boxes": none, "twists": np.zeros((0, 3)),
    }  # fmt: skip
    return _Cut(SimpleNamespace(**given | more))


def test_orientations_in_words() -> None:
    assert outline().orientations() == "this orientation"
    assert outline(turned=[0.0, -2.0]).orientations() == "this orientation"
    assert outline(force=(0.0, 0.0)).orientations() == "this orientation"
    for scale in (1.0, 1e-160, 1e160):
        for turned, degrees in (([1.0, 0.0], 90), ([-1.0, 0.0], 90), ([1.0, 1.0], 135), ([1.0, -1.0], 45)):
            made = outline((0.0, -scale), scale * np.array(turned))
            assert made.orientations() == f"any orientation within a turn of {degrees} deg"


def test_sizes_of_loads_are_alike_to_their_rounding() -> None:
    """Squares by 4 * 2^-40 of each other, with limits; without any they do not matter."""
    for part, good in (1 + 2.0**-39 * 0.99, True), (1 + 2.0**-39 * 1.01, False):
        for turned in ([part, 0.0], [-1 / part, 0.0]):
            found = list(outline(turned=turned, max_force=5.0).turn())
            assert (found == []) == good, part
            assert good or found == ["the loads at the ends of the turn are of different sizes"]
            assert list(outline(turned=turned).turn()) == []
    assert list(outline(turned=[0.0, 1.0]).turn()) == ["the ends of the turn are half a turn apart"]
    assert list(outline(turned=[0.0, 0.0]).turn()) == ["the ends of the turn are half a turn apart"]
    assert list(outline(turned=[0.0, -1.0]).turn()) == []


def test_works_of_a_finger_by_hand() -> None:
    """At the middle of the upper side, whose normal is down, by t = (-2, 0): no friction is 0.5 of it."""
    made = outline()
    for y, work in (
        ([0, -1, 0], 0.0),
        ([0, 1, 0], -inf),
        ([1, 0, 0], -inf),
        ([2, -1, 0], 0.0),
        ([2.1, -1, 0], -inf),
    ):
        assert made.least_work([Fraction(x) for x in y], (2, Fraction(1, 2))) == work, y
    limited = outline(min_normal=1.0)
    y = [Fraction(0), Fraction(-1), Fraction(0)]
    assert limited.least_work(y, (2, Fraction(1, 2))) == 1
    assert limited.least_work([Fraction(1, 4), Fraction(-1), Fraction(0)], (2, Fraction(1, 2))) == Fraction(
        7, 8
    )
    turn = [Fraction(0), Fraction(0), Fraction(1)]  # about the centre: a point (x, 1) goes by (-1, x)
    assert limited.least_work(turn, (2, Fraction(1, 2))) == -inf
    assert limited.least_work(turn, (2, Fraction(1))) == Fraction(1, 2)  # (-1, -1): 1 along, 1 aside
    assert limited.least_work(turn, (3, Fraction(0))) == -inf  # the same corner as of the side on the left


def test_works_without_a_motion_are_none() -> None:
    for least, most in (0, 2), (1, 2), (Fraction(19, 10), 2), (0, None), (1, None):
        most = None if most is None else Fraction(most)
        found = least_work(Fraction(0), Fraction(0), Fraction(4), Fraction(1, 2), Fraction(least), most)
        assert found == 0
    assert least_work(*map(Fraction, (1, 0, 1)), Fraction(1, 2), Fraction(3), Fraction(2)) == inf
    assert least_work(*map(Fraction, (1, 0, 1)), Fraction(1, 2), Fraction(2), Fraction(2)) == 2


def test_roots_have_a_hundred_bits_and_more_at_every_scale() -> None:
    for exponent in (-400, -3, 0, 3, 400):
        for odd in (2, 3, 5):
            square = odd * Fraction(4) ** exponent
            low, high = root(square, up=False), root(square, up=True)
            assert low**2 < square < high**2
            assert (high - low) <= high / 2**62
        assert root(9 * Fraction(4) ** exponent, up=True) == 3 * Fraction(2) ** exponent
        assert root(9 * Fraction(4) ** exponent, up=False) == 3 * Fraction(2) ** exponent


def test_corners_are_around_the_arc() -> None:
    one, other = [Fraction(3), Fraction(4)], [Fraction(-4), Fraction(3)]
    assert corners(one, other) == [one, other, [Fraction(-1), Fraction(7)]]
    assert corners(one, [Fraction(-3), Fraction(-4)]) == []
    assert corners(one, one) == [one]
    sharp = corners(one, [Fraction(-24, 5), Fraction(-7, 5)])  # cosine -(72/5 + 28/5) / 25 = -4/5
    assert sharp[2] == [5 * Fraction(-9, 5), 5 * Fraction(13, 5)]


def test_strips_are_covered_by_chains_of_boxes() -> None:
    def spans(*rows):
        return [((Fraction(a), Fraction(b)), (Fraction(c), Fraction(d))) for a, b, c, d in rows]

    whole = (Fraction(0), Fraction(4))
    for rows, good in (
        ([(0, 4, 0, 4)], True), ([(0, 4, 0, 2), (0, 4, 2, 4)], True), ([(0, 4, 0, 2), (0, 4, 3, 4)], False),
        ([(0, 4, 2, 4), (0, 4, 0, 2)], True), ([(0, 2, 0, 4), (2, 4, 0, 4)], True),
        ([(0, 2, 0, 4), (3, 4, 0, 4)], False),
        ([(0, 4, 1, 4)], False), ([(0, 4, 0, 3)], False), ([(-1, 5, -1, 5)], True), ([], False),
        ([(0, 3, 0, 4), (1, 4, 0, 2), (2, 4, 3, 4)], False),
        ([(0, 3, 0, 4), (1, 4, 0, 2), (3, 4, 1, 4)], True),
        ([(0, 4, 0, 4), (0, 4, 0, 1)], True), ([(0, 4, 0, 3), (0, 4, 1, 2)], False),
    ):  # fmt: skip
        assert _covered(whole, whole, spans(*rows)) == good, rows
    at = (Fraction(2), Fraction(2))
    for rows, good in (
        ([(2, 4, 0, 4)], True),
        ([(0, 2, 0, 4)], True),
        ([(3, 4, 0, 4)], False),
        ([(1, 3, 0, 3)], False),
    ):
        assert _covered(at, whole, spans(*rows)) == good, rows


def whole(**more) -> str:
    """What is said of a cut on a square whose sides 1 and 3 are parted, under a load down."""
    ends = {
        "start": np.array([[1, 0.25], [1, 0.5], [1, 0.75]]),
        "goal": np.array([[3, 0.25], [3, 0.5], [3, 0.75]]),
    }
    given = {
        "vertices": np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float), "friction": 1e-3,
        "force": np.array([0.0, -1.0]), "turned": None, "forbidden": np.array([0, 2]), "min_normal": 0.0,
        "max_force": None, **ends,
        "reached": np.array([[1, 0.0, 1.0]]), "boxes": np.array([[1, 3, 0, 1, 0, 1.0]]),
        "twists": np.array([[0.0, -1.0, 0.0]]),
    }  # fmt: skip
    return "; ".join(rg.verify(SimpleNamespace(**given | more)).violations)


def test_limits_and_sides_of_a_cut_with_a_form() -> None:
    words = "a cut has three places at either end"
    for most in (0.5, 1e-9, 9.0):
        assert words not in whole(max_force=most)
        assert words not in whole(min_normal=most)
    for most in (0.0, -1.0, inf, float("nan")):
        assert words in whole(max_force=most)
        assert most == 0.0 or words in whole(min_normal=most)
    twice = np.array([[-1, -1], [1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    assert whole(vertices=twice) == "a side of the outline has no length"
    assert whole(vertices=twice[[0, 1, 3, 4, 0]]) == "a side of the outline has no length"


def test_every_place_of_the_start_is_reached() -> None:
    none = {"boxes": np.zeros((0, 6)), "twists": np.zeros((0, 3)), "reached": np.array([[1, 0.0, 0.5]])}
    words = "places of the start on sides 1 and 1 may hold and are not both on its side"
    for first in (0.75, 0.25), (0.25, 0.75), (0.75, 0.8):
        assert words in whole(start=np.array([[1, x] for x in (*first, 0.1)]), **none)
    assert words not in whole(start=np.array([[1, x] for x in (0.5, 0.25, 0.1)]), **none)


def test_what_limited_forces_take_up_is_said() -> None:
    """Along (tilt, -1) a push of the right side, at most 1 / 2, works by - tilt / 2; the left's by none."""
    for tilt, good in (1.9, True), (2.1, False):
        said = whole(max_force=0.5, twists=np.array([[tilt, -1.0, 0.0]]))
        words = "box 1: the load does no work along its twist, beyond what forces within the limits take up"
        assert (words not in said) == good
