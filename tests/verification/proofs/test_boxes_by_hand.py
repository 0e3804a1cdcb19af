"""Boxes of a proof, by hand: what a force may do on stretches, what doubles decide, and what excludes."""

from fractions import Fraction

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, planar
from regrasp.verification.placed.clear_boxes import clear_boxes
from regrasp.verification.placed.cubic import CubicEdges
from regrasp.verification.placed.forces.eroded import most_eroded
from regrasp.verification.placed.roots import root_above, root_below
from regrasp.verification.placed.straight import StraightEdges

pytestmark = pytest.mark.oracle

UP, DOWN = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)
SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def floor(twist=UP, fingers=1, load=DOWN, **changes):
    """Fingers on the lower side of a square, one box."""
    sides = np.array([[0, 0, 1.0]])
    node = (everything(sides, fingers), (0, 0), 0, twist)
    return planar(SQUARE, [load], [node], sides=sides, **changes)


def of_legs(legs, **changes):
    """A cubic of these legs, three times."""
    curve = np.concatenate([[[0, 0]], np.cumsum(legs, axis=0)]).astype(float)
    node = ([(0, 0, 0.0, 1.0)], (0, 0), 0, UP)
    proof = planar([curve[0]] * 3, [DOWN], [node], control=np.array([curve] * 3), **changes)
    return CubicEdges(proof)


def judged(edges, v, square) -> None:
    """The most along v between the outermost normals in rationals, a root from above, or nothing.

    In doubles the same, or what is no more and the most of the part in rationals, too.
    """
    y = [*v, 0]
    exact = edges.most_along(0, Fraction(0), Fraction(1), [tuple(Fraction(c) for c in v)])
    most = edges.most(0, Fraction(0), Fraction(1), [Fraction(c) for c in y])
    rough = edges.roughly(np.array([0]), np.array([0.0]), np.array([1.0]), np.array([y], dtype=float))[0]
    if square is None:
        assert (exact, rough) == (0, 0)
        return
    square = Fraction(square)
    assert square <= exact * exact <= square * (1 + Fraction(1, 2**80)), v
    assert 0 <= most <= exact
    assert rough == pytest.approx(float(most), rel=1e-12, abs=1e-15), v


TURNS = [(1, 0), (4, 3), (3, 4)]  # of 53 degrees together, in any order


@pytest.mark.parametrize(
    ("size", "mu", "along"),
    [
        # from (0, 1) to (-4, 3)
        ("force", 0, [((0, 1), 1), ((-4, 3), 25), ((-3, 4), 25), ((1, 0), None), ((0, -1), None),
                      ((3, 4), 16), ((-4, -3), "49/25"), ((4, -3), None)]),
        ("normal", 0, [((0, 1), 1), ((-4, 3), 25), ((-3, 4), 25), ((3, 4), 16), ((-4, -3), "49/25")]),
        # from (3, 4) to (-1, 0)
        ("force", 0.75, [((3, 4), 25), ((4, 3), "576/25"), ((-1, -1), 1), ((0, 1), 1), ((-3, 4), 25),
                         ((1, -1), None), ((-1, 0), 1), ((1, 0), "9/25")]),
        # 5/4 of the arcs from (3, 4) to (-7, 24) and from (-3, 4) to (-1, 0)
        ("normal", 0.75, [((0, 1), "25/16"), ((-3, 4), "625/16"), ((-5, 12), "104329/400"),
                          ((3, 4), "625/16"), ((4, 3), 36), ((-1, 0), "25/16"), ((-4, 3), "625/16"),
                          ((1, -1), None)]),
        # half a turn from (2, 1) to (-2, -1)
        ("force", 2, [((-1, 2), 5), ((1, -2), None), ((2, 1), 5), ((-2, -1), 5), ((3, 4), 25), ((4, 3), 25),
                      ((4, 1), "81/5"), ((-4, -1), 17), ((-4, -3), "121/5")]),
        # 190 degrees from (5, 2) to (-23, -14)
        ("force", 2.5, [((0, 1), 1), ((5, 2), 29), ((-23, -14), 725), ((15, 8), 289), ((-15, -8), 289),
                        ((0, -1), "196/725"), ((5, -12), "2809/725"), ((1, -1), "9/29"), ((-1, 0), 1)]),
        # 246 degrees
        ("force", 100, [((0, 1), 1), ((3, 4), 25), ((-3, 4), 25), ((-4, -4), 32), ((-1, 0), 1)]),
    ],
)  # fmt: skip
def test_most_work_between_the_outermost_normals(size, mu, along) -> None:
    for k in range(3):
        legs = np.multiply(TURNS[k:] + TURNS[:k], 8.0 ** (k - 1))
        edges = of_legs(legs, size=size, friction=mu, bound=7.0)
        for v, square in along:
            judged(edges, v, square)
            if size == "force" and mu > 2.2:  # of margins the same, times their limit
                wide = of_legs(legs, size="margin", friction=mu, bound=7.0, margin=1.0)
                most = wide.most(0, Fraction(0), Fraction(1), [Fraction(c) for c in (*v, 0)])
                assert most == 7 * edges.most_along(0, Fraction(0), Fraction(1), [tuple(map(Fraction, v))])
                assert wide.roughly(np.array([0]), np.zeros(1), np.ones(1), np.array([[*v, 0.0]])) == np.inf


