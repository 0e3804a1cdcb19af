"""``regrasp simulate`` on real files."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from executed_plans import removal
from regrasp.files import write_plan

pytestmark = pytest.mark.end_to_end

pytest.importorskip("mujoco")


def run(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "regrasp", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def test_a_plan_that_holds_is_written_and_returns_0(tmp_path: Path) -> None:
    write_plan(removal(), tmp_path / "plan.json")
    done = run("simulate", ".", "-o", "run", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "holds, true friction 0.3, the plan needs 0.1837" in done.stdout
    assert sorted(p.name for p in (tmp_path / "run").iterdir()) == [
        "execution.csv",
        "execution.gif",
        "execution.png",
    ]
    with (tmp_path / "run" / "execution.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 100
    assert float(rows[-1]["P3_fx"]) == 0.0
    assert float(rows[-1]["P1_fx"]) == pytest.approx(float(rows[-1]["P1_planned_fx"]), rel=1e-3)


def test_a_plan_that_does_not_hold_returns_1_and_says_so(tmp_path: Path) -> None:
    write_plan(removal(), tmp_path / "plan.json")
    done = run("simulate", "plan.json", "--friction", 0.15, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.strip() == "Error: plan.json: does not hold in physics"


def test_bad_options_return_2(tmp_path: Path) -> None:
    write_plan(removal(), tmp_path / "plan.json")
    done = run("simulate", "plan.json", "--mass", -1, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.strip() == "Error: mass must be greater than 0, got -1.0"
