"""The command line called in this process, and the scenario that tests spoil."""

import re
import sys
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from regrasp import cli
from regrasp.files import parse_scenario, plan_scenario

PAPER = (files("regrasp.files.scenarios") / "paper.toml").read_text(encoding="utf-8")


def edited(*changes: tuple[str, str]) -> str:
    """The paper's scenario with texts replaced."""
    return changed(PAPER, *changes)


def changed(text: str, *changes: tuple[str, str]) -> str:
    """A scenario with each (old, new) text replaced once; ``old`` must be there."""
    for old, new in changes:
        assert old in text, f"{old!r} is not in the scenario"
        text = text.replace(old, new, 1)
    return text


def planned(*changes: tuple[str, str]) -> Any:
    """What the paper's scenario with texts replaced plans."""
    return plan_scenario(parse_scenario(edited(*changes)))


def regrasp(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """(exit status, stdout, stderr) of ``regrasp ARGUMENTS``."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["regrasp", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
    captured = capsys.readouterr()
    return int(stop.value.code or 0), captured.out, captured.err


def check_refused(
    capsys: pytest.CaptureFixture[str],
    text: str,
    expected: int,
    lines: Sequence[str | re.Pattern[str]],
) -> None:
    """``regrasp plan`` says these lines of a scenario, in a folder of its own, and leaves no file behind."""
    patterns = (line.pattern if isinstance(line, re.Pattern) else re.escape(line) for line in lines)
    Path("bad.toml").write_text(text)
    status, out, err = regrasp(capsys, "plan", "bad.toml", "-o", "out")
    assert re.fullmatch("Error: " + "".join(rf"bad\.toml: {pattern}\n" for pattern in patterns), err), err
    assert status == expected
    assert out == ""
    assert [file.name for file in Path().iterdir()] == ["bad.toml"]


def check_bad(text: str, lines: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """``regrasp plan`` says these lines of a scenario, with its path, and writes nothing."""
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    status, out, err = regrasp(capsys, "plan", path, "-o", tmp_path / "out")
    assert err == "Error: " + "".join(f"{path}: {line}\n" for line in lines)
    assert (status, out) == (2, "")
    assert not (tmp_path / "out").exists()
