"""Proofs in numbers of which doubles lose digits: sides, places and limits too small or too large."""

from fractions import Fraction
from math import sqrt

import numpy as np
import pytest

import regrasp as rg
from proofs import bent, everything, limit, planar, planar_points

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


@pytest.mark.parametrize("fast", [1e3, 1e6])
def test_squares_by_twists_about_a_point_next_to_the_finger(fast: float) -> None:
    """Velocities are a 1e-5 of what they are differences of, and much more than the bound."""
    vertices, sides = np.array([[1, 0.5], [5, 1.5], [4, 4], [0, 4]]), np.array([[0, 0.25, 0.25 + 2.0**-20]])
    rng = np.random.default_rng(0)
    for _ in range(4):
        turn, off = fast * rng.uniform(0.5, 1), 1e-5 * fast * rng.uniform(0.1, 1, size=2)
        twist = 0.75 * turn - 0.1 * off[0], off[1] - 2 * turn, turn
        given = {"norm": "squares", "friction": 0.75, "max_force": 9.0}
        proof = one(vertices, twist, (0, 0, -1e-5), sides=sides, **given)
        most = float(limit(proof, planar_points(proof)))
        assert proves(proof, most * (1 - 2.0**-51))
        assert not proves(proof, most * (1 + 2.0**-51))


def test_turned_proofs_have_one_twist_a_box_and_no_limits() -> None:
    words = "proof: turns go with a smooth boundary, forces of any size and one twist for each box"
    given = {"turned": True, "control": bent(SQUARE)}
    assert words not in rg.verify(one(SQUARE, (0, -1, 0), (0, 1, 0), **given)).violations
    for other in (
        {"control": None}, {"max_force": 9.0}, {"min_normal": 1.0, "max_force": 9.0}, {"size": "margin"},
        {"tied": np.zeros((1, 3))}, {"movers": np.array([[0, 0]]), "motions": np.zeros((1, 5))},
    ):  # fmt: skip
        assert rg.verify(one(SQUARE, (0, -1, 0), (0, 1, 0), **given | other)).violations == (words,), other
