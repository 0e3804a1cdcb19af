"""The benchmark's runner, with solvers of an outside package that hang, crash, lie and are slow."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse

from regrasp.bench.answer import Answer, understood
from regrasp.bench.judgement import judged
from regrasp.bench.problem import BenchProblem, Family, Known, Truth, Verdict
from regrasp.bench.report import write_report
from regrasp.bench.residual import row_residual
from regrasp.bench.rows import TIMES, Key, Row
from regrasp.bench.runner import Limits, chosen_problems, planned, run
from regrasp.bench.settings import SETTINGS, options
from regrasp.bench.solvers import Solver, chosen_solvers, installed_solvers
from regrasp.bench.store import ROWS, Store, read_rows
from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program

MODULE = """
import os, sys, time
from pathlib import Path
from types import SimpleNamespace
import numpy as np

def right(program, **settings):
    from regrasp.bench.calls.clarabel_call import Session, layout
    found = Session(layout(program), tol_feas=1e-9).solve()
    return SimpleNamespace(status=found.status, x=found.x, duals=found.duals, iterations=found.iterations)

def slow(program, **settings):
    time.sleep(0.02)
    return right(program)

def hangs(program, **settings):
    Path(os.environ.get("FAKE_PID", os.devnull)).write_text(str(os.getpid()))
    while True:
        time.sleep(1)

def crashes(program, **settings):
    print("noise " * 1000)
    os.abort()

def leaves(program, **settings):
    sys.exit(3)

def raises(program, **settings):
    raise ValueError("will not")

def eats(program, **settings):
    return np.ones(10**12)

def babbles(program, **settings):
    return SimpleNamespace(status="almost", x=None)

def odd(program, **settings):
    given = right(program)
    times = {"solve_time": float("nan"), "setup_time": -5.0}
    return SimpleNamespace(status="found", x=given.x, said="a\\ud800", **times)

class Unspeakable(Exception):
    def __str__(self):
        raise RuntimeError

def chokes(program, **settings):
    raise Unspeakable

SEEN = {}
def remembers(program, **settings):
    if id(program) not in SEEN:
        SEEN[id(program)] = right(program)
        SEEN.setdefault("kept", []).append(program)  # or its place in memory is taken again
        return SEEN[id(program)]
    return SimpleNamespace(status="failed", x=None, said="known")

def scribbles(program, **settings):
    given = right(program)
    program.q[:] = 1e9
    program.b[:] = 1e9
    return given

def breeds(program, **settings):
    child = os.fork()
    if child == 0:
        time.sleep(60)
        os._exit(0)
    Path(os.environ["FAKE_PID"]).write_text(str(child))
    os.abort()

def asked(program, **settings):
    return SimpleNamespace(status="failed", x=None, said=repr(sorted(settings.items())))

def lies(program, **settings):
    return SimpleNamespace(status="found", x=np.ones(program.q.size) / 3, duals=None)

def denies(program, **settings):
    return SimpleNamespace(status="infeasible", x=None, duals=np.arange(1.0, 1 + program.b.size))

def crashes_on_the_second(program, **settings):
    mark = Path(os.environ["FAKE_PID"])
    calls = len(mark.read_text()) if mark.exists() else 0
    mark.write_text("x" * (calls + 1))
    if calls == 2:
        os.abort()
    return right(program)
"""
NAMES = MODULE.replace("(", " ").split()
FAKES = [after for word, after in pairwise(NAMES) if word == "def" and not after.startswith("_")]


def qp(name: str, total: float, known: Known, follows: str | None = None) -> BenchProblem:
    """Minimise 1/2 |x|^2 with x1 + x2 = total and x >= 0."""
    A = sparse.csc_matrix([[1.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    blocks = (Block(Cone.ZERO, 1), Block(Cone.NONNEGATIVE, 2))
    b = np.array([total, 0.0, 0.0])
    program = Program(sparse.identity(2, format="csc"), np.zeros(2), A, b, blocks)
    return BenchProblem(name, "toy", program, known, follows)


def solvable(total: float, follows: str | None = None) -> BenchProblem:
    known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, total**2 / 4)
    return qp(f"toy/sum/{total:g}", total, known, follows)


INFEASIBLE = qp("toy/negative", -1.0, Known(Verdict.INFEASIBLE, Truth.PROOF))
UNKNOWN = qp("toy/unknown", 3.0, Known(Verdict.UNKNOWN, Truth.NONE))
CONE = BenchProblem(
    "toy/cone",
    "toy",
    Program(
        sparse.csc_matrix((2, 2)),
        np.array([1.0, 0.0]),
        sparse.csc_matrix([[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]),
        np.array([2.0, 0.0, 0.0]),
        (Block(Cone.ZERO, 1), Block(Cone.SECOND_ORDER, 2)),
    ),
    Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, 2.0),
)
TOYS = [solvable(1.0), solvable(2.0, "toy/sum/1"), INFEASIBLE, UNKNOWN, CONE]


@pytest.fixture
def fakes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An installed package that announces the solvers of ``MODULE``, in the way pip leaves one."""
    site = tmp_path / "site"
    info = site / "fake_solvers-1.2.dist-info"
    info.mkdir(parents=True)
    (site / "fake_solvers.py").write_text(MODULE)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: fake-solvers\nVersion: 1.2\n")
    lines = [f"{name} = fake_solvers:{name}" for name in FAKES]
    conic = "[regrasp.solvers.conic]\nright-conic = fake_solvers:right\n"
    (info / "entry_points.txt").write_text("\n".join(["[regrasp.solvers]", *lines, conic]))
    monkeypatch.syspath_prepend(str(site))
    monkeypatch.setenv("FAKE_PID", str(tmp_path / "pid"))
    yield site
    sys.modules.pop("fake_solvers", None)


