"""A back end in a process of its own, which can be ended and whose crash ends nothing else."""

import json
import pickle
import subprocess
import sys
from multiprocessing import Pipe
from signal import Signals
from typing import Any

from regrasp.errors import RegraspError
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, failed

_CODE = """
import json, sys
path, channel = json.loads(sys.argv[1])
sys.path[:] = path
from regrasp.programs.child_side import serve
serve(channel)
"""
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
    )
    theirs.close()
    try:
        ours.send_bytes(pickle.dumps((program, backend, options)))
        if not ours.poll(_START):
            return failed(program, backend, f"its process did not start within {_START:g} s")
        ours.recv_bytes()
        if not ours.poll(time_limit):
            return failed(program, backend, f"no answer within {time_limit:g} s")
        answer = pickle.loads(ours.recv_bytes())
    except (EOFError, OSError):
        code = process.wait()
        ended = f"by {Signals(-code).name}" if code < 0 else f"with exit status {code}"
        return failed(program, backend, f"crashed: its process was ended {ended}")
    finally:
        process.kill()
        process.wait()
        ours.close()
    if isinstance(answer, RegraspError):
        raise answer
    given: Solution = answer
    return Solution(program, backend, given.status, *(getattr(given, name) for name in _REST))


_REST = ("value", "duals", "iterations", "build_time", "solve_time", "said")
