"""Where cases are done: in this process, in processes of this machine, on a dask cluster.

Each takes batches and gives a future for each; batches are done by ``Worker`` on the last two, so that
limits, lost workers and threads are treated alike, and rows are the same.
"""

import os
import pickle
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from queue import SimpleQueue
from types import TracebackType
from typing import Any, Protocol, Self

from regrasp.studies.task import Task, machine, versions
from regrasp.studies.worker import Batch, Done, Limits, Worker


class Engine(Protocol):
    """Takes batches of cases."""

    said: str
    """Where cases are done, in words."""
    dashboard: str | None
    """Where a browser sees more of it."""

    @property
    def at_once(self) -> int:
        """How many cases are done at a time."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

    def submit(self, batch: Batch) -> Any:
        """A future of ``Done``."""

    def lost(self) -> str | None:
        """Why nothing comes any more, in words, or None."""

    def killed(self, error: BaseException) -> bool:
        """Whether a batch ended the workers that tried it; else it is to be handed out again.

        Raises an error where neither is so.
        """


class Here:
    """This process, with nothing between a case and us."""

    said, at_once = "in this process", 1
    dashboard: str | None = None

    def __init__(self, task: Task, function: Callable[..., Any]) -> None:
        self._task, self._function = task, function

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def submit(self, batch: Batch) -> Future[Done]:
        """A future that is done."""
        future: Future[Done] = Future()
        try:
            outcomes = [(number, self._task.outcome(self._function, case)) for number, case in batch]
            future.set_result(Done(outcomes, machine(), versions()))
        except Exception as error:
            future.set_exception(error)
        return future

    def lost(self) -> None:
        """Nothing is lost."""

    def killed(self, error: BaseException) -> bool:
        """Errors here are of the task."""
        raise error


class Processes:
    """Processes of this machine; the first batch is done by one alone, which compiles what all need."""

    dashboard: str | None = None

    def __init__(self, task: Task, count: int, limits: Limits) -> None:
        self.at_once, self.said = count, f"in {count} process{'es' if count > 1 else ''}"
        payload = pickle.dumps(task)
        self._workers = [Worker(payload, limits) for _ in range(count)]

    def __enter__(self) -> Self:
        self._free: SimpleQueue[Worker] = SimpleQueue()
        for worker in self._workers:
            self._free.put(worker)
        self._threads = ThreadPoolExecutor(self.at_once)
        return self

    def __exit__(self, *error: object) -> None:
        self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in self._workers:
            worker.close()
        self._threads.shutdown(wait=True)
        for worker in self._workers:
            worker.clear()

    def submit(self, batch: Batch) -> Future[Done]:
        """A future of what the next free process makes of a batch."""
        return self._threads.submit(self._done, batch)

    def lost(self) -> None:
        """A process that is lost is replaced."""

    def killed(self, error: BaseException) -> bool:
        """Errors here are of the task; processes that end are outcomes."""
        raise error

    def _done(self, batch: Batch) -> Done:
        worker = self._free.get()
        try:
            return worker.done(batch)
        finally:
            self._free.put(worker)


def cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not of every system
        return os.cpu_count() or 1
