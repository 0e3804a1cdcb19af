"""Functions of a case, in a module, where workers find them."""

import os
import signal
import time
from typing import Any

import numpy as np

import regrasp as rg


def product(a: float, b: float = 2.0) -> float:
    return a * b


def spun(a: float, spin: float = 0.005) -> dict[str, Any]:
    end = time.perf_counter() + spin
    while time.perf_counter() < end:
        pass
    return {"square": a * a, "root": abs(a) ** 0.5}


def removal(friction: float, seed: int) -> rg.Transition:
    rng = np.random.default_rng(seed)
    grasp = rg.Grasp(
        rg.Contact([np.cos(t), np.sin(t)], [-np.cos(t), -np.sin(t)], friction)
        for t in rng.uniform(0, 6.28, 3)
    )
    return rg.plan_removal(grasp, 0, load=rg.Wrench([0.0, -1.0]))


def fated(a: int) -> Any:
    """Every way in which a case can end."""
    if a == 1:
        rg.choose_state(rg.Grasp([rg.Contact([0, 1], [0, -1], 0.5)] * 2), rg.Wrench([0, -1.0]))
    elif a == 2:
        rg.Wrench([0])
    elif a == 3:
        raise ZeroDivisionError("nothing\nto divide by")
    elif a == 4:
        raise MemoryError
    elif a == 5:
        time.sleep(60)
    elif a == 6:
        os.kill(os.getpid(), signal.SIGKILL)
    elif a == 7:
        bytearray(2**36)
    elif a == 8:
        os._exit(7)
    return {"a_again": a}


def mixed(a: int) -> dict[str, Any]:
    """Types that widen from case to case, and a key that comes late."""
    if a < 3:
        return {"number": a, "text": a}
    return {"number": 0.5, "text": "x", "late": 7}


def echo(a: int) -> dict[str, Any]:
    return {"a": a}


def threads(a: int) -> str:
    import numba

    return f"{numba.get_num_threads()} {os.environ['OMP_NUM_THREADS']} {a}"


def entry(a: int, values: Any) -> float:
    return float(values[a])
