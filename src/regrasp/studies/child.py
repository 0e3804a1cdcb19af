"""The process that does cases, one at a time, and may be killed at any moment.

task (bytes)              -> ("ready", machine, versions) or ("cannot", words)
[(number, case), ...]     -> (number, Outcome) for each, or ("cannot", words)

After "cannot" it ends.
"""

import pickle
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

from regrasp.errors import InvalidInput
from regrasp.process_limits import die_with, limit_memory
from regrasp.studies.task import NotKept, Task, machine, versions


def main(channel: int, parent: int, memory_limit: int) -> None:
    """Serve the process ``parent`` through a file descriptor until it closes it.

    memory_limit: of addresses [bytes], 0 for none.
    """
    die_with(parent)
    limit_memory(memory_limit)
    connection: Connection[Any, Any] = Connection(channel)
    with suppress(EOFError, BrokenPipeError):
        try:
            task: Task = pickle.loads(connection.recv_bytes())
            function = task.function()
        except InvalidInput as error:
            connection.send(("cannot", str(error)))
            return
        except Exception as error:  # of a module that is imported, or of what cases share
            connection.send(("cannot", f"{type(error).__name__}: {error}"))
            return
        connection.send(("ready", machine(), versions()))
        while True:
            for number, case in connection.recv():
                try:
                    outcome = task.outcome(function, case)
                except NotKept as error:
                    connection.send(("cannot", str(error)))
                    return
                connection.send((number, outcome))
