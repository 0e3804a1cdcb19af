"""What a run ran on."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

_PACKAGES = ("regrasp", "numpy", "scipy", "numba", "qpsolvers", "cvxpy")


def machine() -> dict[str, Any]:
    """Processor, cores, memory [bytes], system, Python and the packages below the solvers."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "memory": memory(),
        "system": platform.platform(),
        "python": platform.python_version(),
        **{package: _version(package) for package in _PACKAGES},
    }


def name() -> str:
    """A short name of the machine for rows."""
    return f"{_processor()}, {os.cpu_count()} cores, {platform.system()}"


def memory() -> int | None:
    """Physical memory [bytes], where the system tells."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None


def can_limit_memory() -> bool:
    """Whether the system limits the memory of a process."""
    try:
        import resource
    except ImportError:  # not a POSIX system
        return False
    return hasattr(resource, "RLIMIT_AS")


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
