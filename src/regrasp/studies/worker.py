"""A process that does cases, seen from who hands them out: started, asked, killed when it hangs, replaced."""

import os
import signal
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import suppress
from time import monotonic
from typing import Any, NamedTuple

from regrasp.errors import InvalidInput
from regrasp.process_limits import PINNED
from regrasp.programs.child import end_group, piped
from regrasp.studies.cases import Case
from regrasp.studies.task import LATE, LOST, Outcome

Batch = Sequence[tuple[int, Case]]
_CODE = """
import json, sys
path, channel, parent, memory = json.loads(sys.argv[1])
sys.path[:] = path
from regrasp.studies.child import main
main(channel, parent, memory)
"""
_LOOK = 0.1  # seconds between looks whether a silent process lives
_START = 120.0  # seconds that a process may take to import what it needs
_AGAIN = 2  # times a case is tried again in another process where one was killed, as dask does
_STARTS = 10  # processes in a row that may end before they are ready


class Limits(NamedTuple):
    """What a case may take: seconds, and bytes of addresses (0 for any number)."""

    seconds: float | None = None
    memory: int = 0


class Done(NamedTuple):
    """What came of a batch, and where."""

    outcomes: list[tuple[int, Outcome]]
    machine: str
    versions: str


class Refused(InvalidInput):
    """The task cannot be done, whatever the case. Ends the run."""


class _Ended(Exception):
    """The process is gone. Carries the ``verdict`` for the case it was at."""

    def __init__(self, verdict: str, said: str) -> None:
        super().__init__(said)
        self.verdict = verdict


class Worker:
    """One process that does cases; started when first asked and again after it was lost.

    task: a pickled ``Task``.
    """

    def __init__(self, task: bytes, limits: Limits) -> None:
        self._task, self._limits = task, limits
        self._process: subprocess.Popen[bytes] | None = None
        self._place = ("", "")
        self.closed = False
        """Whether it does nothing any more."""

    def done(self, batch: Batch) -> Done:
        """What comes of each case. One that ends its process again and again, or hangs, is an outcome, too.

        Raises ``Refused`` where the task itself cannot be done.
        """
        outcomes, tries, left = [], 0, list(batch)
        while left:
            started = monotonic()
            try:
                for outcome in self._asked(left):
                    outcomes.append(outcome)
                    tries, started = 0, monotonic()
                left = []
            except _Ended as end:
                self.clear()
                left = list(batch)[len(outcomes) :]
                if end.verdict == LOST and tries < _AGAIN:
                    tries += 1
                    continue
                number, _ = left.pop(0)
                outcomes.append((number, Outcome(end.verdict, {}, str(end), None, monotonic() - started)))
                tries = 0
        return Done(outcomes, *self._place)

    def close(self) -> None:
        """End the process, from any thread; a batch that is awaited is refused."""
        self.closed = True
        if self._process is not None:
            end_group(self._process)

    def _asked(self, batch: Batch) -> Iterator[tuple[int, Outcome]]:
        if self._process is None:
            self._start()
        try:
            self._connection.send(list(batch))
        except OSError:
            raise self._ended() from None
        for _ in batch:
            reply = self._reply(self._limits.seconds)
            if reply[0] == "cannot":
                raise Refused(reply[1])
            yield reply

    def _start(self) -> None:
        """Have a process that is ready; those that end before are no case's fault."""
        for _ in range(_STARTS):
            try:
                self._open()
                return
            except _Ended as end:
                self.clear()
                said = str(end)
        raise Refused(f"{_STARTS} processes ended before they were ready: {said}")

    def _open(self) -> None:
        if os.name != "posix":
            raise Refused("workers are handed a pipe as POSIX systems do; give workers=0")
        if self.closed:
            raise Refused("the run has ended")
        pinned = dict.fromkeys((*PINNED, "NUMBA_NUM_THREADS"), "1")
        self._connection, self._process = piped(_CODE, os.getpid(), self._limits.memory, environment=pinned)
        if self.closed:  # meanwhile
            end_group(self._process)
        try:
            self._connection.send_bytes(self._task)
        except OSError:
            raise self._ended() from None
        reply = self._reply(_START)
        if reply[0] == "cannot":
            raise Refused(f"workers cannot begin: {reply[1]}")
        self._place = reply[1:]

    def _reply(self, within: float | None) -> tuple[Any, ...]:
        """The next message. Raises ``_Ended`` if the process ends, or is ended, before."""
        deadline = None if within is None else monotonic() + within
        assert self._process is not None
        try:
            while not self._connection.poll(
                _LOOK if deadline is None else max(min(_LOOK, deadline - monotonic()), 0)
            ):
                if self._process.poll() is not None and not self._connection.poll(0):
                    raise EOFError
                if deadline is not None and monotonic() >= deadline:
                    raise _Ended(LATE, f"no answer within {within:g} s")
            reply: tuple[Any, ...] = self._connection.recv()
        except (EOFError, OSError):
            raise self._ended() from None
        return reply

    def _ended(self) -> "_Ended":
        """How the process ended by itself."""
        if self.closed:
            raise Refused("the run has ended")
        assert self._process is not None
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        code = self._process.poll()
        if code is None:
            return _Ended(LOST, "the process closed its pipe")
        if code < 0:
            return _Ended(LOST, f"the process was ended by {signal.Signals(-code).name}")
        return _Ended(LOST, f"the process ended with exit status {code}")

    def clear(self) -> None:
        """End the process, if there is one, and forget it."""
        if self._process is not None:
            end_group(self._process)
            self._process.wait()
            self._connection.close()
        self._process = None
