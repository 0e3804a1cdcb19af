"""Plan files: strict JSON with a version, read back equal; set-points beside them; output written whole."""

import csv
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from regrasp.disk.staging import whole_file, whole_folder
from regrasp.files import (
    read_plan,
    write_plan,
    write_setpoints,
)
from scenarios import planned
from spoiling import put

pytestmark = pytest.mark.contract

PLAN = planned()


def test_plan_file_is_strict_json_with_its_version(tmp_path: Path) -> None:
    write_plan(PLAN, tmp_path / "plan.json")
    text = (tmp_path / "plan.json").read_text(encoding="utf-8")

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    data = json.loads(text, parse_constant=refuse)
    assert (data["format"], data["version"]) == ("regrasp plan", 1)
    assert data["contacts"][0]["max_force"] is None


def test_plan_that_is_not_finite_is_not_written(tmp_path: Path) -> None:
    plan = replace(PLAN, record=replace(PLAN.record, balancing=nan))
    path = tmp_path / "plan.json"
    with pytest.raises(rg.InvalidInput) as raised:
        write_plan(plan, path)
    assert str(raised.value) == f"{path}: record.balancing: expected a finite number, got nan"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put(2, "version"), "version: expected 1, got 2; "
                            "a plan of a newer regrasp needs that regrasp to be read"),
        (put("regrasp cut", "format"), "expected a plan with \"format\": \"regrasp plan\", "
                                       "found \"format\": 'regrasp cut'"),
        (put(3, "format"), 'expected a plan with "format": "regrasp plan", found other JSON'),
        (lambda data: data.pop("load"), "load: a required key is missing"),
        (lambda data: data["record"].pop("reserve"), "record.reserve: a required key is missing"),
        (put("fast", "speed"), "speed: unknown key; known here: format, version, kind, contact, load, "
                               "contacts, start, end, scaling, course, record, arrival, leaving, arriving, "
                               "turn"),
        (put("removing", "kind"), "kind: expected 'removal', 'addition', 'exchange', 'rotation', 'hold', "
                                  "'regrasp' or 'grasp', got 'removing'"),
        (put("rotation", "kind"), "a rotation names the wrong fingers: 'P3' and None"),
        (put("P2", "arrival"), "a removal names the wrong fingers: 'P3' and 'P2'"),
        (put("P9", "contact"), "no contact 'P9' in this grasp; it has P1, P2, P3"),
        (put("1", "start", 0, 1), "start[0][1]: expected a number, got '1'"),
        (put(nan, "start", 0, 1), "start[0][1]: expected a finite number, got nan"),
        (put([[0.0, 1.0]], "end"), "forces must have shape (3, 2), got (1, 2): [[0.0, 1.0]]"),
        (put([[0.0, 1.0], [1.0], [2.0]], "end"), "forces must be numbers of shape (3, 2), "
                                                  "got [[0.0, 1.0], [1.0], [2.0]]"),
        (put([1.0, 2.0], "load"), "a wrench must have 3 (plane) or 6 (space) numbers, got 2"),
        (put([0.0, 0.0], "contacts", 0, "normal"), "contact 'P1': normal must not be zero; "
                                                  "give the direction that points into the object"),
        (put("P2", "contacts", 0, "name"), "contacts of one grasp must have different names, "
                                              "'P2' came twice"),
        (put(-0.1, "contacts", 0, "friction"), "contact 'P1': friction must be at least 0, got -0.1"),
        (put([1.0, 2.0, 0.0], "scaling", "control"), "control values must fall from 1 to 0, "
                                                     "got (1.0, 2.0, 0.0)"),
        (put(9, "scaling", "degree"), "degree must be from 1 to 4, got 9"),
        (put(0.0, "scaling", "duration"), "duration must be greater than 0, got 0.0"),
        (put("middle", "record", "choices", 0, "end"), "record.choices[0].end: expected 'start' or 'end', "
                                                       "got 'middle'"),
        (put(["many"], "record", "choices", 0, "force_limits"), "record.choices[0].force_limits[0]: "
                                                                "expected a number, got 'many'"),
    ],
)  # fmt: skip
def test_damaged_plan(change: Callable[[dict[str, Any]], None], message: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(PLAN, path)
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(rg.InvalidInput) as raised:
        read_plan(path)
    assert str(raised.value) == f"{path}: {message}"


def test_plan_cut_short_anywhere(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(PLAN, path)
    text = path.read_text(encoding="utf-8").rstrip()
    for length in range(0, len(text), 7):
        path.write_text(text[:length], encoding="utf-8")
        with pytest.raises(rg.InvalidInput) as raised:
            read_plan(path)
        assert str(raised.value).startswith(f"{path}: not JSON, or cut short: ")


@pytest.mark.parametrize("text", ["[]", "3", "null", '{"format": 1}', "[" * 100_000, "1" * 5000])
def test_foreign_json(text: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(rg.InvalidInput) as raised:
        read_plan(path)
    assert str(raised.value).startswith(f"{path}: ")


# -- set-points -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("duration", "rate"), [(1.0, 1000.0), (0.3, 7.0), (30.0, 1000.0)])
def test_setpoints_are_the_plan_to_the_last_bit(duration: float, rate: float, tmp_path: Path) -> None:
    plan = PLAN.retimed(PLAN.scaling.lasting(duration))
    write_setpoints(plan, tmp_path / "setpoints.csv", rate)
    with (tmp_path / "setpoints.csv").open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    table = np.array(rows, dtype=float)
    assert header == ["t", "P1_fx", "P1_fy", "P2_fx", "P2_fy", "P3_fx", "P3_fy"]
    assert (table[0, 0], table[-1, 0]) == (0.0, duration)
    assert (table[:, 1:] == plan.forces(table[:, 0]).reshape(len(table), -1)).all()
    assert (table[-1, 1:] == plan.end.forces.ravel()).all()


@given(duration=st.floats(1e-6, 1e3), rate=st.floats(1e-3, 1e3))
def test_sampling_times_run_from_end_to_end(duration: float, rate: float) -> None:
    times = PLAN.retimed(PLAN.scaling.lasting(duration)).times(rate)
    steps = np.diff(times)
    assert (times[0], times[-1]) == (0.0, duration)
    assert (steps > 0).all()
    assert steps.max() <= (1 + 1e-9) / rate
    assert times.size <= duration * rate + 2


def test_name_with_a_comma_stays_one_column(tmp_path: Path) -> None:
    plan = planned(('name = "P3"', 'name = "thumb, left"'), ('contact = "P3"', 'contact = "thumb, left"'))
    write_setpoints(plan, tmp_path / "setpoints.csv", 10)
    with (tmp_path / "setpoints.csv").open(encoding="utf-8", newline="") as file:
        assert next(csv.reader(file))[-2:] == ["thumb, left_fx", "thumb, left_fy"]


# -- whole or not at all --------------------------------------------------------------------------------


def contents(folder: Path) -> dict[str, str | None]:
    """Every path below a folder, with the text of files."""
    return {
        str(path.relative_to(folder)): path.read_text() if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }


def test_new_folder_and_its_parents_appear_at_the_end(tmp_path: Path) -> None:
    target = tmp_path / "a" / "b"
    with whole_folder(target) as folder:
        (folder / "x").write_text("1")
        assert not target.parent.exists()
    assert contents(tmp_path) == {"a": None, "a/b": None, "a/b/x": "1"}


def test_files_of_equal_name_are_replaced_and_others_left(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("old")
    (tmp_path / "mine").write_text("mine")
    with whole_folder(tmp_path) as folder:
        (folder / "x").write_text("new")
        (folder / "y").write_text("new")
    assert contents(tmp_path) == {"x": "new", "y": "new", "mine": "mine"}


def test_folder_behind_a_link_and_dots(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    for target in (tmp_path / "link", tmp_path / "missing" / ".." / "dots"):
        with whole_folder(target) as folder:
            (folder / "x").write_text("1")
    assert (tmp_path / "real" / "x").read_text() == "1"
    assert (tmp_path / "dots" / "x").read_text() == "1"
    assert not (tmp_path / "missing").exists()


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_error_while_writing_leaves_what_was_there(
    there: bool, error: type[BaseException], tmp_path: Path
) -> None:
    target = tmp_path / "out"
    if there:
        target.mkdir()
        (target / "x").write_text("old")
    before = contents(tmp_path)

    def write() -> None:
        with whole_folder(target) as folder:
            (folder / "x").write_text("new")
            raise error

    with pytest.raises(error):
        write()
    assert contents(tmp_path) == before


@pytest.mark.parametrize("done", [True, False])
@pytest.mark.parametrize("move", range(5))
def test_interrupt_between_any_two_moves_puts_everything_back(
    move: int, done: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("x", "z"):
        (tmp_path / name).write_text("old")
    before, moves, replace_file = contents(tmp_path), iter(range(100)), Path.replace

    def interrupted(self: Path, target: Path) -> Path:
        now = next(moves)
        if now == move and not done:
            raise KeyboardInterrupt
        result = replace_file(self, target)
        if now == move:
            raise KeyboardInterrupt
        return result

    def write() -> None:
        with whole_folder(tmp_path) as folder:
            for name in ("x", "y", "z"):
                (folder / name).write_text("new")
            monkeypatch.setattr(Path, "replace", interrupted)

    with pytest.raises(KeyboardInterrupt):
        write()
    assert contents(tmp_path) == before


def occupied(tmp_path: Path) -> Iterator[tuple[Path, str]]:
    """Places where no folder can be written, and what is said of them."""
    (tmp_path / "file").write_text("")
    yield tmp_path / "file", f"{tmp_path / 'file'}: expected a folder to write into, found a file"
    inside = tmp_path / "file" / "out"
    yield inside, f"{inside}: cannot be written: Not a directory"
    (tmp_path / "full" / "x").mkdir(parents=True)
    yield tmp_path / "full", f"{tmp_path / 'full' / 'x'}: expected a file to replace, found a folder"


def test_places_that_cannot_be_written(tmp_path: Path) -> None:
    for target, message in occupied(tmp_path):
        before = contents(tmp_path)

        def write(target: Path = target) -> None:
            with whole_folder(target) as folder:
                (folder / "x").write_text("new")

        with pytest.raises(rg.InvalidInput) as raised:
            write()
        assert str(raised.value) == message
        assert contents(tmp_path) == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_folder_without_permission(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(rg.InvalidInput, match="Permission denied"), whole_folder(tmp_path / "out"):
            pass
    finally:
        tmp_path.chmod(0o700)


def test_single_file_is_replaced_whole(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_text("old")

    def write(error: BaseException | None = None) -> None:
        with whole_file(path) as file:
            file.write("new")
            if error:
                raise error

    with pytest.raises(KeyboardInterrupt):
        write(KeyboardInterrupt())
    assert contents(tmp_path) == {"x": "old"}
    write()
    assert contents(tmp_path) == {"x": "new"}


def test_file_in_a_missing_folder(tmp_path: Path) -> None:
    path = tmp_path / "missing" / "plan.json"
    with pytest.raises(rg.InvalidInput) as raised:
        write_plan(PLAN, path)
    assert str(raised.value) == f"{path}: cannot be written: No such file or directory"


@pytest.mark.parametrize("depth", [900, 5000, 100_000])
@pytest.mark.parametrize("open_and_close", [("[", "]"), ('{"a":', "}")])
def test_plans_nested_without_end(depth: int, open_and_close: tuple[str, str], tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    opened, closed = open_and_close
    path.write_text(opened * depth + "1" + closed * depth, encoding="utf-8")
    with pytest.raises(rg.InvalidInput) as raised:
        read_plan(path)
    assert "recursion" not in str(raised.value)
    assert "\n" not in str(raised.value)
    assert len(str(raised.value)) < 400
