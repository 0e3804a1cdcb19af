"""A back end in a process of its own, which can be ended and whose crash ends nothing else."""

import json
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from math import inf
from multiprocessing import Pipe
from threading import TIMEOUT_MAX, Event, Timer
from typing import TYPE_CHECKING, Any

from regrasp.errors import InvalidInput, RegraspError, told
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
    if os.name != "posix":
        raise InvalidInput(
            f"a process of its own for {backend} is handed a pipe as POSIX systems do; "
            "leave isolated and time_limit out"
        )
    try:
        question = pickle.dumps((program, backend, options))
    except Exception as error:
        raise InvalidInput(f"options for another process must be plain values; {told(error)}") from None
    ours, process = piped(_CODE)
    answering, late = False, Event()
    try:
        with ended_after(process, _START) as late:
            ours.send_bytes(question)
            awaited(ours, process)
            ours.recv_bytes()
        answering = True
        with ended_after(process, inf if time_limit is None else time_limit) as late:
            awaited(ours, process)
            reply = ours.recv_bytes()
    except (EOFError, OSError):
        if late.is_set():
            no = f"no answer within {time_limit:.3g} s"
            return failed(
                program, backend, no if answering else f"its process did not start within {_START:g} s"
            )
        code = process.wait()
        ended = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit status {code}"
        return failed(program, backend, f"crashed: its process was ended {ended}")
    finally:
        end_group(process)
        process.wait()
        ours.close()
    try:
        answer = pickle.loads(reply)
    except Exception as error:
        return failed(program, backend, f"its answer is none that can be read; {told(error)}")
    if isinstance(answer, RegraspError):
        raise answer
    given: Solution = answer
    return Solution(program, backend, given.status, *(getattr(given, name) for name in _REST))


def piped(
    code: str, *more: int, environment: Mapping[str, str] | None = None
) -> tuple["Connection[Any, Any]", subprocess.Popen[bytes]]:
    """Our end of a pipe, and the process that runs ``code`` at the other; what it starts is of its session.

    The code finds ``sys.path``, the number of its end and ``more`` in its argument, as JSON. An interrupt
    from the keyboard is for whoever started it to handle.
    """
    ours, theirs = Pipe()
    process = subprocess.Popen(
        [sys.executable, "-c", code, json.dumps([sys.path, theirs.fileno(), *more])],
        pass_fds=[theirs.fileno()],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | (environment or {}),
        start_new_session=True,
    )
    theirs.close()
    return ours, process


@contextmanager
def ended_after(process: subprocess.Popen[bytes], seconds: float) -> Iterator[Event]:
    """The process and what it started are killed if the block takes longer, whatever it waits for.

    So a message that nobody reads is given up, and a reply that stops halfway. Yields an event that is set
    where that happened; the block then sees an ``EOFError`` or an ``OSError``, or is just through.
    """
    late = Event()

    def end() -> None:
        late.set()
        end_group(process)

    timer = Timer(min(seconds, TIMEOUT_MAX), end)
    timer.daemon = True
    timer.start()
    try:
        yield late
    finally:
        timer.cancel()


def end_group(process: subprocess.Popen[bytes]) -> None:
    """Kill a process that leads a session, and what it has started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def awaited(ours: "Connection[Any, Any]", process: subprocess.Popen[bytes]) -> None:
    """Return once something can be read; ``EOFError`` once the process ended without.

    What a solver started holds the pipe open, so that its end says nothing of the solver's.
    """
    while not ours.poll(_LOOK):
        if process.poll() is not None and not ours.poll(0):
            raise EOFError


_REST = ("value", "duals", "iterations", "build_time", "solve_time", "said")
