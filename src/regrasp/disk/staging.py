"""Output written whole or not at all: made in a temporary folder on the same disk, then moved into place.

A process that is killed cannot clear its temporary folder; the next one that writes to the same place does.
Which folders are abandoned is known from locks, which end with the process that holds them.
"""

import os
import shutil
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import TextIO
from weakref import finalize

from regrasp.disk.locks import HAS_LOCKS, locked
from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import file_path

_PREFIX = ".regrasp-"
# Where there are no locks, a temporary folder this old is nobody's [s].
_OLD = 86400.0


@contextmanager
def whole_path(path: str | Path) -> Iterator[Path]:
    """Where to write a file, under a name of the same ending; moved to ``path`` at the end of the block.

    What is there and is no file, a pipe or a device, is written to directly.
    Raises ``InvalidInput`` where it cannot be written.
    """
    path = file_path(path)
    with _writing(path):
        path = Path(os.path.realpath(path))  # a link stays a link
        if path.is_dir():
            raise InvalidInput(f"{path}: expected a file to write, found a folder")
        if path.exists() and not path.is_file():
            yield path
            return
        with _temporary_in(path.parent) as temporary:
            part = temporary / f"part{path.suffix}"
            yield part
            part.replace(path)


@contextmanager
def whole_file(path: str | Path) -> Iterator[TextIO]:
    """A text file that appears at ``path`` as of ``whole_path``."""
    path = file_path(path)
    with whole_path(path) as part, _writing(path), part.open("w", encoding="utf-8", newline="") as file:
        yield file


def check_folder(path: str | Path) -> None:
    """Raise ``InvalidInput`` where ``whole_folder`` could not write, so that nothing is done in vain."""
    path = file_path(path).absolute()
    if path.exists() and not path.is_dir():
        raise InvalidInput(f"{path}: expected a folder to write into, found a file")
    with _writing(path):
        there = next(folder for folder in (path, *path.parents) if folder.exists())
    if not there.is_dir():
        raise InvalidInput(f"{path}: expected a folder to write into, found the file {there}")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InvalidInput(f"{path}: cannot be written: {there} may not be written to")


@contextmanager
def whole_folder(path: str | Path) -> Iterator[Path]:
    """A folder to write files into; they appear in ``path`` together when the block ends without error.

    A folder that is not there is made, its parents too. In one that is, files of equal name are replaced
    and others left alone; an error, or an interrupt, half-way puts back what was there. Of two that write to
    one folder, one comes after the other.
    Raises ``InvalidInput`` where it cannot be written.
    """
    with _writing(file_path(path)):
        path = Path(path).resolve()
        if path.exists() and not path.is_dir():
            raise InvalidInput(f"{path}: expected a folder to write into, found a file")
        missing = path  # the uppermost folder that is not there, or the folder itself
        while not missing.parent.exists():
            missing = missing.parent
        beside = path if path.is_dir() else missing.parent
        with _temporary_in(beside) as temporary:
            made = temporary / (missing.name if beside != path else "new")
            folder = made / path.relative_to(missing)
            folder.mkdir(parents=True)
            yield folder
            with locked(beside, wait=True):
                if not missing.exists():
                    made.rename(missing)
                    return
                path.mkdir(parents=True, exist_ok=True)  # by another run meanwhile, if it was not there
                with nullcontext() if path == beside else locked(path, wait=True):
                    _exchange(folder, path, temporary)


@contextmanager
def _temporary_in(folder: Path) -> Iterator[Path]:
    """A temporary folder in another, which is ours until the block ends; abandoned ones are cleared first."""
    made = folder / f"{_PREFIX}{os.urandom(8).hex()}"  # known before it is made: interrupts come at once
    with ExitStack() as ours:
        # When the process ends at the latest: an interrupt can keep every block below from its end.
        clear = finalize(ours, shutil.rmtree, made, ignore_errors=True)
        try:
            with locked(folder, wait=True):
                for left in folder.glob(f"{_PREFIX}*"):
                    if left.is_dir() and _is_abandoned(left):
                        shutil.rmtree(left, ignore_errors=True)
                made.mkdir(mode=0o700)
                ours.enter_context(locked(made, wait=False))
            yield made
        finally:
            try:
                shutil.rmtree(made, ignore_errors=True)
            finally:
                clear()


def _is_abandoned(folder: Path) -> bool:
    """Whether the process whose temporary folder it is has ended; its parent folder is locked by us."""
    with locked(folder, wait=False) as ended:
        if ended:
            return True
    if HAS_LOCKS and _knows_locks(folder.parent):
        return False
    with suppress(OSError):
        return time.time() - folder.stat().st_mtime > _OLD
    return False


def _knows_locks(folder: Path) -> bool:
    """Whether the disk knows locks: a folder that we hold cannot be locked once more."""
    with locked(folder, wait=False) as again:
        return not again


def _exchange(new: Path, path: Path, temporary: Path) -> None:
    """Move the files of ``new`` into ``path`` and those in their places aside; on any error, back."""
    old = temporary / f"{_PREFIX}old"
    old.mkdir()
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
