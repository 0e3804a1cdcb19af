"""Runs solvers over problems one by one, each solve in its own time limit; resumes where a run was ended."""

from collections.abc import Callable, Iterator, Sequence
from datetime import date
from pathlib import Path
from typing import Any

from regrasp.bench.problems.problem import BenchProblem
from regrasp.bench.problems.settings import options
from regrasp.bench.running import machine
from regrasp.bench.running.jobs import USUAL, Job, Limits, planned
from regrasp.bench.running.process import Worker, WorkerLost
from regrasp.bench.running.result import ERROR, MEMORY, TIMEOUT, Row, written
from regrasp.bench.running.solvers import Solver
from regrasp.bench.running.store import COMPARABLE, Store
from regrasp.programs.answer import Answer

# A first call shorter than this warms up only; what a first call adds is lost in a longer one, which counts.
WARM_UP = 1.0
# Raised with every change to what is timed or how answers are judged, so that rows of two kinds never mix.
MEASURING = 2
# Importing a solver and handing over a program take time that is no solver's fault.
PATIENCE = 120.0

Told = Callable[[str, int, int], None]
"""Called with what is being solved, how many rows are settled, and how many there are."""


def run(
    folder: Path,
    problems: Sequence[BenchProblem],
    solvers: Sequence[Solver],
    settings: Sequence[str] = ("default",),
    limits: Limits = USUAL,
    told: Told = lambda *_: None,
) -> list[Row]:
    """Make every solve that has no row in ``folder`` yet; returns all rows there.

    Raises ``InvalidInput`` as ``planned`` and ``Store`` do.
    """
    jobs = planned(problems, solvers, settings)
    memory = limits.memory_of(1)
    total, settled = len(jobs) * limits.repeat, 0
    with Store(folder, header(solvers, limits, memory, COMPARABLE)) as store:
        missing = [job.missing(store.rows, limits.repeat) for job in jobs]  # refused before any work
        worker = Worker(memory)
        try:
            for job, repeats in zip(jobs, missing, strict=True):
                settled += limits.repeat - len(repeats)
                if repeats:
                    told(f"{job.solver.name} {job.settings}: {job.problem.name}", settled, total)
                    for row in _rows(worker, job, repeats, limits):
                        store.append(row)
                    settled += len(repeats)
                told("", settled, total)
        finally:
            worker.kill()
        return list(store.rows.values())


def header(solvers: Sequence[Solver], limits: Limits, memory: int, times: str) -> dict[str, Any]:
    """What a run is: rows of two runs that differ in it are not laid side by side."""
    return {
        "started": date.today().isoformat(),
        "measuring": MEASURING,
        "machine": machine.machine(),
        "time_limit": limits.time_limit,
        "memory_limit": memory,
        "times": times,
        "solvers": {solver.name: solver.release for solver in solvers},
    }


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
        reply = worker.ask("load", job.solver, within=PATIENCE)
        if reply[0] == "error":
            return str(reply[1])
        worker.loaded = job.solver.name
    given = options(job.solver.name, job.settings, outside=job.solver.outside)
    before = None if job.before is None else job.before.program
    reply = worker.ask("prepare", job.problem.program, before, given, within=PATIENCE)
    return str(reply[1]) if reply[0] == "error" else ""
