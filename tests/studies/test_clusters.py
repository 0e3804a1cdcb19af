"""Studies on a dask cluster."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import regrasp as rg
import study_cases
from studies_compared import rows

pytestmark = [
    pytest.mark.contract,
    pytest.mark.filterwarnings("ignore"),  # of dask's own sockets and loops
]


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        yield client


def test_rows_are_those_of_this_process(client: Any, tmp_path: Path) -> None:
    grid = {"friction": [0.3, 0.6], "seed": range(8)}
    rg.sweep(study_cases.removal, grid, out=tmp_path / "here", workers=0, progress=False)
    heard: list[str] = []
    for name, given in (("client", client), ("address", client.scheduler_info()["address"])):
        rg.sweep(
            study_cases.removal,
            grid,
            out=tmp_path / name,
            client=given,
            progress=lambda p: heard.append(str(p)),
        )
        pd.testing.assert_frame_equal(rows(tmp_path / "here"), rows(tmp_path / name), check_exact=True)
    assert "on 2 threads of tcp://127.0.0.1" in heard[-1]
    assert client.status == "running"


def test_a_case_that_kills_its_process_or_hangs_takes_no_worker_with_it(client: Any, tmp_path: Path) -> None:
    before = set(client.nthreads())
    rg.sweep(
        study_cases.fated,
        {"a": [0, 4, 5, 6, 8]},
        out=tmp_path,
        client=client,
        time_limit=1.0,
        progress=False,
    )
    frame = rg.read_study(tmp_path).set_index("a").sort_index()
    assert list(frame["verdict"]) == ["answered", "out of memory", "time limit", "worker lost", "worker lost"]
    assert set(client.nthreads()) == before


def test_what_cases_share_is_sent_once_however_large(client: Any, tmp_path: Path) -> None:
    values = np.arange(200_000.0)
    rg.sweep(
        study_cases.entry, {"a": [1, 5, 7]}, out=tmp_path, shared={"values": values}, client=client,
        progress=False,
    )  # fmt: skip
    assert sorted(rg.read_study(tmp_path)["value"]) == [1, 5, 7]


def test_no_scheduler_or_no_client_is_said(tmp_path: Path) -> None:
    from regrasp.studies import cluster

    before, cluster.CONNECT = cluster.CONNECT, "0.2s"
    try:
        with pytest.raises(rg.RegraspError, match="no dask scheduler answers at"):
            rg.sweep(study_cases.product, {"a": [1]}, out=tmp_path / "a", client="tcp://127.0.0.1:9")
    finally:
        cluster.CONNECT = before
    with pytest.raises(rg.InvalidInput, match="client must be a dask Client or a scheduler's address, got 3"):
        rg.sweep(study_cases.product, {"a": [1]}, out=tmp_path / "a", client=3)
    assert not (tmp_path / "a").exists()
