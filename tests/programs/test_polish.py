"""What ``polished`` promises: an answer that is sound, or none; steps on the faces that are touched."""

import numpy as np
import pytest
from scipy.optimize import brentq

from programs_by_hand import nonnegative, program, zero
from regrasp.programs import Block, Cone
from regrasp.programs.judging.audit import audited
from regrasp.programs.judging.polish import polished, touched

pytestmark = pytest.mark.contract

CONE = Block(Cone.SECOND_ORDER, 3)
BOX = program(np.eye(2), [-3.0, -1.0], [[1, 0], [0, 1], [1, 1]], [1, 2, 1.5], nonnegative(3))
X, Z = np.array([1.0, 0.5]), np.array([1.5, 0.0, 0.5])
"""Its optimum: x1 = 1 and x1 + x2 = 1.5 are touched."""


def worst(p, x, z) -> float:
    return max(audited(p, x, z)[:4])


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-4])
def test_what_is_a_little_off_is_made_right_in_any_units(size) -> None:
    off = np.array([1.0, -1.0])
    for r, c, k in ((1.0, 1.0, 1.0), (1e5, 1e-3, 1e4), (1e-14, 1.0, 1.0)):
        p = program(k * c * c * np.eye(2), k * c * BOX.q, r * c * BOX.A.toarray(), r * BOX.b, nonnegative(3))
        x, z = polished(p, (X + size * off) / c, k / r * (Z + size * np.array([1, 1e-3, -1])), 1e-12)
        np.testing.assert_allclose(c * x, X, rtol=1e-12)
        np.testing.assert_allclose(r / k * z, Z, atol=1e-12)


def test_a_sound_answer_comes_back_and_a_polished_one_does() -> None:
    again = polished(BOX, X, Z, 1e-12)
    assert again[0] is X
    assert np.array_equal(again[1], Z)
    once = polished(BOX, X + 1e-6, Z - 1e-6, 1e-12)
    twice = polished(BOX, *once, 1e-12)
    assert all(np.array_equal(a, b) for a, b in zip(once, twice, strict=True))


@pytest.mark.parametrize(("noise", "quiet"), [(0.9995e-6, True), (1.0005e-6, False)])
@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("price", [1e-3, 1.0, 1e3])
def test_duals_that_are_noise_are_left_out(noise, quiet, sign, price) -> None:
    """max t below 1 beside y = w, which cost nothing: the columns of y and w have noise alone.

    Too many others for steps. The row of noise has terms 2 noise for the objective's one; or min t with
    t = -1 in its place.
    """
    n = 300
    A = np.zeros((2, 3 + n))
    A[0, 0], A[1, 1:3] = 1, (1, -1)
    row = nonnegative(1) if sign > 0 else zero(1)
    p = program(np.zeros((3 + n, 3 + n)), [-price * sign] + [0.0] * (2 + n), A, [sign, 0], row, zero(1))
    x = sign * np.r_[1.0, 1.0, 1.0, np.zeros(n)]
    found = polished(p, x, price * np.array([sign, noise / 2]), 1e-9)
    assert (found is not None) is quiet
    if found is not None:
        assert found[1].tolist() == [price * sign, 0.0]


@pytest.mark.parametrize(("noise", "quiet"), [(0.9995e-6, True), (1.0005e-6, False)])
def test_a_negative_side_is_a_term_of_noise(noise, quiet) -> None:
    """Beside t, y >= 1 with y = 1: 2 noise again, half of it the right side's."""
    n = 300
    A = np.zeros((2, 2 + n))
    A[0, 0], A[1, 1] = 1, -1
    p = program(np.zeros((2 + n, 2 + n)), [-1.0] + [0.0] * (1 + n), A, [1, -1], nonnegative(2))
    found = polished(p, np.r_[1.0, 1.0, np.zeros(n)], np.array([1.0, noise / 2]), 1e-9)
    assert (found is not None) is quiet


def test_what_nothing_pays_for_is_noise() -> None:
    p = program([[1.0]], [0.0], [[1.0]], [0.0], nonnegative(1))
    assert polished(p, np.zeros(1), np.ones(1), 1e-9)[1].tolist() == [0]


def test_a_measure_at_its_limit_is_sound_and_above_is_not() -> None:
    """Too many unknowns and rows for steps, so that the answer stands or falls as it is."""
    n = 151
    p = program(np.eye(n), -np.ones(n), np.eye(n), np.full(n, 0.5), nonnegative(n))
    x, z = np.full(n, 0.5 + 1e-6), np.full(n, 0.5)
    found = polished(p, x, z, worst(p, x, z))
    assert found is not None
    assert np.array_equal(found[0], x)
    assert polished(p, x, z, worst(p, x, z) * (1 - 1e-9)) is None


