"""``regrasp plan --motions --mcap`` on a real file, judged and simulated by other commands."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from wrong_calls.files import MOVING

pytestmark = pytest.mark.end_to_end

EXAMPLE = Path(__file__).parents[2] / "examples" / "regrasp.toml"


def run(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "regrasp", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def test_ways_are_planned_verified_and_written(tmp_path: Path) -> None:
    pytest.importorskip("rosbags")
    (tmp_path / "regrasp.toml").write_text(MOVING, encoding="utf-8")
    done = run("plan", "regrasp.toml", "-o", "out", "--motions", "--mcap", "--no-figures", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "ways verified at " in done.stdout
    assert "2 or more touch at every instant" in done.stdout
    written = sorted(p.name for p in (tmp_path / "out").iterdir())
    assert written == ["motions.csv", "motions.json", "plan.json", "plan.mcap", "setpoints.csv"]
    table = tmp_path / "out" / "motions.csv"
    done = run("verify", "out", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "ways verified at " in done.stdout
    assert "set-points of positions and forces verified: tips of radius" in done.stdout
    simulated(tmp_path)
    header, *rows = table.read_text(encoding="utf-8").splitlines()
    column = header.split(",").index("F1_touching")
    cells = [[*row.split(",")[:column], "0", *row.split(",")[column + 1 :]] for row in rows]
    table.write_text("\n".join([header, *map(",".join, cells)]), encoding="utf-8")
    done = run("verify", "out", cwd=tmp_path)
    assert done.returncode == 1
    assert "during step 1 no finger is at" in done.stderr
    table.unlink()
    ways = tmp_path / "out" / "motions.json"
    text = ways.read_text(encoding="utf-8")
    data = json.loads(text)
    for motion in data["motions"]:  # straight across, through the object
        motion["points"], motion["cuts"] = [motion["points"][0], motion["points"][-1]], []
    ways.write_text(json.dumps(data), encoding="utf-8")
    done = run("verify", "out", cwd=tmp_path)
    assert done.returncode == 1
    assert "is in the object by" in done.stderr
    ways.unlink()  # a folder of before there were files of ways
    assert run("verify", "out", cwd=tmp_path).returncode == 0


def simulated(folder: Path) -> None:
    """``regrasp simulate`` goes the ways that lie beside the plan."""
    pytest.importorskip("mujoco")
    done = run("simulate", "out", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)["execution"]
    own = json.loads(run("simulate", "out", "--motions", "none", "--json", cwd=folder).stdout)["execution"]
    assert facts["held"]
    assert own["held"]
    assert (facts["ways"], own["ways"]) == (len(written_ways(folder)), 0)


def written_ways(folder: Path) -> list[object]:
    data = json.loads((folder / "out" / "motions.json").read_text(encoding="utf-8"))
    return list(data["motions"])


def test_without_the_table_one_line_says_what_is_missing(tmp_path: Path) -> None:
    text = EXAMPLE.read_text(encoding="utf-8").split("[motions]")[0]
    (tmp_path / "bare.toml").write_text(text, encoding="utf-8")
    done = run("plan", "bare.toml", "-o", "out", "--motions", cwd=tmp_path)
    assert done.returncode == 2
    assert "ways of fingers need a table [motions]" in done.stderr
    assert not (tmp_path / "out").exists()
