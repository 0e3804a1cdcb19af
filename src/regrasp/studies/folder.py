"""The folder of a study: what it is, and its rows in parts; one run at a time fills it.

    _study.json       what the study is, its columns, the version of this layout
    rows-*.parquet    the rows
    _plans/KEY.json   plans, on request
    _lock             held by the run that fills the folder

Readers of Parquet folders leave names that begin with "_" or "." aside.
"""

import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from secrets import token_hex
from types import TracebackType
from typing import Any, Self

from regrasp.disk.locks import HAS_LOCKS, is_locked
from regrasp.errors import InvalidInput, shown
from regrasp.studies import columns as kinds
from regrasp.studies.axes import Plain
from regrasp.studies.columns import Columns
from regrasp.studies.parts import (
    SUFFIX,
    clear_drafts,
    parts_in,
    read_part,
    replace_file,
    widen_part,
    write_part,
)

FORMAT, VERSION = "regrasp study", 1
STUDY, PLANS, _LOCK = "_study.json", "_plans", "_lock"
_FREE = ("grid", "source", "shared")
"""What may differ where a study is extended."""

Definition = dict[str, Any]


def read_definition(folder: Path) -> dict[str, Any]:
    """What the study of a folder is.

    Raises ``InvalidInput`` for a folder of no study, or of one of another version of this layout.
    """
    path = folder / STUDY
    try:
        study = json.loads(path.read_bytes())
    except FileNotFoundError:
        raise InvalidInput(f"{folder}: expected the folder of a study, found no {STUDY}") from None
    except (OSError, ValueError) as error:
        raise InvalidInput(f"{path} cannot be read: {error}") from None
    if not isinstance(study, dict) or study.get("format") != FORMAT:
        raise InvalidInput(f"{path}: expected a {FORMAT}, got {shown(study)}")
    if study.get("version") != VERSION:
        raise InvalidInput(
            f"{path}: expected version {VERSION} of a study, got {shown(study.get('version'))}; read its "
            "rows with pandas, polars or duckdb, or use a regrasp of its time"
        )
    return study


class Folder:
    """The rows of a study, open for more; a context manager that no second run can enter meanwhile.

    definition: what makes the rows. extend: whether rows of other cases, or of another source, may stay.
    Raises ``InvalidInput`` on entering the folder of another study, and one that a run is filling.
    """

    def __init__(self, path: Path, definition: Definition, inputs: Columns, *, extend: bool) -> None:
        self.path, self._definition, self._extend = path, definition, extend
        self._inputs, self._outputs = inputs, Columns()
        self._run, self._count, self.keys = token_hex(4), 0, set[str]()
        self._waiting: list[dict[str, Any]] = []

    def __enter__(self) -> Self:
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock = os.open(self.path / _LOCK, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            raise InvalidInput(f"{self.path} must be a folder to write in: {error.strerror}") from None
        try:
            if HAS_LOCKS and not is_locked(self._lock):
                raise InvalidInput(f"another run is filling {self.path}; wait for it, or give another folder")
            clear_drafts(self.path)
            self._agree()
            self._read_keys()
        except BaseException:
            os.close(self._lock)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.flush()
        finally:
            os.close(self._lock)

    @property
    def waiting(self) -> int:
        """Rows that are not on the disk yet."""
        return len(self._waiting)

    @property
    def columns(self) -> Columns:
        """Names and types, in the order of the file."""
        return {"key": kinds.TEXT, **self._inputs, **self._outputs, **kinds.FIXED}

    def add(self, key: str, case: Mapping[str, Plain], outputs: Mapping[str, Plain], **rest: Any) -> None:
        """Take a row; it is written with others by ``flush``.

        Raises ``InvalidInput`` for an output that is called like an input.
        """
        taken = [name for name in outputs if name in self._inputs or name in kinds.FIXED or name == "key"]
        if taken:
            raise InvalidInput(
                f"a case returns {shown(taken[0])}, which is a column already; give it another name"
            )
        self._outputs = kinds.widened(self._outputs, outputs)
        self._waiting.append({"key": key, **case, **outputs, **rest})
        self.keys.add(key)

    def flush(self) -> None:
        """Write what waits, as one part; when this returns it is on the disk."""
        if not self._waiting:
            return
        if self._outputs != self._study["columns"]["outputs"]:
            self._write_study()
        path = self.path / f"rows-{self._run}-{self._count:06d}{SUFFIX}"
        write_part(path, self._waiting, self.columns)
        self._count, self._waiting = self._count + 1, []

    def _agree(self) -> None:
        """Take over what the folder says, or say that it is another study's."""
        if not (self.path / STUDY).exists():
            if parts_in(self.path):
                raise InvalidInput(f"{self.path} has rows but no {STUDY}; give another folder")
            self._study: dict[str, Any] = {"columns": {"outputs": {}}, "begun": _now(), "earlier": 0}
            self._write_study()
            return
        self._study = read_definition(self.path)
        self._refuse_others()
        before = self._study["columns"]
        self._outputs = dict(before["outputs"])
        inputs = {
            name: kinds.wider(kind, before["inputs"].get(name, kind)) for name, kind in self._inputs.items()
        }
        self._inputs = {**before["inputs"], **inputs}
        self._write_study()

    def _refuse_others(self) -> None:
        now, then = self._definition, self._study["study"]
        differs = [name for name in now if now[name] != then.get(name)]
        fixed = [name for name in differs if name not in _FREE]
        if fixed:
            raise InvalidInput(
                f"the rows in {self.path} are of another study ({', '.join(fixed)}: "
                f"{shown(then.get(fixed[0]))} there, {shown(now[fixed[0]])} now); give another folder"
            )
        if differs and not self._extend:
            raise InvalidInput(
                f"the study in {self.path} was another one (its {', '.join(differs)} differs); give another "
                "folder, or extend=True (--extend) to keep the rows there and do the new cases only"
            )

    def _write_study(self) -> None:
        """Columns first, then the parts that lack some; a kill between them is mended at the next start."""
        self._study |= {"format": FORMAT, "version": VERSION, "study": self._definition}
        self._study["columns"] = {"inputs": self._inputs, "outputs": self._outputs}
        replace_file(self.path / STUDY, json.dumps(self._study, indent=1).encode())
        for part in parts_in(self.path):
            widen_part(part, self.columns)

    def _read_keys(self) -> None:
        for part in parts_in(self.path):
            for key in read_part(part, ["key"])["key"].to_pylist():
                if key in self.keys:
                    raise InvalidInput(f"{part}: the row of {key} stands in another part too; move one away")
                self.keys.add(key)

    def note_earlier(self, count: int) -> None:
        """Remember how many rows are of cases that the study no longer has."""
        if count != self._study["earlier"]:
            self._study["earlier"] = count
            self._write_study()


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
