"""Programs in their standard form: their data, their right sides, distances to their cones."""

import numpy as np
import pytest

from cones import distance_to_cones
from known_programs import projection_on_simplex
from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program, Rows, solve
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