def fake(name: str, *, cones: bool = False) -> Solver:
    return Solver(name, "1.2", cones, entry=f"fake_solvers:{name}")


def by_problem(rows: list[Row]) -> dict[str, Row]:
    return {row.problem: row for row in rows}


def stripped(rows: list[Row]) -> list[dict[str, object]]:
    """Rows without what differs from run to run."""
    return [{name: value for name, value in asdict(row).items() if name not in TIMES} for row in rows]


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
    assert [w for w in wrong if w[0] not in speechless or w[3:] != ("toy/negative", "no answer")] == []
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
    # A verdict can be right though its certificate is not; of what nobody knows it says nothing.
    assert [row.correct for row in denies.values()] == [False, False, True, None]
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
    (row,) = run(tmp_path / "out", TOYS[:1], [fake("breeds")])
    assert row.status == "crashed"
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


# -- durable rows ---------------------------------------------------------------------------------------

RUNNER = """
import sys
from pathlib import Path
import test_bench_runner as t
from regrasp.bench.runner import Limits, run
problems = [t.solvable(float(k)) for k in range(1, 8)] + [t.INFEASIBLE]
solvers = [t.fake("slow"), t.fake("crashes"), t.fake("lies")]
run(Path(sys.argv[1]), problems, solvers, limits=Limits(repeat=2, jobs=int(sys.argv[2])))
"""


def start(fakes: Path, folder: Path, jobs: int = 1) -> subprocess.Popen[bytes]:
    path = os.pathsep.join([str(fakes), str(Path(__file__).parent), *sys.path])
    command = [sys.executable, "-c", RUNNER, str(folder), str(jobs)]
    return subprocess.Popen(command, env=os.environ | {"PYTHONPATH": path})


def test_a_run_killed_twenty_times_ends_with_the_rows_of_an_undisturbed_one(
    fakes: Path, tmp_path: Path
) -> None:
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    assert start(fakes, whole).wait() == 0
    expected = read_rows(whole)
    assert len(expected) == 8 * (2 + 1 + 2)
    chance, kept = random.Random(6), []
    for _ in range(20):
        process = start(fakes, broken)
        rows = broken / ROWS
        before = rows.stat().st_size if rows.exists() else 0
        # Some at any moment of the start, most once rows are being written.
        if chance.random() < 0.8:
            while process.poll() is None and (not rows.exists() or rows.stat().st_size <= before):
                time.sleep(0.001)
        time.sleep(chance.uniform(0, 0.1))
        process.kill()
        process.wait()
        kept.append(len(read_rows(broken)) if rows.exists() else 0)
    assert kept == sorted(kept)  # nothing lost
    assert 0 < kept[9] < len(expected)  # and the kills were in the midst of it
    assert start(fakes, broken).wait() == 0
    assert stripped(read_rows(broken)) == stripped(expected)


def test_rows_do_not_depend_on_the_number_of_jobs(fakes: Path, tmp_path: Path) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    assert start(fakes, one).wait() == start(fakes, two, 2).wait() == 0
    assert sorted(map(str, stripped(read_rows(one)))) == sorted(map(str, stripped(read_rows(two))))


