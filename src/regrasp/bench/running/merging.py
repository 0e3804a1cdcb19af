"""Rows of several runs, of other machines too, in one folder."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isclose
from pathlib import Path
from typing import Any

from regrasp.bench.running.result import Key, Row
from regrasp.bench.running.store import (
    COMPARABLE,
    NOT_COMPARABLE,
    ROWS,
    Store,
    read_rows,
    read_run,
    times_compare,
)
from regrasp.errors import InvalidInput, shown

_ALIKE = 1e-8  # of an optimum that two machines computed


def merge(folders: Sequence[Path], out: Path) -> list[Row]:
    """Write the rows of several runs into the folder ``out``, which has none; returns them.

    A row that stands in two of them alike is taken once; of two that differ, the second is one more repeat.
    Raises ``InvalidInput`` for runs that do not belong together: other limits, another version of a solver,
    another problem under one name.
    """
    folders = [Path(folder) for folder in folders]
    if len(folders) < 2:
        raise InvalidInput(f"merging takes two folders or more, got {len(folders)}")
    if (Path(out) / ROWS).exists():
        raise InvalidInput(f"{out} has rows already; give another folder")
    runs = [read_run(folder) for folder in folders]
    about = _header(runs, folders)
    rows = list(_merged(folders))
    with Store(Path(out), about) as store:
        for row in rows:
            store.append(row)
    return rows


def _header(runs: Sequence[dict[str, Any]], folders: Sequence[Path]) -> dict[str, Any]:
    first = runs[0]
    for run, folder in zip(runs[1:], folders[1:], strict=True):
        then = {name: first.get(name) for name in ("measuring", "time_limit")}
        now = {name: run.get(name) for name in then}
        both = first["solvers"].keys() & run["solvers"].keys()
        then |= {f"version of {name}": first["solvers"][name] for name in both}
        now |= {f"version of {name}": run["solvers"][name] for name in both}
        differs = [f"{name}: {then[name]} and {now[name]}" for name in then if then[name] != now[name]]
        if differs:
            raise InvalidInput(
                f"{folders[0]} and {folder} are of different runs ({'; '.join(differs)}); "
                "merge like with like"
            )
        first = first | {"solvers": first["solvers"] | run["solvers"]}
    machines = [run.get("machine", {}) for run in runs]
    alike = all(machine == machines[0] for machine in machines)
    compare = alike and all(map(times_compare, runs))
    names = dict.fromkeys(str(machine.get("processor", "unknown")) for machine in machines)
    return {
        "started": min(str(run.get("started", "")) for run in runs),
        "measuring": first.get("measuring"),
        "machine": machines[0] if alike else {"processor": "; ".join(names)},
        "time_limit": first.get("time_limit"),
        "memory_limit": first.get("memory_limit"),
        "times": COMPARABLE if compare else NOT_COMPARABLE,
        "solvers": first["solvers"],
    }


def _merged(folders: Sequence[Path]) -> Iterator[Row]:
    """The rows, repeats counted through; machines know a problem alike to their rounding."""
    known: dict[str, Row] = {}
    seen: dict[Key, list[Row]] = {}
    for folder in folders:
        for row in read_rows(folder):
            before = known.setdefault(row.problem, row)
            if not _is_alike(before, row):
                raise InvalidInput(
                    f"{folder}: its problem {shown(row.problem)} is another than the one before it; "
                    "run both with the same regrasp"
                )
            there = seen.setdefault(row.key._replace(repeat=0), [])
            if any(replace(row, repeat=other.repeat) == other for other in there):
                continue
            row = replace(row, repeat=len(there))
            there.append(row)
            yield row


def _is_alike(one: Row, other: Row) -> bool:
    size = [(row.verdict, row.unknowns, row.rows, row.nonzeros, row.cones) for row in (one, other)]
    if size[0] != size[1] or (one.optimum is None) != (other.optimum is None):
        return False
    return one.optimum is None or isclose(one.optimum, other.optimum or 0.0, rel_tol=_ALIKE, abs_tol=_ALIKE)
