"""End to end: the command line on real files."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import regrasp as rg
from places import ROOT
from regrasp.files import parse_scenario, plan_scenario, read_plan
from scenarios import PAPER, edited, regrasp
from spoiling import Blank

pytestmark = pytest.mark.end_to_end

EXAMPLES = ROOT / "examples"
PLAN = plan_scenario(parse_scenario(PAPER))
NUMBERS = ["plan.json", "setpoints.csv"]


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def run(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """``regrasp ARGUMENTS`` as a person runs it."""
    command = [sys.executable, "-m", "regrasp", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    """The folder in which ``regrasp demo`` ran, and what it said."""
    folder = tmp_path_factory.mktemp("demo")
    return folder, run("demo", cwd=folder)


def test_demo_writes_a_verified_plan_and_says_so(
    demo: tuple[Path, subprocess.CompletedProcess[str]],
) -> None:
    folder, done = demo
    assert (done.returncode, done.stderr) == (0, "")
    assert str(PLAN) in done.stdout
    assert str(rg.verify(PLAN)) in done.stdout
    assert "each of 1001 set-points verified too" in done.stdout
    assert read_plan(folder / "regrasp-demo" / "plan.json") == PLAN


def test_demo_lists_every_file_it_wrote(demo: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, done = demo
    listed = [Path(line.split()[1]).name for line in done.stdout.splitlines() if line.startswith("wrote ")]
    assert listed == names(folder / "regrasp-demo")
    assert {"paper.toml", *NUMBERS, "overview.png"} < set(listed)
    assert names(folder) == ["regrasp-demo"]


def test_demo_figures_are_images(demo: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    pictures = list((demo[0] / "regrasp-demo").glob("*.png"))
    assert len(pictures) >= 8
    for picture in pictures:
        assert picture.read_bytes().startswith(b"\x89PNG")


def test_demo_can_be_verified_and_planned_again(
    demo: tuple[Path, subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    first = demo[0] / "regrasp-demo"
    again = run("plan", first / "paper.toml", "-o", "again", "--no-figures", cwd=tmp_path)
    assert (again.returncode, again.stderr) == (0, "")
    for name in NUMBERS:
        assert (tmp_path / "again" / name).read_bytes() == (first / name).read_bytes()
    for target in (first, "again/plan.json"):
        checked = run("verify", target, cwd=tmp_path)
        assert (checked.returncode, checked.stderr) == (0, "")
        table = first / "setpoints.csv" if target == first else Path("again/setpoints.csv")
        count = f"each of 1001 set-points in {table} verified too"
        assert checked.stdout == f"{PLAN}\n{rg.verify(PLAN)}\n{count}\n"


def test_plan_of_an_addition(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = regrasp(
        capsys, "plan", EXAMPLES / "addition.toml", "-o", tmp_path / "out", "--no-figures"
    )
    assert (status, err) == (0, "")
    assert "addition of B" in out
    assert names(tmp_path / "out") == NUMBERS
    assert rg.verify(read_plan(tmp_path / "out" / "plan.json")).ok


def test_plan_over_an_older_one_keeps_other_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "slow.toml").write_text(edited(("duration = 1.0", "duration = 2.0")))
    (tmp_path / "notes.txt").write_text("mine")
    for scenario in (EXAMPLES / "paper.toml", tmp_path / "slow.toml"):
        assert regrasp(capsys, "plan", scenario, "-o", tmp_path, "--no-figures")[0] == 0
    assert names(tmp_path) == sorted(["notes.txt", "slow.toml", *NUMBERS])
    assert read_plan(tmp_path / "plan.json").duration == 2.0
    assert (tmp_path / "setpoints.csv").read_text().count("\n") == 2002
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_progress_is_shown_on_a_terminal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("regrasp.plots.pages.overview.figures", lambda plan, **_: {"overview": Blank()})
    monkeypatch.setenv("FORCE_COLOR", "1")  # makes rich take any stream for a terminal
    monkeypatch.setenv("TERM", "xterm")
    status, out, err = regrasp(capsys, "plan", EXAMPLES / "paper.toml", "-o", tmp_path)
    assert status == 0
    assert "drawing figures" in err
    assert "drawing" not in out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert regrasp(capsys, "--version") == (0, f"regrasp, version {rg.__version__}\n", "")


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = regrasp(capsys, "--help")
    assert (status, err) == (0, "")
    for command in ("demo", "plan", "verify", "schema"):
        assert f"\n  {command} " in out


def test_schema_is_json(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = regrasp(capsys, "schema")
    assert (status, err) == (0, "")
    kinds = [json.loads(out)["$defs"][of["$ref"].rpartition("/")[2]] for of in json.loads(out)["anyOf"]]
    assert [set(kind["required"]) for kind in kinds] == [
        {"load", "contacts", "task"},
        {"friction", "load", "outline", "start", "goal", "task"},
        {"friction", "load", "object", "start", "goal", "task"},
        {"friction", "load", "outline", "task"},
        {"friction", "load", "object", "task"},
    ]


def test_command_line_starts_light(tmp_path: Path) -> None:
    heavy = ("clarabel", "matplotlib", "numba", "pandas", "pydantic", "rich", "scipy")
    code = f"import sys, regrasp.cli; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_installed_command_is_this_one() -> None:
    from importlib.metadata import entry_points

    (entry,) = entry_points(group="console_scripts", name="regrasp")
    assert entry.value == "regrasp.cli:main"


def test_printed_plan_shows_digits_in_any_unit() -> None:
    grasp, load = PLAN.grasp, PLAN.start.load
    micro = rg.plan_removal(rg.GraspState(grasp, load * 1e-6, PLAN.start.forces * 1e-6), "P3")
    assert "3.790e-06   3.003e-06" in str(micro)
    assert "3.7897     3.0034" in str(PLAN)
