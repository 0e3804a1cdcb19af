"""The command line where something is wrong: one message, its status, and nothing written."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import regrasp as rg
from places import ROOT
from processes import hear_interrupts
from regrasp.files import parse_scenario, plan_scenario
from scenarios import PAPER, edited, regrasp
from spoiling import Blank

pytestmark = pytest.mark.end_to_end

EXAMPLES = ROOT / "examples"
PLAN = plan_scenario(parse_scenario(PAPER))


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def run(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """``regrasp ARGUMENTS`` as a person runs it."""
    command = [sys.executable, "-m", "regrasp", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def tampered(folder: Path, change: Callable[[dict[str, list[list[float]]]], None]) -> Path:
    path = folder / "plan.json"
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))
    return path


def test_force_changed_by_a_millionth_is_refused(tmp_path: Path) -> None:
    (tmp_path / "paper.toml").write_text(PAPER)
    assert run("plan", "paper.toml", "-o", "out", "--no-figures", cwd=tmp_path).returncode == 0

    def nudge(data: dict[str, list[list[float]]]) -> None:
        data["start"][0][0] += 1e-6

    tampered(tmp_path / "out", nudge)
    done = run("verify", "out", cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith(
        f"Error: {Path('out') / 'plan.json'}: does not verify:\n  start: not in equilibrium, G f + w_ext is "
    )
    assert "Traceback" not in done.stderr
    assert "verified in exact arithmetic" not in done.stdout


def test_plan_that_does_not_verify_is_not_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    start = rg.GraspState(PLAN.grasp, PLAN.start.load, -PLAN.start.forces)
    monkeypatch.setattr("regrasp.files.plan_scenario", lambda scenario: replace(PLAN, start=start))
    status, out, err = regrasp(capsys, "plan", EXAMPLES / "paper.toml", "-o", tmp_path / "out")
    assert (status, out) == (1, "")
    assert "start: force of P1 pulls: normal component -4.8" in err
    assert names(tmp_path) == []


def test_setpoint_outside_its_cone_is_not_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Slipping(rg.Transition):
        def forces(self, t: object) -> object:
            return super().forces(t) * [[1, 1], [1, 1], [1, -1]]

    slipping = Slipping(PLAN.start, PLAN.end, PLAN.scaling, PLAN.record, PLAN.leaving)
    monkeypatch.setattr("regrasp.files.plan_scenario", lambda scenario: slipping)
    status, out, err = regrasp(capsys, "plan", EXAMPLES / "paper.toml", "-o", tmp_path / "out")
    assert (status, out) == (1, "")
    assert "set-point 0: force of P3 pulls: normal component -3.92\n" in err
    assert err.splitlines()[-1].endswith("more")
    assert len(err.splitlines()) == 12
    assert names(tmp_path) == []


@pytest.mark.parametrize("error", [RuntimeError("no ink"), KeyboardInterrupt()])
@pytest.mark.parametrize("there", [True, False])
def test_failing_figure_leaves_nothing(
    error: BaseException,
    there: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("regrasp.plots.pages.overview.figures", lambda plan, **_: {"overview": Blank(error)})
    if there:
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "plan.json").write_text("older")
    arguments = ("plan", EXAMPLES / "paper.toml", "-o", tmp_path / "out")
    if isinstance(error, KeyboardInterrupt):
        assert regrasp(capsys, *arguments)[::2] == (130, "\nInterrupted.\n")
    else:
        with pytest.raises(RuntimeError, match="no ink"):
            regrasp(capsys, *arguments)
    assert names(tmp_path) == (["out"] if there else [])
    if there:
        assert names(tmp_path / "out") == ["plan.json"]
        assert (tmp_path / "out" / "plan.json").read_text() == "older"


@pytest.mark.skipif(os.name != "posix", reason="sends an interrupt as a terminal does")
def test_interrupt_from_the_terminal_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "long.toml").write_text(edited(("rate = 1000.0", "rate = 1e6")))
    command = [sys.executable, "-m", "regrasp", "plan", "long.toml", "-o", "out", "--no-figures"]
    with subprocess.Popen(
        command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, preexec_fn=hear_interrupts
    ) as process:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob(".regrasp-*/out/.regrasp-*/part.csv")):  # being written
            assert process.poll() is None, process.stderr and process.stderr.read()
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err == "\nInterrupted.\n"
    assert names(tmp_path) == ["long.toml"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["plan", "missing.toml", "-o", "out"], "missing.toml: expected a scenario in TOML, "
                                                "found no such file"),
        (["plan", "folder", "-o", "out"], "folder: expected a scenario in TOML, found a folder"),
        (["verify", "missing.json"], "missing.json: expected a plan in JSON, found no such file"),
        (["verify", "folder"], f"{Path('folder', 'plan.json')}: expected a plan in JSON, found no such file"),
        (["verify", "paper.toml"], "paper.toml: not JSON, or cut short: "
                                   "Expecting value: line 1 column 1 (char 0)"),
    ],
)  # fmt: skip
def test_path_that_leads_nowhere(
    arguments: list[str],
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    Path("paper.toml").write_text(PAPER)
    assert regrasp(capsys, *arguments) == (2, "", f"Error: {message}\n")
    assert names(tmp_path) == ["folder", "paper.toml"]


def test_output_that_is_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "out").write_text("mine")
    status, _, err = regrasp(capsys, "plan", EXAMPLES / "paper.toml", "-o", tmp_path / "out", "--no-figures")
    assert (status, err) == (
        2,
        f"Error: {tmp_path / 'out'}: expected a folder to write into, found a file\n",
    )
    assert (tmp_path / "out").read_text() == "mine"


def test_infeasible_task_says_how_the_object_escapes(tmp_path: Path) -> None:
    (tmp_path / "paper.toml").write_text(edited(('contact = "P3"', 'contact = "P1"')))
    done = run("plan", "paper.toml", "-o", "out", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr == (
        "Error: paper.toml: no forces of P2, P3 inside their friction cones balance "
        "Wrench(force=(-1.5, -3.5), torque=0): "
        "the object escapes by turning counter-clockwise about (4.13793, -5.7931); "
        "with a friction of at least 0.308 at every contact, it would do\n"
    )
    assert names(tmp_path) == ["paper.toml"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["plan", "paper.toml"], "Missing option '-o' / '--output'"),
        (["plan", "-o", "out"], "Missing argument 'SCENARIO'"),
        (["replan"], "No such command 'replan'"),
        (["verify", "--fast", "x"], "No such option"),
    ],
)
def test_wrong_usage(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = regrasp(capsys, *arguments)
    assert (status, out) == (2, "")
    assert words in err


def test_a_rate_too_large_is_refused_before_anything_is_planned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from regrasp import files

    monkeypatch.setattr(files, "plan_scenario", lambda scenario: pytest.fail("it was planned"))
    (tmp_path / "fast.toml").write_text(edited(("rate = 1000.0", "rate = 1e12")))
    status, _, err = regrasp(capsys, "plan", tmp_path / "fast.toml", "-o", tmp_path / "out")
    assert (status, err.count("\n")) == (2, 1)
    assert "at most 1e+08 are made" in err
