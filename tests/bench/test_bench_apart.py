"""The benchmark on many processes and on a cluster, and runs of several machines in one folder."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

from bench_toys import TOYS, fake, solvable, stripped
from regrasp.bench.running import apart
from regrasp.bench.running.apart import run_apart
from regrasp.bench.running.jobs import Limits
from regrasp.bench.running.merging import merge
from regrasp.bench.running.result import Row
from regrasp.bench.running.runner import run
from regrasp.bench.running.solvers import Solver
from regrasp.bench.running.store import ROWS, read_rows, read_run, times_compare
from regrasp.errors import InvalidInput

pytestmark = [
    pytest.mark.contract,
    pytest.mark.filterwarnings("ignore"),  # of dask's own sockets and loops
]

ODD = [fake(name) for name in ("right", "lies", "crashes", "raises", "eats", "scribbles")]
CLARABEL = Solver("clarabel", "1", True, updates=True)


def in_order(rows: list[Row]) -> list[str]:
    """Rows without times, in the order of their keys."""
    return sorted(map(str, stripped(rows)))


def test_rows_are_those_of_a_run_one_by_one_whatever_solvers_do(fakes: Path, tmp_path: Path) -> None:
    solvers, toys = [*ODD, CLARABEL], [*TOYS[:2], TOYS[4]]
    expected = run(tmp_path / "one", toys, solvers)
    told: list[tuple[str, int, int]] = []
    rows = run_apart(tmp_path / "apart", toys, solvers, workers=2, told=lambda *said: told.append(said))
    assert in_order(rows) == in_order(expected)
    assert "warm" in {row.mode for row in rows}
    assert told[-1] == ("in 2 processes", len(rows), len(rows))
    before = (tmp_path / "apart" / ROWS).read_bytes()
    assert run_apart(tmp_path / "apart", toys, solvers, workers=2) == rows
    assert (tmp_path / "apart" / ROWS).read_bytes() == before
    assert not times_compare(read_run(tmp_path / "apart"))
    with pytest.raises(InvalidInput, match=r"times: not comparable there, comparable now"):
        run(tmp_path / "apart", toys, solvers)
    with pytest.raises(InvalidInput, match=r"another problem that is called toy/sum/1 too"):
        run_apart(tmp_path / "apart", [replace(solvable(3.0), name="toy/sum/1")], ODD[:1], workers=2)


def test_solves_that_hang_or_are_slow_end_at_the_time_limit(
    fakes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(apart, "SLACK", 3.0)
    limits = Limits(time_limit=0.01)
    rows = run_apart(tmp_path, TOYS[:1], [fake("slow"), fake("hangs")], limits=limits, workers=2)
    assert {row.solver: (row.status, row.total_time) for row in rows} == {
        "slow": ("timeout", 0.01), "hangs": ("timeout", 0.01)
    }  # fmt: skip


def test_rows_of_a_cluster_are_the_same(fakes: Path, tmp_path: Path) -> None:
    from distributed import Client, LocalCluster

    expected = run(tmp_path / "one", TOYS[:2], ODD[:3])
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50
        ) as cluster,
        Client(cluster) as client,
    ):
        address: Any = client.scheduler_info()["address"]
        board, heard = client.dashboard_link, list[str]()
        rows = run_apart(
            tmp_path / "apart", TOYS[:2], ODD[:3], told=lambda said, *_: heard.append(said), client=address
        )
    assert heard[-1] == f"on 2 threads of {address}" + (f", dashboard {board}" if board else "")
    named = {row.machine for row in rows if not row.is_lost}
    rows = [replace(row, machine=expected[0].machine) for row in rows]
    assert named == {expected[0].machine}
    assert in_order(rows) == in_order(expected)


def test_runs_of_several_machines_are_merged(fakes: Path, tmp_path: Path) -> None:
    run(tmp_path / "a", TOYS, [fake("right")])
    run(tmp_path / "b", TOYS, [fake("right"), fake("lies")])
    elsewhere(tmp_path / "b")
    rows = merge([tmp_path / "a", tmp_path / "b", tmp_path / "a"], tmp_path / "all")
    assert read_rows(tmp_path / "all") == rows
    right = [row for row in rows if row.solver == "right" and row.problem == "toy/sum/1"]
    assert [(row.repeat, row.machine == "elsewhere") for row in right] == [(0, False), (1, True)]
    assert len(rows) == 4 + 2 * 4
    about = read_run(tmp_path / "all")
    assert not times_compare(about)
    assert about["machine"]["processor"].endswith("; elsewhere")
    assert about["solvers"].keys() == {"right", "lies"}
    with pytest.raises(InvalidInput, match=r"all has rows already; give another folder"):
        merge([tmp_path / "a", tmp_path / "b"], tmp_path / "all")


def test_runs_of_one_machine_keep_times_that_compare(fakes: Path, tmp_path: Path) -> None:
    run(tmp_path / "a", TOYS[:1], [fake("right")])
    run(tmp_path / "b", TOYS[1:2], [fake("right")])
    merge([tmp_path / "a", tmp_path / "b"], tmp_path / "all")
    assert times_compare(read_run(tmp_path / "all"))


def test_runs_that_do_not_belong_together_are_refused(fakes: Path, tmp_path: Path) -> None:
    run(tmp_path / "a", TOYS[:1], [fake("right")])
    run(tmp_path / "limit", TOYS[:1], [fake("right")], limits=Limits(time_limit=1.0))
    run(tmp_path / "version", TOYS[:1], [Solver("right", "1.3", False, entry="fake_solvers:right")])
    run(tmp_path / "problem", [replace(solvable(3.0), name="toy/sum/1")], [fake("lies")])
    for other, said in (
        ("limit", "time_limit: 60.0 and 1.0"),
        ("version", "version of right: 1.2 .* and 1.3 "),
        ("problem", "its problem 'toy/sum/1' is another than the one before it"),
    ):
        with pytest.raises(InvalidInput, match=said):
            merge([tmp_path / "a", tmp_path / other], tmp_path / "all")
        assert not (tmp_path / "all").exists()
    with pytest.raises(InvalidInput, match="two folders or more, got 1"):
        merge([tmp_path / "a"], tmp_path / "all")


def elsewhere(folder: Path) -> None:
    """Let the rows of a folder be of another machine, which rounds otherwise."""
    rows = [replace(row, machine="elsewhere", digest="0" * 16) for row in read_rows(folder)]
    (folder / ROWS).write_text("".join(json.dumps(asdict(row)) + "\n" for row in rows))
    about = read_run(folder)
    about["machine"]["processor"] = "elsewhere"
    (folder / "run.json").write_text(json.dumps(about))
