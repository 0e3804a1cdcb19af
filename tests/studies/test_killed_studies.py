"""Runs, workers and schedulers are killed at random moments: twelve times in all, and no row suffers."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from random import Random
from threading import Thread
from typing import Any

import pandas as pd
import psutil
import pytest

import regrasp as rg
import study_cases
from processes import hear_interrupts, is_running
from regrasp.studies.study import study_in
from studies_compared import raw_keys, rows

pytestmark = pytest.mark.contract

CASES = 300
GRID = {"a": list(range(CASES)), "spin": [0.004]}
RUNS, WORKERS, CLUSTER_WORKERS, SCHEDULERS = 4, 4, 2, 2
ATTEMPTS = 40  # runs that may end before anybody is killed
PATIENCE = 60.0
CODE = f"""
import regrasp as rg
rg.sweep("study_cases:spun", {GRID}, out=OUT, workers=2, part_seconds=0.05, progress=False)
"""


def swept(out: Path, **options: Any) -> Any:
    return rg.sweep(study_cases.spun, GRID, out=out, part_seconds=0.05, progress=False, **options)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("undisturbed")
    swept(folder, workers=0)
    return rows(folder)


@pytest.fixture
def started() -> Iterator[Callable[..., "subprocess.Popen[bytes]"]]:
    """Starts programs, which are ended after the test."""
    all_started: list[subprocess.Popen[bytes]] = []

    def start(*arguments: str) -> "subprocess.Popen[bytes]":
        path = os.pathsep.join(entry for entry in sys.path if entry)
        program = subprocess.Popen(
            [sys.executable, *arguments],
            env=os.environ | {"PYTHONPATH": path},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            preexec_fn=hear_interrupts,
        )
        all_started.append(program)
        return program

    yield start
    for program in all_started:
        with suppress(ProcessLookupError):
            os.killpg(program.pid, signal.SIGKILL)
        program.wait()


def intact(folder: Path) -> int:
    """How many rows there are, each once and each part whole."""
    keys = raw_keys(folder)
    assert len(keys) == len(set(keys))
    return len(keys)


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_the_run_is_killed(undisturbed: Any, started: Any, tmp_path: Path) -> None:
    moment, killed = Random(1), 0
    while killed < RUNS:
        before = intact(tmp_path)
        if before > CASES - 40:  # too few are left to be caught at it: begin again
            for part in tmp_path.glob("*.parquet"):
                part.unlink()
            before = 0
        run = started("-c", CODE.replace("OUT", repr(str(tmp_path))))
        until(lambda before=before: intact(tmp_path) > before)
        time.sleep(moment.uniform(0, 0.15))
        children = [child.pid for child in psutil.Process(run.pid).children()]
        os.kill(run.pid, signal.SIGKILL)
        run.wait()
        killed += 1
        assert before < intact(tmp_path) <= CASES
        until(lambda children=children: not any(map(is_running, children)))
    assert swept(tmp_path, workers=2).left == 0
    pd.testing.assert_frame_equal(rows(tmp_path), undisturbed, check_exact=True)
    assert [path.name for path in tmp_path.glob(".*")] == []


def test_an_interrupt_keeps_what_was_done_and_leaves_nobody_behind(started: Any, tmp_path: Path) -> None:
    run = started(
        "-c", CODE.replace("OUT", repr(str(tmp_path))).replace("part_seconds=0.05", "part_seconds=1e3")
    )
    until(lambda: len(psutil.Process(run.pid).children()) == 2)
    time.sleep(0.5)
    children = [child.pid for child in psutil.Process(run.pid).children()]
    os.kill(run.pid, signal.SIGINT)
    run.wait(20)
    assert 0 < intact(tmp_path) <= CASES
    until(lambda: not any(map(is_running, children)))


class Killer(Thread):
    """Kills one of some processes at random moments, until there were enough or nobody is to be killed."""

    def __init__(self, victims: Callable[[], list[int]], most: int, seed: int, rest: float = 1.0) -> None:
        super().__init__(daemon=True)
        self.rest = rest
        self.victims, self.most, self.moment, self.killed, self.over = victims, most, Random(seed), 0, False

    def run(self) -> None:
        while self.killed < self.most and not self.over:
            time.sleep(self.moment.uniform(0.1, 1.0) * self.rest)
            victims = [pid for pid in self.victims() if is_running(pid)]
            if victims and not self.over:
                os.kill(self.moment.choice(victims), signal.SIGKILL)
                self.killed += 1

    def __enter__(self) -> "Killer":
        self.start()
        return self

    def __exit__(self, *error: object) -> None:
        self.over = True
        self.join()


def our_children() -> list[int]:
    children = psutil.Process().children()
    return [child.pid for child in children if "regrasp.studies.child" in " ".join(child.cmdline())]


def test_workers_are_killed(undisturbed: Any, tmp_path: Path) -> None:
    killed, attempt = 0, 0
    while killed < WORKERS:
        out = tmp_path / str(attempt)
        with Killer(our_children, WORKERS - killed, seed=attempt, rest=0.3) as killer:
            swept(out, workers=2)
        killed, attempt = killed + killer.killed, attempt + 1
        assert attempt < ATTEMPTS
        assert intact(out) == CASES
        pd.testing.assert_frame_equal(rows(out), undisturbed, check_exact=True)


@pytest.mark.filterwarnings("ignore")  # of dask's own sockets and loops
def test_workers_of_a_cluster_are_killed(undisturbed: Any, tmp_path: Path) -> None:
    from distributed import Client, LocalCluster

    killed, attempt = 0, 0
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        while killed < CLUSTER_WORKERS:
            out = tmp_path / str(attempt)
            with Killer(lambda: pids(cluster), CLUSTER_WORKERS - killed, seed=attempt, rest=0.5) as killer:
                swept(out, client=client)
            killed, attempt = killed + killer.killed, attempt + 1
            assert attempt < ATTEMPTS
            assert intact(out) == CASES
            pd.testing.assert_frame_equal(rows(out), undisturbed, check_exact=True)


def pids(cluster: Any) -> list[int]:
    return [nanny.pid for nanny in list(cluster.workers.values()) if nanny.pid]


@pytest.mark.filterwarnings("ignore")  # of dask's own sockets and loops
def test_the_scheduler_is_killed(undisturbed: Any, started: Any, tmp_path: Path) -> None:
    for killed in range(SCHEDULERS):
        out = tmp_path / str(killed)  # with all cases before it, so that it is killed in the midst of them
        scheduler, address = cluster_of(started, tmp_path / f"scheduler-{killed}.json")
        with (
            Killer(lambda: [scheduler.pid] if intact(out) else [], 1, seed=killed, rest=0.2),  # noqa: B023
            pytest.raises(rg.RegraspError, match=r"the dask scheduler went away; \d+ of 300 rows are in"),
        ):
            swept(out, client=address)
        assert 0 < intact(out) < CASES
        assert study_in(out).left == CASES - intact(out)
    _, address = cluster_of(started, tmp_path / "last.json")
    swept(out, client=address)
    assert intact(out) == CASES
    pd.testing.assert_frame_equal(rows(out), undisturbed, check_exact=True)


def cluster_of(started: Any, file: Path) -> tuple[Any, str]:
    """A scheduler with one worker of two threads, by dask's own programs, and its address."""
    quiet = ("--no-dashboard", "--scheduler-file", str(file))
    scheduler = started("-m", "distributed.cli.dask_scheduler", "--port", "0", *quiet)
    until(file.exists)
    started("-m", "distributed.cli.dask_worker", "--nthreads", "2", "--no-nanny", *quiet)
    until(lambda: has_workers(file))
    return scheduler, address_in(file)


def address_in(file: Path) -> str:
    import json

    address: str = json.loads(file.read_text())["address"]
    return address


def has_workers(file: Path) -> bool:
    from distributed import Client

    with Client(address_in(file), timeout="20s") as client:
        return bool(client.nthreads())