def test_half_a_turn_but_for_rounding_is_not_none() -> None:
    """Cones and a bend of half a turn together: doubles cannot tell which, and must not say 0."""
    for turn in np.linspace(0.1, 1.4, 60):
        last, mu = (np.cos(turn), np.sin(turn)), 1 / np.tan(turn / 2)
        edges = of_legs([(1, 0), (1 + last[0], last[1]), last], size="force", friction=float(mu))
        middle = np.array([[-last[1], 1 + last[0], 0.0]]) / np.hypot(last[1], 1 + last[0])
        assert edges.roughly(np.array([0]), np.zeros(1), np.ones(1), middle)[0] == pytest.approx(1)


# |f| <= 13 at 5 or more from (3, 4) and (-3, 4): corners at (+-16, 63) / 5 and (0, 25 / 3)
OF_MARGINS = [
    ((0, 1), 13), ((1, 0), 3.2), ((-1, 0), 3.2), ((0, -1), -25 / 3), ((3, -4), -100 / 3), ((2, -1), -6.2),
    ((-2, -1), -6.2), ((16, 63), 845), ((-16, 63), 845), ((4, -3), -25), ((12, 5), 101.4), ((-12, 5), 101.4),
    ((3, 4), 60), ((-3, 4), 60), ((9, 40), 533), ((5, 12), 167.2),
]  # fmt: skip


@pytest.mark.parametrize("scale", [1.0, 0.25, 64.0])
def test_most_work_of_forces_that_keep_a_distance(scale) -> None:
    given = {"size": "margin", "norm": "largest", "friction": 0.75, "bound": 13 * scale, "margin": 5 * scale}
    for edges in of_legs([(1, 0), (1, 0), (1, 0)], **given), StraightEdges(floor(**given)):
        for v, most in OF_MARGINS:
            y = [*v, 0]
            exact = edges.most(0, Fraction(0), Fraction(1), [Fraction(c) for c in y])
            found = edges.roughly(np.array([0]), np.zeros(1), np.ones(1), np.array([y], dtype=float))[0]
            assert float(exact) == pytest.approx(most * scale, rel=1e-14)
            assert found == pytest.approx(most * scale, rel=1e-14)


def test_corners_of_margins_are_exact() -> None:
    """Against the inward direction across an edge: the distance from it is all, and nothing is rounded."""
    a, b = (Fraction(2), Fraction(1)), (Fraction(-2), Fraction(1))
    margin = Fraction(1, 10)
    least = margin * root_below(Fraction(5))
    for across in (-1, 2), (1, 2):
        v = Fraction(-across[0], 3), Fraction(-across[1], 3)
        assert most_eroded(a, b, Fraction(1), margin, v) == -least / 3


