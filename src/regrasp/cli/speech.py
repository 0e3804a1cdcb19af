"""What a command says: text for a person, or one JSON object for a program."""

import json
import logging
import sys
from dataclasses import fields, is_dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import click

_OPTION = "--json"

json_option = click.option(
    _OPTION,
    "_as_json",
    is_flag=True,
    expose_value=False,
    help="Print one JSON object in the place of text.",
)


def wants_json() -> bool:
    """Whether this run was asked for JSON; also known where its arguments are wrong otherwise."""
    return _OPTION in sys.argv[1:]


def say(text: object = "") -> None:
    """Text for a person."""
    if not wants_json():
        click.echo(text)


def log_on_stderr() -> None:
    """Send the log to standard error where that is a file or a pipe, for a run that nobody watches."""
    log = logging.getLogger("regrasp")
    if wants_json() or sys.stderr.isatty() or log.hasHandlers():
        return
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
    log.addHandler(handler)
    log.setLevel(logging.INFO)


def say_json(facts: dict[str, Any]) -> None:
    """The object for a program."""
    click.echo(json.dumps(plain(facts), allow_nan=False, ensure_ascii=True))


def plain(value: Any) -> Any:
    """A value as JSON holds it: records as objects, what is not finite as null, anything else as text."""
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, Path) or not is_dataclass(value):
        return str(value)
    return {field.name: plain(getattr(value, field.name)) for field in fields(value)}


def called() -> str:
    """How a person calls this program again: as they did now."""
    program = Path(sys.argv[0])
    if program.name == "__main__.py":
        return "python -m regrasp"
    return str(program) if program.parent.name == "bin" else "regrasp"
