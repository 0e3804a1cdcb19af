"""Locks on files and folders that end with the process that holds them, where the system has any."""

import os
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


def lock(folder: Path, *, wait: bool) -> int | None:
    """An open folder whose lock ends when it is closed; None where there is none to have."""
    if not HAS_LOCKS:
        return None
    try:
        number = os.open(folder, os.O_RDONLY)
    except OSError:
        return None
    if is_locked(number, wait=wait):
        return number
    os.close(number)
    return None
