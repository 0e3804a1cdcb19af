"""The process in which a back end is apart; see ``child``."""

import os
import pickle
from multiprocessing.connection import Connection
from typing import Any

from regrasp.errors import RegraspError
from regrasp.programs.backends import asked, warm


def serve(channel: int) -> None:
    """Answer one question that comes through a file descriptor."""
    connection = Connection(channel)
    program, backend, options = pickle.loads(connection.recv_bytes())
    warm(backend)
    connection.send_bytes(b"ready")
    try:
        answer: Any = asked(program, backend, options)
    except RegraspError as error:
        answer = error
    connection.send_bytes(pickle.dumps(answer))
    connection.close()
    os._exit(0)