@pytest.mark.parametrize(("n", "free", "steps"), [(150, 0, True), (150, 1, False)])
def test_how_large_a_program_is_stepped(n, free, steps) -> None:
    """Of n unknowns with a row each, and ``free`` others."""
    p = program(np.eye(n + free), -np.ones(n + free), np.eye(n, n + free), np.full(n, 0.5), nonnegative(n))
    x = np.r_[np.full(n, 0.5 + 1e-6), np.ones(free)]
    found = polished(p, x, np.full(n, 0.5), 1e-9)
    assert (found is not None) is steps


def test_five_steps_are_taken_of_what_is_never_sound(monkeypatch) -> None:
    seen, given = [], np.linalg.lstsq
    monkeypatch.setattr(np.linalg, "lstsq", lambda *a, **k: (seen.append(1), given(*a, **k))[1])
    assert polished(BOX, X, Z, -1.0) is None
    assert len(seen) == 5


@pytest.mark.parametrize(("share", "near"), [(0.9995, True), (1.0005, False)])
def test_how_near_is_near(share, near) -> None:
    """min (x - 1)^2 / 2 off by e: the column is off by e, of |q| + P X = 2 and little of the terms."""
    p = program([[1.0]], [-1.0], np.zeros((0, 1)), [])
    off = share * 1e-3 * 2 * (1 + 2.0**-11)
    assert worst(p, np.array([1.0 - off]), np.zeros(0)) == pytest.approx(share * 1e-3, rel=2e-3)
    assert (polished(p, np.array([1.0 - off]), np.zeros(0), 1e-12) is not None) is near


def test_refused_are_points_that_are_not_finite_and_missing_duals_are_none() -> None:
    free = program(np.eye(2), [-0.5, -0.5], [[1, 0], [0, 1], [1, 1]], [1, 2, 1.5], nonnegative(3))
    inside = np.full(2, 0.5)
    grows = program(np.zeros((2, 2)), [1, 1], [[-1, 0], [0, -1]], [0, 0], nonnegative(2))
    for wrong in (np.nan, np.inf, -np.inf):
        assert polished(grows, np.array([0.0, wrong]), np.ones(2), 1e-6) is None
        assert polished(BOX, np.array([1.0, wrong]), Z, 1e-6) is None
        assert polished(BOX, X, np.array([1.5, 0.0, wrong]), 1e-9) is None  # zero is no dual of it
        x, z = polished(free, inside, np.array([0.0, wrong, 0.0]), 1e-9)
        assert not z.any()
        assert np.array_equal(x, inside)


def test_numbers_too_large_for_a_step_are_refused() -> None:
    """Between P of 1e300 and sides whose products with it no double holds."""
    p = program([[1e300]], [-1e300], [[1e300]], [1e300], nonnegative(1))
    big = program([[0.0]], [-1e300], [[1e300]], [1e300 * (1 + 1e-6)], nonnegative(1))
    for q in (p, big):
        for x in (1 + 1e-5, 1 - 1e-5, 1e10):
            found = polished(q, np.array([x]), np.array([1e300]), 1e-12)
            assert found is None or worst(q, *found) <= 1e-12


def test_a_curvature_too_large_ends_the_steps() -> None:
    """min -u x1 with |u x| <= 1: all of it is a number but u u."""
    u = 1e200
    ball = program(np.zeros((2, 2)), [-u, 0], [[0, 0], [-u, 0], [0, -u]], [1, 0, 0], CONE)
    x, z = np.array([1 / u, 0]), np.array([1.0, -1, 0])
    assert polished(ball, x, z, 1e-12) is not None
    assert worst(ball, x * (1 - 1e-6), z) < 1e-3
    assert polished(ball, x * (1 - 1e-6), z, 1e-12) is None


def test_duals_that_are_returned_lie_in_their_cone() -> None:
    for wrong in (Z - np.array([0, 1e-3, 0]), Z - np.array([0, 1e-20, 0])):
        _, z = polished(BOX, X, wrong, 1e-6)
        assert (z >= 0).all()


def test_without_an_objective_nothing_pulls() -> None:
    p = program(np.zeros((2, 2)), [0, 0], [[1, 1], [1, 0]], [1, 1], zero(1), nonnegative(1))
    x, z = polished(p, np.array([0.5, 0.5]), np.array([7.0, 3.0]), 1e-12)
    assert not z.any()
    assert np.array_equal(x, [0.5, 0.5])
    for P, q in ((np.zeros((2, 2)), [1, 0]), (np.diag([1.0, 0.0]), [0, 0])):  # one pulls, and its dual stays
        p = program(P, q, [[-1, 0], [0, 1]], [-1, 1], nonnegative(2))
        _, z = polished(p, np.array([1.0, 0.0]), np.array([1.0, 0.0]), 1e-12)
        assert np.array_equal(z, [1, 0])


