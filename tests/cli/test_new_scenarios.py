"""Scenarios to start from: each plans as it is, and every option in a comment may be taken up."""

import re
from pathlib import Path

import pytest

from regrasp.cli.scenarios import KINDS
from regrasp.files import parse_scenario, plan_scenario, read_plan
from regrasp.files.scenarios.templates import NAMES, template
from regrasp.verification import verify
from scenarios import regrasp

pytestmark = pytest.mark.end_to_end

OPTION = re.compile(r"^# (\w+ = .*)$")


@pytest.mark.parametrize("name", NAMES)
def test_it_plans_as_it_is(name: str) -> None:
    scenario = parse_scenario(template(name), f"{name}.toml")
    assert scenario.task.kind == name.removeprefix("space-")
    assert verify(plan_scenario(scenario)).ok


@pytest.mark.parametrize("space", [(), ("--space",)])
def test_the_finger_that_arrives_works_and_nothing_is_doubted(
    space: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "exchange.toml"
    assert regrasp(capsys, "new", "exchange", path, *space)[0] == 0
    status, _, err = regrasp(capsys, "plan", path, "-o", tmp_path, "--no-figures")
    assert (status, err) == (0, "")
    plan = read_plan(tmp_path / "plan.json")
    assert abs(plan.end.forces[-1]).max() > 0.1 * abs(plan.end.forces).max()


@pytest.mark.parametrize("name", NAMES)
def test_every_option_in_a_comment_may_be_taken_up(name: str) -> None:
    lines = template(name).splitlines()
    options = [k for k, line in enumerate(lines) if OPTION.match(line)]
    assert len(options) >= 3
    for k in options:
        key = lines[k].split()[1]
        if key in ("force", "end_force"):  # of every contact or of none
            continue
        taken = [*lines[:k], lines[k].removeprefix("# "), *lines[k + 1 :]]
        parse_scenario("\n".join(taken), f"{name}.toml with {key}")


@pytest.mark.parametrize("name", ["removal", "addition"])
@pytest.mark.parametrize("option", ["rate_limit", "min_normal", "idle_time", "path_objective", "reserve"])
def test_an_option_taken_up_plans(name: str, option: str) -> None:
    text = re.sub(rf"(?m)^# ({option} = .*)$", r"\1", template(name))
    assert text != template(name)
    assert verify(plan_scenario(parse_scenario(text))).ok


@pytest.mark.parametrize("space", [(), ("--space",)])
@pytest.mark.parametrize("kind", KINDS)
def test_new_writes_it(
    kind: str,
    space: tuple[str, ...],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    name = f"{'space-' if space else ''}{kind}"
    status, out, err = regrasp(capsys, "new", kind, *space)
    assert (status, err) == (0, "")
    assert out.startswith(f"wrote {name}.toml\n")
    assert Path(f"{name}.toml").read_text() == template(name)
    assert regrasp(capsys, "new", kind, *space) == (
        2,
        "",
        f"Error: {name}.toml: there is such a file already; give another name\n",
    )
    assert regrasp(capsys, "new", kind, "mine.toml", *space)[0] == 0
    assert Path("mine.toml").read_text() == template(name)


def test_new_says_where_it_cannot_write(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "none" / "a.toml"
    message = f"Error: {path}: cannot be written: No such file or directory\n"
    assert regrasp(capsys, "new", "removal", path) == (2, "", message)


def test_completion_knows_commands_and_kinds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("_REGRASP_COMPLETE", "bash_complete")
    for words, expected in (
        ("regrasp v", "verify"),
        ("regrasp new ro", "rotation"),
        ("regrasp plan --no", "--no-figures"),
    ):
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", str(words.count(" ")))
        status, out, _ = regrasp(capsys)
        assert (status, out) == (0, f"plain,{expected}\n")
