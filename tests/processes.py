"""Processes as the system sees them."""

from pathlib import Path


def is_running(pid: int) -> bool:
    """Whether a process runs; one that has ended and waits to be cleared away does not."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"
