"""Processes as the system sees them."""

import signal
from pathlib import Path


def hear_interrupts() -> None:
    """For ``preexec_fn``: children of what a shell starts in the background are deaf to SIGINT."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def is_running(pid: int) -> bool:
    """Whether a process runs; one that has ended and waits to be cleared away does not."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"
