"""Solvers of the benchmark and of outside packages: found, asked, survived, judged and timed."""

import sys
import time
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import sparse

from bench_toys import CONE, TOYS, UNKNOWN, by_problem, fake, solvable
from processes import is_running
from regrasp.bench.judging.judgement import judged
from regrasp.bench.judging.residual import row_residual
from regrasp.bench.problems.answer import understood
from regrasp.bench.problems.problem import BenchProblem, Known, Truth, Verdict
from regrasp.bench.problems.settings import SETTINGS, options
from regrasp.bench.reporting.report import write_report
from regrasp.bench.running.jobs import Limits
from regrasp.bench.running.runner import run
from regrasp.bench.running.solvers import Solver, chosen_solvers, installed_solvers
from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program
from regrasp.programs.answer import Answer

pytestmark = pytest.mark.contract

# -- solvers and settings -------------------------------------------------------------------------------


def test_solvers_of_the_house_and_of_outside_packages_are_found(fakes: Path) -> None:
    there = installed_solvers()
    assert there["clarabel"].takes_cones
    assert there["cvxpy:SCS"].takes_cones
    assert not there["osqp"].takes_cones
    assert there["crashes"] == fake("crashes")
    assert there["right-conic"].takes_cones
    assert "fake_solvers" not in sys.modules  # what may crash is not imported here
    assert [solver.name for solver in chosen_solvers(["slow", "osqp", "slow"])] == ["slow", "osqp"]
    with pytest.raises(InvalidInput, match=r"no solver 'gekko' here; there are clarabel, "):
        chosen_solvers(["gekko"])


def test_an_entry_point_may_not_take_the_name_of_another_solver(fakes: Path) -> None:
    file = next(fakes.glob("*.dist-info")) / "entry_points.txt"
    file.write_text("[regrasp.solvers]\nosqp = fake_solvers:right\n")
    with pytest.raises(InvalidInput, match=r"fake_solvers:right announces a solver 'osqp'"):
        installed_solvers()


def test_every_solver_here_can_be_asked_for_every_accuracy() -> None:
    for name in installed_solvers():
        given = [options(name, settings) for settings in SETTINGS]
        assert given[0] == {}  # its own defaults
        assert name == "quadprog" or given[1] != given[2] != given[3]
    assert options("mine", "mid", outside=True) == {"eps_abs": 1e-6, "eps_rel": 0.0}
    with pytest.raises(InvalidInput, match=r"no settings 'best'; there are default, low, mid, high"):
        options("clarabel", "best")
    with pytest.raises(InvalidInput, match=r"run it with default settings"):
        options("unheard-of", "mid")


def test_every_solver_here_is_right_on_a_toy_and_at_high_accuracy_more_so(tmp_path: Path) -> None:
    there = [solver for solver in installed_solvers().values() if not solver.outside]
    rows = run(tmp_path, [toy for toy in TOYS if toy is not UNKNOWN], there, SETTINGS)
    assert {row.solver for row in rows} == {solver.name for solver in there}
    wrong = [(row.solver, row.settings, row.mode, row.problem, row.why) for row in rows if not row.correct]
    # These have no word for a program without solution, or say no more than that it is close to one.
    speechless = {"cvxopt", "ecos", "qoco", "cvxpy:CVXOPT", "cvxpy:ECOS", "cvxpy:QOCO"}
    # These have a word and nothing to show for it.
    proofless = {"daqp", "ecos", "quadprog", *(solver.name for solver in there if ":" in solver.name)}
    excused = {(name, "no answer") for name in speechless}
    excused |= {(name, "claims infeasibility without a certificate") for name in proofless}
    assert [w for w in wrong if w[3] != "toy/negative" or (w[0], w[4]) not in excused] == []
    for row in rows:
        if row.verdict == "solvable":
            assert row.settings != "high" or row.distance < 1e-8
            assert row.total_time >= (row.solve_time or 0.0) >= 0
    assert {row.mode for row in rows if row.problem == "toy/sum/2" and row.solver == "daqp"} == {
        "cold",
        "warm",
    }
    assert {row.solver for row in rows if row.problem == "toy/cone"} == {
        solver.name for solver in there if solver.takes_cones
    }


def test_cones_in_any_order_have_the_same_answer_and_duals() -> None:
    """Solvers want their cones in an order of their own; what comes back is in that of the program."""
    rng = np.random.default_rng(0)
    kinds = [Cone.SECOND_ORDER, Cone.ZERO, Cone.NONNEGATIVE, Cone.SECOND_ORDER, Cone.ZERO, Cone.NONNEGATIVE]
    sizes = [(3, 1), (1, 1), (1, 2), (2, 2), (1, 1), (1, 1)]
    blocks = tuple(Block(cone, *size) for cone, size in zip(kinds, sizes, strict=True))
    slack = np.array([2.0, 0.6, -1.1, 0.0, 0.3, 0.8, 1.0, -0.9, 0.7, 0.1, 0.0, 0.4])
    A = sparse.csc_matrix(rng.normal(size=(12, 5)))
    program = Program(
        sparse.identity(5, format="csc"), rng.normal(size=5), A, A @ rng.normal(size=5) + slack, blocks
    )
    answers = {}
    for solver in installed_solvers().values():
        if solver.takes_cones and solver.updates:
            call = solver.load()
            answers[solver.name] = call.solve(call.layout(program), **options(solver.name, "high"))
    assert len(answers) >= 3
    for answer in answers.values():
        assert answer.x == pytest.approx(answers["clarabel"].x, abs=1e-7)
        assert answer.duals == pytest.approx(answers["clarabel"].duals, abs=1e-6)


