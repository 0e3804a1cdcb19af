"""Programs in units that solvers' tolerances do not suit are answered in their own."""

import logging

import numpy as np
import pytest
from scipy import sparse

from known_programs import known
from regrasp.programs import Block, Cone, Program, Status, solve
from regrasp.programs.judging.own_units import in_own_units

pytestmark = pytest.mark.laws
UNITS = [1e-13, 1e-6, 1e6, 1e13]


def cone(size: int, q, b, *more, squares: float = 0.0) -> Program:
    """Unknowns (t, v), |v + b_v| <= t + b_0, and equations t or v_1 = value."""
    A = np.vstack([-np.eye(size), *(np.eye(size)[k] for k, _ in more)])
    blocks = (Block(Cone.SECOND_ORDER, size, 1), Block(Cone.ZERO, 1, len(more)))
    right = np.r_[b, [value for _, value in more]]
    return Program(
        sparse.csc_matrix(squares * np.eye(size)), np.asarray(q), sparse.csc_matrix(A), right, blocks
    )


@pytest.fixture(autouse=True)
def silent(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.ERROR, "regrasp.programs")


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("size", [2, 3, 50])
def test_cones_in_any_unit(unit: float, size: int) -> None:
    zero, ones = np.zeros(size), np.r_[0.0, unit * np.ones(size - 1)]
    least = solve(cone(size, np.r_[unit, zero[1:]], zero))
    assert least.objective == pytest.approx(0, abs=1e-6 * unit)
    length = float(np.linalg.norm(ones))
    nearest = solve(cone(size, -2 * ones, zero, squares=2.0))
    assert nearest.value == pytest.approx(np.r_[length, ones[1:]] / 2, rel=1e-4)
    for beyond, status in (0.9, Status.SOLVED), (1.1, Status.INFEASIBLE):
        found = solve(cone(size, zero, zero, (0, unit), (1, beyond * unit)))
        assert found.status is status
    most = solve(cone(size, np.r_[0, -1.0, zero[2:]], zero, (0, unit)))
    assert most.value[1] == pytest.approx(unit, rel=1e-5)
    falls = solve(cone(size, np.r_[-unit, zero[1:]], np.r_[-unit, ones[1:]]))
    assert falls.status is Status.UNBOUNDED


def test_units_are_undone() -> None:
    """The same optimum, measured alike, in both units."""
    seen = 0
    for seed in range(40):
        case = known(seed)
        own = in_own_units(case.program)
        if own is None or case.truth is not Status.SOLVED:
            continue
        found = solve(own.program, "clarabel", throw=False)
        if found.status is Status.SOLVED:
            back = own.answer(found, case.program)
            assert back.residual <= 1e-6
            off = abs(found.audit.primal - back.audit.primal) + abs(found.audit.gap - back.audit.gap)
            assert off <= 1e-9
            _, _, P, q = case.plain
            x = case.units * back.value
            assert x @ P @ x / 2 + q @ x == pytest.approx(case.optimum, rel=1e-5, abs=1e-5)
            seen += 1
    assert seen > 5


def test_what_is_in_its_own_units_is_left_alone() -> None:
    one = Program(sparse.csc_matrix([[1.0]]), np.ones(1), sparse.csc_matrix([[1.0]]), np.ones(1),
                  (Block(Cone.ZERO, 1),))  # fmt: skip
    assert in_own_units(one) is None
    given = Program(one.P, 1e9 * one.q, one.A, one.b, one.blocks, size=1.0)
    assert in_own_units(given) is None
    huge = Program(one.P, one.q, sparse.csc_matrix([[1e-300]]), np.array([1e300]), one.blocks)
    assert in_own_units(huge) is None or np.isfinite(in_own_units(huge).program.q).all()
