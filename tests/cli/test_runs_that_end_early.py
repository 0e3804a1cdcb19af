"""Runs that are interrupted, killed, cut off from their reader or out of disk leave one line, and no file."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from processes import hear_interrupts
from regrasp.cli import statuses
from scenarios import PAPER, edited, regrasp

pytestmark = pytest.mark.end_to_end

posix = pytest.mark.skipif(os.name != "posix", reason="sends signals as POSIX systems do")


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "regrasp", *map(str, arguments)]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("paper.toml").write_text(PAPER)
    return tmp_path


def left(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob(".regrasp-*")]


def started(folder: Path, *arguments: object) -> subprocess.Popen[str]:
    """A run of many set-points, when it has begun to write."""
    (folder / "long.toml").write_text(edited(("rate = 1000.0", "rate = 3e5")))
    process = subprocess.Popen(
        command("plan", "long.toml", "-o", "out", "--no-figures", *arguments),
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    deadline = time.monotonic() + 120
    while not left(folder):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return process


@posix
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_asked_to_end_it_leaves_nothing(name: str, tmp_path: Path) -> None:
    number = getattr(signal, name)
    with started(tmp_path) as process:
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (128 + number, "Ended.\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["long.toml"]


@posix
def test_a_search_that_answers_interrupts_by_its_best_hears_who_asks_it_to_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It took SIGTERM for an interrupt, went on to write files, and no second SIGTERM was heard."""
    from regrasp.planning.placement import search

    def asked_to_end(*_: object, **__: object) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(search.Search, "norm_at", asked_to_end)
    assert regrasp(capsys, "new", "grasp", tmp_path / "grasp.toml")[0] == 0
    code, _, err = regrasp(capsys, "plan", tmp_path / "grasp.toml", "-o", tmp_path / "out", "--no-figures")
    assert (code, err) == (statuses.TERMINATED, "Ended.\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["grasp.toml"]


def test_a_search_that_is_interrupted_before_it_found_anything_says_its_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from regrasp.planning.placement import search

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    for name in ("goes_on", "norm_at"):
        monkeypatch.setattr(search.Search, name, interrupted)
    assert regrasp(capsys, "new", "grasp", tmp_path / "grasp.toml")[0] == 0
    code, _, err = regrasp(capsys, "plan", tmp_path / "grasp.toml", "-o", tmp_path / "out", "--no-figures")
    assert code == statuses.INTERRUPTED
    assert err.startswith("\nInterrupted: ")
    assert "no placement was found that holds the loads" in err
    assert len(err.splitlines()) == 2


@posix
def test_a_search_that_is_interrupted_writes_the_best_so_far_and_no_more_than_that(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Regions and maps took half a minute more, for who had asked it to end."""
    from regrasp.cli import choosing

    def interrupted(word: str, bound: float, best: float) -> str:
        if math.isfinite(best):
            os.kill(os.getpid(), signal.SIGINT)
        return ""

    monkeypatch.setattr(choosing, "_known", interrupted)
    before = signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # ignored where tests run in the background
    try:
        assert regrasp(capsys, "new", "grasp", tmp_path / "grasp.toml")[0] == 0
        code, out, err = regrasp(
            capsys, "plan", tmp_path / "grasp.toml", "-o", tmp_path / "out", "--no-figures"
        )
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert (code, err) == (0, "")
    assert "Interrupted: the grasp is written" in out
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["plan.json"]


def test_an_interrupt_after_the_search_leaves_the_grasp(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It was chosen, proven and printed, and then nothing was written."""
    from regrasp import plots

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(plots, "plot_contact_regions", interrupted)
    assert regrasp(capsys, "new", "grasp", tmp_path / "grasp.toml")[0] == 0
    code, out, err = regrasp(capsys, "plan", tmp_path / "grasp.toml", "-o", tmp_path / "out")
    assert (code, err) == (0, "")
    assert "Interrupted: the grasp is written" in out
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"plan.json", "regions.json", "grasp.png"}


@posix
@pytest.mark.parametrize("delay", [0.03, 0.06, 0.1, 0.15, 0.25, 0.4, 0.7])
def test_an_interrupt_at_any_moment_is_one_line(delay: float, tmp_path: Path) -> None:
    """While modules are imported, too; before our first line Python says what it likes."""
    with subprocess.Popen(
        command("demo", "--json", "-o", "out"), cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, preexec_fn=hear_interrupts,
    ) as process:  # fmt: skip
        time.sleep(delay)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    early = "regrasp" not in err or ("in main" not in err and err.rstrip().endswith("KeyboardInterrupt"))
    if early and process.returncode in (1, -signal.SIGINT):
        return  # Python itself had not come to our first line, if to our modules
    if "Remainder of file ignored" in err:
        return  # Python took it for an error in a file that says where modules are, and went on
    if process.returncode == 0 and "in: <function _get_module_lock" in err:
        return  # a callback of Python's imports heard it, and what is raised there goes no further
    assert (process.returncode, err.strip()) in [(130, "Interrupted."), (0, "")]
    assert json.loads(out)["exit"] == process.returncode
    assert not left(tmp_path)


@posix
@pytest.mark.parametrize("there", [False, True])
def test_what_a_killed_run_left_is_cleared_by_the_next(
    there: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if there:
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "notes.txt").write_text("mine")
    with started(tmp_path) as process:
        process.kill()
        process.communicate(timeout=60)
    assert left(tmp_path)
    (tmp_path / "paper.toml").write_text(PAPER)
    arguments = ("plan", tmp_path / "paper.toml", "-o", tmp_path / "out", "--no-figures")
    assert regrasp(capsys, *arguments)[0] == 0
    assert not left(tmp_path)
    assert {"plan.json", "setpoints.csv"} <= {path.name for path in (tmp_path / "out").iterdir()}


@posix
def test_a_run_that_writes_is_not_cleared_by_another(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two runs into one folder: each writes its own whole, the later one stays."""
    with started(tmp_path) as process:
        (tmp_path / "paper.toml").write_text(PAPER)
        other = ("plan", tmp_path / "paper.toml", "-o", tmp_path / "out", "--no-figures")
        assert regrasp(capsys, *other)[0] == 0
        assert (tmp_path / "out" / "setpoints.csv").read_text().count("\n") == 1002
        _, err = process.communicate(timeout=300)
        assert (process.returncode, err) == (0, "")
    assert (tmp_path / "out" / "setpoints.csv").read_text().count("\n") == 300_002
    assert not left(tmp_path)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize(
    "arguments", [("schema",), ("--help",), ("verify", "out"), ("verify", "out", "--json")]
)
def test_full_output_is_one_line(arguments: tuple[str, ...], here: Path) -> None:
    done = subprocess.run(
        command("plan", "paper.toml", "-o", "out", "--no-figures"), capture_output=True, check=True
    )
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            command(*arguments), stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert (done.returncode, done.stderr) == (
        2,
        "Error: output cannot be written: No space left on device\n",
    )


@posix
def test_reader_that_went_away_is_no_error(here: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(command("schema"), stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert (done.returncode, done.stderr) == (statuses.PIPE_CLOSED, "")
