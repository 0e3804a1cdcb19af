"""Programs in their standard form: their data, their right sides, distances to their cones."""

from math import inf, nan

import numpy as np
import pytest
from scipy import sparse

from cones import distance_to_cones
from known_programs import projection_on_simplex
from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Pattern, Program, Rows, Status, available_backends, solve
from regrasp.programs.cones import Cones

pytestmark = pytest.mark.oracle


def test_data_that_do_not_fit_are_refused():
    rows = Rows(3)
    with pytest.raises(InvalidInput, match="rows must have 3 columns, got 2"):
        rows.equal([[1.0, 2.0]])
    with pytest.raises(InvalidInput, match="4 rows cannot be split into cones of 3"):
        rows.second_order(np.ones((4, 3)), size=3)
    rows.equal(np.eye(3))
    with pytest.raises(InvalidInput, match="q must be finite"):
        rows.program([1.0, np.nan, 0.0])
    good = rows.program(np.zeros(3))
    with pytest.raises(InvalidInput, match="cones must cover the 3 rows"):
        Program(good.P, good.q, good.A, good.b, (Block(Cone.ZERO, 2),))


def test_another_right_side_keeps_the_rest():
    rows = Rows(2)
    rows.equal([[1.0, 1.0]], -1.0)
    rows.second_order([[0.0, 0.0], [1.0, -1.0]], [3.0, 0.0])
    program = rows.program([1.0, 0.0], np.array([[2.0, 0.5], [0.5, 1.0]]))
    b = np.array([2.0, 1.0, 0.5])
    other = program.with_right_side(b)
    again = Program(program.P, program.q, program.A, b, program.blocks)
    before, after = solve(program, "clarabel").value, solve(other, "clarabel").value
    assert after == pytest.approx(solve(again, "clarabel").value, abs=1e-9)
    assert abs(after - before).max() > 0.1
    with pytest.raises(InvalidInput, match=r"b must have shape \(3,\), got \(2,\)"):
        program.with_right_side(b[:2])
    with pytest.raises(InvalidInput, match="b must be finite"):
        program.with_right_side(b * np.inf)


def test_distance_to_cones_measures_each_kind():
    rows = Rows(1)
    rows.equal(np.zeros((1, 1)))
    rows.at_least_zero(np.zeros((2, 1)))
    rows.second_order(np.zeros((6, 1)), size=3)
    program = rows.program([0.0])
    inside = np.array([0.0, 1.0, 0.0, 5.0, 3.0, 4.0, 0.0, 0.0, 0.0])
    assert distance_to_cones(program, inside) == 0

    def moved(place, by, dual=False):
        outside = inside.copy()
        outside[place] += by
        return distance_to_cones(program, outside, dual=dual)

    assert moved(0, 0.5) == 0.5
    assert moved(0, 0.5, dual=True) == 0
    assert moved(2, -0.25) == 0.25
    assert moved(3, -1) == 1
    assert moved([7, 8], [3, 4]) == 5


@pytest.mark.parametrize("size", [1.0, 1e100, 1e160, 1e300])
def test_points_of_any_size_have_a_nearest_one_in_the_dual_cone(size):
    """A solver that diverges hands out duals of 1e200: their squares are no numbers."""
    cones = Cones((Block(Cone.ZERO, 1, 1), Block(Cone.NONNEGATIVE, 1, 2), Block(Cone.SECOND_ORDER, 3, 2)))
    z = np.array([-1.0, -2.0, 3.0, 1.0, 3.0, 4.0, 5.0, 3.0, 4.0])
    nearest = cones.dual(size * z)
    assert nearest == pytest.approx(
        size * np.array([-1.0, 0.0, 3.0, 3.0, 1.8, 2.4, 5.0, 3.0, 4.0]), rel=1e-12
    )


def test_what_programs_share_cannot_be_written_to():
    from paper import GRASP, LOAD
    from regrasp.planning.states.program import state_program

    program = state_program(GRASP, LOAD, "effort", [0.3] * 3, [np.inf] * 3, 1.0)
    for shared in (program.q, program.P.data, program.A.indices, program.A.indptr):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 7


def test_an_answer_of_nothing_is_not_the_optimum_because_a_bound_is_far():
    """min 1/2 x^2 - 0.05 x with x <= 1e6: x = 0 is off by 0.05, whatever the size of the bound."""
    from dataclasses import replace

    rows = Rows(1)
    rows.at_least_zero([[-1.0]], 1e6)
    right = solve(rows.program([-0.05], [[1.0]]), "clarabel")
    assert right.value[0] == pytest.approx(0.05)
    assert replace(right, value=np.zeros(1), duals=np.zeros(1)).residual > 0.1
    assert replace(right, value=np.full(1, 0.0501)).residual > 1e-4


