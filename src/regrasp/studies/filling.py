"""Hands the cases without a row to an engine, in batches, and keeps what comes of them."""

from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any, Protocol

from regrasp.errors import RegraspError
from regrasp.files import write_plan
from regrasp.studies.axes import Plain
from regrasp.studies.cases import Case, Cases, key_of
from regrasp.studies.engines import Engine
from regrasp.studies.folder import PLANS
from regrasp.studies.progress import Progress, Reporter
from regrasp.studies.task import LOST, Outcome
from regrasp.studies.worker import Batch, Done

BATCH_SECONDS = 0.5
"""What a batch is to take, so that what is between batches does not count [s]."""
MOST_TASKS = 200
"""Batches a second that a scheduler is given at most; dask says that it does a thousand or so."""
MOST_IN_BATCH, MOST_IN_PART = 1000, 20_000
CHEAP = 2e-4
"""A case that takes less than this costs less than handing it out [s]."""
_LOOK = 0.5  # seconds between looks whether anything still comes


class Rows(Protocol):
    """Where rows are kept: a ``Folder`` of a study, or another store that outlives a kill."""

    path: Path
    keys: set[str]
    """Of the cases that have a row."""

    @property
    def waiting(self) -> int:
        """Rows that are not on the disk yet."""

    def add(self, key: str, case: Mapping[str, Plain], outputs: Mapping[str, Plain], **rest: Any) -> None:
        """Take a row."""

    def flush(self) -> None:
        """Have every row on the disk."""

    def note_earlier(self, count: int) -> None:
        """Hear how many rows are of other cases."""


def fill(folder: Rows, cases: Cases, engine: Engine, reporter: Reporter, part_seconds: float) -> None:
    """Add the rows that are missing; whatever ends this, what was done is kept.

    Raises ``Refused`` where no case can be done, and ``RegraspError`` where nothing comes any more.
    """
    keys = folder.keys
    todo = [number for number, case in enumerate(cases) if key_of(case) not in keys]
    there = len(cases) - len(todo)
    folder.note_earlier(len(keys) - there)
    progress = Progress(len(cases), there, engine.said)
    if engine.dashboard:
        reporter.note(f"dashboard of dask: {engine.dashboard}")
    if todo:
        with engine:
            filling = _Filling(folder, cases, engine, reporter, progress, part_seconds)
            filling.run((number, cases[number]) for number in todo)
    reporter.tell(progress, last=True)
    each = progress.seconds / max(progress.new, 1)
    if progress.new > 100 and each < CHEAP:
        reporter.note(
            f"a case takes {1e6 * each:.0f} us, less than it costs to hand it out: "
            "functions of arrays (best_squeezes, locus_intervals) in one process are faster"
        )


class _Filling:
    def __init__(
        self, folder: Rows, cases: Cases, engine: Engine, reporter: Reporter, progress: Progress,
        part_seconds: float,
    ) -> None:  # fmt: skip
        self._folder, self._cases, self._engine = folder, cases, engine
        self._reporter, self._progress, self._part_seconds = reporter, progress, part_seconds
        self._came: SimpleQueue[tuple[Batch, Any]] = SimpleQueue()
        self._out, self._flushed = 0, monotonic()

    def run(self, todo: Iterator[tuple[int, Case]]) -> None:
        """Hand out and take in until nothing is left. The first case is done alone: it compiles for all."""
        self._hand(list(islice(todo, 1)))
        self._take()
        while True:
            while self._out < 2 * self._engine.at_once and (batch := list(islice(todo, self._size()))):
                self._hand(batch)
            if not self._out:
                return
            self._take()

    def _size(self) -> int:
        """Cases that take about the time of a batch; fewer when few are left."""
        progress = self._progress
        each = max(progress.seconds / max(progress.new, 1), 1e-6)
        share = (progress.total - progress.done) // (4 * self._engine.at_once) + 1
        seconds = max(BATCH_SECONDS, self._engine.at_once / MOST_TASKS)
        return max(1, min(int(seconds / each), share, MOST_IN_BATCH))

    def _hand(self, batch: Batch) -> None:
        self._out += 1
        future = self._engine.submit(batch)
        future.add_done_callback(lambda came: self._came.put((batch, came)))

    def _take(self) -> None:
        """Keep the rows of the next batch."""
        while True:
            self._write_if_due()
            try:
                batch, future = self._came.get(timeout=_LOOK)
                break
            except Empty:
                lost = self._engine.lost()
                if lost is not None:
                    raise self._gone(lost) from None
        self._out -= 1
        try:
            done = future.result()
        except RegraspError:
            raise
        except BaseException as error:
            if not self._killed(error):
                self._hand(batch)
                return
            if len(batch) > 1:  # one of them is guilty
                for one in batch:
                    self._hand([one])
                return
            said = f"{type(error).__name__}: {error}"[:400]
            done = Done([(batch[0][0], Outcome(LOST, {}, said))], "", "")
        self._keep(done)

    def _killed(self, error: BaseException) -> bool:
        try:
            return self._engine.killed(error)
        except RegraspError as no:
            raise self._gone(str(no)) from error

    def _keep(self, done: Done) -> None:
        for number, outcome in done.outcomes:
            case = self._cases[number]
            key = key_of(case)
            if outcome.plan is not None:
                self._write_plan(key, outcome.plan)
            self._folder.add(
                key,
                case,
                outcome.outputs,
                verdict=outcome.verdict,
                error=outcome.error,
                certificate=outcome.certificate,
                seconds=outcome.seconds,
                machine=done.machine,
                versions=done.versions,
            )
            self._progress.count(outcome.verdict, outcome.seconds)
        self._reporter.tell(self._progress)

    def _write_plan(self, key: str, plan: Any) -> None:
        plans = self._folder.path / PLANS
        plans.mkdir(exist_ok=True)
        write_plan(plan, plans / f"{key}.json")

    def _write_if_due(self) -> None:
        if monotonic() - self._flushed >= self._part_seconds or self._folder.waiting >= MOST_IN_PART:
            self._folder.flush()
            self._flushed = monotonic()

    def _gone(self, why: str) -> RegraspError:
        return RegraspError(
            f"{why}; {self._progress.done} of {self._progress.total} rows are in {self._folder.path}: "
            "the same call again goes on from there"
        )