def test_zero_is_the_best_where_rows_and_objective_grow() -> None:
    p = program(np.zeros((2, 2)), [1, 1], [[-1, 0], [0, -1]], [0, 0], nonnegative(2))
    x, z = polished(p, np.array([1e-1, 1.0]), np.ones(2), 1e-12)
    assert not x.any()
    np.testing.assert_array_equal(z, 1)


def test_an_equation_is_touched_whatever_its_dual() -> None:
    p = program(np.eye(2), [0, 0], [[1, 1], [1, -1]], [2, 0], zero(2))
    x, z = polished(p, np.array([1 + 1e-4, 1 - 1e-4]), np.array([-1.0, 0]), 1e-12)
    np.testing.assert_allclose(x, 1, rtol=1e-12)
    np.testing.assert_allclose(z, [-1, 0], atol=1e-12)


def test_a_row_that_nothing_presses_on_is_let_go() -> None:
    """x1 <= 1 with a dual left of nearly nothing, of an optimum 1 - 1e-5: its slack is larger."""
    p = program(np.eye(2), [-1 + 1e-5, -1.0], [[1, 0], [0, 1]], [1, 2], nonnegative(2))
    x, z = polished(p, np.array([1 - 2e-5, 1.0]), np.array([1e-6, 0]), 1e-12)
    np.testing.assert_allclose(x, [1 - 1e-5, 1], rtol=1e-13)
    assert not z.any()


@pytest.mark.parametrize(
    ("s", "z", "count"),
    [
        ((2.0, 1.0, 0.0), (0.0, 0.0, 0.0), 0),  # inside
        ((1.0, 1.0 - 1e-9, 0.0), (1.0, -1.0, 0.0), 1),  # on the boundary
        ((1.0, 1.0 + 1e-9, 0.0), (0.0, 0.0, 0.0), 1),  # crossed
        ((1.0, 0.6, 0.8), (0.0, 0.0, 0.0), 0),  # touched, and nothing presses
        ((1e-9, 0.0, 1e-9), (2.0, 1.0, 0.0), 3),  # the apex
        ((1e-9, 0.0, 0.0), (0.0, 0.0, 0.0), 0),  # the apex, and nothing presses
        ((1.0, 1.0 - 1e-9, 0.0), (1.0, -1.0 + 1e-8, 0.0), 1),  # nearer to the boundary than to the apex
    ],
)
@pytest.mark.parametrize("unit", [2.0**-20, 1.0, 2.0**20])
def test_which_faces_of_a_cone_are_touched(s, z, count, unit) -> None:
    """b - A x = s for x = 1 and b = 1 + s, behind an equation and before a row that is not touched."""
    rows, b = unit * np.vstack([np.ones(3), np.eye(3), np.ones(3)]), unit * np.r_[3.0, np.array(s) + 1.0, 9.0]
    p = program(np.eye(3), [1, 1, 1], rows, b, zero(1), CONE, nonnegative(1))
    faces = touched(p, np.ones(3), np.r_[0.0, np.array(z) / unit, 0.0])
    assert len(faces) == count + 1
    np.testing.assert_allclose(faces @ faces.T, np.eye(count + 1), atol=1e-12)
    assert faces[0, 0] == 1
    assert not faces[1:, [0, 4]].any()
    if count == 1:
        along = np.array(s[1:]) / np.hypot(*s[1:])
        np.testing.assert_allclose(faces[1, 1:4] * np.sqrt(2), [1, *-along], atol=1e-8)


@pytest.mark.parametrize("unit", [2.0**-20, 1.0, 2.0**20])
def test_the_apex_is_touched_where_s_is_nearer_to_it_than_z_to_the_boundary(unit) -> None:
    """|s| without unit is t / |(t + 2, 2, 2)|; q = 1 gives columns 1 + z, and the pull |z| |1 / (1 + z)|."""
    z = np.array([1.0, 0.9, 0.0])
    limit = np.linalg.norm(z) * np.linalg.norm(1 / (1 + z)) * (1 - 0.9)
    for share, count in ((0.99, 3), (1.01, 1)):
        t = brentq(lambda t, at=share * limit: t / np.linalg.norm([t + 2, 2, 2]) - at, 0, 10)
        b = unit * (np.array([t, 1e-9, 0]) + 1)
        p = program(np.zeros((3, 3)), [1, 1, 1], unit * np.eye(3), b, CONE)
        assert len(touched(p, np.ones(3), z / unit)) == count


