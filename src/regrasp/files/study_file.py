"""A study as a person writes it: a scenario or a function, and the values of the keys that vary."""

import csv
import io
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, model_validator

from regrasp.errors import InvalidInput
from regrasp.files.source import text_of
from regrasp.files.strict import Strict, validated
from regrasp.mechanics.checks import file_path

Name = Annotated[str, Field(min_length=1)]


class StudyFile(Strict):
    """A study: what is done for each case, which cases there are, and what is kept of each."""

    title: str | None = Field(None, description="of the study")
    scenario: Name | None = Field(None, description="a scenario in TOML, relative to this file")
    function: Name | None = Field(None, description="a Python function, 'module:function'")
    cases: dict[str, Any] | None = Field(
        None, description="keys, of a scenario with dots between tables; of each a list, a range or a draw"
    )
    table: Name | None = Field(None, description="cases in CSV, a line each below a line of keys")
    zipped: bool = Field(False, description="values side by side, not all combinations")
    keep: list[Name] = Field([], description="what is kept of each result")
    plans: bool = Field(False, description="write the plan of each case, too")
    time_limit: Annotated[float, Field(gt=0)] | None = Field(None, description="of a case [s]")

    @model_validator(mode="after")
    def _is_whole(self) -> "StudyFile":
        for one, other in (("scenario", "function"), ("cases", "table")):
            if (getattr(self, one) is None) == (getattr(self, other) is None):
                raise ValueError(f"{one}: expected exactly one of {one} and {other}")
        return self


def read_study_file(path: str | Path) -> tuple[StudyFile, Any]:
    """A study and its grid, as ``sweep`` takes it.

    Args:
        path: a file in TOML.

    Raises:
        InvalidInput: In one message, which names the file and what is wrong in it.
    """
    path = file_path(path)
    try:
        data = tomllib.loads(text_of(path, "a study in TOML"))
    except (ValueError, RecursionError) as error:
        if isinstance(error, InvalidInput):
            raise
        raise InvalidInput(f"{path}: not TOML: {error}") from None
    study = validated(StudyFile, data, path)
    if study.table is not None:
        return study, _table(path.parent / study.table)
    return study, dict(_flat(study.cases or {}))


def _flat(cases: Mapping[str, Any], before: str = "") -> list[tuple[str, Any]]:
    """Keys with dots; a table with a ``count`` is a range or a draw, any other one holds more keys."""
    found = []
    for key, value in cases.items():
        if isinstance(value, Mapping) and "count" not in value:
            found += _flat(value, f"{before}{key}.")
        else:
            found.append((before + key, value))
    return found


def _table(path: Path) -> list[dict[str, Any]]:
    rows = list(csv.reader(io.StringIO(text_of(path, "cases in CSV"))))
    rows = [row for row in rows if row]
    if len(rows) < 2 or any(len(row) != len(rows[0]) for row in rows):
        raise InvalidInput(f"{path}: expected a line of keys and lines of as many values")
    keys = [key.strip() for key in rows[0]]
    if len(set(keys)) < len(keys):
        raise InvalidInput(f"{path}: a key stands twice in its first line")
    return [dict(zip(keys, map(_value, row), strict=True)) for row in rows[1:]]


def _value(text: str) -> Any:
    """A whole number, a number, a truth value, nothing, or text."""
    text = text.strip()
    if text in ("", "true", "false"):
        return {"": None, "true": True, "false": False}[text]
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
