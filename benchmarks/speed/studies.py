"""What a row of a study costs: time beside a bare loop, bytes, and hand-out on processes and a local cluster.

    python benchmarks/speed/studies.py                 measures, writes results/studies.json, README.md
    python benchmarks/speed/studies.py --quick -o DIR  a short run into another folder, to see it work

A case of 5 ms is a loop of so many additions, so a busy machine disturbs both sides alike.
"""

import os
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import regrasp as rg
import study_functions
from command import command
from report import Measure, Row
from timing import Comparison

BUSY = "the machine had other work: see the load average"


def swept(function: Any, grid: dict[str, Any], **options: Any) -> tuple[float, float, float]:
    """Seconds that a study takes, processor seconds of it and its processes, and the bytes of its rows."""
    with TemporaryDirectory() as folder:
        began, worked = perf_counter(), processor()
        rg.sweep(function, grid, out=folder, progress=False, **options)
        took, own = perf_counter() - began, processor() - worked
        return took, own, sum(part.stat().st_size for part in Path(folder).glob("*.parquet"))


def processor() -> float:
    """Processor seconds of this process and of those that it has started and that have ended."""
    now = os.times()
    return now.user + now.system + now.children_user + now.children_system


def measure(quick: bool) -> Iterator[Row]:
    """All rows; a quick run does a hundredth of the cases."""
    share, rounds = (100, 1) if quick else (1, 3)
    yield from beside_a_loop(1000 // share, rounds)
    yield from two_workers(400 // share, rounds)
    yield from bytes_of_rows(5000 // share)
    yield from handing_out(20_000 // share)


def beside_a_loop(count: int, rounds: int) -> Iterator[Row]:
    """Cases of 5 ms: a study with one worker beside the loop alone, by the clock and by processor time."""
    loops = calibrated()
    one = swept(study_functions.counted, {"number": [0], "loops": [loops]}, workers=1)
    wall: tuple[list[float], list[float]] = ([], [])
    work: tuple[list[float], list[float]] = ([], [])
    for _ in range(rounds):
        began, worked = perf_counter(), processor()
        for k in range(count):
            study_functions.counted(k, loops)
        wall[1].append((perf_counter() - began) / count)
        work[1].append((processor() - worked) / count)
        took, own, _ = swept(study_functions.counted, {"number": range(count), "loops": [loops]}, workers=1)
        wall[0].append((took - one[0]) / count)
        work[0].append((own - one[1]) / count)
    what = f"a row of a case of 5 ms, one worker, {count:,} cases"
    for key, words, times in (("row", "processor time", work), ("row_wall", "by the clock", wall)):
        found = Comparison(tuple(times[0]), tuple(times[1]))
        yield Row.of(key, f"{what}, {words}", "the bare loop", found, Measure.TIMES, 1.3, BUSY)
    yield Row.alone("start", "starting: processor time, once", one[1], Measure.SECONDS)


def calibrated() -> int:
    """Additions that take 5 ms of processor time."""
    loops = 1 << 16
    began = process_time()
    study_functions.counted(0, loops)
    return round(loops * 5e-3 / (process_time() - began))


def two_workers(count: int, rounds: int) -> Iterator[Row]:
    """Regrasps on two workers beside one, the start of each left out, which a night does not notice.

    Where both take the same processor time, two cores that are free halve it.
    """
    grid = {"seed": range(max(count, 4)), "friction": [0.7], "part": ["wrench"]}
    times: dict[int, list[float]] = {1: [], 2: []}
    works: dict[int, list[float]] = {1: [], 2: []}
    few = {"seed": [0, 1], "friction": [0.7], "part": ["wrench"]}
    for _ in range(rounds):
        for workers in times:
            began, start, _ = swept(study_functions.regrasp, few, workers=workers)
            took, worked, _ = swept(study_functions.regrasp, grid, workers=workers)
            times[workers].append(took - began)
            works[workers].append(worked - start)
    what = f"{count} regrasps on two workers"
    found = Comparison(tuple(works[2]), tuple(works[1]))
    yield Row.of("two_work", f"{what}, processor time", "on one", found, Measure.TIMES, 1.11, BUSY)
    found = Comparison(tuple(times[2]), tuple(times[1]))
    yield Row.of("two", f"{what}, by the clock", "on one", found, Measure.FASTER, 1.8, BUSY)


def bytes_of_rows(count: int) -> Iterator[Row]:
    """Bytes of a row of a removal, errors in words included."""
    grid = {"seed": range(max(count, 10)), "friction": [0.6]}
    _, _, size = swept(study_functions.removal, grid, part_seconds=1e6)
    what = "a row of a removal, half of them infeasible with a sentence"
    yield Row.alone("bytes", what, size / max(count, 10), Measure.BYTES)


def handing_out(count: int) -> Iterator[Row]:
    """What it takes to hand out a case that costs nothing, start left out."""
    from distributed import Client, LocalCluster

    count = max(count, 40)
    grid = {"number": range(count), "milliseconds": [0.0]}
    one = {"number": [0], "milliseconds": [0.0]}
    for workers in (1, 2, 4):
        start, many = (swept(study_functions.spun, given, workers=workers) for given in (one, grid))
        for key, words, at in (("wall", "by the clock", 0), ("work", "processor time", 1)):
            each = (many[at] - start[at]) / count
            what = f"handing out a case, processes: {workers}, {words}"
            yield Row.alone(f"processes_{workers}_{key}", what, each, Measure.SECONDS)
    for workers in (1, 2, 4):
        with (
            LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
            Client(cluster) as client,
        ):
            swept(study_functions.spun, one, client=client)
            start = swept(study_functions.spun, one, client=client)[0]
            each = (swept(study_functions.spun, grid, client=client)[0] - start) / count
            what = f"handing out a case, workers of a local cluster: {workers}, by the clock"
            yield Row.alone(f"cluster_{workers}", what, each, Measure.SECONDS)
            tasks = min(count, 1000)
            began = perf_counter()
            client.gather(client.map(_nothing, range(tasks)))
            what = f"a bare task of dask there, workers: {workers}, by the clock"
            yield Row.alone(f"task_{workers}", what, (perf_counter() - began) / tasks, Measure.SECONDS)


def _nothing(number: int) -> int:
    return number


if __name__ == "__main__":
    command("studies", __doc__, measure, ("regrasp", "numpy", "pyarrow", "dask", "distributed"))
