"""Runs solvers over problems, each solve in its own time limit, and resumes where a run was ended."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass
from datetime import date
from math import isfinite
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Event, Lock
from typing import Any

from regrasp.bench.problems.answer import Answer
from regrasp.bench.problems.problem import BenchProblem, Family
from regrasp.bench.problems.settings import check, options
from regrasp.bench.running import machine
from regrasp.bench.running.process import Worker, WorkerLost
from regrasp.bench.running.result import COLD, ERROR, MEMORY, TIMEOUT, WARM, Key, Row, written
from regrasp.bench.running.solvers import Solver
from regrasp.bench.running.store import Store
from regrasp.errors import InvalidInput, shown

# A first call shorter than this warms up only; what a first call adds is lost in a longer one, which counts.
WARM_UP = 1.0
# Raised with every change to what is timed or how answers are judged, so that rows of two kinds never mix.
MEASURING = 2
# Importing a solver and handing over a program take time that is no solver's fault.
_PATIENCE = 120.0

Told = Callable[[str, int, int], None]
"""Called with what is being solved, how many rows are settled, and how many there are."""


@dataclass(frozen=True)
class Limits:
    """What each solve may take, and how many there are.

    repeat: solves of each kind. time_limit: of each solve [s]. jobs: solved at once; more than one disturbs
    timing. memory_limit: addresses of each worker [bytes], 0 for none, None for half of the machine's memory
    shared by the jobs. Raises ``InvalidInput`` for numbers that make no sense.
    """

    repeat: int = 1
    time_limit: float = 60.0
    jobs: int = 1
    memory_limit: int | None = None

    def __post_init__(self) -> None:
        if self.repeat < 1 or self.jobs < 1:
            raise InvalidInput(f"repeat and jobs must be at least 1, got {self.repeat} and {self.jobs}")
        if not (isfinite(self.time_limit) and self.time_limit > 0):
            raise InvalidInput(f"the time limit must be a positive number of seconds, got {self.time_limit}")

    @property
    def worker_memory(self) -> int:
        """Addresses each worker may have [bytes], 0 for no limit."""
        if not machine.can_limit_memory():
            if self.memory_limit:
                raise InvalidInput("this system limits no process's memory; leave memory_limit out")
            return 0
        if self.memory_limit is not None:
            return self.memory_limit
        return (machine.memory() or 0) // (2 * self.jobs)


@dataclass(frozen=True, eq=False)
class Job:
    """A problem for a solver; before: what it has solved just before, for a warm solve."""

    problem: BenchProblem
    solver: Solver
    settings: str
    before: BenchProblem | None = None

    def key(self, repeat: int) -> Key:
        """The key of a repeat's row."""
        mode = COLD if self.before is None else WARM
        return Key(self.problem.name, self.solver.name, self.settings, mode, repeat)

    def missing(self, rows: dict[Key, Row], repeat: int) -> list[int]:
        """Repeats without a row; none after one that was lost.

        Raises ``InvalidInput`` for a row of another problem of the same name.
        """
        there = [rows.get(self.key(k)) for k in range(repeat)]
        if any(row is not None and row.digest != self.problem.digest for row in there):
            raise InvalidInput(
                f"there are rows of another problem that is called {self.problem.name} too; "
                "give another folder"
            )
        if any(row is not None and row.is_lost for row in there):
            return []
        return [k for k, row in enumerate(there) if row is None]


def chosen_problems(
    families: dict[str, Family], names: Iterable[str], most: int | None = None
) -> list[BenchProblem]:
    """The problems of the named families, or of all, of at most ``most`` unknowns.

    Raises ``InvalidInput`` for an unknown family and where no problem is left.
    """
    names = list(dict.fromkeys(names))
    for name in names:
        if name not in families:
            raise InvalidInput(f"no family {shown(name)}; there are {', '.join(families)}")
    problems = [p for name in names or families for p in families[name].problems()]
    small = [p for p in problems if most is None or p.size[0] <= most]
    if not small:
        least = min((p.size[0] for p in problems), default=0)
        raise InvalidInput(f"no problem has at most {most} unknowns; the smallest has {least}")
    return small


def planned(
    problems: Sequence[BenchProblem], solvers: Sequence[Solver], settings: Sequence[str]
) -> list[Job]:
    """Every solve to make: family by family, and in it solver by solver, so that a crash costs one import."""
    for name in settings:
        check(name)
    by_name = {problem.name: problem for problem in problems}
    if len(by_name) < len(problems):
        raise InvalidInput("two problems of the benchmark have one name")
    families: dict[str, list[BenchProblem]] = {}
    for problem in problems:
        families.setdefault(problem.family, []).append(problem)
    return [
        Job(problem, solver, name, before)
        for family in families.values()
        for solver in solvers
        for name in dict.fromkeys(settings)
        for problem in family
        if solver.takes_cones or problem.is_qp
        for before in _modes(problem, solver, by_name)
    ]


