"""The benchmark's runner: rows that outlive everything, what is run, and the command line."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from math import nan
from pathlib import Path

import pytest

from bench_toys import TOYS, fake, qp, stripped
from processes import hear_interrupts, is_running
from regrasp.bench.problems.problem import Family, Known, Truth, Verdict
from regrasp.bench.running.jobs import Limits, chosen_problems, planned
from regrasp.bench.running.result import Key
from regrasp.bench.running.runner import run
from regrasp.bench.running.solvers import Solver
from regrasp.bench.running.store import ROWS, Store, read_rows
from regrasp.errors import InvalidInput

pytestmark = pytest.mark.end_to_end

# -- durable rows ---------------------------------------------------------------------------------------

RUNNER = """
import sys
from pathlib import Path
import bench_toys as t
from regrasp.bench.running.jobs import Limits
from regrasp.bench.running.runner import run
problems = [t.solvable(float(k)) for k in range(1, 8)] + [t.INFEASIBLE]
solvers = [t.fake("slow"), t.fake("crashes"), t.fake("lies")]
run(Path(sys.argv[1]), problems, solvers, limits=Limits(repeat=2))
"""


def start(fakes: Path, folder: Path) -> subprocess.Popen[bytes]:
    path = os.pathsep.join([str(fakes), *sys.path])
    command = [sys.executable, "-c", RUNNER, str(folder)]
    return subprocess.Popen(command, env=os.environ | {"PYTHONPATH": path})


def test_a_run_killed_ten_times_ends_with_the_rows_of_an_undisturbed_one(fakes: Path, tmp_path: Path) -> None:
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    assert start(fakes, whole).wait() == 0
    expected = read_rows(whole)
    assert len(expected) == 8 * (2 + 1 + 2)
    chance, kept = random.Random(6), []
    for _ in range(10):
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
    assert 0 < kept[4] < len(expected)  # and the kills were in the midst of it
    assert start(fakes, broken).wait() == 0
    assert stripped(read_rows(broken)) == stripped(expected)


def test_no_worker_outlives_a_killed_runner(fakes: Path, tmp_path: Path) -> None:
    note = tmp_path / "pid"
    code = RUNNER.replace('t.fake("slow")', 't.fake("hangs")')
    path = os.pathsep.join([str(fakes), *sys.path])
    command = [sys.executable, "-c", code, str(tmp_path / "out")]
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


@pytest.mark.parametrize("given", [{"repeat": 0}, {"time_limit": 0.0}, {"time_limit": nan}])
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
    done = command(fakes, *asked)
    rows = read_rows(out)
    assert done.returncode == 0
    progress = done.stderr.splitlines()
    assert len(progress) == 10  # a tenth a line where there is no terminal
    assert progress[-1] == f"{len(rows)} of {len(rows)} solves"
    right = [row for row in rows if row.solver == "right"]
    assert all(row.correct for row in right)
    assert f"{len(rows)} solves in {out}: {sum(row.correct is True for row in rows)} right" in done.stdout
    there = f"{len(rows)} solves were there already; another folder makes them anew.\n"
    assert command(fakes, *asked).stdout == there + done.stdout
    assert read_rows(out) == rows


def test_an_interrupt_ends_the_run_at_once_and_leaves_no_row_of_it(fakes: Path, tmp_path: Path) -> None:
    out, note = tmp_path / "out", tmp_path / "pid"
    path = os.pathsep.join([str(fakes), *sys.path])
    line = [sys.executable, "-m", "regrasp", "bench", "--family", "loci", "--most", "4"]
    line += ["--solver", "right", "--solver", "hangs", "-o", str(out)]
    process = subprocess.Popen(
        line, env=os.environ | {"PYTHONPATH": path}, stderr=subprocess.PIPE, text=True,
        preexec_fn=hear_interrupts,
    )  # fmt: skip
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
