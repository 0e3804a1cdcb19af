"""Scenarios, plan files, set-points and the staging of output."""

import csv
import json
import os
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from places import ROOT
from regrasp.disk.staging import whole_file, whole_folder
from regrasp.files import (
    parse_scenario,
    plan_scenario,
    read_plan,
    read_scenario,
    scenario_schema,
    write_plan,
    write_setpoints,
)
from regrasp.plans.record import Choice, Record
from scenarios import PAPER, edited

pytestmark = pytest.mark.contract

EXAMPLES = ROOT / "examples"
SCENARIOS = sorted(path for path in EXAMPLES.glob("*.toml") if path.stem != "study")


def planned(*changes: tuple[str, str]) -> rg.Transition:
    return plan_scenario(parse_scenario(edited(*changes)))


PLAN = planned()

# -- scenarios ------------------------------------------------------------------------------------------


def test_example_and_demo_are_the_same_text() -> None:
    assert (EXAMPLES / "paper.toml").read_text(encoding="utf-8") == PAPER


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_examples_plan_and_verify(path: Path) -> None:
    assert rg.verify(plan_scenario(read_scenario(path))).ok


def test_scenario_plans_what_the_same_calls_plan() -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([-4, -4], [1, 1], 0.3, name="P1"),
            rg.Contact([4, -5], [-1, 2], 0.3, name="P2"),
            rg.Contact([0, 8], [0, -1], 0.3, name="P3"),
        ]
    )
    forces = [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]]
    state = rg.GraspState(grasp, rg.Wrench([-1.5, -3.5]), forces)
    assert rg.plan_removal(state, "P3") == PLAN


TASK = "duration = 1.0"


def without_forces(text: str) -> str:
    """The scenario with no starting force; the load, in brackets of its own, keeps its force."""
    head, *contacts = text.split("[[contacts]]")
    return "[[contacts]]".join(
        [head, *("\n".join(x for x in c.splitlines() if not x.startswith("force")) + "\n" for c in contacts)]
    )


@pytest.mark.parametrize(
    ("line", "seen", "expected"),
    [
        ('whole_objective = "peak"', lambda p: p.record.choices[1].objective, "peak"),
        ('method = "clarabel"', lambda p: p.record.choices[0].method, "clarabel"),
        ("max_force = 7.5", lambda p: p.grasp.max_forces.tolist(), [7.5] * 3),
        ("reserve = 0.25", lambda p: p.record.reserve, 0.25),
        ("duration = 2.5", lambda p: p.duration, 2.5),
    ],
)
def test_option_reaches_the_plan(line: str, seen: Callable[[rg.Transition], Any], expected: Any) -> None:
    changed = plan_scenario(parse_scenario(without_forces(edited((TASK, line)))))
    assert seen(changed) == expected
    assert rg.verify(changed).ok


def test_objective_and_peak_ratio_reach_the_plan() -> None:
    plan = planned(('objective = "angle"', 'objective = "force"\npeak_ratio = 1.5'))
    least = planned(('objective = "angle"', 'objective = "peak"')).end.magnitudes.max()
    (choice,) = plan.record.choices
    assert choice.objective == "force"
    assert choice.force_limits == pytest.approx([1.5 * least] * 2, rel=1e-8)


def test_balance_tolerance_reaches_the_planner() -> None:
    off = ("force = [3.7897, 3.0034]", "force = [3.9, 3.0034]")
    with pytest.raises(rg.InvalidInput, match="no equilibrium"):
        planned(off)
    plan = planned(off, (TASK, "balance_tolerance = 0.02"))
    assert 0.001 < plan.record.balancing < 0.02 * 5.4
    assert rg.verify(plan).ok


@pytest.mark.parametrize(
    ("lines", "scaling"),
    [
        ('scaling = "minimum_jerk"', rg.TimeScaling.minimum_jerk(1.0)),
        ('scaling = "linear"', rg.TimeScaling.linear(1.0)),
        ('scaling = "spline"', rg.TimeScaling.spline(1.0)),
        ("control = [1.0, 1.0, 0.2, 0.1, 0.0, 0.0]", rg.TimeScaling.spline(1.0, (1, 1, 0.2, 0.1, 0, 0))),
    ],
)
def test_scaling_and_control_reach_the_plan(lines: str, scaling: rg.TimeScaling) -> None:
    text = "".join(
        line for line in PAPER.splitlines(keepends=True) if not line.startswith(("scaling", "control"))
    )
    assert plan_scenario(parse_scenario(f"{text}\n{lines}\n")).scaling == scaling