def test_matrices_in_another_format_are_refused():
    from scipy import sparse

    with pytest.raises(InvalidInput, match=r"A must be a scipy.sparse matrix in CSC format"):
        Program(
            sparse.csc_matrix((1, 1)),
            np.zeros(1),
            sparse.csr_matrix((1, 1)),
            np.zeros(1),
            (Block(Cone.ZERO, 1),),
        )
    with pytest.raises(InvalidInput, match="Clarabel has no setting 'speed'"):
        solve(projection_on_simplex(np.ones(2))[0], "clarabel", speed=3)


# minimise x1^2 + x1 x2 + x2^2 - 4 x1 - 5 x2 subject to x1 <= .5, 2 x1 + x2 <= 1.5
P = np.array([[2.0, 1.0], [1.0, 2.0]])
Q, A, B = np.array([-4.0, -5.0]), np.array([[1.0, 0.0], [2.0, 1.0]]), np.array([0.5, 1.5])
RIGHT = {"P": sparse.csc_matrix(P), "q": Q, "A": sparse.csc_matrix(A), "b": B}
BLOCKS = (Block(Cone.NONNEGATIVE, 1, 2),)


def scrambled(matrix: np.ndarray) -> sparse.csc_matrix:
    """Every entry as two halves, rows from last to first, zeros included."""
    m, n = matrix.shape
    rows = np.tile(np.repeat(np.arange(m)[::-1], 2), n).astype(np.int32)
    data = np.repeat(matrix[::-1].T.ravel(), 2) / 2
    return sparse.csc_matrix((data, rows, np.arange(n + 1, dtype=np.int32) * 2 * m), (m, n))


def wide(matrix: np.ndarray) -> sparse.csc_matrix:
    found = sparse.csc_matrix(matrix)
    found.indices, found.indptr = found.indices.astype(np.int64), found.indptr.astype(np.int64)
    return found


