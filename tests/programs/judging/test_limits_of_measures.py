"""Audits, touched faces, hints and loose rows by hand: numbers whose limits are known, on both sides."""

import numpy as np
import pytest
from scipy import sparse

from programs_by_hand import claim, nobody, nonnegative, program, zero
from regrasp.programs import Block, Cone, Program, Status
from regrasp.programs.judging import verdict
from regrasp.programs.judging.audit import audited, missed
from regrasp.programs.judging.convexity import why_not_convex
from regrasp.programs.judging.loose_rows import without_loose_rows
from regrasp.programs.judging.polish import polished, touched
from regrasp.programs.judging.proofs import infeasibility_residual

pytestmark = pytest.mark.contract


# -- audits


def test_of_given_units_all_terms_count() -> None:
    """min x^2 / 2 - x at 1e6, with unknowns of size one: a column of 1 + 1, as much again, and 1e6."""
    p = program([[1.0]], [-1.0], np.zeros((0, 1)), [], size=1.0)
    assert audited(p, np.array([1e6]), np.zeros(0)).dual == pytest.approx((1e6 - 1) / (1e6 + 4), rel=1e-12)


@pytest.mark.parametrize(
    ("far", "counts"), [(2.0**21, 2.0**11), (2.0**23, 2.0**13), (2.0**26, 2.0**12), (2.0**30, 2.0**8)]
)
def test_terms_count_for_a_part_and_for_less_where_more_of_them_cancels(far, counts) -> None:
    """x - y = 1 at x = y = far: a unit of 1 + 1, terms 2 far, of which 2^-11, or 2^14 (2^14 / so much)."""
    p = program(np.zeros((2, 2)), [0, 0], [[1, -1]], [1], zero(1))
    assert audited(p, np.full(2, far), np.zeros(1)).primal == 1 / (2 + counts)


@pytest.mark.parametrize("unit", [0.25, 1.0, 4.0])
@pytest.mark.parametrize(("share", "lost"), [(1.0, False), (1 + 2.0**-40, True)])
def test_what_is_less_than_the_rounding_of_its_terms_is_lost(unit, share, lost) -> None:
    """x - y = u at x = y: a unit of 2 u beside terms of 2 x, the rounding of which is 2^-45."""
    p = program(np.zeros((2, 2)), [0, 0], [[1, -1]], [unit], zero(1))
    found = audited(p, np.full(2, share * unit * 2.0**45), np.zeros(1)).primal
    assert (found == np.inf) is lost


# -- proofs


def test_equations_pull_both_ways() -> None:
    """x = -1 and (1 + e) x = 1, weighted by 1 and -1: e is left of 2 + e, and all of b'z falls."""
    e = 1e-3
    p = program([[0.0]], [0.0], [[1], [1 + e]], [-1, 1], zero(2))
    assert infeasibility_residual(p, np.array([1.0, -1])) == pytest.approx(e / (2 + e), rel=1e-9)


@pytest.mark.parametrize(("r", "infeasible"), [(0.09995, True), (0.10005, False), (0.5, False)])
def test_duals_that_are_nowhere_near_a_proof_are_asked_for_none(r, infeasible) -> None:
    """x <= 1 and x >= 2 by 1 and z: (1 - z) / (1 + z) of (2 z - 1) / (2 z + 1) is r."""
    z = (1 - r + np.sqrt((1 - r) ** 2 + 8 * (1 + r) ** 2)) / (4 * (1 + r))
    p = program([[0.0]], [0.0], [[1], [-1]], [1, -2], nonnegative(2))
    found = verdict.judged(claim(p, Status.STOPPED, [1.5], [1, z]), 1e-9, nobody)
    assert found.status is (Status.INFEASIBLE if infeasible else Status.STOPPED)


@pytest.mark.parametrize(("r", "unbounded"), [(0.09995, True), (0.10005, False), (0.5, False)])
def test_directions_that_are_nowhere_near_one_are_asked_for_none(r, unbounded) -> None:
    """min -y with x + y = 0 along (off - 1, 1): off of 2 - off is r."""
    off = 2 * r / (1 + r)
    p = program(np.zeros((2, 2)), [0, -1], [[1, 1]], [0], zero(1))
    found = verdict.judged(claim(p, Status.STOPPED, [off - 1, 1], [0]), 1e-9, nobody)
    assert found.status is (Status.UNBOUNDED if unbounded else Status.STOPPED)


