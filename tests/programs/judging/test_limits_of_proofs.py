"""Which objectives are convex and which proofs are believed, to a thousandth of their limits."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from programs_by_hand import claim, nobody, nonnegative, program, zero
from regrasp.programs import Block, Cone, Status
from regrasp.programs.judging.cleaning import cleaned_duals
from regrasp.programs.judging.convexity import why_not_convex
from regrasp.programs.judging.elastic import elastic, proven_anyway
from regrasp.programs.judging.loose_rows import without_loose_rows
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.judging.units import units_of_unknowns
from regrasp.programs.judging.verdict import PROVEN, judged

pytestmark = pytest.mark.contract


def test_the_limits_of_proofs_to_a_thousandth() -> None:
    """x <= 1 and (1 + e) x >= 2, and min -y with x <= (1 - e) y from y = 1: e beside 2 and 3, and 2."""
    for e, proven in ((0.9995e-8, True), (1.0005e-8, False)):
        none = program([[0.0]], [0.0], [[1], [-1 - e * 2 / 3]], [1, -2], nonnegative(2))
        for size, scale in ((0.0, 1.0), (1.0, 1.0), (1.0, 1e-12), (1.0, 1e12)):
            residual = infeasibility_residual(replace(none, size=size), np.full(2, scale))
            assert residual == pytest.approx(e, rel=1e-6)
            assert (residual <= PROVEN) is proven
    fixed = program(np.zeros((2, 2)), [0, -1], [[1, 0]], [1], zero(1))
    for miss, near in ((0.9995e-6, True), (1.0005e-6, False)):
        point = np.array([1 + 2 * miss, 0])
        found = judged(
            claim(fixed, Status.UNBOUNDED, [0, 1]), 1e-7, lambda p, x=point: claim(p, Status.SOLVED, x, [0])
        )
        assert found.status is (Status.UNBOUNDED if near else Status.UNBOUNDED_OR_INFEASIBLE)


@pytest.mark.parametrize(("rest", "signed"), [(0.97 * 2.0**-45, False), (1.03 * 2.0**-45, True)])
def test_a_sum_that_is_rounding_has_no_sign(rest, signed) -> None:
    """x <= 1 and x >= 1 + 2 rest, and min -x - (1 - 2 rest) y along (1, -1): of terms 2."""
    none = program([[0.0]], [0.0], [[1], [-1]], [1, -1 - 2 * rest], nonnegative(2))
    assert (infeasibility_residual(none, np.ones(2)) < np.inf) is signed
    falls = program(np.zeros((2, 2)), [-1, -1 + 2 * rest], np.zeros((0, 2)), [])
    assert (unboundedness_residual(falls, np.array([1.0, -1])) < np.inf) is signed


@pytest.mark.parametrize(("size", "unit"), [(0.0, 1.0), (0.5, 0.5), (2.0, 2.0)])
def test_a_hundredth_of_what_unknowns_grow_by_counts(size, unit) -> None:
    """x + y = 0, x + y <= 0 and y >= 1: what the first two leave of y, 1 for 1, in its unit."""
    rows = [[1, 1], [1, 1], [0, -1]]
    p = program(np.zeros((2, 2)), [0, 0], rows, [0, 0, -1], zero(1), nonnegative(2), size=size)
    z = np.array([-1e9, 1e9, 1.0])
    assert infeasibility_residual(p, z) == pytest.approx(1e-2 * unit, rel=1e-6)


def test_of_what_proves_nothing_the_first_is_kept() -> None:
    p = program([[0.0]], [0.0], [[1], [1]], [1, 2], nonnegative(2))
    z = np.array([1.0, 1e-3])
    assert cleaned_duals(p, z, 0.0).tolist() == z.tolist()


def test_what_only_looks_like_a_direction_ends_no_search() -> None:
    """y <= x + 1 and x <= 0.95 y meet at (19, 20), along which the first is crossed by 1 of 39 only."""
    p = program(np.zeros((2, 2)), [0, -1], [[-1, 1], [1, -0.95]], [1, 0], nonnegative(2))
    near = claim(p, Status.STOPPED, np.array([19.0, 20.0]) * (1 + 1e-4), [20, 20])
    assert 0.02 < unboundedness_residual(p, near.value) < 0.1
    found = judged(near, 1e-9, lambda p: claim(p, Status.STOPPED))
    assert found.status is Status.SOLVED
    assert found.value == pytest.approx([19, 20])


def test_noise_hides_no_direction() -> None:
    """min -y along (0, 1); a third unknown, a thousandth of it, is bent as much as all of its own."""
    p = program(np.diag([0, 0, 1.0]), [0, -1, 0], [[-1, 0, 0]], [0], nonnegative(1))
    stopped = claim(p, Status.STOPPED, [0, 1, 1e-3], [0])
    assert unboundedness_residual(p, stopped.value) == 1
    assert judged(stopped, 1e-9, nobody).status is Status.UNBOUNDED


def test_zero_is_a_point_only_of_all_rows() -> None:
    p = program(np.zeros((2, 2)), [0, -1], [[1, 0], [-1, 0]], [1, 5], zero(1), nonnegative(1))
    found = judged(claim(p, Status.UNBOUNDED, [0, 1]), 1e-7, lambda p: claim(p, Status.STOPPED))
    assert found.status is Status.UNBOUNDED_OR_INFEASIBLE


def test_only_an_answer_that_lacks_room_proves_anything() -> None:
    """x <= 1 and x >= 2 beside a y: t is the last number."""
    p = program(np.zeros((2, 2)), [0, 0], [[1, 0], [-1, 0]], [1, -2], nonnegative(2))
    for t, proven in ((0.5, True), (0.0, False), (-0.5, False)):
        for y in (1.0, -1.0):
            answer = claim(elastic(p), Status.SOLVED, [0, y, t], [1, 1, 0])
            found = proven_anyway(claim(p, Status.STOPPED), lambda _, answer=answer: answer, PROVEN)
            assert (found is not None) is proven


def test_sides_that_grow_step_by_step_or_from_nothing_are_not_far() -> None:
    for b in ([1, 1e3, 1e6, 1e9], [0, 1, 2, 3]):
        p = program([[1.0]], [1.0], [[1]] * 4, b, nonnegative(4))
        assert without_loose_rows(p) is None


@pytest.mark.parametrize("n", [2, 101])
def test_an_entry_that_was_to_be_zero_gives_no_unit(n) -> None:
    """A trillionth of the largest of its row, of dense and of sparse terms; and of a cone's rows together."""
    A = np.zeros((5, n))
    A[:, 0], A[:, 1] = [1, 4, 4, 1, 0], [1e-12, 4.002e-12, -3.998e-12, 3.998e-12, 4.002e-12]
    A[3, 0] = 4
    p = program(np.eye(n), np.ones(n), A, np.ones(5), nonnegative(3), Block(Cone.SECOND_ORDER, 2))
    inverses = p.terms.inverses
    assert sparse.issparse(inverses) is (n > 100)
    found = (inverses.toarray() if sparse.issparse(inverses) else inverses)[:, 1]
    np.testing.assert_allclose(found, [0, 1 / 4.002e-12, 0, 0, 1 / 4.002e-12], rtol=1e-12)


