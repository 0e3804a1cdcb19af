"""The verb: a function over the cases of a study, a row for each."""

import pickle
import sys
from collections.abc import Callable, Mapping, Sequence
from hashlib import blake2b
from inspect import Parameter, getsource, signature
from pathlib import Path
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import file_path, items, number, whole
from regrasp.studies import columns as kinds
from regrasp.studies.cases import Cases, cases_of
from regrasp.studies.engines import Engine, Here, Processes, cores
from regrasp.studies.filling import fill
from regrasp.studies.folder import Definition, Folder
from regrasp.studies.parts import parquet
from regrasp.studies.progress import Progress, Reporter
from regrasp.studies.study import Study, study_in
from regrasp.studies.task import Task, function_named, name_of
from regrasp.studies.worker import Limits

_MOST_WORKERS = 1000


def sweep(
    function: Callable[..., Any] | str | Path,
    grid: Any,
    *,
    out: str | Path,
    keep: Sequence[str] = (),
    shared: Mapping[str, Any] | None = None,
    zipped: bool = False,
    plans: bool = False,
    workers: int | None = None,
    client: Any = None,
    time_limit: float | None = None,
    memory_limit: int | None = None,
    extend: bool = False,
    part_seconds: float = 15.0,
    progress: bool | Callable[[Progress], Any] = True,
) -> Study:
    """Call a function for every case of a grid and keep a row of each in a folder of Parquet files.

    Whatever happens to a case is a row: ``Infeasible`` with the kind of its certificate, bad input, an error
    of another kind, no answer in time, no memory, a process that was killed. Given again after it was ended,
    at whatever moment, the same call goes on with the cases that have no row.

    Args:
        function: called with the keys of a case as keyword arguments; processes import it by its name, so it
            stands in a module, or is that name, ``"module:function"``. Or the path of a scenario, which is
            planned and verified for each case with its keys changed: ``friction``, ``task.objective``,
            ``contacts.P1.friction`` or ``contacts.*.friction``.
        grid: a mapping of keys to values: each a list, ``{"from", "to", "count"}`` (``"spacing": "log"``), or
            one of ``{"uniform" | "log_uniform" | "normal" | "integers": [a, b], "count", "seed"}``; all
            combinations are cases. Or a table: a list of cases, or a data frame.
        out: the folder of the rows.
        keep: what is kept of what the function returns: keys of a mapping, or attributes, ``"end.value"``;
            all of a mapping, and ``value``, ``margin``, ``moves``, ``friction_needed`` and ``duration`` of
            anything else, where not given.
        shared: arguments that all cases share, such as shapes, sent to each process once.
        zipped: cases are values that stand side by side, not all combinations.
        plans: write the plan that is returned to ``_plans/KEY.json``, too.
        workers: processes of this machine, a core each if not given; 0 for this process, without limits.
        client: a ``dask.distributed.Client``, or the address of a scheduler, whose workers do the cases.
        time_limit: of a case [s].
        memory_limit: addresses of a process [bytes].
        extend: where the folder is of other cases, keep its rows and do the new cases only.
        part_seconds: rows are written at least so often [s].
        progress: whether to say how far it is, on a terminal and in notebooks; or a function of a
            ``Progress``.

    Raises:
        InvalidInput: For bad input, and for a folder of another study or one that is being filled.
        RegraspError: Where the scheduler went away; what was done is kept.
        ImportError: Without pyarrow (or dask), the extra ``regrasp[study]``.
    """
    cases, folder = cases_of(grid, zipped=_flag(zipped, "zipped")), file_path(out)
    if callable(progress):
        listen, quiet = progress, False
    else:
        listen, quiet = None, not _flag(progress, "progress")
    limits = Limits(
        None if time_limit is None else number(time_limit, "time_limit", above=0.0),
        0 if memory_limit is None else whole(memory_limit, "memory_limit", least=2**20),
    )
    number(part_seconds, "part_seconds", least=0.0)
    if workers is not None:
        whole(workers, "workers", least=0, most=_MOST_WORKERS)
    if shared is not None and not (isinstance(shared, Mapping) and all(isinstance(k, str) for k in shared)):
        raise InvalidInput(f"shared must be a mapping of names to values, got {shown(shared)}")
    apart = client is not None or workers != 0
    if not apart and (time_limit is not None or memory_limit is not None):
        raise InvalidInput("limits need processes that can be ended: give workers of at least 1")
    if isinstance(function, Path) or (isinstance(function, str) and function.endswith(".toml")):
        from regrasp.studies.scenario_cases import NAME, shared_of

        if shared is not None:
            raise InvalidInput("what cases of a scenario share is the scenario; leave shared out")
        function, shared = NAME, shared_of(file_path(function), cases)
    called, name = _function(function, apart)
    task = Task(name, _names(keep), dict(shared or {}), _flag(plans, "plans"))
    _check_arguments(called, name, cases, task.shared)
    parquet()
    engine: Engine
    if client is not None:
        if workers is not None:
            raise InvalidInput("the client knows its workers; give one of workers and client")
        from regrasp.studies.cluster import Cluster

        engine = Cluster(task, client, limits)
    elif workers == 0:
        engine = Here(task, called)
    else:
        engine = Processes(task, workers or cores(), limits)
    opened = Folder(folder, _definition(task, called, cases), _inputs(cases), extend=_flag(extend, "extend"))
    with opened as rows:
        fill(rows, cases, engine, Reporter(listen, quiet), part_seconds)
    return study_in(folder)