def test_what_is_proven_to_the_limit_is_left_as_it_is(monkeypatch) -> None:
    """Duals outside K* and directions keep their numbers, and points that are just near enough serve."""
    none = program([[0.0]], [0.0], [[1], [-1.01], [0]], [1, -2, 1], nonnegative(3))
    given = claim(none, Status.INFEASIBLE, z=[1, 1, -1e-3])
    monkeypatch.setattr(verdict, "PROVEN", given.infeasibility_residual)
    assert verdict.judged(given, 1e-9, nobody) is given
    falls = program(np.zeros((2, 2)), [0, -1], [[1, 1]], [0], zero(1))
    along = claim(falls, Status.UNBOUNDED, [-0.99, 1])
    monkeypatch.setattr(verdict, "PROVEN", along.unboundedness_residual)
    assert verdict.judged(along, 1e-9, nobody) is along
    beside = program(np.zeros((2, 2)), [0, -1], [[1, 0]], [1], zero(1))
    point = np.array([1.001, 0])
    monkeypatch.setattr(verdict, "MISSED", missed(beside, point))
    found = verdict.judged(
        claim(beside, Status.UNBOUNDED, [0, 1]), 1e-9, lambda p: claim(p, Status.SOLVED, point)
    )
    assert found.status is Status.UNBOUNDED


# -- touched faces


@pytest.mark.parametrize(
    ("P", "q", "A", "b", "x", "z", "count"),
    [
        (0, 0.5, [1], [1], -1, [0.5], 0),  # a slack of 2 of 1 + 1, a dual of 0.5 of 1
        (2, 0.5, [1], [-1], -1, [0.5], 1),  # a slack of none
        (0, -2, [1], [-1], -1, [0.5], 1),
        (0, 0, [1, 1], [-1, -1], -1, [0.5, -2], 2),  # beside an equation
    ],
)
def test_sizes_of_rows_and_columns_have_no_sign(P, q, A, b, x, z, count) -> None:
    rows = [[a] for a in A]
    p = program([[P]], [q], rows, b, nonnegative(1), *[zero(1)][: len(A) - 1])
    assert len(touched(p, np.array([float(x)]), np.array(z, dtype=float))) == count


@pytest.mark.parametrize("length", [0.01, 100.0])
def test_the_curvature_of_a_cone_is_that_of_its_radius(length) -> None:
    """min -x - y with |(x, y)| <= r: quadratically, five steps from a tenth of a percent."""
    cone = Block(Cone.SECOND_ORDER, 3)
    p = program(np.zeros((2, 2)), [-1, -1], [[0, 0], [-1, 0], [0, -1]], [length, 0, 0], cone)
    best, z = np.full(2, length / np.sqrt(2)), np.array([np.sqrt(2), -1, -1])
    x, _ = polished(p, best + length * np.array([5e-4, -5e-4]), z, 1e-13)
    assert x == pytest.approx(best, rel=1e-10)


# -- loose rows


@pytest.mark.parametrize(
    ("A", "b", "kept"),
    [
        ([1, 1], [1, 1.0005e4], [True, False]),
        ([1, 1], [1, 1e4], None),
        ([0.5, 1], [1, 1.5e4], None),  # beside 2
        ([0.5, 1], [1, 2.5e4], [True, False]),
        ([1, 0], [1, 1.0005e4], [True, False]),
        ([-1, 1], [-1, 1e9], [True, False]),
    ],
)
def test_sides_beside_their_rows_by_hand(A, b, kept) -> None:
    found = without_loose_rows(program([[0.0]], [0.0], [[a] for a in A], b, nonnegative(len(b))))
    assert (None if found is None else found[1].tolist()) == kept


def test_the_largest_entry_of_a_row_is_its_size() -> None:
    """Beside 1 / 1 the second is 3e4 / 4, or 3e4."""
    for other, loose in ((4, False), (-4, False), (1, True)):
        p = program(np.zeros((2, 2)), [0, 0], [[1, 1], [other, 1]], [1, 3e4], nonnegative(2))
        assert (without_loose_rows(p) is not None) is loose


def test_without_unknowns_no_row_is_loose_but_by_its_side() -> None:
    A = sparse.csc_matrix((2, 0))
    p = Program(sparse.csc_matrix((0, 0)), np.zeros(0), A, np.array([1.0, 1e9]), (nonnegative(2),))
    assert without_loose_rows(p)[1].tolist() == [True, False]


# -- convexity


def test_small_diagonals_and_negative_ones() -> None:
    assert "P[1, 0] is 0.3" in why_not_convex(sparse.csc_matrix([[0.25, 0.3], [0.3, 0.25]]))
    assert "P[0, 0] is -1" in why_not_convex(sparse.csc_matrix([[-1.0]]))


def test_sparse_factors_that_are_none() -> None:
    """Of three that cancel to a pivot of zero, and with a fourth, for which rows would have to change."""
    n = 500
    a = (1 + 1e-12 * n) / 2
    for few in (
        [[1, -a, -a], [-a, 1, -a], [-a, -a, 1]],
        [[1, -a, 0.3, -a], [-a, 1, 0.3, -a], [0.3, 0.3, 1, 0.3], [-a, -a, 0.3, 1]],
    ):
        P = sparse.lil_matrix(sparse.identity(n))
        P[: len(few), : len(few)] = few
        assert "negative eigenvalue" in why_not_convex(sparse.csc_matrix(P))