def test_an_updated_solver_answers_the_problem_it_was_given_last() -> None:
    updating = [solver for solver in installed_solvers().values() if solver.updates]
    assert len(updating) >= 9
    for solver in updating:
        call, asked = solver.load(), options(solver.name, "high")
        session = solver.session()(call.layout(TOYS[0].program), **asked)
        session.solve()
        for total in (2.0, 50.0, 0.1, 3.0):
            session.update(call.layout(solvable(total).program))
            answer = session.solve()
            assert answer.status == "found", solver.name
            assert answer.x == pytest.approx([total / 2, total / 2], abs=1e-6), solver.name


# -- solvers that misbehave -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "status", "said"),
    [
        ("hangs", "timeout", "no answer within 2 s"),
        ("crashes", "crashed", "SIGABRT"),
        ("leaves", "error", "SystemExit: 3"),
        ("raises", "error", "ValueError: will not"),
        ("eats", "out of memory", "MemoryError"),
        (
            "babbles",
            "error",
            "needs a status among found, infeasible, unbounded, failed, refused, got 'almost'",
        ),
    ],
)
def test_a_solver_that_does_not_come_back_is_a_row_and_the_run_goes_on(
    fakes: Path, tmp_path: Path, name: str, status: str, said: str
) -> None:
    limits = Limits(repeat=2, time_limit=2.0 if name == "hangs" else 60.0)
    rows = run(tmp_path / "out", TOYS[:2], [fake(name), fake("right")], limits=limits)
    bad, good = ([row for row in rows if row.solver == solver] for solver in (name, "right"))
    assert {(row.status, row.correct) for row in bad} == {(status, False)}
    assert {row.total_time for row in bad if row.status == "timeout"} <= {limits.time_limit}
    assert all(said in row.said for row in bad)
    # A solve that was lost is not repeated; one that raised is.
    assert [row.repeat for row in bad] == ([0, 1, 0, 1] if status == "error" else [0, 0])
    assert [(row.status, row.correct, row.repeat) for row in good] == [
        ("found", True, k) for k in (0, 1, 0, 1)
    ]
    again = run(tmp_path / "out", TOYS[:2], [fake(name), fake("right")], limits=limits)
    assert again == rows


def test_a_lie_is_found_out_by_our_own_arithmetic(fakes: Path, tmp_path: Path) -> None:
    toys = TOYS[:4]
    rows = run(tmp_path / "out", toys, [fake("lies"), fake("denies"), fake("right")])
    lies, denies, right = (
        by_problem([r for r in rows if r.solver == s]) for s in ("lies", "denies", "right")
    )
    assert [row.correct for row in lies.values()] == [False] * 4
    assert "breaks the constraints" in lies["toy/sum/1"].why
    assert "a solution of an infeasible program" in lies["toy/negative"].why
    # A verdict can be right though its certificate is not, and then scores nothing.
    assert [row.correct for row in denies.values()] == [False, False, None, None]
    assert "a solvable program is infeasible" in denies["toy/sum/1"].why
    assert "does not prove" in denies["toy/negative"].why
    assert [row.correct for row in right.values()] == [True] * 4
    assert right["toy/negative"].certificate_residual < 1e-6


def test_odd_answers_end_no_run_and_no_report(fakes: Path, tmp_path: Path) -> None:
    rows = run(tmp_path / "out", TOYS[:1], [fake("odd"), fake("chokes")])
    odd, chokes = rows
    assert (odd.correct, odd.solve_time, odd.setup_time, odd.said) == (True, None, None, "a?")
    assert (chokes.status, chokes.said) == ("error", "Unspeakable: an unprintable Unspeakable")
    write_report(tmp_path / "out")


def test_every_call_gets_a_program_of_its_own(fakes: Path, tmp_path: Path) -> None:
    limits = Limits(repeat=3)
    rows = run(tmp_path / "out", TOYS[:1], [fake("remembers"), fake("scribbles")], limits=limits)
    assert [row.said for row in rows if row.solver == "remembers"] == ["found"] * 3
    assert [row.correct for row in rows if row.solver == "scribbles"] == [True] * 3


def test_what_a_solver_started_ends_with_it(fakes: Path, tmp_path: Path) -> None:
    started = time.monotonic()
    (row,) = run(tmp_path / "out", TOYS[:1], [fake("breeds")])
    assert row.status == "crashed"
    assert time.monotonic() - started < 50  # its child sleeps for a minute
    child = int((tmp_path / "pid").read_text())
    for _ in range(100):
        if not is_running(child):
            return
        time.sleep(0.05)
    pytest.fail("its child lives on")


