"""Programs in their own units by hand: which those are, and which programs are left alone."""

import numpy as np
import pytest
from scipy import sparse

from programs_by_hand import claim, nonnegative, program, zero
from regrasp.programs import Block, Cone, Program, Status
from regrasp.programs.judging.elastic import elastic, proven_anyway
from regrasp.programs.judging.own_units import in_own_units
from regrasp.programs.judging.proofs import infeasibility_residual

pytestmark = pytest.mark.contract


def test_units_of_unknowns_rows_and_objective() -> None:
    """x is 2 by 8 x = 16, where 16 is the row's; P x = 1 and q = -32, of which 64 is the objective's."""
    p = program([[0.5]], [-32.0], [[8.0]], [16.0], zero(1))
    own = in_own_units(p)
    assert (own.unknowns, own.duals) == (2, 4)
    assert [float(M) for M in (own.program.P.sum(), own.program.q[0])] == [1 / 32, -1]
    assert [float(M) for M in (own.program.A.sum(), own.program.b[0])] == [1, 1]
    back = own.answer(claim(own.program, Status.SOLVED, [3.0], [5.0]), p)
    assert (back.value, back.duals, back.said) == (6, 20, "so they say, in own units")
    assert back.program is p


@pytest.mark.parametrize(
    ("q", "A", "b", "unknowns", "duals"),
    [
        ([0], [[8]], [0], [1 / 8], [1]),  # by its largest term
        ([0], [[4]], [4], [1], [1 / 4]),
        ([16], [[1]], [1], [1], [16]),
        ([0, 0], [[1, 0], [0, 8]], [1, 0], [1, 1 / 8], [1, 1]),
        ([0, 0], [[1, 0], [0, 4]], [1, 4], [1, 1], [1, 1 / 4]),
        ([0, 0], [[0, 4]], [0], [1, 1 / 4], [1]),  # of nothing one is the unit
        ([0], [[4], [0]], [8, -8], [2], [1 / 8, 1 / 8]),  # of a row without terms its side
        ([0], [[1e-155]], [1e154], [2.0**500], [2.0**15]),  # 1e309 is no number
    ],
)
def test_units_by_hand(q, A, b, unknowns, duals) -> None:
    own = in_own_units(program(np.zeros((len(q), len(q))), q, A, b, zero(len(b))))
    assert own.unknowns.tolist() == unknowns
    assert own.duals.tolist() == duals


@pytest.mark.parametrize(
    "p",
    [
        program([[0.0]], [0.0], [[1]], [1], zero(1)),
        program([[0.0]], [64.0], [[8]], [16], zero(1), size=1.0),
        Program(
            sparse.csc_matrix((0, 0)), np.zeros(0), sparse.csc_matrix((1, 0)), np.array([8.0]), (zero(1),)
        ),
        program(
            [[0.0]], [0.0], [[1e-50], [1e200]], [1e100, 0], zero(1), nonnegative(1)
        ),  # one entry overflows
        program([[1, 1], [1, 1]], [2.0**100, 0], np.eye(2), [1, 2.0**-500], zero(2)),  # P'[1, 1] vanishes
    ],
)
def test_what_is_in_its_own_units_or_cannot_be_is_left_alone(p) -> None:
    assert in_own_units(p) is None


def test_a_proof_as_good_as_is_enough_is_one() -> None:
    p = program([[0.0]], [0.0], [[1], [-1 - 1e-3]], [1, -2], nonnegative(2))
    answer = claim(elastic(p), Status.SOLVED, [0, 0.5], [1, 1, 0])
    enough = infeasibility_residual(p, np.ones(2))
    assert proven_anyway(claim(p, Status.STOPPED), lambda _: answer, enough) is not None


def test_equations_get_room_on_both_sides_where_without_it_nothing_is_proven() -> None:
    """x = 1 and |x| <= 0: by 1 and -1 with the equation as it is, or by its upper side, asked second."""
    cone = Block(Cone.SECOND_ORDER, 2)
    p = program([[0.0]], [0.0], [[1], [0], [1]], [1, 0, 0], zero(1), cone)
    exact = [-1, 1, 1]
    found = proven_anyway(
        claim(p, Status.STOPPED), lambda given: claim(given, Status.SOLVED, [0, 0.5], [*exact, 0]), 1e-9
    )
    assert found.duals.tolist() == exact
    seen = []

    def ask(given):
        seen.append(given)
        return (
            claim(given, Status.SOLVED, [0, 0.5], [0, 1, 1, 1, 0])
            if len(seen) == 2
            else claim(given, Status.STOPPED)
        )

    assert proven_anyway(claim(p, Status.STOPPED), ask, 1e-9).duals.tolist() == exact
    wide = seen[1]
    assert wide.blocks == (nonnegative(1), cone, nonnegative(1), nonnegative(1))
    assert wide.A.toarray().tolist() == [[1, -1], [0, -1], [1, 0], [-1, -1], [0, -1]]
    assert wide.b.tolist() == [1, 0, 0, -1, 1]
