"""Every word an answer may come with, judged on a program whose optimum is known by hand."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from regrasp.bench.judging.judgement import judged
from regrasp.bench.problems.problem import BenchProblem, Known, Truth, Verdict
from regrasp.bench.reporting.closeness import closeness
from regrasp.bench.reporting.outcomes import outcomes
from regrasp.programs import Block, Cone, Program
from regrasp.programs.answer import Answer
from test_bench_report import row

pytestmark = pytest.mark.contract


def toy(P: float, q: float, known: Known) -> BenchProblem:
    """P x^2 / 2 + q x for x >= 0."""
    program = Program(
        sparse.csc_matrix([[P]]), np.array([q]), sparse.csc_matrix([[-1.0]]), np.zeros(1),
        (Block(Cone.NONNEGATIVE, 1, 1),),
    )  # fmt: skip
    return BenchProblem("toy/one", "toy", program, known)


SOLVED = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, -1.0, 1e-12)
BOWL, UNKNOWN = toy(2.0, -2.0, SOLVED), Known(Verdict.UNKNOWN, Truth.NONE)
"""Least at x = 1, -1."""


@pytest.mark.parametrize(("status", "why"), [("failed", "no answer"), ("refused", "not taken")])
def test_who_gives_nothing_is_not_right(status, why) -> None:
    found = judged(BOWL, Answer(status), 1e-2)
    assert (found.correct, found.why) == (False, why)


def test_an_answer_to_an_infeasible_program_is_wrong_however_near() -> None:
    found = judged(toy(2.0, -2.0, Known(Verdict.INFEASIBLE, Truth.PROOF)), answered(1.0, 0.0), 1e-2)
    assert (found.correct, found.why) == (False, "claims a solution of an infeasible program")


def answered(x: float, z: float | None) -> Answer:
    return Answer("found", np.array([x]), None if z is None else np.array([z]))


def test_the_dual_residual_is_the_larger_of_two() -> None:
    """A dual of -1/2 is moved by that; one of 1/4 pulls on x by that."""
    assert judged(BOWL, answered(1.0, -0.5), 1e-2).absolute_dual_residual == 0.5
    assert judged(BOWL, answered(1.0, 0.25), 1e-2).absolute_dual_residual == 0.25
    assert judged(BOWL, answered(1.0, None), 1e-2).absolute_dual_residual is None


def test_where_no_optimum_is_known_duals_decide() -> None:
    """And where it is known roughly they may prove, but not refute."""
    for known, wrong in ((UNKNOWN, False), (Known(Verdict.SOLVABLE, Truth.PUBLISHED, -0.9, 0.2), None)):
        problem = toy(2.0, -2.0, known)
        assert judged(problem, answered(1.0, 0.0), 1e-2).correct is True
        assert judged(problem, answered(0.9, 0.0), 1e-2).correct is wrong
        assert judged(problem, answered(1.0, None), 1e-2).correct is None


@pytest.mark.parametrize("verdict", [Verdict.SOLVABLE, Verdict.INFEASIBLE])
def test_what_is_known_not_to_be_unbounded_is_not(verdict) -> None:
    found = judged(toy(0.0, -1.0, replace(SOLVED, verdict=verdict)), Answer("unbounded", np.ones(1)), 1e-2)
    assert found.correct is False
    assert f"known to be {verdict.value}" in found.why


def test_a_direction_of_descent_is_measured() -> None:
    """-x falls for ever along 1, and neither along -1 nor along 0; x^2 - x not at all."""
    falling = toy(0.0, -1.0, UNKNOWN)
    assert judged(falling, Answer("unbounded", np.ones(1)), 1e-2).correct is None
    assert judged(falling, Answer("unbounded", np.ones(1)), 1e-2).certificate_residual == 0
    for x in (-1.0, 0.0):
        assert judged(falling, Answer("unbounded", np.array([x])), 1e-2).correct is False
    assert judged(toy(2.0, -1.0, UNKNOWN), Answer("unbounded", np.ones(1)), 1e-2).correct is False
    assert judged(falling, Answer("unbounded"), 1e-2).correct is None


def test_only_answers_at_the_same_settings_come_near() -> None:
    near = {"distance": 1e-9, "primal_residual": 0.0}
    rows = [row(1, "s", **near), row(2, "s", settings="default", **near)]
    rows.append(row(3, "s", status="infeasible", **near))
    found = closeness(outcomes(rows), rows[0].settings)["s"]
    assert found.distances == (1e-9, float("inf"))


def test_parts_of_the_time_are_medians_of_those_that_were_told() -> None:
    times = [
        {"solve_time": t, "setup_time": None, "build_time": s}
        for t, s in ((1.0, 4.0), (3.0, None), (2.0, 2.0))
    ]
    rows = [row(1, "s", repeat=k, **given) for k, given in enumerate(times)]
    assert outcomes(rows)[0].parts == (3.0, None, 2.0)


def test_a_gap_is_told_of_duals_alone_and_numbers_are_finite() -> None:
    """At x = 1/2 without a dual: x'P x + q'x = -1/2."""
    assert judged(BOWL, answered(0.5, 0.0), 1e-2).absolute_gap == 0.5
    assert judged(BOWL, answered(0.5, 0.0), 1e-2).gap == 0.0625
    assert judged(BOWL, answered(0.5, None), 1e-2).gap is None
    far = judged(BOWL, answered(1e200, 0.0), 1e-2)
    assert (far.objective, far.distance, far.correct) == (None, None, False)


def test_a_proof_of_what_nobody_knows_is_not_right_yet() -> None:
    """x >= 0 and x <= -1, by (1, 1)."""
    program = Program(
        sparse.csc_matrix((1, 1)), np.zeros(1), sparse.csc_matrix([[-1.0], [1.0]]), np.array([0.0, -1.0]),
        (Block(Cone.NONNEGATIVE, 1, 2),),
    )  # fmt: skip
    for known, right in ((UNKNOWN, None), (Known(Verdict.INFEASIBLE, Truth.PROOF), True)):
        problem = BenchProblem("toy/two", "toy", program, known)
        found = judged(problem, Answer("infeasible", duals=np.ones(2)), 1e-2)
        assert (found.correct, found.certificate_residual) == (right, 0.0)


def test_shares_begin_with_the_nearest() -> None:
    near = {"primal_residual": 0.0}
    rows = [row(k, "s", distance=d, **near) for k, d in enumerate((1e-9, 1e-7, 1e-3))]
    rows.append(row(9, "s", distance=1e-12, primal_residual=None))
    found = closeness(outcomes(rows), rows[0].settings)["s"]
    assert [found.share(part) for part in (0.0, 0.25, 0.5, 1.0)] == [1e-9, 1e-9, 1e-7, float("inf")]