def test_no_worker_outlives_a_killed_runner(fakes: Path, tmp_path: Path) -> None:
    note = tmp_path / "pid"
    code = RUNNER.replace('t.fake("slow")', 't.fake("hangs")')
    path = os.pathsep.join([str(fakes), str(Path(__file__).parent), *sys.path])
    command = [sys.executable, "-c", code, str(tmp_path / "out"), "1"]
    process = subprocess.Popen(command, env=os.environ | {"PYTHONPATH": path})
    while not note.exists() or not note.read_text():
        assert process.poll() is None
        time.sleep(0.01)
    worker = int(note.read_text())
    process.kill()
    process.wait()
    for _ in range(500):
        if not is_running(worker):
            return
        time.sleep(0.01)
    os.kill(worker, signal.SIGKILL)
    pytest.fail("the worker went on")


def is_running(pid: int) -> bool:
    """Whether a process runs; one that has ended and waits to be cleared away does not."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"


def test_a_half_written_line_is_dropped_wherever_it_was_cut(fakes: Path, tmp_path: Path) -> None:
    solvers = [fake("right")]
    rows = run(tmp_path, TOYS[:2], solvers)
    whole = (tmp_path / ROWS).read_bytes()
    first = whole.index(b"\n") + 1
    for cut in (first + 1, first + 40, len(whole) - 1):
        (tmp_path / ROWS).write_bytes(whole[:cut])
        assert read_rows(tmp_path) == rows[:1]
        assert stripped(run(tmp_path, TOYS[:2], solvers)) == stripped(rows)
        assert len((tmp_path / ROWS).read_bytes().splitlines()) == 2


def test_a_broken_line_in_the_midst_is_an_error(fakes: Path, tmp_path: Path) -> None:
    run(tmp_path, TOYS[:2], [fake("right")])
    path = tmp_path / ROWS
    path.write_text("{}\n" + path.read_text())
    with pytest.raises(InvalidInput, match=r"rows.jsonl, line 1: not a row of results"):
        run(tmp_path, TOYS[:2], [fake("right")])
    with pytest.raises(InvalidInput, match=r"has no rows.jsonl"):
        read_rows(tmp_path / "nowhere")


def test_rows_of_another_version_or_limit_are_not_mixed(fakes: Path, tmp_path: Path) -> None:
    run(tmp_path, TOYS[:1], [fake("right")])
    with pytest.raises(InvalidInput, match=r"version of right: 1.2 .* there, 1.3 .* now\); give another"):
        run(tmp_path, TOYS[:1], [Solver("right", "1.3", False, entry="fake_solvers:right")])
    with pytest.raises(InvalidInput, match=r"\(time_limit: 60.0 there, 1.0 now\); give another folder"):
        run(tmp_path, TOYS[:1], [fake("right")], limits=Limits(time_limit=1.0))
    more = run(tmp_path, TOYS[:1], [fake("lies")], limits=Limits(repeat=2))
    assert [(row.solver, row.repeat) for row in more] == [("right", 0), ("lies", 0), ("lies", 1)]
    assert json.loads((tmp_path / "run.json").read_text())["solvers"] == {
        "right": "1.2 (fake_solvers:right)",
        "lies": "1.2 (fake_solvers:lies)",
    }
    with pytest.raises(InvalidInput, match=r"version of right: 1.2 \(fake_solvers:right\) there"):
        run(tmp_path, TOYS[:1], [Solver("right", "1.2", False, entry="fake_solvers:slow")])
    other = qp(TOYS[0].name, 1.0, Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, 0.3))
    with pytest.raises(InvalidInput, match=r"rows of another problem that is called toy/sum/1 too"):
        run(tmp_path, [other], [fake("right")])
    (tmp_path / "run.json").write_text("[]")
    with pytest.raises(InvalidInput, match=r"run.json does not say where the rows come from"):
        run(tmp_path, TOYS[:1], [fake("right")])
    (tmp_path / "run.json").unlink()
    with pytest.raises(InvalidInput, match=r"has rows but no run.json"):
        run(tmp_path, TOYS[:1], [fake("right")])


def test_what_cannot_be_a_folder_of_results_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(InvalidInput, match=r"must be a folder to write in"):
            run(folder, TOYS[:1], [])


def test_rows_that_say_nothing_or_stand_twice_are_named(fakes: Path, tmp_path: Path) -> None:
    run(tmp_path, TOYS[:1], [fake("right")])
    line = (tmp_path / ROWS).read_text()
    (tmp_path / ROWS).write_text(line * 2)
    with pytest.raises(InvalidInput, match=r"line 2: the same solve as line 1; take one of them out"):
        read_rows(tmp_path)
    for name, word in (("status", "weird"), ("settings", "ultra"), ("mode", "tepid")):
        (tmp_path / ROWS).write_text(json.dumps(json.loads(line) | {name: word}) + "\n")
        with pytest.raises(
            InvalidInput, match=rf"line 1: not a row of results: {name} must be one of .*{word}"
        ):
            read_rows(tmp_path)


def test_two_runs_cannot_fill_one_folder(fakes: Path, tmp_path: Path) -> None:
    with (
        Store(tmp_path, {"solvers": {}}),
        pytest.raises(InvalidInput, match=r"another run is filling"),
    ):
        run(tmp_path, TOYS[:1], [fake("right")])


# -- what is run ----------------------------------------------------------------------------------------


def test_families_and_sizes_are_chosen_by_name() -> None:
    toy = Family("toy", "here", "1/2 |x|^2", lambda: iter(TOYS))
    assert chosen_problems({"toy": toy}, []) == TOYS
    with pytest.raises(InvalidInput, match=r"no family 'toys'; there are toy"):
        chosen_problems({"toy": toy}, ["toys"])
    with pytest.raises(InvalidInput, match=r"no problem has at most 1 unknowns; the smallest has 2"):
        chosen_problems({"toy": toy}, ["toy"], 1)


def test_what_is_planned_has_one_key_each() -> None:
    solvers = [Solver("clarabel", "1", True, updates=True), Solver("daqp", "1", False)]
    jobs = planned(TOYS, solvers, ("default", "high"))
    keys = {job.key(0) for job in jobs}
    assert len(keys) == len(jobs) == 2 * (5 + 1) + 2 * 4
    assert Key("toy/sum/2", "clarabel", "high", "warm", 0) in keys
    with pytest.raises(InvalidInput, match=r"two problems of the benchmark have one name"):
        planned([*TOYS, TOYS[0]], solvers, ("default",))


@pytest.mark.parametrize("given", [{"repeat": 0}, {"jobs": 0}, {"time_limit": 0.0}, {"time_limit": np.nan}])
def test_limits_that_make_no_sense_are_refused(given: dict[str, float]) -> None:
    with pytest.raises(InvalidInput, match=r"must be"):
        Limits(**given)  # type: ignore[arg-type]


# -- the command line -----------------------------------------------------------------------------------


def command(fakes: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join([str(fakes), *sys.path])
    line = [sys.executable, "-m", "regrasp", "bench", *map(str, arguments)]
    return subprocess.run(
        line, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, check=False
    )


def test_the_command_runs_resumes_and_says_what_came_of_it(fakes: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    asked = ["--family", "loci", "--most", "4", "--solver", "right", "--solver", "lies", "-o", out]
    done = command(fakes, *asked, "--jobs", "2")
    rows = read_rows(out)
    assert done.returncode == 0
    warning, *progress = done.stderr.splitlines()
    assert warning == "Warning: 2 solves at once disturb one another's timing."
    assert len(progress) == 10  # a tenth a line where there is no terminal
    assert progress[-1] == f"{len(rows)} of {len(rows)} solves"
    right = [row for row in rows if row.solver == "right"]
    assert all(row.correct for row in right)
    assert f"{len(rows)} solves in {out}: {sum(row.correct is True for row in rows)} right" in done.stdout
    assert command(fakes, *asked, "--jobs", "2").stdout == done.stdout
    assert read_rows(out) == rows


def test_an_interrupt_ends_the_run_at_once_and_leaves_no_row_of_it(fakes: Path, tmp_path: Path) -> None:
    out, note = tmp_path / "out", tmp_path / "pid"
    path = os.pathsep.join([str(fakes), *sys.path])
    line = [sys.executable, "-m", "regrasp", "bench", "--family", "loci", "--most", "4"]
    line += ["--solver", "right", "--solver", "hangs", "-o", str(out)]
    process = subprocess.Popen(line, env=os.environ | {"PYTHONPATH": path}, stderr=subprocess.PIPE, text=True)
    while not note.exists() or not note.read_text():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=20)  # the time limit of the solve that hangs is 60 s
    assert (process.returncode, said.splitlines()[-1]) == (130, "Interrupted.")
    rows = read_rows(out)
    assert rows
    assert {row.solver for row in rows} == {"right"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "out", "--family", "paper"], "no family 'paper'; there are states, loci"),
        (["-o", "out", "--family", "loci", "--solver", "simplex"], "no solver 'simplex' here; there are"),
        (["--family", "loci"], "the results need a folder: -o DIR"),
        (["-o", "out", "--time-limit", "0"], "the time limit must be a positive number of seconds, got 0"),
    ],
)
def test_what_does_not_exist_is_named_and_what_does(
    fakes: Path, tmp_path: Path, arguments: list[str], message: str
) -> None:
    done = command(fakes, *[tmp_path / word if word == "out" else word for word in arguments])
    assert done.returncode == 2
    assert message in done.stderr
    assert not (tmp_path / "out").exists()