def test_the_least_units_of_a_program_in_one() -> None:
    """min x^2 / 2 + 3 y^2 / 2 with 2 y <= 1: columns 1 + 3 and 3 + 3, the row 2, its product 2 / (2 / 6)."""
    p = program(np.diag([1.0, 3]), [0, 0], [[0, 2]], [1], nonnegative(1), size=1.0)
    assert p.floors == pytest.approx((2, 4, 6, 4))


def test_a_unit_is_passed_on_four_times() -> None:
    """x0 = 1, and each is twice the one before; after four rows there is none."""
    rows = np.eye(7) - 2 * np.eye(7, k=-1)
    p = program(np.zeros((7, 7)), np.zeros(7), rows, [1, 0, 0, 0, 0, 0, 0], zero(7))
    assert units_of_unknowns(p)[0].tolist() == [1, 2, 4, 8, 16, 0, 0]


def test_what_measures_as_much_as_is_allowed_is_sound() -> None:
    p = program([[1.0]], [-1.0], [[1.0]], [0.5], nonnegative(1))
    given = claim(p, Status.SOLVED, [0.5 + 1e-5], [0.5])
    assert judged(given, given.residual, nobody) is given


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_none_prove_nothing(wrong) -> None:
    """Alone, or beside one that would do."""
    p = program(np.diag([1.0, 0, 0]), [0, -1, 0], np.eye(3), [1, 0, 0], Block(Cone.SECOND_ORDER, 3))
    for given in ([wrong] * 3, [wrong, 1, 1], [1, 1, wrong]):
        for status, parts in ((Status.INFEASIBLE, (None, given)), (Status.UNBOUNDED, (given, None))):
            assert judged(claim(p, status, *parts), 1e-7, nobody).status is Status.UNSOUND


