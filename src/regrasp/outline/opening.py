"""Files opened with care: of a bounded size, and no device that never ends."""

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import Any

from regrasp.errors import InvalidInput

_LONGEST = 300  # characters of another library's message


@contextmanager
def naming(file: Any) -> Iterator[None]:
    """Put the file's name before the message of every ``InvalidInput`` raised inside."""
    try:
        yield
    except InvalidInput as error:
        name = str(file)
        raise InvalidInput(f"{name if name.isprintable() else ascii(name)}: {error}") from None


def read_bytes(path: Path, what: str, most: int) -> bytes:
    """The bytes of a regular file of at most ``most`` of them, opened without waiting for a writer."""
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError, ValueError):
        raise InvalidInput(f"expected a file with {what}, found none") from None
    except OSError as error:
        raise InvalidInput(f"the file cannot be opened: {reason(error)}") from None
    mode = os.fstat(handle).st_mode
    if not S_ISREG(mode):
        os.close(handle)
        if S_ISDIR(mode):
            raise InvalidInput(f"expected a file with {what}, found none")
        raise InvalidInput(f"expected a file with {what}; this is a device, whose end nobody knows")
    with os.fdopen(handle, "rb") as file:
        try:
            data = file.read(most + 1)
        except OSError as error:
            raise InvalidInput(f"the file cannot be read: {reason(error)}") from None
    if len(data) > most:
        raise InvalidInput(
            f"the file is longer than the {most / 1e6:.0f} MB that are read; keep only the object in it"
        )
    return data


def decoded(data: bytes) -> str:
    """Text in UTF-8 or UTF-16, by its first bytes, else Latin-1, which never fails."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            pass
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def reason(error: BaseException) -> str:
    """What another library says, on one line of bounded length."""
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    words = " ".join(text[: 2 * _LONGEST].split()) or type(error).__name__
    printable = "".join(letter if letter.isprintable() else "?" for letter in words)
    return printable if len(printable) <= _LONGEST else printable[:_LONGEST] + "..."


@contextmanager
def quiet(logger: str) -> Iterator[None]:
    """Without what another library would log: what matters of it is an error or a note here."""
    log = logging.getLogger(logger)
    before = log.level
    log.setLevel(logging.CRITICAL + 1)  # which its children take from it, unlike being disabled
    try:
        yield
    finally:
        log.setLevel(before)
