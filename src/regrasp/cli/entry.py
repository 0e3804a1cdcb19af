"""The program: its commands, and how a run ends."""

import gc
import os
import signal
import sys
import warnings
from contextlib import ExitStack, suppress
from io import TextIOWrapper
from types import FrameType
from typing import Any

import click

from regrasp import __version__
from regrasp.cli.benchmarking import bench
from regrasp.cli.exploring import explore
from regrasp.cli.planning import demo, plan
from regrasp.cli.scenarios import new, schema
from regrasp.cli.simulating import simulate
from regrasp.cli.speech import say_json, wants_json
from regrasp.cli.statuses import (
    BAD_INPUT,
    HUNG_UP,
    INTERRUPTED,
    PIPE_CLOSED,
    TERMINATED,
    VERIFIED,
    facts_of,
    status_of,
)
from regrasp.cli.sweeping import sweep
from regrasp.cli.verifying import verify
from regrasp.cli.warming import warm_up
from regrasp.errors import RegraspError

_COMPLETING = "_REGRASP_COMPLETE"


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="regrasp")
def commands() -> None:
    """Contact forces while a grasp changes: planned, proven and explained.

    Exit status: 0 for a plan that verified, 1 for one that did not, 2 for bad input, 3 for an infeasible
    task.
    """


for command in (demo, new, explore, plan, verify, simulate, schema, bench, sweep, warm_up):
    commands.add_command(command)


class _Ended(SystemExit):
    """A signal that asks the program to end.

    Everything clears up as at an interrupt from the keyboard, which searches answer by the best so far; this
    they do not hear.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def run() -> None:
    """Run the command line and exit with its status; an error is one message on stderr."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal need not know every letter
    with ExitStack() as heard:
        _hear_signals(heard)
        heard.enter_context(warnings.catch_warnings())
        warnings.showwarning = _warn
        status = _ended()
        gc.freeze()  # all of it goes with the process: a last look for garbage takes a fifth of a second
        sys.exit(status)


def _ended() -> int:
    """The status of a run whose output is out, or dropped."""
    try:
        status = _run()
        sys.stdout.flush()
    except BrokenPipeError:
        status = PIPE_CLOSED
    except OSError as error:
        _complain(f"Error: output cannot be written: {error.strerror or error}")
        status = BAD_INPUT
    if status in (PIPE_CLOSED, BAD_INPUT):
        _drop_output()
    return status


def _run() -> int:
    error: BaseException
    try:
        facts = commands(standalone_mode=False, prog_name="regrasp")
        if isinstance(facts, int):  # of --help and --version
            return facts
        if wants_json() and facts is not None:
            say_json(facts)
        return VERIFIED
    except click.ClickException as wrong:
        status, message, error = BAD_INPUT, wrong.format_message(), wrong
        wrong.show()
    except (click.Abort, KeyboardInterrupt, _Ended) as stop:
        status, message = _stopped(stop)
        error = stop
        _complain(message)
    except SystemExit as stop:  # click's way out, of completion and where nobody reads what it prints
        if stop.code == 1 and _COMPLETING not in os.environ:
            return PIPE_CLOSED
        raise
    except RegraspError as problem:
        status, message, error = status_of(problem), str(problem), problem
        _complain(f"Error: {message}")
    if wants_json():
        say_json(facts_of(error, status, message))
    return status


def _stopped(stop: BaseException) -> tuple[int, str]:
    """The status of a run that was stopped, and what is said."""
    if isinstance(stop, _Ended):
        return (TERMINATED if stop.number == signal.SIGTERM else HUNG_UP), "Ended."
    heard = stop.__cause__ if isinstance(stop, click.Abort) else stop
    return INTERRUPTED, f"Interrupted: {heard}" if str(heard or "") else "Interrupted."  # a search says more


def _complain(text: str) -> None:
    """On stderr, if somebody can read it."""
    with suppress(OSError):
        click.echo(text, err=True)


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    """A doubt, on a line of stderr."""
    _complain(f"Warning: {message}")


def _hear_signals(heard: ExitStack) -> None:
    """Let requests to end the program be errors while it runs, so that temporary files are cleared."""
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            with suppress(ValueError):  # not in the main thread
                heard.callback(signal.signal, number, signal.signal(number, _end))


def _end(number: int, frame: FrameType | None) -> None:
    signal.signal(number, signal.SIG_IGN)  # clearing up is not interrupted a second time
    raise _Ended(number)


def _drop_output() -> None:
    """What nobody takes is not tried again when the interpreter ends."""
    with suppress(OSError, ValueError):
        sys.stdout.flush()
        return
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
