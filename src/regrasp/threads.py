"""How many threads share the work on arrays: one answer for compiled loops and for NumPy."""

import os
import sys


def threads() -> int:
    """As many as Numba was told to use, ``NUMBA_NUM_THREADS``, or the cores this process may use.

    Numba is asked only where it is loaded.
    """
    parallel = sys.modules.get("numba.np.ufunc.parallel")
    if parallel is not None and getattr(parallel, "_is_initialized", False):
        return int(parallel.get_num_threads())
    config = sys.modules.get("numba.core.config")
    if config is not None and hasattr(config, "NUMBA_NUM_THREADS"):
        return int(config.NUMBA_NUM_THREADS)
    given = os.environ.get("NUMBA_NUM_THREADS", "")
    if given.isdecimal() and int(given):
        return int(given)
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