def test_rate_limit_sets_the_duration() -> None:
    plan = planned((TASK, "rate_limit = 10.0"))
    fastest = np.linalg.norm(plan.rates(np.linspace(0, plan.duration, 2001)), axis=-1).max()
    assert fastest == pytest.approx(10.0, rel=1e-6)
    assert plan == PLAN.fastest(10.0)


def test_given_end_is_used() -> None:
    plan = planned(
        ("force = [3.7897, 3.0034]", "force = [3.7897, 3.0034]\nend_force = [1.8557, 2.4555]"),
        ("force = [-3.0096, 4.4156]", "force = [-3.0096, 4.4156]\nend_force = [-0.3557, 1.0445]"),
    )
    assert plan.record.choices == ()
    assert plan.end.forces[:2] == pytest.approx(np.array([[1.8557, 2.4555], [-0.3557, 1.0445]]), abs=1e-4)
    assert rg.verify(plan).ok


def test_addition_with_both_ends_given_is_the_removal_run_backwards() -> None:
    text = edited(
        ('kind = "removal"', 'kind = "addition"'),
        ("force = [3.7897, 3.0034]", "end_force = [3.7897, 3.0034]\nforce = [1.8557, 2.4555]"),
        ("force = [-3.0096, 4.4156]", "end_force = [-3.0096, 4.4156]\nforce = [-0.3557, 1.0445]"),
        ("force = [0.7199, -3.9190]", "end_force = [0.7199, -3.9190]"),
    )
    plan = plan_scenario(parse_scenario(text))
    assert plan.kind == "addition"
    assert plan.grasp.names == ("P1", "P2", "P3")
    assert plan.end == PLAN.start
    assert not plan.start.force("P3").any()


def test_arriving_finger_may_stand_first_in_the_file() -> None:
    text = without_forces(edited(('kind = "removal"', 'kind = "addition"')))
    head, *contacts = text.split("[[contacts]]")
    last, task = contacts[2].split("[task]")
    text = "[[contacts]]".join([head, last, contacts[0], contacts[1]]) + "[task]" + task
    plan = plan_scenario(parse_scenario(text))
    assert plan.grasp.names == ("P1", "P2", "P3")
    assert plan.contact == "P3"
    assert rg.verify(plan).ok


@pytest.mark.parametrize("change", [lambda b: b"\xef\xbb\xbf" + b, lambda b: b.replace(b"\n", b"\r\n")])
def test_windows_text_is_read(change: Callable[[bytes], bytes], tmp_path: Path) -> None:
    path = tmp_path / "paper.toml"
    path.write_bytes(change(PAPER.encode()))
    assert read_scenario(path) == parse_scenario(PAPER)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: None, "expected a scenario in TOML, found no such file"),
        (lambda path: path.mkdir(), "expected a scenario in TOML, found a folder"),
        (
            lambda path: path.write_bytes(b"# \xff"),
            "expected a scenario in TOML, found no UTF-8 text (at byte 2)",
        ),
        (
            lambda path: path.write_text("a = " + "[" * 100_000),
            "not a scenario: lists within lists, hundreds deep",
        ),
    ],
)
def test_file_that_is_no_scenario(make: Callable[[Path], object], message: str, tmp_path: Path) -> None:
    path = tmp_path / "scenario.toml"
    make(path)
    with pytest.raises(rg.InvalidInput) as raised:
        read_scenario(path)
    assert str(raised.value).startswith(f"{path}: {message}")


def test_json_schema_accepts_the_examples_and_refuses_what_we_refuse() -> None:
    schema = scenario_schema()
    for path in SCENARIOS:
        jsonschema.validate(tomllib.loads(path.read_text(encoding="utf-8")), schema)
    for change in (
        ('kind = "removal"', 'kind = "rotation"'),
        ('kind = "removal"', 'kind = "regrasp"'),
        ("friction = 0.3", "friction = -0.3"),
        ("friction = 0.3", "friktion = 0.3"),
        ("position = [4.0, -5.0]", "position = [4.0, -5.0, 0.0, 0.0]"),
        ('objective = "angle"', 'objective = "safest"'),
    ):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(tomllib.loads(edited(change)), schema)