def test_thin_cones_are_judged_in_rationals() -> None:
    """Their tips are far from both edges: 1e-16 of these are 1e-10 there."""
    for friction, fine in (
        (0.0501256, False), (0.0501257, True), (19.9498, True), (19.9499, False), (1e-6, False),
    ):  # fmt: skip
        margin = 0.5 * friction / np.hypot(1, friction)
        proof = floor(size="margin", norm="largest", friction=friction, bound=1.0, margin=margin)
        place, y = (np.array([0]), np.zeros(1), np.ones(1)), np.array([[1.0, 2, 3]])
        assert np.isfinite(StraightEdges(proof).roughly(*place, y)[0]) == fine


def clear(proof) -> list[bool]:
    return clear_boxes(proof, StraightEdges(proof)).tolist()


def at_limits(proof, axis, done, judge=clear) -> None:
    """Work along one axis against what may be done, 1e-13 of it lost."""
    for factor, good in (1 + 1e-8, True), (1 - 1e-8, False):
        proof.loads = np.zeros((1, 3))
        proof.loads[0, axis] = -done / proof.twists[0, axis] * factor
        assert judge(proof) == [good], (axis, factor)


def test_doubt_where_nothing_is_done() -> None:
    """Fingers left of the centre do nothing along x, down and clockwise: all that is left is doubt.

    It is 1e-13 of the twist times (1, 1, reach), reach the farthest coordinates and the centre together.
    """
    sides, centre = np.array([[0, 0, 1.0]]), np.array([5.0, 12])
    low = np.array([[-4.0, -3], [-3, -3], [-3, -2], [-4, -2]])
    for axis, y, reach in (0, 2.0, 1), (0, -2.0, 1), (1, -2.0, 1), (2, 2.0, 5 + 13):
        twist = np.zeros(3)
        twist[axis] = y
        node = (everything(sides, 1), (0, 0), 0, twist)
        proof = planar(low, [DOWN], [node], sides=sides, centre_of_mass=centre, friction=0.0, bound=3.0)
        at_limits(proof, axis, 3e-13 * 2 * reach)
        proof.control = np.stack([low, low, low, np.roll(low, -1, axis=0)], axis=1)
        proof.control[0] = [[-4, -3], [-3.75, -3], [-3.25, -3], [-3, -3]]
        proof.control[2, 1] = [-40, 30]
        far = 1 if axis < 2 else 50 + 13
        at_limits(proof, axis, 3e-13 * 2 * far, lambda p: clear_boxes(p, CubicEdges(p)).tolist())


def test_second_twists_have_their_part_of_doubt() -> None:
    for y, z in (DOWN, (0, -3.0, 0)), (DOWN, (4.0, -8.0, 0)), ((0.5, -1.0, 0), (-0.5, -2.0, 0)):
        proof = floor(y, norm="largest", bound=2.0, friction=0.0)
        proof.pairs, proof.seconds = np.array([[0, 0]]), np.array([z])
        for factor, good in (1 + 1e-8, True), (1 - 1e-8, False):
            work = 2e-13 * np.abs([y, z]).sum() * factor
            proof.loads = np.array([[0, -work / (y[1] + z[1]), 0]])
            assert clear(proof) == [good]
    proof = floor(DOWN, norm="largest", bound=2.0, friction=0.0)
    proof.pairs, proof.seconds = np.array([[0, 0]]), np.array([[0, 3.0, 0]])  # both together push by 3
    for work, good in (6 * (1 + 1e-12), True), (6 * (1 - 1e-12), False):
        proof.loads = np.array([[0, -work / 2, 0]])
        assert clear(proof) == [good]


def test_second_twists_of_no_box_count_for_none() -> None:
    for box in -1, 0, 1:
        proof = floor(norm="largest", bound=0.9, load=(0, -1.0, 0))
        proof.pairs, proof.seconds = np.array([[box, 0]]), np.array([[0, 5.0, 0]])
        assert clear(proof) == [True]
        assert said(proof) == ""
        proof.bound, proof.seconds = 1.1, np.array([[0.0, 0, 1.0]])  # along which a load is lifted
        proof.loads = np.array([[0, -1.0, -8.0]])
        assert clear(proof) == [box == 0]
        assert ("does not exclude it" in said(proof)) == (box != 0)


