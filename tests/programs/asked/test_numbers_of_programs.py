"""Cones, programs and answers by numbers: at their limits, on both sides."""

from math import inf, nan

import numpy as np
import pytest
from scipy import sparse

from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program, Rows, Solution, Status
from regrasp.programs.cones import Cones
from regrasp.programs.solution import failed

pytestmark = pytest.mark.contract

# -- cones: one equation, one inequality, two cones of three rows ------------------------------------------

ALL = Cones((Block(Cone.ZERO, 1), Block(Cone.NONNEGATIVE, 1), Block(Cone.SECOND_ORDER, 3, 2)))
STRAIGHT = Cones((Block(Cone.ZERO, 1), Block(Cone.NONNEGATIVE, 2)))


def array(*numbers: float) -> np.ndarray:
    return np.array(numbers, dtype=float)


def test_each_cone_is_a_unit_of_its_own() -> None:
    sizes = array(1, 2, 3, 4, 12, 2, 1, 2)
    assert ALL.units(sizes).tolist() == [1, 2, 13, 13, 13, 3, 3, 3]
    assert ALL.largest(sizes).tolist() == [1, 2, 12, 12, 12, 2, 2, 2]
    assert sizes.tolist() == [1, 2, 3, 4, 12, 2, 1, 2]
    assert [(part.start, part.stop) for part in ALL.round] == [(2, 5), (5, 8)]
    assert ALL.excess(array(-3, -2, 1, 3, 4, 9, 3, 4)).tolist() == [3, 2, 4, 0, 0, 0, 0, 0]
    assert ALL.excess(array(3, 2, -1, 3, 4, -2, 0, 0)).tolist() == [3, 0, 6, 0, 0, 2, 0, 0]
    products = ALL.products(array(2, 3, 1, 2, 3, 4, 5, 6), array(5, 7, 1, 1, 2, 2, 1, 1))
    assert products.tolist() == [10, 21, 9, 0, 0, 19, 0, 0]
    assert (ALL.has_round, STRAIGHT.has_round) == (True, False)
    assert Cones(()).excess(np.zeros(0)).tolist() == []
    assert Cones((Block(Cone.SECOND_ORDER, 3, 0),)).dual(np.zeros(0)).tolist() == []


def test_points_inside_are_their_own_nearest_to_the_last_bit() -> None:
    """49 (1 / 49) is not 1 in doubles."""
    for z in (array(-1, 1, 49, 3, 1, 5, 3, 4), array(7, 0, 49, 0, 0, 0, 0, 0)):
        assert ALL.has_dual(z)
        assert ALL.dual(z).tolist() == z.tolist()
    far = 2.0**600 * array(-49, 49, 1)
    assert (far / far[1] * far[1] != far).any()
    assert STRAIGHT.dual(far).tolist() == far.tolist()


@pytest.mark.parametrize("size", [1.0, 1e160, -1.0, -1e160])
def test_far_points_have_a_nearest_one_whichever_of_their_numbers_is_large(size) -> None:
    nearest = ALL.dual(array(0, 0, 0, size, 0, 0, 0, 0))
    assert nearest == pytest.approx(array(0, 0, abs(size) / 2, size / 2, 0, 0, 0, 0))


@pytest.mark.parametrize("cones", [ALL, STRAIGHT])
def test_what_is_no_number_is_not_made_one(cones) -> None:
    for bad in (-inf, nan):
        z = np.zeros(cones.zero.size)
        z[1] = bad
        assert not cones.has_dual(z)
        np.testing.assert_array_equal(cones.dual(z), z)
    z = np.zeros(cones.zero.size)
    z[2] = inf
    np.testing.assert_array_equal(cones.dual(z), z)


@pytest.mark.parametrize(
    "blocks",
    [
        (Block(Cone.ZERO, 1, 1),),
        (Block(Cone.ZERO, 1, 3),),
        (Block(Cone.ZERO, 1, 2), Block(Cone.SECOND_ORDER, 1, 1)),
    ],
)
def test_cones_cover_the_rows_and_have_rows_themselves(blocks) -> None:
    assert Block(Cone.ZERO, 3).rows == 3
    parts = sparse.csc_matrix((1, 1)), np.zeros(1), sparse.csc_matrix((2, 1)), np.zeros(2)
    assert Program(*parts, (Block(Cone.ZERO, 1, 2), Block(Cone.SECOND_ORDER, 1, 0))).b.size == 2
    with pytest.raises(InvalidInput, match="the cones must cover the 2 rows of A"):
        Program(*parts, blocks)


@pytest.mark.parametrize(("size", "count"), [(-2, -1), (1, -1), (0, 1)])
def test_no_block_has_less_than_no_rows(size, count) -> None:
    for cone in Cone:
        with pytest.raises(InvalidInput, match="of a block must be a whole number"):
            Block(cone, size, count)