# -- plan files -----------------------------------------------------------------------------------------

finite = st.floats(-1e200, 1e200)  # rates of larger ones have no number
positive = st.floats(min_value=0, exclude_min=True, allow_infinity=False, allow_nan=False)
frictions = st.floats(min_value=0, allow_infinity=False, allow_nan=False)


@st.composite
def normals(draw: st.DrawFn, d: int) -> list[float]:
    n = draw(st.lists(finite, min_size=d, max_size=d).filter(any))
    unit = draw(st.booleans())
    return rg.Contact([0.0] * d, n, 0.0).normal.tolist() if unit else n


@st.composite
def transitions(draw: st.DrawFn) -> rg.Transition:
    """Any transition that can be made, balanced or not: a file must keep its every bit."""
    d, n = draw(st.sampled_from([2, 3])), draw(st.integers(1, 4))
    points = draw(st.lists(st.integers(-9, 9), min_size=n, max_size=n, unique=True))
    scale = draw(st.floats(1e-100, 1e100))
    grasp = rg.Grasp(
        rg.Contact(
            [k * scale, *draw(st.lists(st.just(scale) | st.just(-0.0), min_size=d - 1, max_size=d - 1))],
            draw(normals(d)),
            draw(frictions),
            max_force=draw(st.none() | positive),
            name=draw(st.none() | st.just(f"Finger {i}, “left”")),
        )
        for i, k in enumerate(points)
    )
    load = rg.Wrench.from_vector(draw(st.lists(finite, min_size=3 * (d - 1), max_size=3 * (d - 1))))
    rows = st.lists(st.lists(finite, min_size=d, max_size=d), min_size=n, max_size=n)
    start, end = (rg.GraspState(grasp, load, draw(rows)) for _ in range(2))
    fall = sorted(draw(st.lists(st.floats(0, 1), max_size=5)), reverse=True)
    scaling = rg.TimeScaling.spline(draw(st.floats(1e-100, 1e100)), (1, *fall, 0))
    limits = tuple(draw(st.lists(positive | st.just(inf), min_size=n, max_size=n)))
    record = Record(
        draw(st.floats(0, 0.99)), (Choice("end", "angle", "closed-form", limits),), draw(frictions)
    )
    moving = {draw(st.sampled_from(["leaving", "arriving"])): grasp.names[: draw(st.integers(1, n))]}
    return rg.Transition(start, end, scaling, record, **moving)


@given(plan=transitions())
def test_plan_is_read_back_bit_for_bit(plan: rg.Transition, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "any-plan.json"
    write_plan(plan, path)
    back = read_plan(path)
    assert back == plan
    for ours, theirs in ((plan.start, back.start), (plan.end, back.end)):
        assert ours.forces.tobytes() == theirs.forces.tobytes()
        assert ours.load.vector.tobytes() == theirs.load.vector.tobytes()
        assert ours.grasp.normals.tobytes() == theirs.grasp.normals.tobytes()
        assert ours.grasp.positions.tobytes() == theirs.grasp.positions.tobytes()
    text = path.read_text(encoding="utf-8")
    write_plan(back, path)
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("d", [2, 3])
def test_normalising_twice_changes_no_bit(d: int) -> None:
    rng = np.random.default_rng(d)
    for normal in rng.normal(size=(5000, d)) * 10.0 ** rng.uniform(-300, 300, size=(5000, 1)):
        once = rg.Contact(np.zeros(d), normal, 0.3).normal
        assert once.tobytes() == rg.Contact(np.zeros(d), once, 0.3).normal.tobytes()
        assert abs(np.linalg.norm(once) - 1) < 1e-15


def test_plan_read_back_gets_the_same_verdict(tmp_path: Path) -> None:
    write_plan(PLAN, tmp_path / "plan.json")
    assert rg.verify(read_plan(tmp_path / "plan.json")) == rg.verify(PLAN)


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


def put(value: Any, *keys: str | int) -> Callable[[dict[str, Any]], None]:
    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value

    return change


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
        (put("removing", "kind"), "kind: expected 'removal', 'addition', 'rotation', 'exchange' or 'hold', "
                                  "got 'removing'"),
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
