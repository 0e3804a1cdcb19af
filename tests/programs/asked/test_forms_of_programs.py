"""Matrices, rows and limits in every form that is taken, and the first that is not."""

import sys

import numpy as np
import pytest
from scipy import sparse

from programs_by_hand import nonnegative, program
from regrasp.errors import InvalidInput
from regrasp.programs import Pattern, Program, Rows, Status, facts, solve
from regrasp.programs.facts import is_available

pytestmark = pytest.mark.contract

A = np.array([[1.0, 0.0], [2.0, 3.0]])
BLOCKS = (nonnegative(2),)


def of(matrix, *blocks) -> Program:
    return Program(sparse.csc_matrix((2, 2)), np.zeros(2), matrix, np.ones(2), list(blocks) or BLOCKS)


def raw(data, indices, indptr, kind=np.float64) -> sparse.csc_matrix:
    """Arrays as they are, which need not be those of a matrix."""
    matrix = sparse.csc_matrix(A)
    matrix.data = np.array(data, dtype=kind)
    matrix.indices, matrix.indptr = np.array(indices, dtype=np.int32), np.array(indptr, dtype=np.int32)
    return matrix


def fixed(matrix):
    matrix.indices.setflags(write=False)
    return matrix


@pytest.mark.parametrize(
    "given",
    [
        sparse.csc_array(A),
        sparse.csc_matrix(A.astype(np.float32)),
        raw([1, 2, 3], [0, 1, 1], [0, 2, 3], np.float32),
        raw([1, 2, 3, 9], [0, 1, 1, 0], [0, 2, 3]),  # one more entry than there are
        raw([2, 1, 3], [1, 0, 1], [0, 2, 3]),
        raw([0.5, 0.5, 2, 3], [0, 0, 1, 1], [0, 3, 4]),
        fixed(raw([0.5, 0.5, 2, 3], [0, 0, 1, 1], [0, 3, 4])),
        fixed(sparse.csc_matrix(A.astype(int))),
        Pattern((2, 2), [0, 1, 1], [0, 0, 1]).filled(np.array([1, 2, 3])),
    ],
)
def test_a_matrix_in_another_form_becomes_one_of_doubles_in_order(given) -> None:
    found = of(given).A
    assert isinstance(found, sparse.csc_matrix)
    assert found.dtype == np.float64
    assert found.toarray().tolist() == A.tolist()
    assert [found.indices.size, found.data.size, found.indptr.tolist()] == [3, 3, [0, 2, 3]]
    assert found.indices.tolist() == [0, 1, 1]


@pytest.mark.parametrize(
    "given",
    [
        raw([1, 2, 3], [0, 1, -1], [0, 2, 3]),
        raw([1, 2, 3], [0, 1, 2], [0, 2, 3]),
        fixed(raw([1, 2, 3], [0, 1, 2], [0, 2, 3])),
        raw([1, 2, 3], [0, 1, 1], [1, 2, 3]),
        raw([1, 2, 3], [0, 1, 1], [0, 2, 4]),
        raw([1, 2], [0, 1, 1], [0, 2, 3]),
    ],
)
def test_arrays_that_are_no_matrix_are_refused(given) -> None:
    with pytest.raises(InvalidInput, match="no matrix in CSC format"):
        of(given)


def test_blocks_are_kept_as_a_tuple() -> None:
    assert of(sparse.csc_matrix(A), nonnegative(1), nonnegative(1)).blocks == (nonnegative(1),) * 2


def test_rows_of_none_of_one_and_of_nothing() -> None:
    assert Rows(0).program([]).q.size == 0
    with pytest.raises(InvalidInput, match="whole number of 0 or more, got True"):
        Rows(True)
    rows = Rows(3)
    rows.second_order(np.zeros((0, 3)))
    rows.second_order(np.ones((1, 3)))
    rows.at_least_zero(np.eye(3), [2.0])
    made = rows.program(np.zeros(3))
    assert [block.rows for block in made.blocks] == [1, 3]
    assert made.b.tolist() == [0, 2, 2, 2]


def test_the_longest_limit_is_the_largest_number() -> None:
    p = program([[1.0]], [-1.0], [[1.0]], [2.0], nonnegative(1))
    assert solve(p, "clarabel", time_limit=sys.float_info.max).status is Status.SOLVED
    for limit in (np.inf, 0.0):
        with pytest.raises(InvalidInput, match="time_limit"):
            solve(p, "clarabel", time_limit=limit)


def test_what_is_known_but_not_installed_is_not_available(monkeypatch) -> None:
    monkeypatch.setattr(facts, "is_installed", lambda _: False)
    assert not is_available("clarabel")
    assert not is_available("nobody")
