"""What cleaning promises: never a worse certificate, one that is enough left, noise away, the rest moved."""

import numpy as np
import pytest

from known_programs import known
from programs_by_hand import nonnegative, program, zero
from regrasp.programs import Block, Cone
from regrasp.programs.judging.cleaning import cleaned_direction, cleaned_duals
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.judging.verdict import PROVEN
from test_certificates import random_infeasible

pytestmark = pytest.mark.contract

NONE = program(np.zeros((2, 2)), [-1, 0], [[1, 0], [-1, 0], [0, 1], [0, 1]], [1, -2, 9, 9], nonnegative(4))
"""x <= 1 and x >= 2, by z = (1, 1, 0, 0); y falls for ever."""


def test_what_is_enough_stays_as_it_is() -> None:
    z = np.array([1.0, 1.0 + 1e-9, 0.0, 0.0])
    assert np.array_equal(cleaned_duals(NONE, z, PROVEN), z)
    assert not np.array_equal(cleaned_duals(NONE, z, 1e-10), z)
    measured = infeasibility_residual(NONE, z)
    assert np.array_equal(cleaned_duals(NONE, z, measured), z)
    d = np.array([1.0, 1e-9])
    ray = program(np.diag([0.0, 1.0]), [-1, 0], [[-1, 0]], [1], nonnegative(1), size=1.0)
    assert cleaned_direction(ray, d, 2.0) is d
    assert np.array_equal(cleaned_direction(ray, d, 0.5), [1, 0])


@pytest.mark.parametrize("steps", [0, 3])
def test_never_worse_whatever_comes(steps) -> None:
    """Random numbers, of which most prove nothing: the residual does not rise, and duals lie in K*."""
    for seed in range(16):
        rng = np.random.default_rng(seed)
        p = known(seed).program
        z, d = rng.normal(size=p.b.size), rng.normal(size=p.q.size)
        clean = cleaned_duals(p, z, 0.0, steps)
        assert infeasibility_residual(p, clean) <= infeasibility_residual(p, z) * (1 + 1e-12)
        np.testing.assert_allclose(p.cones.dual(clean), clean, rtol=1e-12, atol=1e-12)
        clean = cleaned_direction(p, d, 0.0, steps)
        assert unboundedness_residual(p, clean) <= unboundedness_residual(p, d)


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
@pytest.mark.parametrize("noise", [1e-10, 1e-7, 1e-5, 1e-3, 1e-2 / 0.9])
def test_noise_becomes_zero_and_the_rest_stays(noise, scale) -> None:
    """A guess is above the noise, or the noise itself, and below what is true; the rest is not moved."""
    z = scale * np.array([1.0, 1 + 1e-3, 0.7 * noise, 0.9 * noise])
    assert np.array_equal(cleaned_duals(NONE, z, 0.0, steps=0), [*z[:2], 0, 0])
    falls = program(np.diag([0.0, 1, 1, 0]), [1, 0, 0, 0], [[1, 0, 0, 0]], [1], nonnegative(1))
    d = scale * np.array([-1.0, 0.7 * noise, -0.9 * noise, 0.0])
    assert np.array_equal(cleaned_direction(falls, d, 0.0, steps=0), [d[0], 0, 0, 0])


def test_what_is_larger_than_any_noise_is_not_put_at_zero() -> None:
    """2e-2 of the largest, of a certificate and of a direction that need it."""
    p = program([[0.0]], [0.0], [[2.0], [-0.04]], [2, -0.08], nonnegative(2))
    np.testing.assert_allclose(cleaned_duals(p, np.array([0.02, 1.0]), 0.0), [0.02, 1], rtol=1e-12)
    ray = program(np.zeros((2, 2)), [0, -1], [[1, -0.02], [-1, 0.02]], [0, 0], zero(2))
    clean = cleaned_direction(ray, np.array([0.02 + 1e-7, 1.0]), 0.0)
    np.testing.assert_allclose(clean[0] / clean[1], 0.02, rtol=1e-12)


@pytest.mark.parametrize("off", [1e-6, 1e-3])
@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_the_rest_is_moved_least_each_entry_by_its_own_size(off, scale) -> None:
    """x1 + x2 of z = (1, 100) against z3: all three share the miss by their squares."""
    p = program([[0.0]], [0.0], [[1.0], [1.0], [-1.0]], [1, 1, -200], nonnegative(3))
    z = np.array([1.0, 100.0, 101.0 + off])
    moved = z + off * np.array([1, 1e4, -(101.0**2)]) / (1 + 1e4 + 101.0**2)
    np.testing.assert_allclose(cleaned_duals(p, scale * z, 1e-12, 1), scale * moved, rtol=1e-8)
    ray = program(np.zeros((3, 3)), [-1, 0, 0], [[1, 1, -1]], [0], zero(1))
    np.testing.assert_allclose(cleaned_direction(ray, scale * z, 1e-12, 1), scale * moved, rtol=1e-8)


def test_a_row_that_is_crossed_is_met_and_one_that_is_not_is_left() -> None:
    """x1 <= x2 along (1 + e, 1) and back; x3 >= 0 has room along it."""
    p = program(np.zeros((3, 3)), [-1, 0, 0], [[1, -1, 0], [0, 0, -1]], [0, 0], nonnegative(2))
    clean = cleaned_direction(p, np.array([1 + 1e-5, 1, 1e-1]), 0.0)
    assert clean[0] == pytest.approx(clean[1], rel=1e-12)
    assert clean[2] == pytest.approx(1e-1, rel=1e-12)
    both = program(np.diag([0, 0, 1.0]), [-1, 0, 0], [[1, -1, 0]], [0], nonnegative(1))
    clean = cleaned_direction(both, np.array([1 + 1e-5, 1, 2e-2]), PROVEN)
    assert unboundedness_residual(both, clean) <= PROVEN
    inside = program(np.diag([0, 0, 1.0]), [-1, 0, 0], [[1, -1, 0]], [0], nonnegative(1))
    clean = cleaned_direction(inside, np.array([1 - 1e-3, 1, 2e-2]), 0.0)
    np.testing.assert_allclose(clean[:2], [1 - 1e-3, 1], rtol=1e-12)  # its slack is its own


