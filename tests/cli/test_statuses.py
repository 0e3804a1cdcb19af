"""How a run ends: exit statuses, JSON for programs, options that are wrong."""

import json
from pathlib import Path
from typing import Any

import pytest

from places import ROOT
from regrasp.cli import statuses
from regrasp.cli.speech import plain
from scenarios import PAPER, edited, regrasp

pytestmark = pytest.mark.end_to_end


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
