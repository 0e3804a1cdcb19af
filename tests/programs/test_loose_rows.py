"""Bounds far beyond everything else hide nothing, beside second-order cones either."""

import numpy as np
import pytest
from scipy import sparse

from regrasp.programs import Block, Cone, Program, Status, solve
from regrasp.programs.judging.loose_rows import without_loose_rows

pytestmark = pytest.mark.oracle


def ball_and_plane(seed, share, far):
    """A point of a plane, in a ball of ``share`` of its middle's distance; its first number is <= far."""
    rng = np.random.default_rng(seed)
    d = int(rng.integers(2, 4))
    middle, a, beta, q = rng.normal(size=d), rng.normal(size=d), rng.normal(), rng.normal(size=d)
    radius = share * abs(a @ middle - beta) / np.linalg.norm(a)
    rows = np.vstack([a, np.eye(d)[0], np.zeros(d), -np.eye(d)])
    b = np.r_[beta, far, radius, -middle]
    blocks = (Block(Cone.ZERO, 1, 1), Block(Cone.NONNEGATIVE, 1, 1), Block(Cone.SECOND_ORDER, d + 1))
    u = a / np.linalg.norm(a)
    foot = middle - (u @ middle - beta / np.linalg.norm(a)) * u
    along = q - (u @ q) * u
    reach = np.sqrt(max(radius**2 - ((foot - middle) ** 2).sum(), 0.0))
    best = float(q @ foot - reach * np.linalg.norm(along))
    return Program(sparse.csc_matrix((d, d)), q, sparse.csc_matrix(rows), b, blocks), best


@pytest.mark.parametrize("far", [1e3, 1e8, 1e12, 1e20, 1e30])
@pytest.mark.parametrize("seed", range(6))
def test_a_far_bound_hides_no_verdict(seed, far) -> None:
    for share in (0.5, 0.99):
        program, _ = ball_and_plane(seed, share, far)
        assert solve(program).status is Status.INFEASIBLE
    program, best = ball_and_plane(seed, 1.5, far)
    assert solve(program).objective == pytest.approx(best, rel=1e-5, abs=1e-6)


def test_what_is_left_out() -> None:
    program, _ = ball_and_plane(0, 0.5, 1e12)
    rest, kept = without_loose_rows(program)
    assert kept.tolist() == [True, False, *[True] * (program.b.size - 2)]
    assert [block.cone for block in rest.blocks] == [Cone.ZERO, Cone.SECOND_ORDER]
    assert rest.b.tolist() == program.b[kept].tolist()
    assert without_loose_rows(rest) is None
    assert without_loose_rows(ball_and_plane(0, 0.5, 1.0)[0]) is None


@pytest.mark.parametrize("cone", [Cone.ZERO, Cone.SECOND_ORDER])
def test_only_inequalities_are_left_out(cone) -> None:
    one, sizes = sparse.csc_matrix(np.eye(2)), (2, 1) if cone is Cone.SECOND_ORDER else (1, 2)
    program = Program(one, np.zeros(2), one, np.array([1e9, 1.0]), (Block(cone, *sizes),))
    assert without_loose_rows(program) is None
    none = Program(one, np.zeros(2), sparse.csc_matrix((0, 2)), np.zeros(0), ())
    assert without_loose_rows(none) is None


def test_a_far_bound_below_is_no_loose_one() -> None:
    """x >= 1e9 asks much: it stays."""
    one = sparse.csc_matrix(np.eye(1))
    rows = sparse.csc_matrix([[-1.0], [1.0]])
    program = Program(one, np.zeros(1), rows, np.array([-1e9, 1.0]), (Block(Cone.NONNEGATIVE, 1, 2),))
    assert without_loose_rows(program) is None
    assert solve(program).status is Status.INFEASIBLE


@pytest.mark.parametrize("size", [1, 3])
def test_rows_of_a_block_are_left_out_one_by_one(size) -> None:
    rows, b = sparse.csc_matrix([[1.0], [1.0], [-1.0]]), np.array([1.0, 1e9, 2.0])
    program = Program(
        sparse.csc_matrix(np.eye(1)), np.zeros(1), rows, b, (Block(Cone.NONNEGATIVE, size, 3 // size),)
    )
    rest, kept = without_loose_rows(program)
    assert kept.tolist() == [True, False, True]
    assert rest.blocks == (Block(Cone.NONNEGATIVE, 1, 2),)


def test_far_is_told_by_sides_beside_each_other_whatever_their_size() -> None:
    for unit in (2.0**-30, 1.0, 2.0**30):
        rows, b = sparse.csc_matrix([[1.0], [-1.0]]), unit * np.array([1e5, 1.0])
        program = Program(
            sparse.csc_matrix(np.eye(1)), np.zeros(1), rows, b, (Block(Cone.NONNEGATIVE, 1, 2),)
        )
        assert without_loose_rows(program)[1].tolist() == [False, True]
