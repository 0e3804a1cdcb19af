"""Output written whole or not at all: made in a temporary folder on the same disk, then moved into place."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TextIO

from regrasp.errors import InvalidInput


@contextmanager
def whole_file(path: str | Path) -> Iterator[TextIO]:
    """A text file that appears at ``path``, in place of an earlier one, when the block ends without error.

    Raises ``InvalidInput`` where it cannot be written.
    """
    path = Path(path)
    with _writing(path), TemporaryDirectory(prefix=".regrasp-", dir=path.parent) as temporary:
        part = Path(temporary, path.name)
        with part.open("w", encoding="utf-8", newline="") as file:
            yield file
        part.replace(path)


@contextmanager
def whole_folder(path: str | Path) -> Iterator[Path]:
    """A folder to write files into; they appear in ``path`` together when the block ends without error.

    A folder that is not there is made, its parents too. In one that is, files of equal name are replaced
    and others left alone; an error, or an interrupt, half-way puts back what was there.
    Raises ``InvalidInput`` where it cannot be written.
    """
    with _writing(Path(path)):
        path = Path(path).resolve()
        if path.is_dir():
            with TemporaryDirectory(prefix=".regrasp-", dir=path) as temporary:
                new, old = Path(temporary, "new"), Path(temporary, "old")
                new.mkdir()
                old.mkdir()
                yield new
                _exchange(new, path, old)
            return
        if path.exists():
            raise InvalidInput(f"{path}: expected a folder to write into, found a file")
        missing = path  # the uppermost folder that is not there
        while not missing.parent.exists():
            missing = missing.parent
        with TemporaryDirectory(prefix=".regrasp-", dir=missing.parent) as temporary:
            made = Path(temporary, missing.name)
            folder = made / path.relative_to(missing)
            folder.mkdir(parents=True)
            yield folder
            made.rename(missing)


def _exchange(new: Path, path: Path, old: Path) -> None:
    """Move the files of ``new`` into ``path`` and those in their places into ``old``; on any error, back."""
    names = [file.name for file in new.iterdir()]
    for name in names:
        if (path / name).is_dir():
            raise InvalidInput(f"{path / name}: expected a file to replace, found a folder")
    try:
        for name in names:
            if os.path.lexists(path / name):
                (path / name).replace(old / name)
            (new / name).replace(path / name)
    except BaseException:
        for name in names:  # what was done is read from the disk: an interrupt may come between two lines
            if not (new / name).exists():
                (path / name).unlink()
            if os.path.lexists(old / name):
                (old / name).replace(path / name)
        raise


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be written: {error.strerror or error}") from None