def test_every_row_counts_by_its_own_unit() -> None:
    """Balance of a force of order one and of a torque of order 1e-6, which is not there at all."""
    A = sparse.csc_matrix([[1.0, 1.0], [1e-6, -1e-6], [-1.0, 0.0]])
    blocks = (Block(Cone.ZERO, 2), Block(Cone.NONNEGATIVE, 1))
    program = Program(sparse.csc_matrix((2, 2)), np.array([1.0, 1.0]), A, np.array([2.0, 1e-6, 0.0]), blocks)
    assert row_residual(program, np.array([1.5, 0.5])) < 1e-15
    assert row_residual(program, np.array([1.0, 1.0])) == pytest.approx(0.5)
    assert row_residual(program, np.array([-1.0, 3.0])) == pytest.approx(5 / 4)  # of the torque
    assert np.isnan(row_residual(program, np.array([np.nan, 0.0])))
    toy = BenchProblem("toy/units", "toy", program, Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, 2.0))
    assert judged(toy, Answer("found", np.array([1.0, 1.0])), 1e-2).correct is False
    cone = CONE.program
    assert row_residual(cone, np.array([2.0, 2.0])) == 0.0
    assert row_residual(cone, np.array([1.0, 2.0])) == pytest.approx(1 / 2)


def test_a_feasible_point_that_is_not_the_best_is_wrong() -> None:
    feasible = Answer("found", np.array([1.0, 0.0]))
    assert judged(TOYS[0], feasible, 1e-3).correct is False
    assert "farther than 0.001" in judged(TOYS[0], feasible, 1e-3).why
    assert judged(UNKNOWN, Answer("found", np.array([3.0, 0.0])), 1e-3).correct is None
    near = Answer("found", np.array([0.5, 0.5]) * (1 + 1e-5))
    assert [judged(TOYS[0], near, within).correct for within in (1e-3, 1e-6)] == [True, False]


def test_outside_solvers_get_the_tolerances_and_nothing_for_default(fakes: Path, tmp_path: Path) -> None:
    rows = run(tmp_path / "out", TOYS[:1], [fake("asked")], ("default", "mid"))
    assert [row.said for row in rows] == ["[]", "[('eps_abs', 1e-06), ('eps_rel', 0.0)]"]


def test_an_answer_is_told_in_plain_words_and_numbers() -> None:
    class Word(StrEnum):
        FOUND = "found"

    given = SimpleNamespace(status=Word.FOUND, x=np.ones(2), iterations=float("nan"))
    answer = understood(given, TOYS[0].program)
    assert (type(answer.status), answer.status, answer.iterations) == (str, "found", None)


def test_what_overflows_satisfies_nothing() -> None:
    assert np.isnan(row_residual(TOYS[0].program, np.array([1.7e308, 1.7e308])))


def test_daqp_is_updated_after_a_program_that_it_refused() -> None:
    solver = installed_solvers()["daqp"]
    call = solver.load()
    program = TOYS[0].program
    A = sparse.vstack([program.A[:1], program.A], format="csc")
    blocks = (Block(Cone.ZERO, 1), *program.blocks)
    b = np.concatenate([[3.0], program.b])
    twice = Program(program.P, program.q, A, b, blocks)
    session = solver.session()(call.layout(twice))
    assert session.solve().status != "found"
    session.update(call.layout(replace(twice, b=np.concatenate([program.b[:1], program.b]))))
    assert session.solve().x == pytest.approx([0.5, 0.5])


def test_an_answer_of_another_shape_is_refused() -> None:
    program = TOYS[0].program
    with pytest.raises(InvalidInput, match=r"x of a solver's answer must have 2 entries, got 3"):
        understood(Answer("found", np.ones(3)), program)
    with pytest.raises(InvalidInput, match=r"needs x"):
        understood(Answer("found"), program)
    assert understood(Answer("found", np.ones(2), np.full(3, np.nan)), program).duals is None


def test_a_module_that_cannot_be_imported_is_a_row(tmp_path: Path) -> None:
    missing = Solver("gone", "1", False, entry="no_such_module:solve")
    (row,) = run(tmp_path, TOYS[:1], [missing])
    assert (row.status, row.correct) == ("error", False)
    assert "No module named 'no_such_module'" in row.said


# -- what is timed --------------------------------------------------------------------------------------


def test_the_first_call_warms_up_and_does_not_count(fakes: Path, tmp_path: Path) -> None:
    rows = run(tmp_path / "out", TOYS[:1], [fake("crashes_on_the_second")], limits=Limits(repeat=3))
    # Its third call crashes: one to warm up, one that counts.
    assert [(row.repeat, row.status) for row in rows] == [(0, "found"), (1, "crashed")]


def test_time_is_measured_around_the_call(fakes: Path, tmp_path: Path) -> None:
    (row,) = run(tmp_path / "out", TOYS[:1], [fake("slow")])
    assert row.total_time >= 0.02
    assert row.setup_time is None  # it does not tell
