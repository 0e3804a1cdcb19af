"""Runs solvers on many processes, or a dask cluster, as studies do their cases: for answers, not for times.

A case is a problem's name, a solver's, settings and a mode; the problems themselves are sent to each process
once. Rows and resuming are those of a run one by one.
"""

import json
import pickle
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any

from regrasp.bench.problems.answer import printable, understood
from regrasp.bench.problems.problem import BenchProblem
from regrasp.bench.problems.settings import options
from regrasp.bench.running import machine
from regrasp.bench.running.jobs import USUAL, Job, Limits, planned
from regrasp.bench.running.result import (
    CRASHED,
    ERROR,
    MEMORY,
    TIMEOUT,
    WARM,
    Key,
    Row,
    row_of,
    written,
)
from regrasp.bench.running.runner import Told, header
from regrasp.bench.running.solvers import Solver
from regrasp.bench.running.store import NOT_COMPARABLE, Store
from regrasp.programs.answer import Answer
from regrasp.studies.cases import cases_of, key_of
from regrasp.studies.cluster import Cluster
from regrasp.studies.engines import Engine, Processes
from regrasp.studies.filling import fill
from regrasp.studies.progress import Reporter
from regrasp.studies.task import FAILED, LATE, LOST, Task
from regrasp.studies.task import MEMORY as NO_MEMORY
from regrasp.studies.worker import Limits as CaseLimits

SLACK = 30.0
"""Seconds beside the time limit of a solve in which a process may import the solver and lay data out."""
_ENDS = {LATE: TIMEOUT, LOST: CRASHED, NO_MEMORY: MEMORY, FAILED: ERROR}


def run_apart(
    folder: Path,
    problems: Sequence[BenchProblem],
    solvers: Sequence[Solver],
    settings: Sequence[str] = ("default",),
    limits: Limits = USUAL,
    told: Told = lambda *_: None,
    *,
    workers: int = 1,
    client: Any = None,
) -> list[Row]:
    """Make every solve that has no row in ``folder`` yet, many at a time; returns all rows there.

    workers: processes of this machine. client: a ``dask.distributed.Client`` or the address of a scheduler,
    in their place; its workers have the same solvers, and ``told`` names its dashboard. Raises
    ``InvalidInput`` as ``planned`` and ``Store`` do, ``RegraspError`` where the scheduler goes away; what was
    done is kept.
    """
    jobs = {key_of(_case(job.key(0))): job for job in planned(problems, solvers, settings)}
    shared = {
        "problems": {problem.name: problem for problem in problems},
        "solvers": {solver.name: solver for solver in solvers},
        "time_limit": limits.time_limit,
    }
    task = Task(f"{__name__}:solved", ("row",), shared)
    memory = limits.memory_of(workers) if client is None else limits.memory_limit or 0
    allowed = CaseLimits(limits.time_limit + SLACK, memory)
    engine: Engine = Processes(task, workers, allowed) if client is None else Cluster(task, client, allowed)
    about = header(solvers, limits, memory, NOT_COMPARABLE)
    if client is not None:
        about["machine"] = {"processor": "of a dask cluster, named in each row"}
    with Store(folder, about) as store:
        for job in jobs.values():
            job.missing(store.rows, 1)  # refused before any work
        rows = _Rows(folder, store, jobs, limits.time_limit, machine.name() if client is None else "")
        board = f", dashboard {engine.dashboard}" if engine.dashboard else ""
        reporter = Reporter(lambda now: told(now.where + board, now.done, now.total), quiet=False)
        fill(rows, cases_of([_case(job.key(0)) for job in jobs.values()]), engine, reporter, 0.0)
        return list(store.rows.values())


def solved(
    problem: str,
    solver: str,
    settings: str,
    mode: str,
    *,
    problems: Mapping[str, BenchProblem],
    solvers: Mapping[str, Solver],
    time_limit: float,
) -> dict[str, str]:
    """One solve, in the process that does it: its row, as a line."""
    given, by = problems[problem], solvers[solver]
    answer, status, said, took = None, "", "", None
    try:
        once = _once(by, given, problems[str(given.follows)] if mode == WARM else None, settings)
        started = perf_counter()
        answer = understood(once(), given.program)
        took = perf_counter() - started
    except MemoryError:
        raise
    except BaseException as error:  # Rust's panics and sys.exit() end a solve, not the process
        status, said = ERROR, f"{type(error).__name__}: {printable(error)}"
    if took is not None and took > time_limit:
        answer, status, said, took = None, TIMEOUT, f"no answer within {time_limit:g} s", time_limit
    row = written(
        given, by, Key(problem, solver, settings, mode, 0), answer,
        time_limit=time_limit, machine=machine.name(), status=status, said=said, total_time=took,
    )  # fmt: skip
    return {"row": row.line()}


def _once(
    solver: Solver, problem: BenchProblem, before: BenchProblem | None, settings: str
) -> Callable[[], Any]:
    """The solve, once its data are in the solver's own form."""
    given = options(solver.name, settings, outside=solver.outside)
    call = _loaded(solver)
    data = call.layout(pickle.loads(pickle.dumps(problem.program)))  # a solver may write into it
    if before is None:
        return lambda: call.solve(data, **given)
    opened = solver.session()(call.layout(before.program), **given)
    opened.solve()

    def updated() -> Answer:
        opened.update(data)
        answer: Answer = opened.solve()
        return answer

    return updated


@cache
def _loaded(solver: Solver) -> Any:
    return solver.load()


def _case(key: Key) -> dict[str, Any]:
    """A key without its repeat: where times do not count, one solve tells."""
    return {name: value for name, value in key._asdict().items() if name != "repeat"}


class _Rows:
    """The store of a run, as studies keep rows."""

    waiting = 0

    def __init__(
        self, path: Path, store: Store, jobs: Mapping[str, Job], time_limit: float, machine_name: str
    ) -> None:
        self.path, self._store, self._jobs = path, store, jobs
        self._time_limit, self._machine = time_limit, machine_name
        self.keys = {key_of(_case(key)) for key in store.rows}

    def add(self, key: str, case: Mapping[str, Any], outputs: Mapping[str, Any], **rest: Any) -> None:
        """Write a row, or that of a solve that never came back."""
        if outputs:
            self._store.append(row_of(json.loads(str(outputs["row"]))))
            return
        job, status = self._jobs[key], _ENDS.get(rest["verdict"], ERROR)
        place = self._machine or rest["machine"] or "unknown"
        self._store.append(
            written(
                job.problem, job.solver, job.key(0), None,
                time_limit=self._time_limit, machine=place, status=status,
                said=rest["error"] or "", total_time=self._time_limit if status == TIMEOUT else None,
            )
        )  # fmt: skip

    def flush(self) -> None:
        """Rows are on the disk as they come."""

    def note_earlier(self, count: int) -> None:
        """Rows of other solves may stay."""
