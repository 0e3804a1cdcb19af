"""Studies of scenarios, as files and by the command line."""

import json
import logging
import re
from pathlib import Path
from typing import Any

import pytest

import regrasp as rg
from places import ROOT
from regrasp.cli import main
from regrasp.files import read_plan, read_scenario
from regrasp.files.scenarios.planned import plan_scenario
from regrasp.files.study_file import read_study_file
from regrasp.studies.scenario_cases import changed

pytestmark = pytest.mark.contract

PAPER = ROOT / "examples" / "paper.toml"
STUDY = f"""
scenario = "{PAPER}"
[cases]
contacts.P1.friction = [0.3, 0.4]
"""


def regrasp(capsys: Any, monkeypatch: Any, *arguments: object) -> tuple[int, str, str]:
    monkeypatch.setattr("sys.argv", ["regrasp", *map(str, arguments)])
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr()
    return int(end.value.code or 0), said.out, said.err


def test_keys_reach_tables_names_numbers_and_all() -> None:
    data = {"a": 1, "t": {"b": 2}, "contacts": [{"name": "P1", "f": 1}, {"name": "P2", "f": 2}]}
    new = {"a": 5, "t.b": 6, "t.c": 7, "contacts.*.f": 8, "contacts.P2.f": 9, "contacts.0.g": 10}
    assert changed(data, new) == {
        "a": 5,
        "t": {"b": 6, "c": 7},
        "contacts": [{"name": "P1", "f": 8, "g": 10}, {"name": "P2", "f": 9}],
    }
    assert data["contacts"][0] == {"name": "P1", "f": 1}
    assert changed(data, {"t.b": None}) == {**data, "t": {}}
    for key in ("u.b", "contacts.P3.f", "contacts.2.f", "a.b"):
        with pytest.raises(rg.InvalidInput, match=f"no place for '{re.escape(key)}'; it has a, t, contacts"):
            changed(data, {key: 1})


def test_a_scenario_is_planned_and_verified_for_each_case(tmp_path: Path) -> None:
    grid = {"contacts.*.friction": [0.1, 0.3, 0.5], "task.objective": ["angle", "effort"]}
    rg.sweep(PAPER, grid, out=tmp_path, workers=0, plans=True, progress=False)
    frame = rg.read_study(tmp_path)
    assert frame["verdict"].value_counts().to_dict() == {"answered": 4, "invalid": 2}
    row = frame[(frame["contacts.*.friction"] == 0.3) & (frame["task.objective"] == "angle")].iloc[0]
    plan = plan_scenario(read_scenario(PAPER))
    assert row["friction_needed"] == plan.friction_needed
    assert row["margin"] == pytest.approx(rg.verify(plan).least_angle)
    assert read_plan(tmp_path / "_plans" / f"{row['key']}.json") == plan


def test_a_regrasp_has_moves_and_a_margin(tmp_path: Path) -> None:
    grid = {"friction": [0.6], "task.orientations": [12], "task.candidates": [60]}
    rg.sweep(ROOT / "examples" / "regrasp.toml", grid, out=tmp_path, workers=0, progress=False)
    row = rg.read_study(tmp_path).iloc[0]
    assert row["verdict"] == "answered"
    assert row["moves"] == 2
    assert 0 < row["margin"] < 0.6


@pytest.mark.parametrize(
    ("grid", "words"),
    [
        ({"contacts.P9.friction": [0.3]}, "no place for 'contacts.P9.friction'"),
        ({"task.objectiv": ["angle"]}, "task.objectiv: unknown key"),
    ],
)
def test_keys_that_lead_nowhere_are_refused_before_any_work(grid: Any, words: str, tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        rg.sweep(str(PAPER), grid, out=tmp_path / "out", workers=0)
    assert not (tmp_path / "out").exists()


def test_a_study_file_runs_goes_on_and_says_how_far_it_is(
    tmp_path: Path, capsys: Any, monkeypatch: Any
) -> None:
    out, example = tmp_path / "rows", ROOT / "examples" / "study.toml"
    status, said, err = regrasp(capsys, monkeypatch, "sweep", example, "-o", out, "--workers", 0)
    assert (status, err) == (0, "")
    assert said.startswith(f"{out}: 33 rows of 33 cases, 0 left: answered 27, invalid 6\n")
    next(out.glob("*.parquet")).unlink()
    assert regrasp(capsys, monkeypatch, "sweep", "status", out)[1] == f"{out}: 0 rows of 33 cases, 33 left\n"
    facts = json.loads(regrasp(capsys, monkeypatch, "sweep", "--json", "-o", out, example, "--workers", 1)[1])
    assert (facts["rows"], facts["left"], facts["verdicts"]) == (33, 0, {"answered": 27, "invalid": 6})
    assert json.loads(regrasp(capsys, monkeypatch, "sweep", "--json", "status", out)[1]) == facts


def test_where_no_terminal_is_the_log_says_how_far_it_is(
    tmp_path: Path, capsys: Any, monkeypatch: Any
) -> None:
    log, example = logging.getLogger("regrasp"), ROOT / "examples" / "study.toml"
    monkeypatch.setattr(log, "propagate", False)  # of pytest's own handlers
    monkeypatch.setattr(log, "handlers", [])
    before = log.level
    try:
        _, said, err = regrasp(capsys, monkeypatch, "sweep", example, "-o", tmp_path, "--workers", 0)
    finally:
        log.setLevel(before)
    assert "33 of 33 rows in this process" in err
    assert "; invalid 6" in err
    assert "INFO" not in said


def test_a_table_and_a_function_make_a_study(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("a, b,c\n1,2.5,x\n2,true,\n")
    (tmp_path / "study.toml").write_text('function = "m:f"\ntable = "cases.csv"\n')
    study, grid = read_study_file(tmp_path / "study.toml")
    assert study.function == "m:f"
    assert grid == [{"a": 1, "b": 2.5, "c": "x"}, {"a": 2, "b": True, "c": None}]


def test_keys_in_tables_are_keys_with_dots(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(STUDY + 'load.torque = {from = 0, to = 1, count = 2}\n"a.b" = [1]\n')
    _, grid = read_study_file(tmp_path / "study.toml")
    assert grid == {
        "contacts.P1.friction": [0.3, 0.4],
        "load.torque": {"from": 0, "to": 1, "count": 2},
        "a.b": [1],
    }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("scenario = 3", "scenario: expected text, got 3"),
        ("[cases]\na=[1]", "expected exactly one of scenario and function"),
        ('function = "m:f"', "expected exactly one of cases and table"),
        (STUDY.replace("[cases]", "kept = []\n[cases]"), "kept: unknown key; known here: title, scenario"),
        ("= 3", "not TOML"),
        ('function = "m:f"\ntable = "none.csv"', "none.csv: expected cases in CSV, found no such file"),
        ('function = "m:f"\ntable = "bad.csv"', "bad.csv: expected a line of keys"),
        ('function = "m:f"\ntable = "twice.csv"', "a key stands twice"),
        ("time_limit = 0\n" + STUDY, "time_limit: expected a number greater than 0, got 0"),
    ],
)
def test_what_is_no_study_is_refused(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_text("a,b\n1\n")
    (tmp_path / "twice.csv").write_text("a,a\n1,2\n")
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(rg.InvalidInput, match=words):
        read_study_file(tmp_path / "study.toml")