@pytest.mark.parametrize(
    ("P", "words"),
    [
        ([[0, 0.5], [0.5, 1]], "P[1, 0] is 0.5 and P[0, 1] is 0.5 beside 1 and 0"),
        ([[1, 0.5], [0.5, 0]], "P[1, 0] is 0.5 and P[0, 1] is 0.5 beside 0 and 1"),
        ([[1, 2], [2, 1]], "P[1, 0] is 2 and P[0, 1] is 2 beside 1 and 1"),
        ([[1, -2], [-2, 1]], "P[1, 0] is -2 and P[0, 1] is -2 beside 1 and 1"),
        ([[1, 1 + 1.0005e-12], [1 + 1.0005e-12, 1]], "P[1, 0] is 1 and P[0, 1] is 1 beside 1 and 1"),
        ([[1, 1.0005e-12], [0, 1]], "not symmetric: P[1, 0] is 0 and P[0, 1] is 1.0005e-12"),
        ([[1, 0.9, -0.9], [0.9, 1, 0.9], [-0.9, 0.9, 1]], "it has a negative eigenvalue"),
        ([[4, 4 + 1e-11], [4 + 1e-11, 4]], "P[1, 0] is 4 and P[0, 1] is 4 beside 4 and 4"),
        ([[1, 0], [0, -1e-30]], "P[1, 1] is -1e-30"),
    ],
)
def test_the_words_of_what_is_not_convex(P, words) -> None:
    assert words in why_not_convex(sparse.csc_matrix(np.array(P, dtype=float)))


def test_what_is_convex() -> None:
    """Zeros that are stored, a row of ones at the edge of Gershgorin's discs and of a factor, rounding."""
    stored = sparse.csc_matrix((np.array([1.0, 0, 0, 0]), ([0, 0, 1, 1], [0, 1, 0, 1])), (2, 2))
    assert stored.nnz == 4
    assert why_not_convex(sparse.csc_matrix([[1, 0.9995e-12], [0, 1]])) == ""
    for P in (stored, np.ones((2, 2)), np.ones((3, 3)), [[4, 4 + 1e-13], [4 + 1e-13, 4]], [[1, 0], [0, 0]]):
        assert why_not_convex(sparse.csc_matrix(P)) == ""
    for count in (3, 401):
        P = np.zeros((count, count))
        P[:3, :3] = [[1, -0.5, -0.5], [-0.5, 1, -0.5], [-0.5, -0.5, 1]]
        assert why_not_convex(sparse.csc_matrix(P)) == ""
        P[0, 1] = P[1, 0] = -0.5 - 1e-6
        assert why_not_convex(sparse.csc_matrix(P)) != ""


def test_a_matrix_of_low_rank_is_convex_however_many_unknowns() -> None:
    root = np.random.default_rng(0).normal(size=(390, 5))
    assert why_not_convex(sparse.csc_matrix(root @ root.T)) == ""
