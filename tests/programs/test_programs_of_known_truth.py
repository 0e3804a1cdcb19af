"""No lie gets through: random programs in random units, whose truth is known by construction."""

import logging

import numpy as np
import pytest
from scipy import sparse

from known_programs import is_a_lie, known
from programs_by_hand import program, zero
from regrasp.programs import Block, Cone, Program, Status, available_backends, solve
from regrasp.programs.facts import BACKENDS
from regrasp.programs.judging.audit import MOST, ROUNDING, audited
from regrasp.programs.judging.own_units import in_own_units
from regrasp.programs.judging.units import OWN

pytestmark = pytest.mark.laws
SEEDS = {"auto": 80, "proxqp": 12, "scs": 24, "qpalm": 60, "osqp": 60, "cvxpy": 4}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("backend", ["auto", *available_backends()])
def test_no_back_end_is_believed_where_it_errs(backend: str, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.ERROR, "regrasp.programs")  # which back end was not believed
    takes_cones = backend == "auto" or BACKENDS[backend].second_order
    cases = {seed: known(seed) for seed in range(SEEDS.get(backend, 120))}
    asked = {k: case for k, case in cases.items() if takes_cones or not case.program.has_second_order}
    answers = {seed: solve(case.program, backend, throw=False) for seed, case in asked.items()}
    assert {seed: str(answers[seed]) for seed, case in asked.items() if is_a_lie(case, answers[seed])} == {}
    right = sum(answers[seed].status is case.truth for seed, case in asked.items())
    assert right >= len(asked) * (0.9 if backend == "auto" else 0.15)


@pytest.mark.parametrize(("beyond", "lost"), [(0.99, False), (1.01, True)])
def test_nothing_is_said_of_a_unit_less_than_the_rounding_of_terms(beyond: float, lost: bool) -> None:
    """x - y = 1, and x = y + 1 far away: the terms are 2 x, the unit |b| + X = 2."""
    far = beyond / ROUNDING
    p = program(np.zeros((2, 2)), [0.0, 0.0], [[1.0, -1.0]], [1.0], zero(1))
    assert (audited(p, np.array([far + 1, far]), np.zeros(1)).primal == np.inf) is lost


@pytest.mark.parametrize(("beyond", "lost"), [(0.9, False), (1.1, True)])
def test_likewise_of_columns(beyond: float, lost: bool) -> None:
    """P x + q with P x near zero: terms 16 x, the smaller unit |q| + P X = 2 + 8 (3 + 2) / 8."""
    far = beyond * (2 + 5) / 16 / ROUNDING
    p = program([[8.0, 8.0], [8.0, 8.0]], [3.0, 2.0], np.zeros((0, 2)), [])
    assert (audited(p, np.array([far, -far]), np.zeros(0)).primal == np.inf) is lost


def test_what_has_no_unit_loses_none() -> None:
    p = program(np.zeros((2, 2)), [0.0, 0.0], [[1.0, -1.0]], [0.0], zero(1))
    assert audited(p, np.array([1e20, 1e20]), np.zeros(1)).primal == 0


@pytest.mark.parametrize("far", [1e3, 1e6, 1e9, 1e12])
def test_terms_count_the_less_the_more_of_them_cancels(far: float) -> None:
    """x - y = 1 is missed by a thousandth, however large x and y are; 4e-3 of a unit at 2^24 is the worst."""
    p = program(np.zeros((2, 2)), [0.0, 0.0], [[1.0, -1.0]], [1.0], zero(1))
    miss = audited(p, np.array([far + 1 + 2.0**-10, far]), np.zeros(1)).primal
    counted = OWN * 2 * far
    counted = counted if counted <= 2 * MOST else (2 * MOST) ** 2 / counted
    assert miss == pytest.approx(2.0**-10 / (2 + counted), rel=1e-3)
    assert miss > 5e-7


def test_truths_of_every_kind_come() -> None:
    cases = [known(seed) for seed in range(60)]
    assert {case.truth for case in cases} == {Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED}
    assert {case.program.has_second_order for case in cases} == {True, False}
    assert max(abs(np.log2(case.units)).max() for case in cases) > 20


UNITS = [1e-13, 1e-6, 1e6, 1e13]


def round_one(size: int, q, b, *more, squares: float = 0.0) -> Program:
    """Unknowns (t, v), |v + b_v| <= t + b_0, and equations t or v_1 = value."""
    A = np.vstack([-np.eye(size), *(np.eye(size)[k] for k, _ in more)])
    blocks = (Block(Cone.SECOND_ORDER, size, 1), Block(Cone.ZERO, 1, len(more)))
    right = np.r_[b, [value for _, value in more]]
    return Program(
        sparse.csc_matrix(squares * np.eye(size)), np.asarray(q), sparse.csc_matrix(A), right, blocks
    )


@pytest.fixture
def silent(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.ERROR, "regrasp.programs")


@pytest.mark.usefixtures("silent")
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("size", [2, 3, 50])
def test_cones_in_any_unit(unit: float, size: int) -> None:
    zero, ones = np.zeros(size), np.r_[0.0, unit * np.ones(size - 1)]
    least = solve(round_one(size, np.r_[unit, zero[1:]], zero))
    assert least.objective == pytest.approx(0, abs=1e-6 * unit)
    length = float(np.linalg.norm(ones))
    nearest = solve(round_one(size, -2 * ones, zero, squares=2.0))
    assert nearest.value == pytest.approx(np.r_[length, ones[1:]] / 2, rel=1e-4)
    for beyond, status in (0.9, Status.SOLVED), (1.1, Status.INFEASIBLE):
        found = solve(round_one(size, zero, zero, (0, unit), (1, beyond * unit)))
        assert found.status is status
    most = solve(round_one(size, np.r_[0, -1.0, zero[2:]], zero, (0, unit)))
    assert most.value[1] == pytest.approx(unit, rel=1e-5)
    falls = solve(round_one(size, np.r_[-unit, zero[1:]], np.r_[-unit, ones[1:]]))
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
