"""A worker seen from the runner: started, asked, and killed when it does not answer in time."""

import os
import signal
import subprocess
from threading import Event
from typing import Any

from regrasp.bench.running.result import CRASHED, TIMEOUT
from regrasp.errors import InvalidInput
from regrasp.process_limits import PINNED
from regrasp.programs.child import awaited, end_group, ended_after, piped

_CODE = """
import json, sys
path, channel, parent, memory = json.loads(sys.argv[1])
sys.path[:] = path
from regrasp.bench.running.worker import main
main(channel, parent, memory)
"""


class WorkerLost(Exception):
    """The worker did not come back and is gone. Carries the ``status`` and what to say of it."""

    def __init__(self, status: str, said: str) -> None:
        super().__init__(f"{status}: {said}")
        self.status, self.said = status, said


class Worker:
    """One process that solves; started when first asked and again after it was lost.

    memory_limit: [bytes] of addresses it may have, 0 for no limit.
    """

    def __init__(self, memory_limit: int) -> None:
        self._memory_limit = memory_limit
        self._process: subprocess.Popen[bytes] | None = None
        self.loaded: str | None = None

    def ask(self, *message: Any, within: float) -> tuple[Any, ...]:
        """The reply to a message. Raises ``WorkerLost`` if there is none ``within`` so many seconds."""
        if self._process is None:
            self._start()
        assert self._process is not None
        late = Event()
        try:
            with ended_after(self._process, within) as late:
                self._connection.send(message)
                awaited(self._connection, self._process)
                reply: tuple[Any, ...] = self._connection.recv()
        except (EOFError, OSError) as error:
            if late.is_set():
                self.kill()
                raise WorkerLost(TIMEOUT, f"no answer within {within:g} s") from None
            raise WorkerLost(CRASHED, self._ended()) from error
        if late.is_set():  # it was ended just after it had answered
            self.kill()
        return reply

    def kill(self) -> None:
        """End the process, whatever it is doing."""
        if self._process is not None:
            end_group(self._process)  # with what it has started; they are a session of their own
            self._process.wait()
            self._connection.close()
        self._process = self.loaded = None

    def _start(self) -> None:
        if os.name != "posix":
            raise InvalidInput(
                "the benchmark hands workers a pipe as POSIX systems do; run it on one of them"
            )
        self._connection, self._process = piped(
            _CODE, os.getpid(), self._memory_limit, environment=dict.fromkeys(PINNED, "1")
        )

    def _ended(self) -> str:
        """How the process ended, by itself; it is cleared away."""
        assert self._process is not None
        code = self._process.wait()
        self.kill()
        if code < 0:
            return f"the process was ended by {signal.Signals(-code).name}"
        return f"the process ended with exit status {code}"
