"""The process that solves. It does one thing at a time, when asked, and may be killed at any moment.

    ("load", Solver)                       -> ("loaded",)
    ("prepare", program, before, options)  -> ("prepared",)
    ("solve",)                             -> ("answer", Answer, seconds, bytes), ("error", words, seconds)
                                              or ("memory", words)

A reply of ("error", words, None) may come to anything.

The program is brought into the solver's own form before the clock starts. With ``before``, a solve is a warm
one: a session solves ``before`` untimed, is given the right side of ``program``, and only that and the solve
after it are timed.
"""

import contextlib
import ctypes
import gc
import pickle
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter
from typing import Any

from regrasp.bench.problems.answer import printable, understood
from regrasp.bench.running.machine import can_limit_memory
from regrasp.bench.running.solvers import Solver
from regrasp.process_limits import die_with, limit_memory
from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Call
from regrasp.programs.program import Program

Once = Callable[[], tuple[Answer, float]]
"""One solve: the answer and the seconds it took."""


def main(channel: int, parent: int, memory_limit: int) -> None:
    """Serve the runner with process id ``parent`` through a file descriptor until it closes it.

    memory_limit: of addresses [bytes], 0 for none; a solver that wants more is refused it.
    """
    die_with(parent)
    if can_limit_memory():
        limit_memory(memory_limit)
    _serve(Connection(channel))


def _serve(connection: Connection) -> None:
    solver: Solver | None = None
    call: Call | None = None
    once: Once | None = None
    is_first = True
    while True:
        try:
            what, *given = connection.recv()
        except EOFError:
            return
        try:
            if what == "load":
                (solver,) = given
                call = solver.load()
                gc.collect()
                gc.freeze()
                reply: tuple[Any, ...] = ("loaded",)
            elif what == "prepare":
                program, before, options = given
                assert solver is not None
                assert call is not None
                once = (
                    _cold(call, program, options)
                    if before is None
                    else _warm(solver.session(), call.layout, program, before, options)
                )
                is_first = True
                reply = ("prepared",)
            else:
                assert once is not None
                reply = _solved(once, is_first)
                is_first = False
        except BaseException as error:  # Rust's panics and sys.exit() end a solve, not the run
            reply = ("error", _words(error), None)
        connection.send(reply)


def _cold(call: Call, program: Program, options: dict[str, Any]) -> Once:
    copies = pickle.dumps(program)

    def once() -> tuple[Answer, float]:
        # Anew each time: a solver may write into it, or know it again.
        data = call.layout(pickle.loads(copies))
        started = perf_counter()
        given = call.solve(data, **options)
        took = perf_counter() - started
        return understood(given, program), took

    return once


def _warm(
    session: Callable[..., Any], layout: Callable[[Program], Any], program: Program, before: Program,
    options: dict[str, Any],
) -> Once:  # fmt: skip
    def once() -> tuple[Answer, float]:
        opened = session(layout(before), **options)
        opened.solve()
        data = layout(program)
        started = perf_counter()
        opened.update(data)
        given = opened.solve()
        took = perf_counter() - started
        return understood(given, program), took

    return once


def _solved(once: Once, is_first: bool) -> tuple[Any, ...]:
    """One solve with the garbage collector off, and what memory the first of its kind took."""
    gc.collect()
    before = _forget_peak() if is_first else None
    gc.disable()
    started = perf_counter()
    try:
        answer, took = once()
    except MemoryError as error:
        return "memory", _words(error)
    except BaseException as error:
        return "error", _words(error), perf_counter() - started
    finally:
        gc.enable()
    peak = None if before is None else _status("VmHWM")
    return "answer", answer, took, None if before is None or peak is None else max(peak - before, 0)


def _forget_peak() -> int | None:
    """Give free memory back, set the peak of the resident set to what it is now and return that [bytes]."""
    try:
        ctypes.CDLL(None).malloc_trim(0)
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except (AttributeError, OSError):
        return None
    return _status("VmRSS")


def _status(name: str) -> int | None:
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
            if line.startswith(name + ":"):
                return int(line.split()[1]) * 1024
    return None


def _words(error: BaseException) -> str:
    return f"{type(error).__name__}: {printable(error)}"