MATRICES = {
    "scrambled": scrambled,
    "whole numbers": lambda M: sparse.csc_matrix(M.astype(int)),
    "single precision": lambda M: sparse.csc_matrix(M.astype(np.float32)),
    "long indices": wide,
    "sparse array": sparse.csc_array,
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("backend", ["auto", *available_backends()])
def test_matrices_however_given_are_the_same_program(backend: str) -> None:
    asked = solve(Program(**RIGHT, blocks=BLOCKS), backend)
    for name, made in MATRICES.items():
        program = Program(made(P), Q, made(A), B, list(BLOCKS))
        answer = solve(program, backend)
        assert answer.value == pytest.approx(asked.value, abs=1e-6), name
        assert program.A.has_canonical_format
        assert program.A.dtype == program.P.dtype == np.float64
    whole = Program(RIGHT["P"], [-4, -5], RIGHT["A"], (0.5, 1.5), BLOCKS)
    assert solve(whole, backend).value == pytest.approx(asked.value, abs=1e-9)


def test_what_is_given_is_not_changed() -> None:
    given = scrambled(A)
    before = given.copy()
    Program(RIGHT["P"], Q, given, B, BLOCKS)
    assert (given.data == before.data).all()
    assert (given.indices == before.indices).all()


def test_a_matrix_of_doubles_in_order_is_kept_as_it_is() -> None:
    program = Program(**RIGHT, blocks=BLOCKS)
    assert program.A is RIGHT["A"]
    places = program.A.indices, program.A.indptr
    again = Program(program.P, program.q, program.A, program.b, BLOCKS).A  # kept solvers know it by these
    assert again.indices is places[0]
    assert again.indptr is places[1]
    assert program.q is Q


def far_index() -> sparse.csc_matrix:
    found = sparse.csc_matrix(A)
    found.indices = np.array([0, 1, 5], dtype=np.int32)
    return found


def backwards() -> sparse.csc_matrix:
    found = sparse.csc_matrix(A)
    found.indptr = np.array([0, 4, 3], dtype=np.int32)
    return found


@pytest.mark.parametrize(
    ("name", "wrong", "words"),
    [
        ("P", P, "P must be a scipy.sparse matrix in CSC format, got ndarray"),
        ("P", None, "P must be a scipy.sparse matrix in CSC format, got NoneType"),
        ("A", sparse.csc_matrix(A * 1j), "A must hold real numbers, got complex128"),
        ("A", far_index(), "A is no matrix in CSC format: it has 2 rows, and entries in others"),
        ("A", backwards(), "A is no matrix in CSC format: its columns do not follow each other"),
        ("A", sparse.csc_matrix(A * np.array([[nan], [1]])), "A must be finite"),
        ("q", None, "q must be numbers, got None"),
        ("q", ["a", "b"], "q must be numbers"),
        ("q", [[1], [1, 2]], "q must be numbers"),
        ("q", Q[:, None], r"q must have one dimension, got shape \(2, 1\)"),
        ("b", 1.0, r"b must have one dimension, got shape \(\)"),
        ("b", [inf, 1], "b must be finite"),
        ("b", [1j, 1], "b must be numbers"),
        ("blocks", None, "blocks must be a tuple of Block, got None"),
        ("blocks", ("a",), "blocks must be a tuple of Block"),
        ("blocks", BLOCKS * 2, "the cones must cover the 2 rows of A"),
        ("size", nan, "size must be a number of 0 or more, got nan"),
        ("size", inf, "size must be a number of 0 or more, got inf"),
        ("size", -1.0, "size must be a number of 0 or more, got -1.0"),
        ("size", "1", "size must be a number of 0 or more, got '1'"),
    ],
)
def test_other_data_are_refused(name: str, wrong: object, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        Program(**{**RIGHT, "blocks": BLOCKS, name: wrong})


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Block("zero", 1), "cone must be one of Cone.ZERO"),
        (lambda: Block(Cone.ZERO, 0), "size of a block must be a whole number of 1 or more, got 0"),
        (lambda: Block(Cone.ZERO, 2.0), "size of a block must be a whole number of 1 or more, got 2.0"),
        (lambda: Block(Cone.ZERO, True), "size of a block must be a whole number of 1 or more, got True"),
        (lambda: Block(Cone.ZERO, 1, -1), "count of a block must be a whole number of 0 or more, got -1"),
        (lambda: Rows(2.5), "unknowns must be a whole number of 0 or more, got 2.5"),
        (lambda: Rows(-1), "unknowns must be a whole number of 0 or more, got -1"),
        (lambda: Rows(2).equal(None), "rows must be numbers, got None"),
        (lambda: Rows(2).equal(np.ones((1, 1, 2))), r"rows must have shape \(k, 2\)"),
        (lambda: Rows(2).equal(np.eye(2), [1, 2, 3]), r"offset must be a number or have shape \(2,\)"),
        (lambda: Rows(2).second_order(np.eye(2), size=2.0), "cannot be split into cones of 2.0"),
        (lambda: Rows(2).program([1, 1], [1, 1]), r"P must have shape \(2, 2\), got \(2,\)"),
        (lambda: Rows(2).program([1, 1], np.eye(3)), r"P and A must have shapes \(2, 2\)"),
        (lambda: Pattern((2, 2), [0, 5], [0, 1]), "a row and a column within"),
        (lambda: Pattern((2, 2), [0, 1], [0, 1]).filled(None), "values must be an array of 2 numbers"),
        (lambda: solve("x"), "solve takes a Program, got 'x'"),
        (lambda: solve(Program(**RIGHT, blocks=BLOCKS), None), "backend must be a name, got None"),
        (lambda: solve(Program(**RIGHT, blocks=BLOCKS), time_limit="1"), "time_limit must be a positive"),
        (lambda: solve(Program(**RIGHT, blocks=BLOCKS), time_limit=10**400), "time_limit must be a positive"),
        (lambda: Program(**RIGHT, blocks=BLOCKS).save("/nowhere/a.npz"), "/nowhere/a.npz: cannot be written"),
        (lambda: Program(**RIGHT, blocks=BLOCKS).save(None), "path must be a file's name, got None"),
        (lambda: Program.load(3.0), "path must be a file's name, got 3.0"),
    ],
)  # fmt: skip
def test_other_calls_are_refused(call, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        call()


@pytest.mark.parametrize("backend", ["auto", *available_backends()])
def test_a_builder_without_rows(backend: str) -> None:
    rows = Rows(2)
    rows.equal(np.zeros((0, 2)))
    answer = solve(rows.program([-2.0, -4.0], 2 * np.eye(2)), backend)
    assert answer.status is Status.SOLVED
    assert answer.value == pytest.approx([1, 2], abs=1e-5)
