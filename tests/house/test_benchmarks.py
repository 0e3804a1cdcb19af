"""The benchmark runs and reports every row. Its times are never tested."""

import json
import subprocess
import sys
from math import isfinite
from pathlib import Path
from runpy import run_path
from typing import Any

import pytest

from places import ROOT
from regrasp.closed_form.choice import OBJECTIVES

pytestmark = pytest.mark.end_to_end

SCRIPT = ROOT / "benchmarks" / "speed" / "closed_form.py"
ROWS = {
    *(f"{size}_{objective}" for size in ("one", "batch") for objective in OBJECTIVES),
    *(f"removal_{objective}_{seen}" for objective in ("angle", "effort") for seen in ("first", "again")),
    "set_points",
    "intervals_1",
    "loop_1",
    "import",
    "version",
}
PAGE = "before\n<!-- closed_form: generated, do not edit -->\nold\n<!-- end of closed_form -->\nafter\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark")
    (folder / "README.md").write_text(PAGE, encoding="utf-8")
    subprocess.run([sys.executable, SCRIPT, "--quick", "-o", folder], check=True, capture_output=True)
    return folder


def test_every_row_is_measured(folder: Path) -> None:
    report = json.loads((folder / "results" / "closed_form.json").read_text(encoding="utf-8"))
    keys = [row["key"] for row in report["rows"]]
    assert len(keys) == len(set(keys))
    assert set(keys) >= ROWS
    for row in report["rows"]:
        numbers = [row[name] for name in ("ours", "theirs", "value", "value_of_best", "goal")]
        assert all(isfinite(number) and number > 0 for number in numbers), row
        assert row["met"] == (
            row["value"] <= row["goal"] if row["measure"] == "TIMES" else row["value"] >= row["goal"]
        )
    assert report["quick"]
    assert report["environment"]["versions"].keys() >= {"regrasp", "numpy", "numba", "daqp", "cvxpy"}


def test_the_page_has_a_line_per_row(folder: Path) -> None:
    report = json.loads((folder / "results" / "closed_form.json").read_text(encoding="utf-8"))
    page = (folder / "README.md").read_text(encoding="utf-8")
    lines = [line for line in page.splitlines() if line.startswith("| ")]
    assert len(lines) == 1 + len(report["rows"])
    assert report["environment"]["date"] in page


def test_the_section_is_replaced_and_the_rest_kept(folder: Path) -> None:
    page = (folder / "README.md").read_text(encoding="utf-8")
    assert page.startswith("before\n<!-- closed_form: generated, do not edit -->\n| what |")
    assert page.endswith("\n<!-- end of closed_form -->\nafter\n")
    assert "old" not in page.splitlines()


def test_a_quick_run_does_not_replace_the_results() -> None:
    done = subprocess.run([sys.executable, SCRIPT, "--quick"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "say where to write it with -o DIR" in done.stderr


def test_the_benchmark_of_programs_measures_every_row(tmp_path: Path) -> None:
    script = SCRIPT.with_name("programs.py")
    subprocess.run([sys.executable, script, "--quick", "-o", tmp_path], check=True, capture_output=True)
    report = json.loads((tmp_path / "results" / "programs.json").read_text(encoding="utf-8"))
    keys = {row["key"] for row in report["rows"]}
    solved = {
        f"clarabel_{objective}_{n}" for objective in ("effort", "peak", "peak_normal") for n in (2, 3, 6)
    }
    others = {"clarabel_first_3", "growth_10_1000", "growth_100_1000", "road_cvxpy_warm", "road_cvxpy_cold"}
    assert keys >= solved | others
    for row in report["rows"]:
        assert is_measured(row), row


def test_the_benchmark_of_regrasps_measures_every_row(tmp_path: Path) -> None:
    script = SCRIPT.with_name("regrasps.py")
    subprocess.run([sys.executable, script, "--quick", "-o", tmp_path], check=True, capture_output=True)
    report = json.loads((tmp_path / "results" / "regrasps.json").read_text(encoding="utf-8"))
    assert [row["key"] for row in report["rows"]] == [
        "sweep_numpy", "sweep_highs", "growth_points", "growth_orientations", "sequence", "exact_numpy",
        "exact_first", "exact_sequence", "bytes", "widest_time", "widest_memory",
    ]  # fmt: skip
    for row in report["rows"]:
        assert all(isfinite(row[name]) and row[name] > 0 for name in ("ours", "theirs", "goal")), row


def is_measured(row: dict[str, Any], least: float = 1e-300) -> bool:
    """Whether a row has its numbers.

    A slope of a few single times may be anything, where another process takes the machine between them.
    """
    names = ("ours", "theirs") if row["measure"] == "SLOPE" else ("ours", "theirs", "value")
    return isfinite(row["value"]) and all(isfinite(row[name]) and row[name] >= least for name in names)


def test_the_benchmark_of_space_measures_every_row(tmp_path: Path) -> None:
    script = SCRIPT.with_name("space.py")
    subprocess.run([sys.executable, script, "--quick", "-o", tmp_path], check=True, capture_output=True)
    report = json.loads((tmp_path / "results" / "space.json").read_text(encoding="utf-8"))
    keys = [row["key"] for row in report["rows"]]
    assert len(keys) == len(set(keys))
    facets = (4, 8, 16, 32)
    assert set(keys) >= {
        *(f"clarabel_{objective}_4" for objective in ("effort", "peak", "peak_normal")),
        *("clarabel_first_4", "growth_10_100", "contacts_effort_8_32", "contacts_peak_16_32"),
        *(
            f"pyramid_{way}_{m}"
            for way in ("effort_clarabel", "peak_clarabel", "effort_piqp")
            for m in facets
        ),
        *(f"loss_{objective}_{m}" for objective in ("effort", "peak", "force") for m in facets),
        *("triples_8_1", "triples_16_1", "triples_margins"),
        *(f"missed_{m}" for m in facets),
        *("regrasp", "verify_regrasp", "verify_removal", "verify_turn", "verify_path"),
    }
    for row in report["rows"]:
        least = 0 if row["measure"] == "PERCENT" else 1e-300
        assert is_measured(row, least), row


def test_areas_of_changes_have_files_for_each_pattern(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is tried against no test would count as never noticed, and what has no module as done."""
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setenv("HYPOTHESIS_STORAGE_DIRECTORY", "none")
    mutants = run_path(str(ROOT / "benchmarks" / "mutants" / "__main__.py"))
    for sources, tests, _ in mutants["AREAS"].values():
        for folder, patterns in ("SOURCE", sources), ("TESTS", tests):
            for pattern in patterns:
                assert mutants["matched"](mutants[folder], [pattern]), pattern
    with pytest.raises(FileNotFoundError, match=r"^no file under tests matches verification/test_no\*\.py$"):
        mutants["matched"](mutants["TESTS"], ["verification/test_cuts*.py", "verification/test_no*.py"])
