"""Studies end to end: what is in a row, restarts, refusals, other readers."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import pandas as pd
import polars as pl
import pytest

import regrasp as rg
import study_cases
from regrasp.files import read_plan
from regrasp.studies.parts import parts_in
from regrasp.studies.study import study_in
from studies_compared import raw_keys, rows

pytestmark = pytest.mark.contract

GRID = {"a": [1, 2, 3.5], "b": {"from": 0, "to": 1, "count": 5}}


def swept(out: Path, grid: Any = GRID, function: Any = study_cases.product, **options: Any) -> Any:
    return rg.sweep(function, grid, out=out, **{"workers": 0, "progress": False, **options})


def test_a_row_has_its_key_inputs_outputs_verdict_and_origin(tmp_path: Path) -> None:
    done = swept(tmp_path)
    assert (done.cases, done.rows, done.left, done.verdicts) == (15, 15, 0, {"answered": 15})
    frame = rg.read_study(tmp_path)
    assert list(frame) == [
        "key", "a", "b", "value", "verdict", "error", "certificate", "seconds", "machine", "versions",
    ]  # fmt: skip
    assert (frame["value"] == frame["a"] * frame["b"]).all()
    assert (frame["seconds"] >= 0).all()
    assert frame["versions"].str.contains("regrasp").all()
    assert frame["error"].isna().all()


@pytest.mark.parametrize("workers", [0, 1, 3])
def test_rows_are_the_same_whatever_the_number_of_workers(workers: int, tmp_path: Path) -> None:
    grid = {"friction": [0.3, 0.6], "seed": range(8)}
    swept(tmp_path / "one", grid, study_cases.removal)
    swept(tmp_path / "other", grid, study_cases.removal, workers=workers)
    one, other = rows(tmp_path / "one"), rows(tmp_path / "other")
    pd.testing.assert_frame_equal(one, other, check_exact=True)
    assert set(one["verdict"]) == {"answered", "infeasible"}
    assert set(one["certificate"].dropna()) == {"EscapeTwist"}


def test_however_a_case_ends_it_is_a_row(tmp_path: Path) -> None:
    done = swept(tmp_path, {"a": range(10)}, study_cases.fated, workers=2, time_limit=1.0, memory_limit=2**33)
    frame = rg.read_study(tmp_path).set_index("a").sort_index()
    assert list(frame["verdict"]) == [
        "answered", "invalid", "invalid", "failed", "out of memory", "time limit", "worker lost",
        "out of memory", "worker lost", "answered",
    ]  # fmt: skip
    said = frame["error"]
    assert said[2] == "force must be 2 or 3 numbers, got 1: [0]"
    assert said[3] == "ZeroDivisionError: nothing to divide by"
    assert said[5] == "no answer within 1 s"
    assert said[6] == "the process was ended by SIGKILL"
    assert said[8] == "the process ended with exit status 7"
    assert done.left == 0


def test_the_same_call_again_does_nothing_and_one_with_rows_missing_does_those(tmp_path: Path) -> None:
    swept(tmp_path, part_seconds=0.0)
    before, parts = rows(tmp_path), parts_in(tmp_path)
    assert len(parts) > 1
    seen: list[Any] = []
    swept(tmp_path, progress=seen.append)
    assert seen[-1].new == 0
    gone = parts[0]
    lost = len(pd.read_parquet(gone))
    gone.unlink()
    assert study_in(tmp_path).left == lost
    swept(tmp_path, progress=seen.append)
    assert seen[-1].new == lost
    pd.testing.assert_frame_equal(rows(tmp_path), before, check_exact=True)


def test_another_grid_is_refused_or_its_new_cases_are_done(tmp_path: Path) -> None:
    swept(tmp_path, {"a": [1, 2]})
    with pytest.raises(rg.InvalidInput, match=r"its grid differ.*extend=True .--extend."):
        swept(tmp_path, {"a": [2, 3]})
    done = swept(tmp_path, {"a": [2, 3]}, extend=True)
    assert (done.rows, done.cases, done.earlier, done.left) == (3, 2, 1, 0)
    assert sorted(rg.read_study(tmp_path)["a"]) == [1, 2, 3]
    with pytest.raises(rg.InvalidInput, match="grid"):
        swept(tmp_path, {"a": [1, 2]})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"function": study_cases.spun}, "function: 'study_cases:product' there, 'study_cases:spun' now"),
        ({"keep": ["value"]}, "keep: "),
        ({"plans": True}, "plans: False there, True now"),
    ],
)
def test_rows_of_another_study_are_never_mixed(change: Any, words: str, tmp_path: Path) -> None:
    swept(tmp_path, {"a": [1]})
    for extend in (False, True):
        with pytest.raises(rg.InvalidInput, match=words):
            swept(tmp_path, {"a": [1]}, extend=extend, **change)


def test_shared_values_reach_every_case_and_belong_to_the_study(tmp_path: Path) -> None:
    swept(tmp_path, {"a": [1, 2]}, shared={"b": 10.0}, workers=1)
    assert sorted(rg.read_study(tmp_path)["value"]) == [10, 20]
    with pytest.raises(rg.InvalidInput, match="its shared differ"):
        swept(tmp_path, {"a": [1, 2]}, shared={"b": 11.0})
    with pytest.raises(rg.InvalidInput, match="'a' is in the grid and shared"):
        swept(tmp_path / "new", {"a": [1, 2]}, shared={"a": 11.0})


def test_columns_widen_and_earlier_parts_with_them(tmp_path: Path) -> None:
    swept(tmp_path, {"a": list(range(6))}, study_cases.mixed, part_seconds=0.0)
    parts = [pl.read_parquet(part) for part in parts_in(tmp_path)]
    assert len(parts) > 2
    assert len({tuple(part.schema.items()) for part in parts}) == 1
    frame = rg.read_study(tmp_path).set_index("a").sort_index()
    assert frame["number"].tolist() == [0, 1, 2, 0.5, 0.5, 0.5]
    assert frame["text"].tolist() == ["0.0", "1.0", "2.0", "x", "x", "x"]
    np.testing.assert_array_equal(frame["late"], [np.nan] * 3 + [7.0] * 3)


def test_other_readers_read_the_folder_a_half_written_part_beside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    swept(tmp_path, part_seconds=0.0)
    rows, was = len(rg.read_study(tmp_path)), {path.name for path in tmp_path.iterdir()}
    with monkeypatch.context() as torn:
        torn.setattr("regrasp.studies.parts._place", lambda draft, path: draft.write_bytes(b"PAR1"))
        swept(tmp_path, {"a": [9, 8]}, extend=True, part_seconds=0.0)
    assert any(name.startswith(".rows-") for name in {path.name for path in tmp_path.iterdir()} - was)
    assert len(rg.read_study(tmp_path)) == rows
    ours = rg.read_study(tmp_path)
    assert len(pd.read_parquet(tmp_path)) == len(ours)
    with_polars = pl.read_parquet(f"{tmp_path}/*.parquet")
    assert with_polars["value"].sum() == pytest.approx(ours["value"].sum())
    sql = f"select sum(value), count(*) from '{tmp_path}/*.parquet'"
    assert duckdb.sql(sql).fetchall() == [(pytest.approx(ours["value"].sum()), 15)]


def test_a_dataset_lies_over_the_grid(tmp_path: Path) -> None:
    swept(tmp_path)
    data: Any = rg.read_study(tmp_path, "xarray")
    assert dict(data.sizes) == {"a": 3, "b": 5}
    np.testing.assert_array_equal(data["value"], np.outer([1, 2, 3.5], np.linspace(0, 1, 5)))
    swept(tmp_path / "zipped", {"a": [1, 2], "b": [3, 4]}, zipped=True)
    with pytest.raises(rg.InvalidInput, match="no product"):
        rg.read_study(tmp_path / "zipped", "xarray")


def test_plans_are_kept_on_request(tmp_path: Path) -> None:
    grid = {"friction": [0.6], "seed": [0, 2, 3]}
    swept(tmp_path, grid, study_cases.removal, plans=True, workers=1, keep=["end.magnitudes"])
    frame = rg.read_study(tmp_path).set_index("key")
    answered = frame[frame["verdict"] == "answered"]
    assert {path.stem for path in (tmp_path / "_plans").iterdir()} == set(answered.index)
    for key, row in answered.iterrows():
        plan = read_plan(tmp_path / "_plans" / f"{key}.json")
        np.testing.assert_array_equal(plan.end.magnitudes, row["end.magnitudes"])
        assert rg.verify(plan).ok


@pytest.mark.parametrize("workers", [0, 1])
def test_what_is_not_there_to_keep_ends_the_run_at_once(workers: int, tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match=r"a Transition has no 'margn'; it has .*friction_needed"):
        swept(
            tmp_path,
            {"friction": [0.6], "seed": [2, 3]},
            study_cases.removal,
            keep=["margn"],
            workers=workers,
        )
    with pytest.raises(rg.InvalidInput, match="a case returns no 'roots'; it has square, root"):
        swept(tmp_path / "b", {"a": [1]}, study_cases.spun, keep=["roots"], workers=workers)


@pytest.mark.parametrize(
    ("function", "options", "words"),
    [
        (lambda a: a, {"workers": 1}, "workers import the function by its name"),
        ("study_cases.product", {}, "named 'module:function'"),
        ("study_cases:nothing", {}, "cannot be imported"),
        (3, {}, "function must be a function or its name"),
        (study_cases.product, {"grid": {"c": [1]}}, "takes a, b; the cases have c"),
        (study_cases.product, {"grid": {"b": [1]}}, "missing a required argument: 'a'"),
        (study_cases.product, {"time_limit": 1.0}, "give workers of at least 1"),
        (study_cases.product, {"workers": 1, "client": "tcp://127.0.0.1:1"}, "one of workers and client"),
        (study_cases.spun, {"grid": {"a": [1], "root": [2]}}, "takes a, spin"),
    ],
)
def test_bad_input_is_refused_before_any_work(
    function: Any, options: Any, words: str, tmp_path: Path
) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        swept(tmp_path / "out", **{"grid": {"a": [1]}, "function": function, **options})
    assert not (tmp_path / "out").exists()


def test_outputs_do_not_hide_inputs(tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match="returns 'a', which is a column already"):
        swept(tmp_path, {"a": [1]}, study_cases.echo)


def test_a_folder_that_is_none_of_a_study_is_refused(tmp_path: Path) -> None:
    for read in (rg.read_study, study_in):
        with pytest.raises(rg.InvalidInput, match="expected the folder of a study"):
            read(tmp_path)
    pd.DataFrame({"x": [1]}).to_parquet(tmp_path / "mine.parquet")
    with pytest.raises(rg.InvalidInput, match=r"has rows but no _study\.json"):
        swept(tmp_path)
    swept(tmp_path / "b")
    study = tmp_path / "b" / "_study.json"
    study.write_text(study.read_text().replace('"version": 1', '"version": 2'))
    with pytest.raises(rg.InvalidInput, match="expected version 1 of a study, got 2"):
        rg.read_study(tmp_path / "b")


def test_a_part_that_is_no_part_and_a_doubled_one_are_named(tmp_path: Path) -> None:
    swept(tmp_path)
    (part,) = parts_in(tmp_path)
    (tmp_path / "rows-x.parquet").write_bytes(part.read_bytes())
    with pytest.raises(rg.InvalidInput, match=r"rows-.*stands in another part too"):
        swept(tmp_path)
    (tmp_path / "rows-x.parquet").write_bytes(part.read_bytes()[:-100])
    with pytest.raises(rg.InvalidInput, match=r"rows-x\.parquet: not a part of a study"):
        swept(tmp_path)


def test_two_runs_do_not_fill_one_folder(tmp_path: Path) -> None:
    def meanwhile(progress: Any) -> None:
        if progress.done != progress.total:
            with pytest.raises(rg.InvalidInput, match="another run is filling"):
                swept(tmp_path)

    swept(tmp_path, progress=meanwhile)
    assert len(raw_keys(tmp_path)) == 15


def test_a_listener_hears_of_failures_by_kind(tmp_path: Path) -> None:
    heard: list[str] = []
    swept(tmp_path, {"a": range(5)}, study_cases.fated, progress=lambda p: heard.append(str(p)))
    assert heard[-1].startswith("5 of 5 rows in this process")
    assert heard[-1].endswith("; failed 1, invalid 2, out of memory 1")


def test_a_notebook_shows_one_line_that_is_renewed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []

    class Handle:
        def update(self, data: dict[str, str], raw: bool) -> None:
            shown.append(data["text/plain"])

    def display(data: dict[str, str], raw: bool, display_id: bool) -> Handle:
        shown.append(data["text/plain"])
        return Handle()

    monkeypatch.setitem(sys.modules, "ipykernel", sys)
    monkeypatch.setattr("IPython.display.display", display)
    swept(tmp_path, progress=True)
    assert shown[-1].startswith("15 of 15 rows in this process, ")
    assert shown[-1].endswith("/s, 0 s left")


def test_cheap_cases_are_told_of_the_functions_of_arrays(tmp_path: Path, caplog: Any) -> None:
    with caplog.at_level("INFO", "regrasp"):
        swept(tmp_path, {"a": range(200)})
    assert "less than it costs to hand it out" in caplog.text
    assert "200 of 200 rows" in caplog.text


@pytest.mark.parametrize(
    ("missing", "words"),
    [("pyarrow", r"studies need pyarrow: pip install 'regrasp\[study\]'"), ("distributed", "regrasp")],
)
def test_without_the_extra_one_line_says_which(
    missing: str, words: str, monkeypatch: Any, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    client = {"client": "tcp://127.0.0.1:1", "workers": None} if missing == "distributed" else {}
    with pytest.raises(ImportError, match=words):
        swept(tmp_path, {"a": [1]}, **client)


def test_threads_inside_are_held_at_one(tmp_path: Path) -> None:
    swept(tmp_path, {"a": [1]}, study_cases.threads, workers=1)
    assert rg.read_study(tmp_path)["value"][0] == "1 1 1"


def test_functions_are_found_in_the_folder_where_one_stands(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("def twice(a):\n    return 2 * a\n")
    code = "import regrasp as rg; print(rg.sweep('mine:twice', {'a': [1, 2]}, out='o', workers=1).rows)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout == "2\n"
    assert done.stderr == ""
