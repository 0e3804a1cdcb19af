"""The folder of a run: rows appended durably, so that a run killed at any moment resumes where it was."""

import json
import os
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

from regrasp.bench.running.result import Key, Row, row_of
from regrasp.disk.locks import HAS_LOCKS, is_locked
from regrasp.errors import InvalidInput

ROWS, RUN = "rows.jsonl", "run.json"
# Of a run that goes on: more solvers change nothing for the rows of the others.
_FREE = ("solvers", "started")
COMPARABLE, NOT_COMPARABLE = "comparable", "not comparable"
"""What a run says of its times: each solve had the machine to itself, or not."""


def read_rows(folder: Path) -> list[Row]:
    """The rows of a folder; a half-written last line is left out.

    Raises ``InvalidInput`` for a folder without rows and for a broken line.
    """
    path = folder / ROWS
    if not path.exists():
        raise InvalidInput(f"{folder} has no {ROWS}; fill it with  regrasp bench -o {folder}")
    return list(_parsed(path.read_bytes(), path))


def stored_rows(folder: Path) -> list[Row]:
    """The rows of a folder as ``read_rows`` has them; none where no run has begun."""
    return read_rows(folder) if (folder / ROWS).exists() else []


def read_run(folder: Path) -> dict[str, Any]:
    """Machine, versions and limits of a folder's run. Raises ``InvalidInput`` if there are none."""
    path = folder / RUN
    if not path.exists():
        raise InvalidInput(f"{folder} has no {RUN}; fill it with  regrasp bench -o {folder}")
    try:
        run = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        run = None
    if not isinstance(run, dict) or not isinstance(run.get("solvers"), dict):
        raise InvalidInput(f"{path} does not say where the rows come from; give another folder")
    return run


def times_compare(run: dict[str, Any]) -> bool:
    """Whether each solve of a run had the same machine to itself."""
    return bool(run.get("times", COMPARABLE) == COMPARABLE and run.get("jobs", 1) == 1)  # jobs: of old runs


class Store:
    """The rows of one run, open for more; a context manager that no second run can enter meanwhile.

    run: what must be alike for rows to be laid side by side (machine, versions, time limit). Raises
    ``InvalidInput`` on entering a folder whose rows come from another such run, or from nobody knows which,
    or that a run is filling.
    """

    def __init__(self, folder: Path, run: dict[str, Any]) -> None:
        self._folder, self._run = folder, run
        self.rows: dict[Key, Row] = {}

    def __enter__(self) -> "Store":
        path = self._folder / ROWS
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
        except OSError as error:
            raise InvalidInput(f"{self._folder} must be a folder to write in: {error}") from error
        try:
            if HAS_LOCKS and not is_locked(self._file):
                raise InvalidInput(f"another run is filling {self._folder}; give another folder")
            content = path.read_bytes()
            self.rows = {row.key: row for row in _parsed(content, path)}
            self._agree()
            os.ftruncate(self._file, _whole(content))
            _sync_folder(self._folder)
        except BaseException:
            os.close(self._file)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._file)

    def append(self, row: Row) -> None:
        """Write a row; when this returns it is on the disk."""
        line = (row.line() + "\n").encode()
        if row.key in self.rows:
            raise InvalidInput(f"there is a row of {row.key} already")
        while line:
            line = line[os.write(self._file, line) :]
        os.fsync(self._file)
        self.rows[row.key] = row

    def _agree(self) -> None:
        """Write down what the run is, or compare it with what the rows here come from."""
        path = self._folder / RUN
        if self.rows and not path.exists():
            raise InvalidInput(
                f"{self._folder} has rows but no {RUN} that says where they come from; give another folder"
            )
        if self.rows:
            before = read_run(self._folder)
            both = before.get("solvers", {}).keys() & self._run["solvers"].keys()
            now = {f"version of {name}": self._run["solvers"][name] for name in both}
            then = {f"version of {name}": before["solvers"][name] for name in both}
            now |= {key: value for key, value in self._run.items() if key not in _FREE}
            then |= {key: before.get(key) for key in now if key not in then}
            differs = [f"{key}: {then[key]} there, {now[key]} now" for key in now if then[key] != now[key]]
            if differs:
                raise InvalidInput(
                    f"the rows in {self._folder} come from another run ({'; '.join(sorted(differs))}); "
                    "give another folder, or the same options"
                )
            started = {"started": before["started"]} if "started" in before else {}
            self._run = self._run | started | {"solvers": before["solvers"] | self._run["solvers"]}
        draft = path.with_suffix(".part")
        with draft.open("w", encoding="utf-8") as file:
            json.dump(self._run, file, indent=2)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)


def _whole(content: bytes) -> int:
    """Bytes up to the end of the last whole line."""
    return content.rfind(b"\n") + 1


def _parsed(content: bytes, path: Path) -> Iterator[Row]:
    lines: dict[Key, int] = {}
    for number, line in enumerate(content[: _whole(content)].splitlines(), 1):
        try:
            row = row_of(json.loads(line))
        except (ValueError, TypeError) as error:
            raise InvalidInput(
                f"{path}, line {number}: not a row of results: {error}; take the line out to solve it again"
            ) from error
        if row.key in lines:
            raise InvalidInput(
                f"{path}, line {number}: the same solve as line {lines[row.key]}; take one of them out"
            )
        lines[row.key] = number
        yield row


def _sync_folder(folder: Path) -> None:
    """Make the names in a folder durable, too."""
    if os.name != "posix":  # folders cannot be opened
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
