"""Proofs in numbers of which doubles lose digits: sides, places and limits too small or too large."""

from fractions import Fraction
from math import sqrt

import numpy as np
import pytest

import regrasp as rg
from proofs import bent, everything, planar

pytestmark = pytest.mark.oracle

LEAST = 5e-324
FLOOR = np.array([[0, 0, 1.0]])


def one(vertices, twist, load, *, sides=FLOOR, **changes):
    """A proof of one box: the fingers along a twist."""
    node = (everything(sides, changes.pop("fingers", 1)), (0, 0), changes.pop("number", 0), twist)
    given = {"size": "force", "norm": "largest", "friction": 0.0, "sides": sides}
    return planar(vertices, [load], [node], **given | changes)


def proves(proof, bound: float) -> bool:
    proof.bound = bound
    return rg.verify(proof).ok


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("k", [1, 2, 3, 5, 1e5])
def test_sides_of_a_few_of_the_least_numbers(k: float, curved: bool) -> None:
    """From (0, 0) to 3 (k, k) of them: along its normal a force does the whole, root 2."""
    vertices = np.array([[0, 0], [3 * k * LEAST] * 2, [0, 1]])
    for box in {}, {"tied": np.array([[-1.0, 1, 0]]), "number": -2}:
        proof = one(vertices, (-1.0, 1, 0), (1.0, -1, 0), **box)
        if curved:
            proof.control = bent(vertices)
            proof.control[0] = k * LEAST * np.arange(4)[:, None]
        assert proves(proof, sqrt(2) * (1 - 1e-15))
        assert not proves(proof, sqrt(2) * (1 + 1e-15))


def test_outlines_of_a_few_of_the_least_numbers() -> None:
    """Levers of a third of 600 of them are no doubles."""
    vertices = np.array([[0, 0], [600, 0], [0, 600]]) * LEAST
    sides = np.array([[0, 0.3, 0.3334]])
    lever = Fraction(0.3334) * Fraction(float(vertices[1, 0]))
    for box in {}, {"tied": np.array([[0, 0, 1e300]]), "number": -2}:
        proof = one(vertices, (0, 0, 1e300), (0, 0, -1e-100), sides=sides, **box)
        limit = Fraction(1e-100) / lever
        assert proves(proof, float(limit * (1 - Fraction(1, 10**14))))
        assert not proves(proof, float(limit * (1 + Fraction(1, 10**14))))
    proof = one(vertices, (0, 0, 0), (0, 0, -1e-100), sides=sides)
    proof.movers, proof.motions = np.array([[0, 0]]), np.array([[0, 0, 1e300, 0, 0]])
    assert proves(proof, float(limit * (1 - Fraction(1, 10**14))))
    assert not proves(proof, float(limit * (1 + Fraction(1, 10**14))))


SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])


@pytest.mark.parametrize("unit", [1.0, 1e-200, 1e-145, 1e145, 1e200])
def test_limits_whose_squares_are_no_doubles(unit: float) -> None:
    """Of work there is enough for doubles: twists are as fast as limits are small."""
    fast = 1e70 / unit if unit < 1 else 1.0
    least = {"max_force": 2 * unit, "min_normal": unit, "friction": 10.0}  # of root 3 at most along the side
    apart = {"size": "margin", "margin": 5 * unit, "friction": 0.75}  # a corner of its region at (3.2, 12.6)
    for limits, twist, bound, most in (
        (least, (1.0, -11), 2 * unit, 3**0.5 - 11),
        (apart, (1.0, 1), 13 * unit, 15.8),
    ):
        for factor, good in (1 - 1e-12, most < 0), (1 + 1e-12, most > 0):
            load = 0, -unit * most * factor / twist[1], 0
            proof = one(SQUARE, (*np.multiply(twist, fast), 0), load, **limits)
            assert proves(proof, bound) == good, (limits, factor)