def test_what_is_too_small_for_doubles() -> None:
    """Doubt of less than 1e-140 of either kind."""
    for y, load, good in (
        (1.0, 1e-126, True), (1.0, 1e-128, False), (1e-126, 1.0, True), (1e-128, 1e10, False),
        (1e10, 1e-136, True), (1e10, 1e-138, False), (1e-138, 1e20, False),
    ):  # fmt: skip
        proof = floor((0, y, 0), load=(0, -load, 0), bound=1e-9 * load)
        assert clear(proof) == [good], (y, load)
        assert said(proof) == ""


@pytest.mark.parametrize("fingers", [1, 2])
def test_margins_exclude_what_is_beyond_their_region(fingers) -> None:
    """Along (0, -3) no force of 6 off both edges does more than -30, along (0, 1) none more than 13."""
    given = {"size": "margin", "norm": "largest", "friction": 0.75, "bound": 13.0, "margin": 6.0}
    for twist, load, good in (
        ((0, -3.0, 0), (0, -10.0, 0), False), ((0, -3.0, 0), (0, -10 - 1e-12, 0), False),
        ((0, -3.0, 0), (0, -10 + 1e-12, 0), True), (UP, (0, -13 - 1e-12, 0), True),
        (UP, (0, -13.0, 0), False),
    ):  # fmt: skip
        proof = floor(twist, fingers, np.multiply(load, fingers), **given)
        assert said(proof) == ("" if good else "proof: the twist of box 0 does not exclude it")


def test_most_work_on_a_straight_side() -> None:
    for mu, v, square in (
        (0.0, (0, 1), 1), (0.0, (0, -1), None), (0.0, (1, 0), None), (0.0, (3, 4), 16), (0.75, (0, -1), None),
        (0.75, (4, 1), "256/25"), (0.75, (-4, 1), "256/25"), (0.75, (3, 4), 25), (0.75, (-3, 5), 34),
        (0.75, (4, -4), None), (0.75, (4, -2), "16/25"),
    ):  # fmt: skip
        judged(StraightEdges(floor(size="force", friction=mu)), v, square)


def test_bounds_that_are_just_reached_are_proven() -> None:
    """On a floor 4 long, of 2 to either side of the centre: fingers lift by 1 and turn by 2."""
    centre = np.array([2.0, 0])
    for bound, good in (1.0, True), (1 + 2.0**-52, False):
        assert (said(floor(bound=bound)) == "") == good
        proof = floor((0, 0, 1.0), load=(0, 0, -2.0), friction=0.0, bound=bound, centre_of_mass=centre)
        assert (said(proof) == "") == good
        proof.norm, proof.bound = "largest", 2 * bound  # both ways together 2, at either end
        proof.pairs, proof.seconds = np.array([[0, 0]]), np.array([[0, 0, -1.0]])
        proof.loads = np.array([[0, 0, -2.0], [0, 0, 2.0]])
        proof.pairs[0, 1] = 1
        assert (said(proof) == "") == good


def test_on_a_curve_the_most_is_done_between_its_ends() -> None:
    """Along (-3, 4), in the middle of a bend from (0, 1) to (-4, 3), 5, and 4.8 at its end."""
    curve = np.concatenate([[[0, 0]], np.cumsum(TURNS, axis=0)]).astype(float)
    node = ([(0, 0, 0.0, 1.0)], (0, 0), 0, (-3.0, 4.0, 0.0))
    for bound, good in (1 - 1e-15, True), (1 + 1e-15, False):
        proof = planar([curve[0]], [(3, -4, 0)], [node], control=curve[None], friction=0.0, bound=5 * bound)
        assert (said(proof) == "") == good


def test_roots_are_on_their_side_and_near() -> None:
    assert root_above(Fraction(0)) == 0
    for value in (
        Fraction(n, d) ** p for n in (1, 2, 10, 99) for d in (1, 3, 100) for p in (-60, -1, 1, 2, 75)
    ):
        low, high = root_below(value), root_above(value)
        assert low**2 <= value < high**2
        assert high - low <= high * Fraction(1, 2**90)
    assert root_below(Fraction(25, 16)) == Fraction(5, 4)
