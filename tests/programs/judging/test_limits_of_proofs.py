"""Which objectives are convex and which proofs are believed, to a thousandth of their limits."""

import numpy as np
import pytest
from scipy import sparse

from regrasp.programs import Block, Cone, Program, Status
from regrasp.programs.judging.convexity import why_not_convex
from regrasp.programs.judging.proofs import infeasibility_residual
from regrasp.programs.judging.verdict import PROVEN, judged
from regrasp.programs.solution import Solution

pytestmark = pytest.mark.contract


def program(P, q, A, b, *blocks, size=0.0):
    n = len(q)
    parts = [sparse.csc_matrix(np.array(M, dtype=float).reshape(-1, n)) for M in (P, A)]
    return Program(parts[0], np.array(q, dtype=float), parts[1], np.array(b, dtype=float), blocks, size)


def zero(count):
    return Block(Cone.ZERO, 1, count)


def nonnegative(count):
    return Block(Cone.NONNEGATIVE, 1, count)


def claim(p, status, x=None, z=None) -> Solution:
    x = np.full(p.q.size, np.nan) if x is None else np.array(x, dtype=float)
    z = np.full(p.b.size, np.nan) if z is None else np.array(z, dtype=float)
    return Solution(p, "somebody", status, x, z, 7, 0.25, 0.5, "so they say")


def nobody(_):
    raise AssertionError("no point is asked for")


def test_the_limits_of_proofs_to_a_thousandth() -> None:
    """x <= 1 and (1 + e) x >= 2, and min -y with x <= (1 - e) y from y = 1: e beside 2 and 3, and 2."""
    for e, proven in ((0.9995e-8, True), (1.0005e-8, False)):
        none = program([[0.0]], [0.0], [[1], [-1 - e * 2 / 3]], [1, -2], nonnegative(2))
        residual = infeasibility_residual(none, np.ones(2))
        assert residual == pytest.approx(e, rel=1e-6)
        assert (residual <= PROVEN) is proven
    fixed = program(np.zeros((2, 2)), [0, -1], [[1, 0]], [1], zero(1))
    for miss, near in ((0.9995e-6, True), (1.0005e-6, False)):
        point = np.array([1 + 2 * miss, 0])
        found = judged(
            claim(fixed, Status.UNBOUNDED, [0, 1]), 1e-7, lambda p, x=point: claim(p, Status.SOLVED, x, [0])
        )
        assert found.status is (Status.UNBOUNDED if near else Status.UNBOUNDED_OR_INFEASIBLE)


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
