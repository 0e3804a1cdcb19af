"""What a file holds, read within bounds, and errors that name the file they are about."""

import os
import select
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic

from regrasp.errors import Infeasible, InvalidInput, RegraspError
from regrasp.mechanics.value import one_line

MOST_BYTES = 256 * 2**20
"""Of a file that is read whole."""
_PATIENCE = 8.0
"""Seconds that a pipe or a terminal may say nothing, and that it may take in all."""
_BLOCK = 2**20


def text_of(path: Path, expected: str, *, most: int = MOST_BYTES) -> str:
    """The text of a UTF-8 file. Raises ``InvalidInput`` where there is none to read, or too much.

    A pipe is read, too, as long as something comes; a device that never ends is refused when it has given
    ``most`` bytes.
    """
    with reading(path, expected):
        content = _bytes_of(path, expected, most)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InvalidInput(
            f"{path}: expected {expected}, found no UTF-8 text (at byte {error.start})"
        ) from None


@contextmanager
def reading(path: Path, expected: str) -> Iterator[None]:
    """Errors of reading a file in words."""
    try:
        if path.is_dir():
            raise InvalidInput(f"{path}: expected {expected}, found a folder")
        yield
    except FileNotFoundError:
        raise InvalidInput(f"{path}: expected {expected}, found no such file") from None
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be read: {error.strerror or error}") from None


def _bytes_of(path: Path, expected: str, most: int) -> bytes:
    """At most ``most`` bytes, within bounded time."""
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        about = os.fstat(number)
        if about.st_size > most:  # a pipe, a terminal and a device have no size
            raise _too_much(path, expected, most)
        parts: list[bytes] = []
        size, deadline = 0, monotonic() + _PATIENCE
        while size <= most:
            if not stat.S_ISREG(about.st_mode) and not _has_more(number, deadline):
                raise InvalidInput(f"{path}: expected {expected}, nothing came within {_PATIENCE:g} s")
            try:
                part = os.read(number, _BLOCK)
            except BlockingIOError:
                continue
            if not part:
                return b"".join(parts)
            parts.append(part)
            size += len(part)
        raise _too_much(path, expected, most)
    finally:
        os.close(number)


def _has_more(number: int, deadline: float) -> bool:
    """Whether a pipe, a terminal or another device has something to say, or its end, before the deadline."""
    left = deadline - monotonic()
    if left <= 0:
        return False
    if os.name != "posix":  # select is for sockets alone
        return True
    return bool(select.select([number], [], [], left)[0])


def _too_much(path: Path, expected: str, most: int) -> InvalidInput:
    return InvalidInput(f"{path}: expected {expected}, found more than {most // 2**20} MiB")


@contextmanager
def naming(file: str | Path) -> Iterator[None]:
    """Put the file's name before the message of every ``InvalidInput`` and ``Infeasible`` raised inside."""
    try:
        yield
    except InvalidInput as error:
        raise type(error)(f"{file}: {error}") from None
    except Infeasible as error:
        raise Infeasible(f"{file}: {error}", error.certificate) from None


@contextmanager
def legible(names: Iterable[str]) -> Iterator[Callable[[object], str]]:
    """A function that shows values with line breaks in ``names`` escaped; errors inside are shown so, too.

    A name from a file must not forge a line of what is printed.
    """
    odd = sorted({name for name in names if not name.isprintable()}, key=len, reverse=True)

    def shown(value: object) -> str:
        text = str(value)
        for name in odd:
            text = text.replace(name, one_line(name))
        return text

    try:
        yield shown
    except RegraspError as error:
        error.args = (shown(error), *error.args[1:])
        raise
