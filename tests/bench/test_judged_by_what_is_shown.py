"""The benchmark believes what is shown: proofs, optima to what was asked, and ranks among two or more."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from regrasp.bench.families import FAMILIES
from regrasp.bench.judging.judgement import CERTIFICATE, is_near, is_proof, judged
from regrasp.bench.judging.residual import row_residual
from regrasp.bench.problems.problem import NEAR_ZERO, BenchProblem, Known, Truth, Verdict
from regrasp.bench.reporting.contests import contests
from regrasp.bench.reporting.outcomes import Kind, outcomes
from regrasp.bench.reporting.tables import contest_table, summary_table
from regrasp.programs import Block, Cone, Program
from regrasp.programs.answer import Answer
from test_bench_report import LIMIT, WRONG, row, written

pytestmark = pytest.mark.oracle


@cache
def infeasible():
    return list(FAMILIES["infeasible"].problems())[::4]


@given(st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_who_always_says_infeasible_scores_nothing(seed):
    """Without a certificate, with zeros, with noise: never right, and wrong of a solvable problem."""
    rng = np.random.default_rng(seed)
    problem = infeasible()[seed % len(infeasible())]
    m = problem.program.b.size
    for duals in (None, np.zeros(m), rng.normal(size=m), np.ones(m), 1e9 * rng.random(m)):
        assert judged(problem, Answer("infeasible", duals=duals), 1e-2).correct is None
    solvable = next(FAMILIES["states"].problems())
    assert judged(solvable, Answer("infeasible", duals=rng.normal(size=7)), 1e-2).correct is False


def strip(e):
    """x <= 1 and (1 + e) x >= 2, at z = (1, 1): a residual of 3 e / (2 + e)."""
    A = sparse.csc_matrix([[1.0], [-1.0 - e]])
    program = Program(
        sparse.csc_matrix((1, 1)), np.zeros(1), A, np.array([1.0, -2.0]), (Block(Cone.NONNEGATIVE, 1, 2),)
    )
    return BenchProblem("toy/strip", "toy", program, Known(Verdict.INFEASIBLE, Truth.PROOF))


@pytest.mark.parametrize(("share", "right"), [(0.9, True), (1.1, None)])
def test_a_certificate_proves_up_to_its_limit(share, right):
    assert CERTIFICATE == 1e-3
    e = share * CERTIFICATE * 2 / 3
    for scale in (1e-9, 1.0, 1e9):
        given = judged(strip(e), Answer("infeasible", duals=scale * np.ones(2)), 1e-2)
        assert given.correct is right
        assert given.certificate_residual == pytest.approx(3 * e / (2 + e))
        assert ("does not prove" in given.why) is (right is None)
    assert is_proof(CERTIFICATE)
    assert not is_proof(np.nextafter(CERTIFICATE, 1))
    assert not is_proof(None)


def test_noise_in_a_certificate_costs_nothing_and_is_no_proof():
    problem = strip(0.0)
    A = sparse.csc_matrix([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
    program = Program(
        sparse.csc_matrix((2, 2)),
        np.zeros(2),
        A,
        np.array([1.0, -2.0, 1.0]),
        (Block(Cone.NONNEGATIVE, 1, 3),),
    )
    wider = replace(problem, program=program)
    assert judged(wider, Answer("infeasible", duals=np.array([1.0, 1.0, 1e-9])), 1e-2).correct is True
    assert judged(wider, Answer("infeasible", duals=np.array([1.0, 2.0, 3.0])), 1e-2).correct is None


@given(
    st.floats(-6, 6), st.sampled_from([-1.0, 1.0]), st.sampled_from([0.0, 1.0]), st.sampled_from([1e-2, 1e-5])
)
@settings(max_examples=40, deadline=None)
def test_errors_are_relative_to_the_optimum(size, sign, scale, within):
    """An objective off by 1.7 times what is allowed is not right, beside a scale of one or none."""
    optimum = sign * 10.0 ** (size if scale == 0 else max(size, -3.0))
    known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, optimum, 1e-12, scale)
    for off, right in ((0.0, True), (0.99, True), (1.01, False), (1.7, False)):
        for way in (-1, 1):
            distance = known.distance(optimum * (1 + way * off * within))
            assert is_near(distance, known, within) is right


def test_an_optimum_of_zero_has_the_scale_of_its_problem():
    known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, 0.0, 1e-12, 2.0)
    assert NEAR_ZERO == 1e-3
    assert known.distance(2e-5) == pytest.approx(1e-2)
    assert Known(Verdict.UNKNOWN, Truth.NONE).distance(1.0) is None


def test_what_is_known_roughly_is_not_told_apart():
    known = Known(Verdict.SOLVABLE, Truth.PUBLISHED, 1.0, 1e-4)
    assert is_near(1e-6, known, 1e-6) is True
    for distance, right in ((1.1e-6, None), (1.009e-4, None), (1.02e-4, False)):
        assert is_near(distance, known, 1e-6) is right
    assert is_near(1.02e-2, Known(Verdict.SOLVABLE, Truth.PUBLISHED, 1.0, 1e-9), 1e-2) is False


def test_where_the_optimum_is_known_roughly_duals_may_prove_the_answer():
    """min 1/2 x^2 with x = 1: 0.5, printed as 0.5001."""
    program = Program(
        sparse.csc_matrix([[1.0]]),
        np.zeros(1),
        sparse.csc_matrix([[1.0]]),
        np.ones(1),
        (Block(Cone.ZERO, 1),),
    )
    known = Known(Verdict.SOLVABLE, Truth.PUBLISHED, 0.5001, 1e-3)
    problem = BenchProblem("toy/one", "toy", program, known)
    for duals, right in ((np.array([-1.0]), True), (np.array([-0.99]), None), (None, None)):
        assert judged(problem, Answer("found", np.ones(1), duals), 1e-6).correct is right


def test_far_unknowns_hide_no_broken_row():
    """x = 0 and x = 1 beside y = 1e8."""
    A = sparse.csc_matrix([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    program = Program(
        sparse.csc_matrix((2, 2)), np.zeros(2), A, np.array([0.0, 1.0, 1e8]), (Block(Cone.ZERO, 1, 3),)
    )
    for x in (0.0, 0.5, 1.0):
        assert row_residual(program, np.array([x, 1e8])) > 0.3
    assert row_residual(program, np.array([1e-9, 1e8 * (1 + 1e-9)])) == pytest.approx(0.5, rel=1e-6)


# -- contests ------------------------------------------------------------------------------------------------


def test_families_of_unequal_size_weigh_alike():
    rows = [row(n, s) for s in ("one", "two") for n in range(9)]
    rows += [row(9, "one", family="b", **WRONG), row(9, "two", family="b")]
    (contest,) = contests(outcomes(rows))
    assert (contest.by_family("one"), contest.by_family("two")) == (0.5, 1.0)
    assert contest.count("one", Kind.RIGHT) == 9


def test_right_but_late_is_charged_the_limit():
    (late,) = outcomes([row(1, "s", 3 * LIMIT)])
    assert (late.kind, late.time, late.charged) == (Kind.RIGHT, 3 * LIMIT, LIMIT)
    (early,) = outcomes([row(1, "s", LIMIT / 2)])
    assert early.charged == LIMIT / 2


def test_one_solver_alone_has_no_rank(tmp_path):
    (alone,) = contests(outcomes([row(n, "s") for n in range(3)]))
    assert alone.is_alone
    assert summary_table([alone]).rows == []
    assert not {"fastest", "within 2x", "within 10x", "mean, shared"} & set(contest_table(alone).header)
    files = {path.name for path in written(tmp_path / "run", [row(n, "s") for n in range(3)])}
    assert not any(name.startswith("profile") for name in files)
    text = (tmp_path / "run" / "report.md").read_text(encoding="utf-8")
    assert "One solver alone" in text
    assert "## In short" not in text
    (two,) = contests(outcomes([row(n, s) for s in "ab" for n in range(3)]))
    assert not two.is_alone
    assert {"fastest", "mean, shared"} <= set(contest_table(two).header)


def test_nobody_is_first_where_nobody_is_right():
    (contest,) = contests(outcomes([row(n, s, **WRONG) for s in "ab" for n in range(3)]))
    (line,) = summary_table([contest]).rows
    assert line[1:] == ["–", "0 of 3", "–", "–", "–"]


def test_claims_that_show_nothing_have_a_column():
    rows = [row(n, s, correct=None if s == "a" else True, status="infeasible", verdict="infeasible")
            for s in "ab" for n in range(2)]  # fmt: skip
    (contest,) = contests(outcomes(rows))
    assert contest.ranking == ["b", "a"]
    table = contest_table(contest)
    cells = dict(zip(table.header, table.rows[1], strict=True))
    assert (cells["right"], cells["not shown"], cells["wrong"], cells["verdict only"]) == (
        "0.0 %",
        "2",
        "0",
        "100.0 %",
    )
