"""Parts of a study: Parquet files that are whole or not there."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from regrasp.errors import InvalidInput
from regrasp.studies.columns import Columns, held, schema_of

if TYPE_CHECKING:
    import pyarrow

SUFFIX, DRAFT = ".parquet", ".draft"


def parquet() -> Any:
    """``pyarrow.parquet``.

    Raises:
        ImportError: Without pyarrow, the extra ``regrasp[study]``.
    """
    try:
        from pyarrow import parquet
    except ImportError:
        raise ImportError("studies need pyarrow: pip install 'regrasp[study]'") from None
    return parquet


def parts_in(folder: Path) -> list[Path]:
    """The parts of a study, in the order of their names."""
    return sorted(folder.glob(f"*{SUFFIX}"))


def write_part(path: Path, rows: Sequence[Mapping[str, Any]], columns: Columns) -> None:
    """Write rows; once this returns they are on the disk, and before that there is no such file."""
    import pyarrow as pa

    schema = schema_of(columns)
    arrays = [
        pa.array([held(row.get(name), kind) for row in rows], schema.field(name).type)
        for name, kind in columns.items()
    ]
    _write(path, pa.Table.from_arrays(arrays, schema=schema))


def widen_part(path: Path, columns: Columns) -> None:
    """Bring an earlier part to the columns of today, unless it has them."""
    if not read_schema(path).equals(schema_of(columns)):
        write_part(path, read_part(path).to_pylist(), columns)


def read_part(path: Path, columns: Sequence[str] | None = None) -> "pyarrow.Table":
    """The table of a part. Raises ``InvalidInput`` for a file that is none."""
    with _parsing(path):
        return parquet().read_table(path, columns=columns)


def read_schema(path: Path) -> "pyarrow.Schema":
    """The columns of a part. Raises ``InvalidInput`` for a file that is none."""
    with _parsing(path):
        return parquet().read_schema(path)


@contextmanager
def _parsing(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError) as error:
        raise InvalidInput(
            f"{path}: not a part of a study: {error}; move it away, and its rows are made again"
        ) from None


def clear_drafts(folder: Path) -> None:
    """Remove what a killed run was writing; the folder is ours."""
    for draft in folder.glob(f".*{DRAFT}"):
        draft.unlink(missing_ok=True)


def replace_file(path: Path, content: bytes) -> None:
    """Write a file whole, in the place of an earlier one."""
    draft = _draft_of(path)
    with draft.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    _place(draft, path)


def _draft_of(path: Path) -> Path:
    """Where a file is written; no pattern for parts finds it."""
    return path.with_name(f".{path.name}{DRAFT}")


def _write(path: Path, table: "pyarrow.Table") -> None:
    draft = _draft_of(path)
    with draft.open("wb") as file:
        parquet().write_table(table, file, compression="zstd")
        file.flush()
        os.fsync(file.fileno())
    _place(draft, path)


def _place(draft: Path, path: Path) -> None:
    draft.replace(path)
    if os.name != "posix":  # folders cannot be opened
        return
    number = os.open(path.parent, os.O_RDONLY)  # the name is to be durable, too
    try:
        os.fsync(number)
    finally:
        os.close(number)
