"""What single contacts withstand, to the last digit: rooms of sets, friction, linear limits, the way out."""

from fractions import Fraction
from math import cos, sin

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.withstood.contacts import Body, Touch, _worst

pytestmark = pytest.mark.oracle

STILL = rg.Wrench([0, 0])


def test_sets_that_tilt_have_room_for_the_rounding_of_their_support() -> None:
    """A force of 1 within 0.1 rad of x: 1 along x, -cos 0.1 back, sin 0.1 up, and 2^-40 of sizes."""
    body, up = Body(rg.LoadSet.tilted(rg.Wrench([1, 0]), 0.1)), Fraction(1, 2**40)
    for twist, most, size in (
        ([1, 0, 0], 1.0, 1.0),
        ([-1, 0, 0], -cos(0.1), 1.0),
        ([0, 1, 0], sin(0.1), sin(0.1)),
    ):
        for part, good in (Fraction(1, 2), False), (Fraction(3, 2), True):
            room = Fraction(most) + part * up * Fraction(size)
            assert body.allows(room, [Fraction(x) for x in twist]) == good, (twist, part)


def test_the_way_out_of_a_cone_and_of_a_limit() -> None:
    """Beside the normal, x, by mu = 1 / 2; a soft finger's torque counts mu / e = 2 times, squared."""
    point = Touch(rg.Contact([0, 0, 0], [1, 0, 0], 0.5), Fraction(1), 3)
    after = [Fraction(x) for x in (1, 3, 4)]
    assert point._outward(after, None) == pytest.approx([-0.5, 0.6, 0.8])
    assert point._outward(after, Fraction(9)) == pytest.approx([1, 3, 4])
    assert point._outward([Fraction(-2), Fraction(0), Fraction(0)], None) == pytest.approx([-0.5, 0, 0])
    soft = Touch(rg.Contact([0, 0, 0], [1, 0, 0], 0.5, torsion=0.25), Fraction(1), 4)
    after = [Fraction(x) for x in (1, 3, 0, 2)]
    assert soft._outward(after, None) == pytest.approx([-0.5, 0.6, 0, 1.6])
    assert soft._outward(after, Fraction(9)) == pytest.approx([1, 3, 0, 8])


def test_rooms_of_balls_and_hulls_are_exact() -> None:
    """Along (3, 4) a ball of 1 around (1, 1) works 7 + 5, a hull of its corners 7 + 7."""
    twist, less = [Fraction(3), Fraction(4), Fraction(0)], Fraction(1, 10**30)
    middle = rg.Wrench([1, 1])
    corners = [rg.Wrench([1 + x, 1 + y]) for x in (1, -1) for y in (1, -1)]
    for loads, most in (rg.LoadSet.ball(middle, force=1.0), 12), (rg.LoadSet.hull(corners), 14):
        assert Body(loads).allows(Fraction(most), twist)
        assert not Body(loads).allows(Fraction(most) - less, twist)
        assert not Body(loads).allows(Fraction(-99), twist)
    back = Body(rg.LoadSet.tilted(rg.Wrench([-1, 0]), 0.1))  # reaches 1 the other way
    for part, good in (Fraction(1, 2), False), (Fraction(3, 2), True):
        room = part / 2**40 - Fraction(cos(0.1))
        assert back.allows(room, [Fraction(1), Fraction(0), Fraction(0)]) == good
    assert back.allows(Fraction(0), [Fraction(0), Fraction(0), Fraction(1)])  # none has a torque


def test_contacts_of_hardly_any_friction_and_without_force() -> None:
    flat = rg.Contact([0, 0, 0], [1, 0, 0], 2.0**-50, torsion=0.5, limits=rg.ForceLimits([[1, 0, 0]], [2]))
    touch, least = Touch(flat, Fraction(1, 2), 4), Fraction(1, 2**40)
    assert (touch.mu, touch.weights) == (least / 2, [1, 1, 1, (2 * least) ** 2])
    assert touch.rows == [([1, 0, 0, 0], 2)]
    assert touch._keeps([Fraction(0)] * 4, None)
    assert not touch._keeps([Fraction(0), least, Fraction(0), Fraction(0)], None)


def test_a_ball_that_just_fits_a_planar_cone() -> None:
    """The edge (3/4, 1), of length 5/4, is 3 from the force (5, 0)."""
    answer = [[Fraction(-int(i == j)) for j in range(3)] for i in range(2)]
    touch = Touch(rg.Contact([0, 0], [1, 0], 0.75), Fraction(1), 2)
    for radius, good in (3.0, True), (3 + 2.0**-51, False):
        body = Body(rg.LoadSet.ball(STILL, force=radius))
        assert (touch.broken([Fraction(5), Fraction(0)], answer, body) is None) == good


