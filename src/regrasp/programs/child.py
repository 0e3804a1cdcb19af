"""A back end in a process of its own, which can be ended and whose crash ends nothing else."""

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from contextlib import suppress
from math import inf
from multiprocessing import Pipe
from typing import TYPE_CHECKING, Any

from regrasp.errors import RegraspError
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, failed

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

_CODE = """
import json, sys
path, channel = json.loads(sys.argv[1])
sys.path[:] = path
from regrasp.programs.child_side import serve
serve(channel)
"""
_LOOK = 0.1  # seconds between looks whether a silent process lives
_START = 60.0
"""How long a process may take to start and to import a solver [s]."""


def solved_apart(
    program: Program, backend: str, time_limit: float | None, options: dict[str, Any]
) -> Solution:
    """What ``backends.asked`` answers in another process within ``time_limit`` [s]."""
    ours, theirs = Pipe()
    process = subprocess.Popen(
        [sys.executable, "-c", _CODE, json.dumps([sys.path, theirs.fileno()])],
        pass_fds=[theirs.fileno()],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # with what the solver starts
    )
    theirs.close()
    try:
        ours.send_bytes(pickle.dumps((program, backend, options)))
        if not answers(ours, process, _START):
            return failed(program, backend, f"its process did not start within {_START:g} s")
        ours.recv_bytes()
        if not answers(ours, process, inf if time_limit is None else time_limit):
            return failed(program, backend, f"no answer within {time_limit:g} s")
        answer = pickle.loads(ours.recv_bytes())
    except (EOFError, OSError):
        code = process.wait()
        ended = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit status {code}"
        return failed(program, backend, f"crashed: its process was ended {ended}")
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        ours.close()
    if isinstance(answer, RegraspError):
        raise answer
    given: Solution = answer
    return Solution(program, backend, given.status, *(getattr(given, name) for name in _REST))


def answers(ours: "Connection[Any, Any]", process: subprocess.Popen[bytes], within: float) -> bool:
    """Whether something can be read within so many seconds; ``EOFError`` once the process ended without.

    What a solver started holds the pipe open, so that its end says nothing of the solver's.
    """
    end = time.monotonic() + within
    while not ours.poll(min(_LOOK, max(end - time.monotonic(), 0.0))):
        if process.poll() is not None and not ours.poll(0):
            raise EOFError
        if time.monotonic() >= end:
            return False
    return True


_REST = ("value", "duals", "iterations", "build_time", "solve_time", "said")