def _modes(
    problem: BenchProblem, solver: Solver, by_name: dict[str, BenchProblem]
) -> Iterator[BenchProblem | None]:
    yield None
    if problem.follows in by_name and solver.updates:
        yield by_name[problem.follows]


def run(
    folder: Path,
    problems: Sequence[BenchProblem],
    solvers: Sequence[Solver],
    settings: Sequence[str] = ("default",),
    limits: Limits = Limits(),
    told: Told = lambda *_: None,
) -> list[Row]:
    """Make every solve that has no row in ``folder`` yet; returns all rows there.

    Raises ``InvalidInput`` as ``planned`` and ``Store`` do.
    """
    jobs = planned(problems, solvers, settings)
    header: dict[str, Any] = {
        "started": date.today().isoformat(),
        "measuring": MEASURING,
        "machine": machine.machine(),
        "time_limit": limits.time_limit,
        "memory_limit": limits.worker_memory,
        "jobs": limits.jobs,
        "solvers": {solver.name: solver.release for solver in solvers},
    }
    with Store(folder, header) as store:
        waiting: SimpleQueue[tuple[Job, list[int]]] = SimpleQueue()
        settled = _Settled(len(jobs) * limits.repeat, told)
        for job in jobs:
            missing = job.missing(store.rows, limits.repeat)
            settled.add(limits.repeat - len(missing))
            if missing:
                waiting.put((job, missing))
        stop, workers = Event(), [Worker(limits.worker_memory) for _ in range(limits.jobs)]
        with ThreadPoolExecutor(limits.jobs) as pool:
            threads = [pool.submit(_work, own, waiting, store, limits, settled, stop) for own in workers]
            try:
                wait(threads, return_when=FIRST_EXCEPTION)
            finally:
                stop.set()
                for own in workers:
                    own.interrupt()
            for thread in threads:
                thread.result()
        return list(store.rows.values())


class _Settled:
    """Counts settled rows for the display, from several threads."""

    def __init__(self, total: int, told: Told) -> None:
        self._total, self._told, self._done, self._lock = total, told, 0, Lock()

    def add(self, count: int, what: str = "") -> None:
        with self._lock:
            self._done += count
            self._told(what, self._done, self._total)


def _work(
    worker: Worker,
    waiting: "SimpleQueue[tuple[Job, list[int]]]",
    store: Store,
    limits: Limits,
    settled: _Settled,
    stop: Event,
) -> None:
    """Take jobs until there is none left."""
    try:
        while not stop.is_set():
            try:
                job, missing = waiting.get_nowait()
            except Empty:
                return
            settled.add(0, f"{job.solver.name} {job.settings}: {job.problem.name}")
            made = 0
            for row in _rows(worker, job, missing, limits):
                if stop.is_set():  # the solve may have ended because the run does
                    return
                store.append(row)
                settled.add(1)
                made += 1
            settled.add(len(missing) - made)
    finally:
        worker.kill()


def _rows(worker: Worker, job: Job, missing: list[int], limits: Limits) -> Iterator[Row]:
    """The rows of a job, each as soon as it is there; none after a solve that was lost."""
    name, memory = machine.name(), None

    def row(repeat: int, answer: Answer | None, **more: Any) -> Row:
        key = job.key(repeat)
        more |= {"time_limit": limits.time_limit, "machine": name, "memory": memory}
        return written(job.problem, job.solver, key, answer, **more)

    repeats = list(missing)
    try:
        refused = _ready(worker, job)
        is_first = True
        while repeats:
            reply = ("error", refused, None) if refused else worker.ask("solve", within=limits.time_limit)
            if reply[0] == "answer":
                _, answer, took, grown = reply
                memory = grown if is_first else memory
                if not is_first or took >= WARM_UP:
                    yield row(repeats.pop(0), answer, total_time=took)
                is_first = False
            elif reply[0] == "memory":
                worker.kill()
                raise WorkerLost(MEMORY, reply[1])
            else:
                yield row(repeats.pop(0), None, status=ERROR, said=reply[1], total_time=reply[2])
    except WorkerLost as lost:
        took = limits.time_limit if lost.status == TIMEOUT else None
        yield row(repeats[0], None, status=lost.status, said=lost.said, total_time=took)


def _ready(worker: Worker, job: Job) -> str:
    """Have the worker load the solver and take the program; returns what it says if it cannot."""
    if worker.loaded != job.solver.name:
        reply = worker.ask("load", job.solver, within=_PATIENCE)
        if reply[0] == "error":
            return str(reply[1])
        worker.loaded = job.solver.name
    given = options(job.solver.name, job.settings, outside=job.solver.outside)
    before = None if job.before is None else job.before.program
    reply = worker.ask("prepare", job.problem.program, before, given, within=_PATIENCE)
    return str(reply[1]) if reply[0] == "error" else ""
