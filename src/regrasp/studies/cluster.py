"""Cases on a dask cluster: its scheduler and its retries; each of its workers has a process for the cases.

So a case that hangs is ended, and takes no worker of the cluster with it. The task, with what cases share, is
sent to each worker once.
"""

import pickle
import threading
from contextlib import suppress
from hashlib import blake2b
from importlib import import_module
from typing import Any, Self

from regrasp.errors import InvalidInput, RegraspError, shown
from regrasp.studies.task import Task
from regrasp.studies.worker import Batch, Done, Limits, Worker

CONNECT = "10s"
_GRACE = 4  # looks in a row at a client that is not connected, before its scheduler counts as gone
_PATIENCE = 30  # seconds that workers may take to come back
_SHORT = 2**13  # bytes of a task that are sent with every batch
_MOST_CANCELLED = 1000
_CANCELLED = ("CancelledError", "FutureCancelledError", "CommClosedError")
_GONE = "the dask scheduler went away"
_here = threading.local()
_all: list[tuple[bytes, Worker]] = []


class Cluster:
    """The workers of an existing cluster.

    client: a ``dask.distributed.Client``, or the address of a scheduler. Raises ``RegraspError`` where no
    scheduler answers there.
    """

    def __init__(self, task: Task, client: Any, limits: Limits) -> None:
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise ImportError("clusters need dask and distributed: pip install 'regrasp[study]'") from None
        self._own = isinstance(client, str)
        if self._own:
            try:
                client = distributed.Client(client, timeout=CONNECT, set_as_default=False)
            except (OSError, TimeoutError, ValueError) as error:
                raise RegraspError(f"no dask scheduler answers at {shown(client)}: {error}") from None
        if not isinstance(client, distributed.Client):
            raise InvalidInput(f"client must be a dask Client or a scheduler's address, got {shown(client)}")
        if client.asynchronous:
            raise InvalidInput("client must be a dask Client with asynchronous=False")
        self._client: Any = client
        self._limits = limits
        self._silent = self._cancelled = 0
        self._sent: Any = None
        self._payload = pickle.dumps(task)
        self.at_once = sum(client.nthreads().values())
        if not self.at_once:
            raise RegraspError("the dask cluster has no workers; start some first")
        self.said = f"on {self.at_once} threads of {client.scheduler_info()['address']}"
        self.dashboard: str | None = client.dashboard_link

    def __enter__(self) -> Self:
        self._send()
        return self

    def __exit__(self, *error: object) -> None:
        if self._client.status == "running":
            with suppress(Exception):
                self._client.run(_close, _digest(self._payload))
        if self._own:
            with suppress(Exception):
                self._client.close(timeout=2)

    def submit(self, batch: Batch) -> Any:
        """A future of what a worker of the cluster makes of a batch."""
        return self._client.submit(_done, self._sent, list(batch), self._limits, pure=False)

    def lost(self) -> str | None:
        """Whether the scheduler is gone: not there at several looks in a row."""
        self._silent = 0 if self._client.status == "running" else self._silent + 1
        if self._client.status in ("closed", "closing") or self._silent >= _GRACE:
            return _GONE
        return None

    def killed(self, error: BaseException) -> bool:
        """Whether a batch ended the workers that tried it; else it was lost and may be handed out again.

        Raises ``RegraspError`` where that would help nothing.
        """
        from distributed import KilledWorker

        if isinstance(error, KilledWorker):
            return True
        if type(error).__name__ not in _CANCELLED:
            raise RegraspError(f"the cluster cannot do a batch: {type(error).__name__}: {error}")
        self._cancelled += 1
        try:
            if self._client.status != "running" or self._cancelled > _MOST_CANCELLED:
                raise RegraspError(_GONE)
            self._send()  # the workers that had it may be gone
        except (OSError, TimeoutError) as no:
            raise RegraspError(_GONE) from no
        return False

    def _send(self) -> None:
        """Send the task to each worker once; one that is short goes with each batch."""
        self._sent = self._payload
        if len(self._payload) > _SHORT:
            self._sent = self._client.scatter(self._payload, broadcast=True, hash=False, timeout=_PATIENCE)


def _done(task: bytes, batch: Batch, limits: Limits) -> Done:
    """Do a batch in the process that belongs to this thread of a cluster's worker."""
    wanted = (_digest(task), limits)
    if getattr(_here, "wanted", None) != wanted or _here.worker.closed:
        if hasattr(_here, "worker"):
            _here.worker.close()
            _here.worker.clear()
        _here.wanted, _here.worker = wanted, Worker(task, limits)
        _all.append((_digest(task), _here.worker))
    done: Done = _here.worker.done(batch)
    return done


def _close(task: bytes) -> None:
    """End the processes of a task on this worker of a cluster; a later study starts its own."""
    for entry in [entry for entry in _all if entry[0] == task]:
        entry[1].close()
        _all.remove(entry)


def _digest(task: bytes) -> bytes:
    return blake2b(task).digest()