def test_a_row_that_is_only_touched_is_none_that_is_crossed() -> None:
    """x1 <= 0.9 x2 is crossed, x2 <= x3 not yet: the step is (-1, 0.9, 0), of length 0.1 / 1.81."""
    p = program(np.zeros((3, 3)), [-1, 0, 0], [[1, -0.9, 0], [0, 1, -1]], [0, 0], nonnegative(2))
    clean = cleaned_direction(p, np.ones(3), 0.0, 1)
    np.testing.assert_allclose(clean, 1 + 0.1 / 1.81 * np.array([-1, 0.9, 0]), rtol=1e-12)


@pytest.mark.parametrize("unit", [2.0**-10, 1.0, 2.0**10])
@pytest.mark.parametrize("noise", [1e-6, 1e-5, 1e-4])
def test_duals_on_the_boundary_of_a_cone_stay_there(noise, unit) -> None:
    """Certificates that lie on it, of random rows, each in units of its own: proven in nearly all cases."""
    proven = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        p, z = random_infeasible(rng, True)
        clean = cleaned_duals(p, unit * z * (1 + noise * rng.normal(size=z.size)), 1e-12)
        proven += infeasibility_residual(p, clean) <= 1e-12
        if noise < 1e-5:
            np.testing.assert_allclose(clean[:9], unit * z[:9], rtol=1e3 * noise)
    assert proven >= 19


@pytest.mark.parametrize(("share", "kept"), [(1 - 0.9995e-3, True), (1 - 1.0005e-3, False)])
def test_how_near_a_boundary_is_touched(share, kept) -> None:
    """z1 of the cone is to grow by a thousandth: it meets the boundary only where this is touched."""
    rows = [[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1.001, 0], [-1, 0, 0]]
    p = program(np.zeros((3, 3)), [0, 0, 0], rows, [-3, 0, 0, 0, 0], Block(Cone.SECOND_ORDER, 3), zero(2))
    clean = cleaned_duals(p, np.array([1.0, share, 0.0, share, 1.0]), 0.0, 1)
    assert bool(clean[1] == pytest.approx(clean[0], rel=1e-6)) is kept


def test_numbers_too_large_are_left_as_they_are() -> None:
    z = np.array([1e200, 1e200, 0.0, 0.0])
    p = program(np.zeros((2, 2)), [-1, 0], 1e200 * NONE.A.toarray(), NONE.b, nonnegative(4))
    assert np.array_equal(cleaned_duals(p, z, 0.0), z)


def test_a_proof_of_a_thousand_rows_is_cleaned() -> None:
    """A chain x1 <= x2 - 1 <= ...  <= x1 by duals of one, each off by a thousandth."""
    n = 1000
    rows = np.eye(n) - np.roll(np.eye(n), 1, axis=1)
    p = program(np.zeros((n, n)), np.zeros(n), rows, np.r_[-np.ones(n - 1), 0], nonnegative(n))
    z = 1 + 1e-3 * np.random.default_rng(0).normal(size=n)
    assert infeasibility_residual(p, cleaned_duals(p, z, PROVEN)) <= PROVEN


@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-6, 1e-4, 1e-2])
def test_every_guess_of_noise_on_both_sides(noise) -> None:
    """x <= 1 and x >= 2 by 1.0005 of it, y by 0.9995 of it, beside a w <= 0 and w >= 0 by one."""
    rows = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1]]
    p = program(np.zeros((3, 3)), np.zeros(3), rows, [1, -2, 0, 0, 0], nonnegative(5))
    true, off = 1.0005 * noise or 1e-11, 0.9995 * noise
    z = np.array([true, true, off, 1.0, 1.0])
    clean = cleaned_duals(p, z, 0.0, steps=0)
    assert clean.tolist() == [true, true, 0, 1, 1]
    d = np.array([1.0, true, off])
    ray = program(np.zeros((3, 3)), [0, -1, 0], [[0, 0, 1]], [0], zero(1))
    assert cleaned_direction(ray, d, 0.0, steps=0).tolist() == [1, true, 0]


def test_the_smallest_entries_are_moved_before_any_is_noise() -> None:
    """A trillionth of the largest, of which one of 1e-3 is off."""
    rows = [[1, 0], [-1, 0], [0, 1], [0, -1]]
    p = program(np.zeros((2, 2)), np.zeros(2), rows, [1, -2, 0, 0], nonnegative(4))
    clean = cleaned_duals(p, np.array([1e-12, 1.001e-12, 1, 1]), PROVEN)
    assert clean[0] == pytest.approx(1.0005e-12, rel=1e-6)
    assert infeasibility_residual(p, clean) <= PROVEN


def test_three_steps_are_taken_from_every_guess(monkeypatch) -> None:
    import scipy.sparse.linalg as linear

    seen, given = [], linear.lsmr
    monkeypatch.setattr(linear, "lsmr", lambda *a, **k: (seen.append(1), given(*a, **k))[1])
    free = program([[0.0]], [0.0], [[1.0], [1.0]], [1, 2], nonnegative(2))
    cleaned_duals(free, np.ones(2), 0.0)
    assert len(seen) == 3 * 5