@pytest.mark.parametrize("kind", [-1, 3])
def test_a_kind_of_cone_that_there_is_not_is_not_read(tmp_path, kind) -> None:
    rows = Rows(1)
    rows.equal([[1.0]])
    path = rows.program([1.0]).save(tmp_path / "p.npz")
    with np.load(path) as file:
        parts = dict(file)
    np.savez(path, **(parts | {"cones": np.array([[kind, 1, 1]])}))
    with pytest.raises(InvalidInput, match="not the cones"):
        Program.load(path)


@pytest.mark.parametrize("size", [0, -1])
def test_a_cone_has_a_row_at_least(size) -> None:
    rows = Rows(1)
    with pytest.raises(InvalidInput, match=f"2 rows cannot be split into cones of {size}"):
        rows.second_order([[1.0], [1.0]], size=size)
    rows.second_order([[1.0], [1.0]], size=1)
    assert rows.program([1.0]).blocks == (Block(Cone.SECOND_ORDER, 1, 2),)


def test_dense_and_sparse_rows_stand_in_the_order_of_their_demands() -> None:
    rows = Rows(2)
    rows.equal([[1.0, 2.0]])
    rows.equal(sparse.coo_array(np.array([[0.0, 3.0]])))
    rows.at_least_zero([4.0, 0.0], 5.0)
    assert len(rows) == 3
    assert rows.program([0.0, 0.0]).A.toarray().tolist() == [[-1, -2], [0, -3], [-4, 0]]


# -- programs and answers ----------------------------------------------------------------------------------


def test_a_program_says_what_it_is() -> None:
    none = Program(sparse.csc_matrix((2, 2)), np.zeros(2), sparse.csc_matrix((0, 2)), np.zeros(0), ())
    assert str(none) == "program of 2 unknowns, no rows"
    assert none.codes.shape == (0, 3)
    assert none.slices == ()
    rows = Rows(1)
    for demand in (rows.equal, rows.at_least_zero, rows.equal, rows.second_order):
        demand([[1.0], [0.0]])
    whole = rows.program([0.0])
    assert str(whole) == "program of 1 unknowns, rows 4 zero, 2 non-negative, 2 second-order"
    assert whole.codes.tolist() == [[0, 2, 1], [1, 2, 1], [0, 2, 1], [2, 2, 1]]
    assert [(part.start, part.stop) for _, part in whole.slices] == [(0, 2), (2, 4), (4, 6), (6, 8)]


@pytest.mark.parametrize(("P", "size", "is_quick"), [
    ([[0, 0], [0, 0]], 1, True), ([[0, 0], [0, 0]], 0, False), ([[0, 0], [0, 0]], 1e-9, True),
    ([[1, 0], [0, 1]], 1, True), ([[0, 0], [0, -1]], 1, False), ([[1, 1], [1, 1]], 1, False),
    ([[1, 0], [0, 0]], 1, True),
])  # fmt: skip
def test_what_a_kept_solver_may_answer(P, size, is_quick) -> None:
    rows = Rows(2)
    rows.at_least_zero(np.eye(2))
    assert rows.program([1.0, 1.0], np.array(P, dtype=float), size=size).is_quick is is_quick
    beside = Rows(3)
    beside.at_least_zero(np.eye(3))
    assert not beside.program(np.ones(3), [[1.0, 1, 0], [1, 1, 0], [0, 0, 1]], size=1.0).is_quick
    many = Rows(200)
    many.at_least_zero(np.eye(200))
    assert not many.program(np.ones(200), size=1.0).is_quick


def test_an_answer_is_as_good_as_the_worst_of_its_measures() -> None:
    """Of -x over x <= 1 at x = 1 + e, z = 1: outside by e of (1 + 1 + e), the worst of four."""
    rows = Rows(1)
    rows.at_least_zero([[-1.0]], 1.0)
    program = rows.program([-1.0])
    for e in (1e-3, 2e-3):
        answer = Solution(program, "told", Status.SOLVED, array(1 + e), array(1), None, 0.0, 0.0, "so")
        assert answer.residual == max(answer.audit[:4])
        assert answer.residual < answer.absolute_gap
    assert failed(program, "told", "no").residual == inf
    half = Solution(program, "told", Status.SOLVED, array(1), array(nan), None, 0.0, 0.0, "so")
    assert half.residual == inf
    falls = Rows(1)
    falls.at_least_zero([[1.0]])
    falling = falls.program([-1.0])
    for status in (Status.UNBOUNDED, Status.UNBOUNDED_OR_INFEASIBLE):
        assert Solution(falling, "told", status, array(1), array(nan), None, 0.0, 0.0, "so").residual == 0
    falls.at_least_zero([[-1.0]], -1.0)
    empty = falls.program([-1.0])
    assert (
        Solution(empty, "told", Status.INFEASIBLE, array(nan), array(1, 1), None, 0.0, 0.0, "so").residual
        == 0
    )
    no = failed(program, "told", "no")
    assert (no.build_time, no.solve_time) == (0, 0)