def _function(given: Any, apart: bool) -> tuple[Callable[..., Any], str]:
    """The function, and its name, by which other processes find it."""
    if isinstance(given, str):
        here = str(Path.cwd())
        if here not in sys.path and "" not in sys.path:
            sys.path.insert(0, here)  # as for a script that stands here
        return function_named(given), given
    if not apart and callable(given):
        return given, f"{getattr(given, '__module__', '')}:{getattr(given, '__qualname__', 'function')}"
    return given, name_of(given)


def _check_arguments(
    function: Callable[..., Any], name: str, cases: Cases, shared: Mapping[str, Any]
) -> None:
    """Refuse keys that the function does not take, and the lack of those that it needs."""
    both = shared.keys() & cases.axes.keys()
    if both:
        raise InvalidInput(f"{shown(min(both))} is in the grid and shared; give it once")
    try:
        asked = signature(function)
    except (TypeError, ValueError):  # compiled, and says nothing of its parameters
        return
    try:
        asked.bind(**dict.fromkeys([*cases.axes, *shared]))
    except TypeError as error:
        takes = [p.name for p in asked.parameters.values() if p.kind is not Parameter.POSITIONAL_ONLY]
        raise InvalidInput(
            f"{name} takes {', '.join(takes) or 'nothing'}; the cases have "
            f"{', '.join([*cases.axes, *shared])}: {error}"
        ) from None


def _definition(task: Task, function: Callable[..., Any], cases: Cases) -> Definition:
    """What makes the rows, as plain data."""
    try:
        source = _digest(getsource(function).encode())
    except (OSError, TypeError):  # typed in, or compiled
        source = None
    try:
        shared = {name: _digest(pickle.dumps(value)) for name, value in sorted(task.shared.items())}
    except Exception as error:
        raise InvalidInput(f"what cases share is sent to processes, and cannot be: {error}") from None
    return {
        "function": task.name,
        "keep": list(task.keep),
        "plans": task.plans,
        "source": source,
        "shared": shared,
        "grid": cases.definition,
    }


def _digest(data: bytes) -> str:
    return blake2b(data, digest_size=12).hexdigest()


def _inputs(cases: Cases) -> kinds.Columns:
    columns: kinds.Columns = {}
    for key, values in cases.axes.items():
        if key == "key" or key in kinds.FIXED:
            raise InvalidInput(
                f"a key of a grid must not be called {shown(key)}, which is a column of every row"
            )
        for value in values:
            columns = kinds.widened(columns, {key: value})
    return columns


def _names(keep: Any) -> tuple[str, ...]:
    names = items(keep, "keep")
    for name in names:
        if not isinstance(name, str) or not name.strip():
            raise InvalidInput(f"keep must be names of what is kept, got {shown(name)}")
    return tuple(dict.fromkeys(name for name in names if name != "seconds"))  # of every row


def _flag(value: Any, what: str) -> bool:
    if not isinstance(value, bool):
        raise InvalidInput(f"{what} must be True or False, got {shown(value)}")
    return value
