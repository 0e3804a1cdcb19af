"""Locks on files and folders that end with the process that holds them, where the system has any."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

fcntl: Any
try:
    import fcntl
except ImportError:  # not a POSIX system
    fcntl = None

HAS_LOCKS = fcntl is not None


def is_locked(number: int, *, wait: bool = False) -> bool:
    """Lock an open file or folder; False where another process holds it, or there are no locks."""
    if not HAS_LOCKS:
        return False
    try:
        fcntl.flock(number, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:  # held by another, or the disk knows no locks
        return False
    return True


@contextmanager
def locked(folder: Path, *, wait: bool) -> Iterator[bool]:
    """A folder that is ours until the block ends; False where it is another's or there are no locks."""
    number = None
    try:
        if HAS_LOCKS:
            with suppress(OSError):
                number = os.open(folder, os.O_RDONLY)
        yield number is not None and is_locked(number, wait=wait)
    finally:
        if number is not None:
            os.close(number)