def test_an_inequality_is_touched_where_its_dual_is_more_than_its_slack() -> None:
    """x = 1 of b = 1 + s: a slack of s / (2 + s) without unit; the dual 1e-3 beside 1 + 1 + 1e-3 pulls."""
    for s, is_touched in ((1.01e-3, False), (0.99e-3, True), (-1e-9, True)):
        p = program([[1.0]], [1.0], [[1.0]], [1.0 + s], nonnegative(1))
        assert len(touched(p, np.ones(1), np.array([1e-3]))) == is_touched


@pytest.mark.parametrize("seed", range(5))
def test_optima_on_cones_are_made_right(seed) -> None:
    """The point of a ball nearest to one outside; the point of a cone nearest to one below its apex a."""
    rng = np.random.default_rng(seed)
    far = rng.normal(size=2)
    far *= 3 / np.linalg.norm(far)
    ball = program(np.eye(2), -far, np.vstack([np.zeros(2), -np.eye(2)]), [1, 0, 0], CONE)
    u = far / 3
    x, z = polished(ball, u + 3e-4 * rng.normal(size=2), np.r_[2, -2 * u] * (1 + 1e-4), 1e-12)
    np.testing.assert_allclose(x, u, rtol=1e-11)
    np.testing.assert_allclose(z, np.r_[2, -2 * u], rtol=1e-11)
    apex, pull = rng.normal(size=3) + np.array([5, 0, 0]), np.r_[2, far / 3]
    below = program(np.eye(3), pull - apex, -np.eye(3), -apex, CONE)
    x, z = polished(below, apex + 1e-5 * rng.normal(size=3), pull * (1 + 1e-5), 1e-12)
    np.testing.assert_allclose(x, apex, rtol=1e-11)
    np.testing.assert_allclose(z, pull, rtol=1e-11)


def test_the_shortest_step_is_so_in_the_units_of_rows_and_columns() -> None:
    """x1 + x2 / 8 = 1 is met by both in halves, each in the unit in which its entry is one."""
    p = program(np.zeros((2, 2)), [0, 0], [[1, 1 / 8]], [1], zero(1))
    x, _ = polished(p, np.array([0.5, 4]) * (1 + 1e-5), np.zeros(1), 1e-12)
    np.testing.assert_allclose(x, [0.5, 4], rtol=1e-12)
    x, _ = polished(p, np.array([1 + 1e-5, 0]), np.zeros(1), 1e-12)
    np.testing.assert_allclose(x, [1 + 0.5e-5, -4e-5], rtol=1e-9)


def test_rows_that_are_one_to_rounding_count_as_one() -> None:
    p = program(np.eye(2), [0, 0], [[1, 0], [1, 1e-14]], [1, 1 + 4 * 2.0**-52], zero(2))
    x, _ = polished(p, np.array([1 + 1e-5, 1e-5]), np.array([-1.0, 0]), 1e-12)
    np.testing.assert_allclose(x, [1, 0], atol=1e-9)


def test_rows_that_differ_by_less_than_a_millionth_are_not_told_apart() -> None:
    """A second y = 1e-6 would be, by rows that differ by 1e-7 of it: 1e-14 of what steps are found by."""
    p = program(np.eye(2), [0, 0], [[1, 0], [1, 1e-7]], [1, 1 + 1e-13], zero(2))
    x, _ = polished(p, np.array([1 + 1e-5, 1e-5]), np.array([-1.0, 0]), 1e-12)
    np.testing.assert_allclose(x, [1, 0], atol=1e-9)


def test_five_steps_are_enough_by_the_curvature_of_cones() -> None:
    """min -x1 - 2 x2 in an ellipse, and beside a plane: by nothing but the curvature is x found."""
    for width in (1.0, 3.0, 0.2):
        rows = np.vstack([np.zeros(2), [[-1 / width, 0], [0, -1]]])
        p = program(np.zeros((2, 2)), [-1, -2], rows, [1, 0, 0], CONE)
        t = np.hypot(width, 2)
        best, dual = np.array([width**2, 2]) / t, np.array([t, -width, -2])
        x, z = polished(p, best + np.array([1e-4, -1e-4]), dual * (1 + 1e-4), 1e-13)
        np.testing.assert_allclose(x, best, rtol=1e-11)
        np.testing.assert_allclose(z, dual, rtol=1e-11)


def test_a_row_that_pulls_as_much_as_it_is_away_is_not_touched() -> None:
    """x <= 0 at x = 0 without a dual: neither is larger."""
    p = program([[1.0]], [0.0], [[1], [1]], [0, 1], nonnegative(2))
    assert touched(p, np.zeros(1), np.zeros(2)).shape == (0, 2)
    assert touched(p, np.zeros(1), np.array([1e-9, 0])).tolist() == [[1, 0]]