def test_without_friction_a_planar_finger_pushes_straight() -> None:
    touch, still = Touch(rg.Contact([0, 0], [1, 0], 0.5), Fraction(0), 2), Body(rg.LoadSet.hull([STILL]))
    none = [[Fraction(0)] * 3] * 2
    for force, good in ([1, 0], True), ([0, 0], True), ([-1, 0], False), ([1, 1], False), ([1, -1], False):
        assert (touch.broken([Fraction(x) for x in force], none, still) is None) == good, force


def test_every_linear_limit_counts_and_names_a_member_that_breaks_it() -> None:
    limits = rg.ForceLimits([[1.0, 0.0], [0.0, 1.0]], [9.0, 1.0])
    touch = Touch(rg.Contact([0, 0], [1, 0], 9.0, limits=limits), Fraction(1), 2)
    none, still = [[Fraction(0)] * 3] * 2, Body(rg.LoadSet.hull([STILL]))
    assert touch.broken([Fraction(1), Fraction(2)], none, still).how == "breaks a linear limit"
    assert touch.broken([Fraction(1), Fraction(1)], none, still) is None
    tilted = Body(rg.LoadSet.tilted(rg.Wrench([1, 0]), 0.1))
    touch = Touch(rg.Contact([0, 0], [1, 0], 9.0, limits=rg.ForceLimits([[1.0, 0.0]], [1.0])), Fraction(1), 2)
    as_it_is = [[Fraction(int(i == j)) for j in range(3)] for i in range(2)]
    for share, named in (Fraction(1), False), (Fraction(1, 2), True):
        found = touch.broken([Fraction(0)] * 2, as_it_is, tilted, share)
        assert (found.how, found.member is not None) == ("breaks a linear limit", named)


def test_the_way_out_beside_an_oblique_normal() -> None:
    touch = Touch(rg.Contact([0, 0, 0], [3, 4, 0], 0.5), Fraction(1), 3)
    assert touch._outward([Fraction(0), Fraction(5), Fraction(0)], None) == pytest.approx([-1.1, 0.2, 0])


def test_the_member_that_breaks_is_one_of_the_set_and_breaks_it_exactly() -> None:
    """A ball of 3 against a push of 1: its member farthest along the normal; a hull's own."""
    as_it_is = [[Fraction(int(i == j)) for j in range(6)] for i in range(3)]
    touch = Touch(rg.Contact([0, 0, 0], [1, 0, 0], 1.0), Fraction(1, 3), 3)
    ball = Body(rg.LoadSet.ball(rg.Wrench([0, 0, 0]), force=3.0))
    found = touch.broken([Fraction(1), Fraction(0), Fraction(0)], as_it_is, ball)
    assert found.member.vector.tolist() == [-3, 0, 0, 0, 0, 0]
    edge = [Fraction(1), Fraction(1, 3), Fraction(0)]
    for sign in (1, -1):  # along the edge in doubles: one of the two is outside
        members = [rg.Wrench([s / 2, s / 6, 0]) for s in (sign, -sign)]
        found = touch.broken(edge, as_it_is, Body(rg.LoadSet.hull(members)))
        assert found.member.vector.tolist() == [-0.5, -1 / 6, 0, 0, 0, 0]


def test_the_worst_of_a_ball_makes_a_form_negative_wherever_something_does() -> None:
    """All below zero; curved upwards with the least inside; random ones, on the sphere to rounding."""
    rng = np.random.default_rng(5)
    given = [[[-1, -1], [-1, -1]], [[1, 0], [0, -(2.0**-20)]], [[1, 0.5], [0.5, 0.125]]]
    for k in range(60):
        root = rng.normal(size=(1 + k % 6, 1 + k % 6))
        given.append(np.block([[root + root.T, root[:, :1]], [root[:, :1].T, -1]]).tolist())
    for form in given:
        z = _worst([[Fraction(x) for x in row] for row in form])
        assert np.linalg.norm(z) <= 1 + 2.0**-50
        assert np.r_[z, 1] @ form @ np.r_[z, 1] < 0
    for form in [[0, 0], [0, 0]], [[1, 1], [1, 1]], [[-1, 0], [0, 1]], [[0, 1], [1, 2]]:
        assert _worst([[Fraction(x) for x in row] for row in form]) is None
