"""How each back end is asked, and what is made of its words, by solvers that say what they are told to."""

from math import nan
from threading import local

import numpy as np
import pytest
from scipy import sparse

from regrasp.programs import Program, Rows, Status, solve
from regrasp.programs import clarabel_backend as clarabel
from regrasp.programs.backends import answered_quickly
from regrasp.programs.facts import BACKENDS

pytestmark = pytest.mark.contract

FINE = {"eps_abs": 1e-9, "eps_rel": 1e-9}
TIGHT = ("tol_gap_abs", "tol_gap_rel", "tol_feas", "tol_infeas_abs", "tol_infeas_rel")

STEPS = {"max_iter": 5000, "max_iter_in": 50}


def test_how_well_each_must_answer_and_how_it_is_asked_to() -> None:
    assert {name: (backend.tolerance, backend.options) for name, backend in BACKENDS.items()} == {
        "clarabel": (5e-7, dict.fromkeys(TIGHT, 1e-10)),
        "daqp": (1e-7, {}),
        "quadprog": (1e-7, {}),
        "highs": (1e-6, {"presolve": "off"}),
        "piqp": (1e-7, {"eps_abs": 1e-10, "eps_rel": 1e-10}),
        "proxqp": (1e-6, {"eps_abs": 1e-10, "eps_rel": 0.0, "default_rho": 1e-2, **STEPS}),
        "qpalm": (1e-5, {**FINE, "max_iter": 20_000}),
        "osqp": (1e-5, {**FINE, "max_iter": 50_000}),
        "scs": (1e-5, {**FINE, "max_iters": 200_000}),
        "cvxpy": (1e-6, {}),
    }


def ticking(monkeypatch, module) -> None:
    clock = iter([100.0, 103.0, 110.0])
    monkeypatch.setattr(module, "perf_counter", lambda: next(clock))


def half_line(b: float = 1.0, q: float = -1.0) -> Program:
    rows = Rows(1)
    rows.at_least_zero([[-1.0]], b)
    return rows.program([q], size=1.0)


def test_clarabel_tells_what_was_spent_on_what(monkeypatch) -> None:
    ticking(monkeypatch, clarabel)
    answer = clarabel.solve(half_line(), "clarabel")
    assert (answer.build_time, answer.solve_time) == (3, 7)


def test_clarabel_is_silent_and_has_the_settings_that_are_given() -> None:
    settings = clarabel._settings(max_iter=7)
    assert not settings.verbose
    assert (settings.max_iter, settings.tol_feas) == (7, 1e-10)


def scripted(monkeypatch, said):
    """What solvers are made of and told later, that answer x = 2 and z = 3 with this word."""
    made, told = [], []

    class Solver:
        status, x, z = said, [2.0], [3.0]

        def __init__(self, *given) -> None:
            made.append(given)

        def update(self, **new) -> None:
            told.append(new)

        def solve(self):
            return self

    monkeypatch.setattr(clarabel.clarabel, "DefaultSolver", Solver)
    monkeypatch.setattr(clarabel, "_memory", local())
    return made, told


@pytest.mark.parametrize(
    ("said", "x", "z"),
    [("Solved", 2.0, 3.0), ("AlmostSolved", 2.0, 3.0), ("PrimalInfeasible", nan, 3.0),
     ("DualInfeasible", None, None), ("MaxIterations", None, None), ("AlmostPrimalInfeasible", None, None)],
)  # fmt: skip
def test_what_a_kept_solver_says(monkeypatch, said, x, z) -> None:
    made, _ = scripted(monkeypatch, said)
    answer = answered_quickly(half_line())
    if x is None:
        assert answer is None
    else:
        np.testing.assert_array_equal(answer, [[x], [z]])
    lean = made[0][-1]
    assert not lean.presolve_enable
    assert not lean.equilibrate_enable
    assert not lean.chordal_decomposition_enable
    assert not lean.iterative_refinement_enable


def test_a_kept_solver_is_told_only_what_is_new(monkeypatch) -> None:
    made, told = scripted(monkeypatch, "Solved")
    first = half_line()
    none, square = sparse.csc_matrix((1, 1)), sparse.csc_matrix([[1.0]])
    for P, q, entries, new in (
        (first.P, first.q, None, {"b"}),
        (first.P, np.ones(1), None, {"b", "q"}),
        (none, first.q, None, {"b", "q"}),
        (none, first.q, np.ones(1), {"b", "A"}),
        (none, first.q, None, {"b", "A"}),
    ):
        answered_quickly(Program(P, q, first.A, 2 * first.b, first.blocks, 1.0), entries)
        assert told[-1].keys() == new
        assert told[-1]["b"].tolist() == [2.0]
    for P, new in ((square, {"b"}), (square, {"b"}), (2 * square, {"b", "P"})):  # by another solver
        answered_quickly(Program(P, first.q, first.A, first.b, first.blocks, 1.0))
        assert told[-1].keys() == new
    assert told[-1]["P"].tolist() == [2.0]
    assert len(made) == 2


