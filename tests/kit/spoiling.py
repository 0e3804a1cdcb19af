"""Files of plans with one thing changed, and tables read back without the readers of regrasp."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import regrasp as rg
from regrasp.files import write_plan

Change = Callable[[Any], None]


def put(value: Any, *keys: str | int) -> Change:
    """Another value at a place of JSON."""

    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value

    return change


def drop(*keys: str | int) -> Change:
    """A key or an entry taken out of JSON."""

    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        del data[keys[-1]]

    return change


def damaged(plan: rg.Transition | rg.RegraspPlan, change: Change, path: Path) -> Path:
    """The file of a plan, changed."""
    write_plan(plan, path)
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


def table_of(path: Path) -> tuple[list[str], np.ndarray]:
    """Header and (rows, columns) numbers of a table."""
    header, *rows = path.read_text(encoding="utf-8").splitlines()
    return header.split(","), np.array([[float(x) for x in row.split(",")] for row in rows])


class Blank:
    """A figure that saves nothing, or fails half-way."""

    def __init__(self, error: BaseException | None = None) -> None:
        self.error = error

    canvas = None

    def savefig(self, path: Path, **_: str) -> None:
        path.write_bytes(b"half a picture")
        if self.error is not None:
            raise self.error
