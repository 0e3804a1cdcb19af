"""What a process that solves may take of the machine: one thread for each library, so much memory.

And it ends with the process that started it.
"""

import ctypes
import os
import signal
import sys
from threading import Thread
from time import sleep

PINNED = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "RAYON_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""Libraries that would use every core in every process are held to one."""

_SET_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of Linux
_LOOK = 1.0  # seconds between looks whether the parent lives, where the system does not tell


def limit_memory(memory: int) -> None:
    """Take no more addresses than ``memory`` [bytes], 0 for any number, and leave no image of a crash."""
    try:
        import resource
    except ImportError:  # not a POSIX system
        return
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if memory:
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        soft = memory if hard == resource.RLIM_INFINITY else min(memory, hard)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def die_with(parent: int) -> None:
    """End this process when the process ``parent`` ends, however it does: leave no orphan that goes on."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_SET_DEATH_SIGNAL, signal.SIGKILL)
    else:
        Thread(target=_watch, args=(parent,), daemon=True).start()
    if os.getppid() != parent:
        os._exit(1)


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        sleep(_LOOK)
    os._exit(1)