@pytest.fixture(scope="module")
def through():
    """The back end that asks through cvxpy."""
    pytest.importorskip("cvxpy")
    from regrasp.programs import cvxpy_backend

    return cvxpy_backend


def test_it_tells_what_was_spent_on_what(through, monkeypatch) -> None:
    ticking(monkeypatch, through)
    answer, own = through.timed_solve(half_line(), "cvxpy:CLARABEL")
    assert (answer.build_time, answer.solve_time) == (3, 7)
    assert 0 < own < 60
    assert answer.iterations > 0


def test_each_cone_is_laid_out_and_its_duals_are_ours(through) -> None:
    """x0 = 1, x1 >= -2, |(x2, x3)| <= 5, |x4| <= 6, by squares and a pull."""
    rows = Rows(5)
    eye = np.eye(5)
    rows.equal(eye[:1], -1.0)
    rows.at_least_zero(eye[1:2], 2.0)
    none = 0 * eye[0]
    rows.second_order([none, eye[2], eye[3], none, eye[4], none], [5.0, 0, 0, 6.0, 0, 0], size=3)
    program = rows.program([-3.0, 4.0, -6.0, -8.0, -9.0], np.diag([2.0, 1, 1, 1, 1]))
    answer = solve(program, "cvxpy:CLARABEL")
    assert answer.value == pytest.approx([1, -2, 3, 4, 6], abs=1e-6)
    assert answer.duals == pytest.approx([-1, 2, 5, -3, -4, 3, -3, 0], abs=1e-5)
    assert answer.objective == pytest.approx(1 - 3 + 2 - 8 + 4.5 - 18 + 8 - 32 + 18 - 54, abs=1e-5)


def test_without_rows_or_without_squares(through) -> None:
    none = sparse.csc_matrix((0, 1)), np.zeros(0), ()
    square = Program(sparse.csc_matrix([[2.0]]), -np.ones(1), *none)
    assert solve(square, "cvxpy").value == pytest.approx([0.5])
    answer = solve(half_line(), "cvxpy")
    assert answer.value == pytest.approx([1.0])
    assert answer.status is Status.SOLVED
    assert solve(half_line(), "cvxpy:SCIPY").value == pytest.approx([1.0])  # who takes no squares


def test_squares_that_rounding_bends_are_squares(through) -> None:
    """An eigenvalue of -1e-13 of the largest, which cvxpy would refuse in large units."""
    P = 2.0**30 * np.array([[1.0, 1.0], [1.0, 1.0 - 2.0**-42]])
    rows = Rows(2)
    rows.equal([[1.0, -1.0]])
    answer = through.solve(rows.program([-(2.0**30)] * 2, P), "cvxpy:CLARABEL")
    assert answer.status is Status.SOLVED
    assert answer.value == pytest.approx([0.5, 0.5])


def test_it_has_no_numbers_where_there_is_no_answer(through) -> None:
    empty = Rows(1)
    empty.equal([[1.0]], -2.0)
    empty.at_least_zero([[-1.0]], 1.0)
    for program in (empty.program([1.0]), half_line(q=1.0)):
        answer = through.solve(program, "cvxpy:CLARABEL")
        assert answer.status is Status.NOT_FOUND
        assert np.isnan(answer.value).all()
        assert np.isnan(answer.duals).all()


def test_what_it_warns_of_is_in_its_word(through, recwarn) -> None:
    answer = through.solve(half_line(), "cvxpy:CLARABEL", max_iter=1)
    assert answer.status is Status.STOPPED
    assert not recwarn.list


def test_who_is_asked_where_nobody_is_named(through, monkeypatch) -> None:
    asked = []

    class Problem:
        status, solver_stats = "optimal", None

        def __init__(self, *_) -> None: ...

        def solve(self, **options) -> None:
            asked.append(options)

    monkeypatch.setattr(through.cp, "Problem", Problem)
    monkeypatch.setattr(through, "_dual", lambda *_: 0.0)
    for name in ("cvxpy", "cvxpy:CLARABEL"):
        answer, own = through.timed_solve(half_line(), name, speed=2)
        assert (answer.iterations, own) == (None, None)
    assert asked == [{"solver": None, "speed": 2}, {"solver": "CLARABEL", "speed": 2}]
