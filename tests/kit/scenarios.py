"""The command line called in this process, and the scenario that tests spoil."""

import sys
from importlib.resources import files

import pytest

from regrasp import cli

PAPER = (files("regrasp.files.scenarios") / "paper.toml").read_text(encoding="utf-8")


def edited(*changes: tuple[str, str]) -> str:
    """The paper's scenario with each (old, new) text replaced once; ``old`` must be there."""
    text = PAPER
    for old, new in changes:
        assert old in text, f"{old!r} is not in the scenario"
        text = text.replace(old, new, 1)
    return text


def regrasp(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """(exit status, stdout, stderr) of ``regrasp ARGUMENTS``."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["regrasp", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
    captured = capsys.readouterr()
    return int(stop.value.code or 0), captured.out, captured.err
