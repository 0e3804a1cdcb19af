"""How a run ends: exit statuses, JSON for programs, signals, pipes and full disks."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from places import ROOT
from processes import hear_interrupts
from regrasp.cli import statuses
from regrasp.cli.speech import plain
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


def as_json(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, dict[str, Any], str]:
    status, out, err = regrasp(capsys, *arguments, "--json")
    assert out.count("\n") == 1
    facts = json.loads(out, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))
    assert facts["exit"] == status
    return status, facts, err


# -- JSON -----------------------------------------------------------------------------------------------


def test_plan_and_verify_in_json(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status, facts, err = as_json(capsys, "plan", "paper.toml", "-o", "out", "--no-figures")
    assert (status, facts["status"], err) == (0, "verified", "")
    assert facts["plan"]["kind"] == "removal"
    assert facts["plan"]["contacts"] == ["P1", "P2", "P3"]
    assert facts["setpoints"] == 1001
    assert facts["verification"]["violations"] == []
    assert 0 < facts["verification"]["least_angle"] < 0.3
    assert [Path(path).name for path in facts["wrote"]] == ["plan.json", "setpoints.csv"]
    assert as_json(capsys, "verify", "out")[:2] == (0, {k: v for k, v in facts.items() if k != "wrote"})


def test_plan_that_does_not_verify_in_json(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert regrasp(capsys, "plan", "paper.toml", "-o", "out", "--no-figures")[0] == 0
    path = here / "out" / "plan.json"
    data = json.loads(path.read_text())
    data["start"][0][0] += 1e-6
    path.write_text(json.dumps(data))
    status, facts, err = as_json(capsys, "verify", "out")
    assert (status, facts["status"]) == (1, "not verified")
    assert [violation[:6] for violation in facts["violations"]] == ["start:"]
    assert err.startswith("Error: ")
    assert facts["message"] in err


def test_infeasible_in_json(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "paper.toml").write_text(edited(('contact = "P3"', 'contact = "P1"')))
    status, facts, err = as_json(capsys, "plan", "paper.toml", "-o", "out")
    assert (status, facts["status"]) == (3, "infeasible")
    assert facts["certificate"]["kind"] == "EscapeTwist"
    assert facts["certificate"]["is_proof"] is True
    assert len(facts["certificate"]["twist"]) == 3
    assert facts["message"] in err


@pytest.mark.parametrize(
    "arguments",
    [
        ("plan", "missing.toml", "-o", "out"),
        ("plan", "paper.toml"),
        ("verify", "paper.toml"),
        ("verify",),
        ("replan",),
        ("new", "removal", "paper.toml"),
        ("new", "kind"),
        ("bench",),
        ("bench", "report", "missing"),
        ("bench", "--solver", "x", "report", "missing"),
        ("bench", "export", "folder", "--family", "none"),
        ("bench", "-o", "out", "--time-limit", "nan"),
        ("sweep", "paper.toml", "-o", "paper.toml"),
        ("sweep", "none.toml", "-o", "out"),
        ("sweep", "status", "none"),
        ("bench", "-o", "out", "--time-limit", "inf"),
        ("bench", "-o", "out", "--time-limit", "0"),
        ("bench", "-o", "out", "--repeat", "9" * 400),
        ("bench", "-o", "out", "--workers", "9" * 400),
        ("bench", "-o", "out", "--workers", "2", "--repeat", "2"),
        ("bench", "-o", "out", "--workers", "2", "--dask", "tcp://127.0.0.1:9"),
        ("bench", "merge", "one", "-o", "out"),
        ("bench", "merge", "none", "nothing", "-o", "out"),
        ("bench", "-o", "out", "--most", "9" * 400),
    ],
)
def test_bad_input_in_json(
    arguments: tuple[str, ...], here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, facts, err = as_json(capsys, *arguments)
    assert (status, facts["status"]) == (2, "bad input")
    assert facts["message"] in err
    assert "Traceback" not in err
    assert sorted(path.name for path in here.iterdir()) == ["paper.toml"]


def test_every_command_speaks_json() -> None:
    from regrasp.cli.entry import commands

    groups = [commands, commands.commands["bench"], commands.commands["sweep"]]
    every = {name: found for group in groups for name, found in group.commands.items()}  # type: ignore[attr-defined]
    assert {"run", "status", "report", "plan"} < set(every)
    for name, found in every.items():
        assert "--json" in [option for parameter in found.params for option in parameter.opts], name


def test_what_is_not_finite_is_null() -> None:
    assert plain({"a": [float("nan"), float("inf"), 1.5], "b": Path("x"), 3: None}) == {
        "a": [None, None, 1.5],
        "b": "x",
        "3": None,
    }


# -- options where a person puts them -------------------------------------------------------------------


def exporting(monkeypatch: pytest.MonkeyPatch, families: dict[str, str]) -> None:
    """Let ``bench export`` say which families it was given."""
    monkeypatch.setattr("regrasp.bench.exchange.export", lambda given, folder: ", ".join(given))
    monkeypatch.setattr("regrasp.bench.families.catalogue.FAMILIES", families)


@pytest.mark.parametrize(
    "arguments",
    [
        ("--family", "states", "export", "x"),
        ("export", "x", "--family", "states"),
        ("export", "--family", "states", "x"),
        ("--family", "states", "export", "x", "--family", "states"),
    ],
)
def test_family_counts_wherever_it_stands(
    arguments: tuple[str, ...],
    here: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        "regrasp.bench.exchange.export", lambda families, folder: ", ".join(map(str, families))
    )
    monkeypatch.setattr("regrasp.bench.families.catalogue.FAMILIES", {"states": "S", "paths": "P"})
    assert regrasp(capsys, "bench", *arguments) == (0, "wrote S\n", "")


def test_families_before_and_after_add_up(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "regrasp.bench.exchange.export", lambda families, folder: ", ".join(map(str, families))
    )
    monkeypatch.setattr("regrasp.bench.families.catalogue.FAMILIES", {"a": "A", "b": "B", "c": "C"})
    assert regrasp(capsys, "bench", "--family", "b", "export", "x", "--family", "a")[1] == "wrote B, A\n"
    assert regrasp(capsys, "bench", "export", "x")[1] == "wrote A, B, C\n"


@pytest.mark.parametrize("subcommand", ["export", "report"])
@pytest.mark.parametrize(
    "option",
    [
        ("--solver", "osqp"), ("--settings", "low"), ("--repeat", "2"), ("--time-limit", "3"),
        ("--workers", "2"), ("--dask", "x"), ("--most", "9"), ("--quick",), ("-o", "elsewhere"),
        ("--family", "states"),
    ],
)  # fmt: skip
def test_option_that_a_subcommand_does_not_take_is_an_error(
    subcommand: str, option: tuple[str, ...], here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if (subcommand, option[0]) == ("export", "--family"):
        pytest.skip("export takes it")
    status, out, err = regrasp(capsys, "bench", *option, subcommand, "x")
    assert (status, out) == (2, "")
    assert f"of a run; bench {subcommand} does not take it" in err
    assert not (here / "x").exists()


# -- signals, pipes, disks ------------------------------------------------------------------------------


def left(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob(".regrasp-*")]


def started(folder: Path, *arguments: object) -> subprocess.Popen[str]:
    """A run of many set-points, when it has begun to write."""
    (folder / "long.toml").write_text(edited(("rate = 1000.0", "rate = 1e6")))
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
    assert (process.returncode, err) == (128 + number, "\nEnded.\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["long.toml"]


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
    if "regrasp" not in err and process.returncode in (1, -signal.SIGINT):
        return  # Python itself had not come to us
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
    assert (tmp_path / "out" / "setpoints.csv").read_text().count("\n") == 1_000_002
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


# -- what the page says ---------------------------------------------------------------------------------


def test_page_lists_every_status() -> None:
    page = (ROOT / "docs" / "command-line.md").read_text()
    numbers = {value for name, value in vars(statuses).items() if name.isupper() and isinstance(value, int)}
    listed = {
        int(line.split("|")[1]) for line in page.splitlines() if line.startswith("| ") and line[2].isdigit()
    }
    assert listed == numbers


def test_page_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    from regrasp.cli.entry import commands

    page = (ROOT / "docs" / "command-line.md").read_text()
    for name, found in commands.commands.items():
        assert f"`regrasp {name}" in page
        for parameter in found.params:
            for option in parameter.opts:
                if option.startswith("--"):
                    assert option in page, f"{name} {option}"


# -- before any work ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ("demo", "-o", "paper.toml"),
        ("demo", "-o", "paper.toml/deeper/still"),
        ("plan", "paper.toml", "-o", "paper.toml"),
        ("plan", "paper.toml", "-o", "n" * 5000),
        ("verify", "out", "--rate", "nan"),
        ("verify", "out", "--rate", "0"),
        ("simulate", "out", "-o", "paper.toml"),
        ("simulate", "out", "--friction", "nan"),
        ("simulate", "out", "--stiffness", "-1"),
        ("simulate", "out", "--gravity", "0"),
        ("bench", "-o", "paper.toml"),
        ("bench", "export", "paper.toml"),
        ("bench", "-o", "out", "--time-limit", "nan"),
        ("sweep", "paper.toml", "-o", "paper.toml"),
        ("sweep", "none.toml", "-o", "out"),
        ("sweep", "status", "none"),
    ],
)
def test_what_is_wrong_is_refused_before_any_work(
    here: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    arguments: tuple[str, ...],
) -> None:
    def worked(*_: object, **__: object) -> None:
        pytest.fail("it went to work")

    for name in ("read_scenario", "parse_scenario", "read_plan", "plan_scenario"):
        monkeypatch.setattr(f"regrasp.files.{name}", worked)
    for name in ("bench.running.jobs.chosen_problems", "bench.exchange.export", "execution.simulate"):
        monkeypatch.setattr(f"regrasp.{name}", worked)
    status, out, err = regrasp(capsys, *arguments)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
