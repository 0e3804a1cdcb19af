"""Turning objects and whole regrasps in files: scenarios, plans and set-points."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from math import nan, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from places import ROOT
from regrasp.files import (
    RegraspScenario,
    parse_scenario,
    plan_scenario,
    read_plan,
    read_scenario,
    write_plan,
    write_setpoints,
)
from regrasp.files.plans.setpoints import checked, read_setpoints, setpoint_blocks
from regrasp.outline import parts
from regrasp.verification import verify_setpoints
from regrasp_moves import check_moves
from scenarios import regrasp

pytestmark = pytest.mark.contract

EXAMPLES = ROOT / "examples"

WEIGHT = rg.Wrench([0, -3.0])
ELLIPSE = rg.Outline.ellipse(2, 1)
JAR = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.8, name="A"), rg.Contact([1, 0.1], [-1, 0], 0.8, name="B")])
ROTATION = rg.plan_rotation(JAR, radians(150), load=WEIGHT, duration=2.0)


def fingers_at(*places: float, prefix: str = "P") -> rg.Grasp:
    """Three contacts at fractions of the boundary of the ellipse."""
    return rg.Grasp(
        ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5, name=f"{prefix}{i}")
        for i, s in enumerate(places, 1)
    )


def turned_in_a_hold(plan: rg.RegraspPlan) -> rg.RegraspPlan:
    """The same, with a turn there and back in its first hold, and one of all fingers in the end."""
    removal, *others = plan.steps
    (air,) = removal.leaving
    hold = removal.end.without(air)
    there = rg.plan_rotation(hold, radians(15))
    steps = (removal, there, rg.plan_rotation(there.end, radians(-15), end=hold), *others)
    steps += (rg.plan_rotation(others[-1].end, radians(75)),)
    turned = np.cumsum([0.0, *(step.turn.angle if step.turn else 0.0 for step in steps)])
    margin = min(plan.margin, there.end.margins.least_angle)
    return rg.RegraspPlan(steps, tuple(turned.tolist()), margin)


REGRASP = turned_in_a_hold(
    rg.plan_regrasp(
        ELLIPSE,
        fingers_at(0.02, 0.35, 0.7),
        fingers_at(0.2, 0.5, 0.85),
        WEIGHT,
        friction=0.5,
        orientations=1,
    )
)
TURNED = rg.plan_regrasp(
    ELLIPSE,
    fingers_at(0.02, 0.35, 0.7),
    fingers_at(0.2, 0.5, 0.85),
    WEIGHT,
    friction=0.5,
    orientations=24,
    goal_orientation=radians(75),
)
EXCHANGE = next(k for k, step in enumerate(REGRASP.steps) if step.kind == "exchange")


def same_bits(ours: rg.Transition, theirs: rg.Transition) -> bool:
    def bits(plan: rg.Transition) -> list[bytes]:
        arrays = [plan.grasp.positions, plan.grasp.normals, plan.grasp.frictions]
        for state in (plan.start, plan.end):
            arrays += [state.forces, state.load.vector]
        if plan.turn is not None:
            arrays += [plan.turn.angles, plan.turn.forces]
        return [array.tobytes() for array in arrays]

    return bits(ours) == bits(theirs)


# -- plan files -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "plan", [ROTATION, ROTATION.reversed(), *REGRASP.steps], ids=lambda plan: plan.in_words
)
def test_turning_plans_are_read_back_bit_for_bit(plan: rg.Transition, tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(plan, path)
    back = read_plan(path)
    assert isinstance(back, rg.Transition)
    assert back == plan
    assert same_bits(plan, back)
    assert rg.verify(back) == rg.verify(plan)
    assert rg.verify(back).ok


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
@given(angle=st.floats(-7, 7).filter(lambda angle: abs(angle) > 1e-6), weight=st.floats(1e-3, 1e3))
def test_any_rotation_is_read_back(
    angle: float, weight: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "any-rotation.json"
    plan = rg.plan_rotation(JAR, angle, load=rg.Wrench([0.1, -weight]))
    write_plan(plan, path)
    back = read_plan(path)
    assert isinstance(back.path, rg.TurningPath)
    assert back == plan
    assert same_bits(plan, back)


def test_regrasp_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    assert {step.kind for step in REGRASP.steps} >= {"removal", "exchange", "rotation", "addition"}
    assert any(step.turn and step.arrival for step in TURNED.steps)
    for plan in (REGRASP, REGRASP.reversed(), TURNED):
        write_plan(plan, tmp_path / "plan.json")
        back = read_plan(tmp_path / "plan.json")
        assert back == plan
        assert isinstance(back, rg.RegraspPlan)
        assert all(same_bits(a, b) for a, b in zip(plan.steps, back.steps, strict=True))
        assert str(back) == str(plan)
        assert rg.verify(back) == rg.verify(plan)
        assert rg.verify(back).ok
        first = (tmp_path / "plan.json").read_bytes()
        write_plan(back, tmp_path / "plan.json")
        assert (tmp_path / "plan.json").read_bytes() == first


def test_straight_plans_are_written_as_before(tmp_path: Path) -> None:
    write_plan(REGRASP.steps[0], tmp_path / "plan.json")
    assert list(json.loads((tmp_path / "plan.json").read_text())) == [
        "format", "version", "kind", "contact", "load", "contacts", "start", "end", "scaling", "course",
        "record",
    ]  # fmt: skip


def put(value: Any, *keys: str | int) -> Callable[[dict[str, Any]], None]:
    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value

    return change


def drop(*keys: str | int) -> Callable[[dict[str, Any]], None]:
    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        del data[keys[-1]]

    return change


COURSE = {
    "times": [0.0, 1.0],
    "forces": [ROTATION.start.forces.tolist()] * 2,
    "loads": [[0.0, -3.0, 0.0]] * 2,
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("A", "contact"), "a rotation names the wrong fingers: 'A' and None"),
        (drop("contact"), "contact: a required key is missing"),
        (drop("turn", "end_load"), "turn.end_load: a required key is missing"),
        (put(nan, "turn", "angles", 1), "turn.angles[1]: expected a finite number, got nan"),
        (put([0.0, 4.0], "turn", "angles"), "angles of a turn must go one way from 0 in steps below pi, "
                                            "got [0.0, 4.0]"),
        (put([], "turn", "angles"), "angles of a turn must go one way from 0 in steps below pi, got []"),
        (put("x", "turn", "forces", 0, 1, 0), "turn.forces[0][1][0]: expected a number, got 'x'"),
        (put([1.0], "turn", "end_load"), "a wrench must have 3 (plane) or 6 (space) numbers, got 1"),
        (put(COURSE, "course"), "a plan has a course or a turn, not both"),
        (put([0.0, 1.0, 0.2], "load"), "a part of the load, Wrench(force=(0, 0), torque=0.2), does not turn: "
                                       "middles are needed, states between angles"),
    ],
)  # fmt: skip
def test_damaged_rotation(change: Callable[[dict[str, Any]], None], message: str, tmp_path: Path) -> None:
    check_damaged(ROTATION, change, message, tmp_path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put([], "steps"), "steps: expected at least 1 entries, got []"),
        (put([0.0], "orientations"), f"orientations: expected {len(REGRASP.steps) + 1} angles, one more than "
                                     "the steps, got 1"),
        (drop("margin"), "margin: a required key is missing"),
        (put("wide", "margin"), "margin: expected a number, got 'wide'"),
        (put(3, "step"), "step: unknown key; known here: format, version, kind, steps, orientations, margin, "
                         "rotations"),
        (put([], "rotations"), "rotations: leave them out in the plane"),
        (drop("steps", 1, "record"), "steps[1].record: a required key is missing"),
        (put(1, "steps", 0, "version"), "steps[0].version: unknown key; known here: kind, contact, load, "
                                        "contacts, start, end, scaling, course, record, arrival, leaving, "
                                        "arriving, turn"),
        (put("P9", "steps", 0, "contact"),
         f"steps[0]: no contact 'P9' in this grasp; it has {', '.join(REGRASP.steps[0].grasp.names)}"),
        (put(None, "steps", EXCHANGE, "arrival"), f"steps[{EXCHANGE}]: an exchange names the wrong fingers: "
                                                  f"{REGRASP.steps[EXCHANGE].contact!r} and None"),
    ],
)  # fmt: skip
def test_damaged_regrasp(change: Callable[[dict[str, Any]], None], message: str, tmp_path: Path) -> None:
    check_damaged(REGRASP, change, message, tmp_path)


def damaged(
    plan: rg.Transition | rg.RegraspPlan, change: Callable[[dict[str, Any]], None], path: Path
) -> Path:
    write_plan(plan, path)
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


def check_damaged(
    plan: rg.Transition | rg.RegraspPlan,
    change: Callable[[dict[str, Any]], None],
    message: str,
    tmp_path: Path,
) -> None:
    path = damaged(plan, change, tmp_path / "plan.json")
    with pytest.raises(rg.InvalidInput) as raised:
        read_plan(path)
    assert str(raised.value) == f"{path}: {message}"


def changed_force(data: dict[str, Any]) -> None:
    data["steps"][1]["start"][0][0] += 1e-6


@pytest.mark.parametrize(
    "change", [put(0.1, "orientations", 1), put(-0.2, "orientations", -1), changed_force]
)
def test_readable_regrasp_that_is_wrong_does_not_verify(
    change: Callable[[dict[str, Any]], None], tmp_path: Path
) -> None:
    assert not rg.verify(read_plan(damaged(REGRASP, change, tmp_path / "plan.json"))).ok


def test_a_step_with_more_contacts_than_fingers(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    turned = replace(
        REGRASP, steps=REGRASP.steps[EXCHANGE:-1], orientations=REGRASP.orientations[EXCHANGE:-1]
    )
    more = replace(turned, steps=(ROTATION, *turned.steps), orientations=(0.0, *turned.orientations))
    write_plan(more, path)
    with pytest.raises(rg.InvalidInput, match=r"plan.json: step 2 has more contacts than there are fingers"):
        read_plan(path)


def test_what_is_no_plan_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput) as raised:
        write_plan("plan", tmp_path / "plan.json")  # type: ignore[arg-type]
    assert str(raised.value) == "write_plan writes a Transition, a RegraspPlan or a ChosenGrasp, got 'plan'"
    with pytest.raises(rg.InvalidInput) as raised:
        write_plan(replace(REGRASP, margin=nan), tmp_path / "plan.json")
    assert str(raised.value) == f"{tmp_path / 'plan.json'}: margin: expected a finite number, got nan"
    assert list(tmp_path.iterdir()) == []


# -- set-points -----------------------------------------------------------------------------------------


def table_of(path: Path) -> tuple[list[str], np.ndarray]:
    header, *rows = path.read_text(encoding="utf-8").splitlines()
    return header.split(","), np.array([[float(x) for x in row.split(",")] for row in rows])


def test_setpoints_of_a_rotation_have_its_angle(tmp_path: Path) -> None:
    path = tmp_path / "setpoints.csv"
    write_setpoints(ROTATION, path, 50.0)
    header, table = table_of(path)
    assert header == ["t", "angle", "A_fx", "A_fy", "B_fx", "B_fy"]
    assert (table[0, :2].tolist(), table[-1, 0]) == ([0.0, 0.0], 2.0)
    assert table[-1, 1] == radians(150)
    assert (table[:, 1] == ROTATION.orientation(table[:, 0])).all()
    assert (table[:, 2:] == ROTATION.forces(table[:, 0]).reshape(len(table), -1)).all()
    (rows,) = read_setpoints(path, ROTATION)
    assert (rows.angles == table[:, 1]).all()
    assert (rows.forces == ROTATION.forces(rows.times)).all()
    assert checked(ROTATION, rows).ok
    spoiled = rows.forces.copy()
    spoiled[7, 0, 1] += 1e-6
    verdict = checked(ROTATION, rows._replace(forces=spoiled))
    assert [v.split(":")[0] for v in verdict.violations] == ["set-point 7"]
    assert not checked(ROTATION, rows._replace(angles=rows.angles[::-1])).ok
    assert verify_setpoints(ROTATION, rows.forces).violations == (
        "set-points of an object that turns need its angles",
    )


@pytest.mark.parametrize("plan", [REGRASP, REGRASP.reversed()], ids=["forwards", "backwards"])
def test_setpoints_of_a_regrasp_hold_the_object_by_themselves(plan: rg.RegraspPlan, tmp_path: Path) -> None:
    """Nothing is used but the table, the friction and the weight; normals are those of the ellipse."""
    path = tmp_path / "setpoints.csv"
    write_setpoints(plan, path, 40.0)
    header, table = table_of(path)
    assert header[:7] == ["t", "angle", "step", "F1_x", "F1_y", "F1_fx", "F1_fy"]
    assert header[-1] == "F3_fy"
    assert path.read_text().splitlines()[1].split(",")[2] == "1"
    t, angle, step = table[:, :3].T
    fingers = table[:, 3:].reshape(len(table), 3, 4)
    points, forces = fingers[..., :2], fingers[..., 2:]
    assert (t[0], t[-1]) == (0.0, plan.duration)
    weight = plan.steps[0].start.load.force
    turned = angle - angle[0]
    load = np.stack(
        [np.cos(turned) * weight[0] + np.sin(turned) * weight[1],
         np.cos(turned) * weight[1] - np.sin(turned) * weight[0]], axis=-1
    )  # fmt: skip
    assert abs(forces.sum(axis=1) + load).max() < 1e-11
    torque = points[..., 0] * forces[..., 1] - points[..., 1] * forces[..., 0]
    assert abs(torque.sum(axis=1)).max() < 1e-11
    inward = -points / np.array([4, 1])  # the ellipse's gradient
    inward /= np.linalg.norm(inward, axis=-1, keepdims=True)
    normal = (forces * inward).sum(axis=-1)
    across = abs(inward[..., 0] * forces[..., 1] - inward[..., 1] * forces[..., 0])
    assert (across <= 0.5 * normal + 1e-9).all()
    joints = check_moves(points, forces, step, len(plan.moves))
    assert (np.diff(t)[joints] == 0).all()
    assert (np.diff(t)[~joints] > 0).all()
    assert angle == pytest.approx(
        np.concatenate([np.asarray(plan.orientation(t[step == k + 1])) for k in range(len(plan.steps))]),
        abs=1e-9,
    )


def test_setpoints_of_a_regrasp_are_read_back_and_verify(tmp_path: Path) -> None:
    path = tmp_path / "setpoints.csv"
    write_setpoints(REGRASP, path, 40.0)
    steps = read_setpoints(path, REGRASP)
    assert [rows.step for rows in steps] == list(range(len(REGRASP.steps)))
    for rows, step in zip(steps, REGRASP.steps, strict=True):
        assert rows.forces == pytest.approx(step.forces(rows.times), abs=1e-12)
        assert checked(REGRASP, rows).ok
    assert sum(rows.times.size for rows in setpoint_blocks(REGRASP, 40.0)) == 41 * len(REGRASP.steps)
    spoiled = steps[1].forces * 1.001
    verdict = checked(REGRASP, steps[1]._replace(forces=spoiled))
    assert verdict.violations[0].startswith("step 2: set-point 0: not in equilibrium")


AIR = next((k, f) for k, names in enumerate(REGRASP.fingers) for f, name in enumerate(names) if name is None)


def cell(row: int, column: int, value: str) -> Callable[[list[list[str]]], None]:
    def change(rows: list[list[str]]) -> None:
        rows[row][column] = value

    return change


def without_step(rows: list[list[str]]) -> None:
    rows[:] = [row for row in rows if row[2] != "2"]


POINT = tuple(REGRASP.steps[0].grasp.positions[0].tolist())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (cell(0, 3, "F0_x"), re.compile("expected the columns t,angle,step,F1_x,F1_y,F1_fx,F1_fy,F2_x,.*")),
        (cell(3, 5, "much"), "expected rows of 15 numbers: could not convert string to float: 'much'"),
        (cell(3, 5, "nan"), "expected rows of 15 finite numbers"),
        (cell(3, 0, "0.9"), "times must rise from 0 to 1.0 s"),
        (cell(3, 1, "0.25"), "angles must be the plan's at these times; one is off by 0.25 rad"),
        (cell(3, 2, "2"), f"steps must rise from 1 to {len(REGRASP.steps)}, and each have rows"),
        (cell(3, 2, "1.5"), f"steps must rise from 1 to {len(REGRASP.steps)}, and each have rows"),
        (without_step, f"steps must rise from 1 to {len(REGRASP.steps)}, and each have rows"),
        (cell(3, 4, "0.25"), f"F1 must be at {POINT!r} all through step 1"),
        (cell(1 + 11 * AIR[0], 5 + 4 * AIR[1], "1e-9"),
         f"F{AIR[1] + 1} is in the air in step {AIR[0] + 1} and carries no force"),
    ],
)  # fmt: skip
def test_damaged_setpoints_of_a_regrasp(
    change: Callable[[list[list[str]]], None], message: str | re.Pattern[str], tmp_path: Path
) -> None:
    path = tmp_path / "setpoints.csv"
    write_setpoints(REGRASP, path, 10.0)
    rows = [line.split(",") for line in path.read_text().splitlines()]
    change(rows)
    path.write_text("\n".join(",".join(row) for row in rows))
    with pytest.raises(rg.InvalidInput) as raised:
        read_setpoints(path, REGRASP)
    pattern = message.pattern if isinstance(message, re.Pattern) else re.escape(message)
    assert re.fullmatch(re.escape(f"{path}: ") + pattern, str(raised.value)), str(raised.value)


# -- scenarios ------------------------------------------------------------------------------------------

TURN = (EXAMPLES / "rotation.toml").read_text(encoding="utf-8")
WHOLE = (EXAMPLES / "regrasp.toml").read_text(encoding="utf-8")
PART = 'part = "wrench"'
BOX = "vertices = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]]"


def changed(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert old in text, f"{old!r} is not in the scenario"
        text = text.replace(old, new, 1)
    return text


def rotation(*changes: tuple[str, str]) -> rg.Transition:
    plan = plan_scenario(parse_scenario(changed(TURN, *changes)))
    assert plan.turn is not None
    assert rg.verify(plan).ok
    return plan


def test_rotation_scenario_plans_what_the_same_call_plans() -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([-0.04, 0.0], [1, 0], 0.6, max_force=20, name="thumb"),
            rg.Contact([0.04, 0.02], [-1, 0], 0.6, max_force=20, name="index"),
            rg.Contact([0.04, -0.02], [-1, 0], 0.6, max_force=20, name="middle"),
        ]
    )
    scaling = rg.TimeScaling.minimum_jerk(2.0)
    assert rotation() == rg.plan_rotation(grasp, radians(150), load=WEIGHT, scaling=scaling)


@pytest.mark.parametrize(
    ("line", "seen", "expected"),
    [
        ("degrees = -400.0", lambda p: p.turn.angle, radians(-400)),
        ('objective = "force"', lambda p: p.record.choices[1].objective, "force"),
        ('method = "clarabel"', lambda p: p.record.choices[0].method, "clarabel"),
        ("max_force = 12.5", lambda p: p.grasp.max_forces.tolist(), [12.5] * 3),
        ("reserve = 0.25", lambda p: p.record.reserve, 0.25),
        ("duration = 0.5", lambda p: p.duration, 0.5),
        ('scaling = "linear"', lambda p: p.scaling, rg.TimeScaling.linear(2.0)),
    ],
)
def test_option_of_a_rotation_reaches_the_plan(
    line: str, seen: Callable[[rg.Transition], Any], expected: Any
) -> None:
    key = line.split(" ")[0]
    text = TURN
    if key in ("degrees", "objective", "duration", "scaling"):
        text = re.sub(rf"(?m)^{key} = .*$", "", text)
    plan = plan_scenario(parse_scenario(f"{text}\n{line}\n"))
    assert plan.turn is not None
    assert seen(plan) == expected
    assert rg.verify(plan).ok


def with_forces(plan: rg.Transition, *keys: tuple[str, np.ndarray]) -> str:
    """The scenario of the turn with the forces of a plan, to five decimals."""
    text = TURN
    for i, name in enumerate(plan.grasp.names):
        lines = "\n".join(f"{key} = {np.round(forces[i], 5).tolist()}" for key, forces in keys)
        text = changed(text, (f'name = "{name}"', f'name = "{name}"\n{lines}'))
    return text


def test_given_forces_of_a_rotation_are_used() -> None:
    plan = rotation()
    text = with_forces(plan, ("force", plan.start.forces), ("end_force", plan.end.forces))
    again = plan_scenario(parse_scenario(text))
    assert again.turn is not None
    assert rg.verify(again).ok
    assert again.record.choices == ()
    assert 0 < again.record.balancing < 1e-4
    assert again.start.forces == pytest.approx(plan.start.forces, abs=1e-4)
    assert again.end.forces == pytest.approx(plan.end.forces, abs=1e-4)


def check_bad(text: str, lines: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    status, out, err = regrasp(capsys, "plan", path, "-o", tmp_path / "out")
    assert err == "Error: " + "".join(f"{path}: {line}\n" for line in lines)
    assert (status, out) == (2, "")
    assert not (tmp_path / "out").exists()


ROTATION_KEYS = (
    "objective, method, facets, duration, rate, scaling, control, max_force, peak_ratio, reserve, "
    "balance_tolerance, min_normal, stiffness, degrees, axis, kind"
)


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ([("degrees = 150.0", "degrees = 0.0")],
         ["task.degrees: expected an angle other than 0, there is nothing to turn"]),
        ([("degrees = 150.0", "")], ["task.degrees: a required key is missing"]),
        ([("degrees = 150.0", "degrees = nan\nangle = 2.0")],
         ["task.degrees: expected a finite number, got nan",
          f"task.angle: unknown key; known here: {ROTATION_KEYS}"]),
        ([("degrees = 150.0", 'degrees = 150.0\ncontact = "thumb"')],
         [f"task.contact: unknown key; known here: {ROTATION_KEYS}"]),
        ([("friction = 0.6", "friction = 0.6\nforce = [1.0, 0.0]")],
         ["contacts[1].force: a required key is missing; others have it, so give it to all or none",
          "contacts[2].force: a required key is missing; others have it, so give it to all or none"]),
        ([("[load]", "[[load]]\ntime = 1.0\nforce = [0.0, -3.0]\n\n[[load]]\ntime = 0.0")],
         ["load: times of a load must rise from 0, two or more; got [1.0, 0.0]"]),
        ([("[load]", "[[load]]\ntime = 0.0\nforce = [0.0, -3.0]\n\n[[load]]\ntime = 1.0")],
         ["load: a rotation needs one load, [load], which turns as seen from the object"]),
        ([("duration = 2.0", "duration = -2.0"), ("rate = 500.0", "rate = 0")],
         ["task.duration: expected a number greater than 0, got -2.0",
          "task.rate: expected a number greater than 0, got 0"]),
        ([('scaling = "minimum_jerk"', 'scaling = "linear"\ncontrol = [1.0, 0.0]')],
         ["task: control belongs to scaling 'spline', got scaling 'linear'"]),
    ],
)  # fmt: skip
def test_bad_rotation(
    changes: list[tuple[str, str]], lines: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    check_bad(changed(TURN, *changes), lines, capsys, tmp_path)


def scenario(*changes: tuple[str, str], file: str | Path = "scenario") -> RegraspScenario:
    result = parse_scenario(changed(WHOLE, *changes), file)
    assert isinstance(result, RegraspScenario)
    return result


def test_regrasp_scenario_plans_what_the_same_call_plans() -> None:
    outline = parts.wrench()

    def grasp(*positions: tuple[float, float]) -> rg.Grasp:
        places = [outline.nearest(np.array(p) + outline.centre_of_mass) for p in positions]
        return rg.Grasp(outline.contact_at(s, friction=0.6) for s in places)

    plan = rg.plan_regrasp(
        outline,
        grasp((-0.01, -0.007), (0.02, 0.007), (0.05, -0.007)),
        grasp((-0.04, 0.007), (-0.01, -0.007), (0.02, 0.007)),
        rg.Wrench([0, -2]),
        friction=0.6,
        orientations=24,
        goal_orientation=radians(180),
        max_turn=radians(90),
        min_distance=0.02,
        step_duration=0.5,
    )
    assert plan_scenario(scenario()) == plan


def test_options_of_a_regrasp_reach_the_plan() -> None:
    def planned(*changes: tuple[str, str]) -> rg.RegraspPlan:
        plan = plan_scenario(scenario(*changes))
        assert isinstance(plan, rg.RegraspPlan)
        assert rg.verify(plan).ok
        return plan

    assert planned(("step_duration = 0.5", "")).steps[0].duration == 1.0
    small = planned(("max_turn_degrees = 90.0", "max_turn_degrees = 30.0"))
    assert max(abs(np.diff(small.orientations))) < radians(30.1)
    straight = planned(("orientations = 24", "orientations = 1"), ("goal_degrees = 180.0", ""))
    assert set(straight.orientations) == {0.0}
    limited = planned(('objective = "angle"', 'objective = "force"\nmax_force = 6.0\nreserve = 0.1'))
    assert {step.record.reserve for step in limited.steps} == {0.1}
    assert limited.steps[1].record.choices[0].objective == "force"
    assert limited.steps[1].grasp.max_forces.tolist() == [6.0] * 3
    few = planned(("candidates = 120", "candidates = 40"))
    assert few.margin <= planned(("candidates = 120", "candidates = 200")).margin + 0.05


@pytest.mark.parametrize(
    ("entry", "outline"),
    [
        (BOX, rg.Outline([[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]])),
        (f"{BOX}\nholes = [[[0.02, 0.02], [0.04, 0.02], [0.03, 0.04]]]",
         rg.Outline([[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]], [[[0.02, 0.02], [0.04, 0.02], [0.03, 0.04]]])),
        ("points = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]]",
         rg.Outline.smooth([[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]])),
        ("ellipse = [0.2, 0.1]", rg.Outline.ellipse(0.2, 0.1)),
        ('part = "cam"', parts.cam()),
    ],
)  # fmt: skip
def test_outline_in_a_scenario(entry: str, outline: rg.Outline) -> None:
    text = re.sub(r"(?s)\[start\].*?\[task\]", "[task]", WHOLE)
    text += "\n[start]\narc_lengths = [0.01, 0.05, 0.08]\n[goal]\narc_lengths = [0.02, 0.06, 0.095]\n"
    read = parse_scenario(changed(text, (PART, entry)))
    assert isinstance(read, RegraspScenario)
    assert read.outline.value == outline
    assert read.start_grasp == rg.Grasp(outline.contact_at(s, friction=0.6) for s in (0.01, 0.05, 0.08))
    assert read == parse_scenario(changed(text, (PART, entry)))


def test_outline_from_a_file_beside_the_scenario(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "box.csv").write_text("0,0\n200,0\n200,50\n0,50\n")
    text = changed(WHOLE, (PART, 'file = "box.csv"\nscale = 0.001'), ("-0.007", "-0.025"), ("0.007", "0.025"))
    (tmp_path / "here" / "scenario.toml").write_text(text)
    for folder, name in ((tmp_path, "here/scenario.toml"), (tmp_path / "here", "scenario.toml")):
        monkeypatch.chdir(folder)
        read = read_scenario(name)
        assert isinstance(read, RegraspScenario)
        assert read.outline.value == rg.Outline([[0, 0], [0.2, 0], [0.2, 0.05], [0, 0.05]])


def test_parts_of_scenarios_are_the_parts_there_are() -> None:
    known = RegraspScenario.model_json_schema()["$defs"]["OutlineEntry"]["properties"]["part"]["anyOf"][0]
    assert known["enum"] == list(parts.PARTS)


START_POINT = "[-0.01, -0.007]"
TASK_KEYS = (
    "kind, objective, states, least_margin_degrees, min_distance, min_normal, stiffness, early_loss, "
    "limits, weights, max_force, peak_ratio, reserve, step_duration, rate, orientations, "
    "goal_degrees, candidates, "
    "max_turn_degrees, one_finger, arcs"
)


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ([(PART, "")], ["outline: expected exactly one of vertices, points, ellipse, part, file, "
                        "found none of them"]),
        ([(PART, f"{PART}\n{BOX}")], ["outline: expected exactly one of vertices, points, ellipse, part, "
                                      "file, found vertices, part"]),
        ([(PART, f"{PART}\nscale = 2.0\nholes = [[[0, 0], [1, 0], [1, 1]]]")],
         ["outline: holes go with vertices, points or ellipse; a part has its own",
          "outline: scale goes with file, found part"]),
        ([(PART, 'part = "spoon"')],
         ["outline.part: expected 'wrench', 'cam', 'gear', 'bracket', 'bottle' or 'puzzle_piece', "
          "got 'spoon'"]),
        ([(PART, "ellipse = [0.2, -0.1, 0.3]")],
         ["outline.ellipse: expected at most 2 entries, got [0.2, -0.1, 0.3]"]),
        ([(PART, "ellipse = [0.2, -0.1]")],
         ["outline.ellipse[1]: expected a number greater than 0, got -0.1"]),
        ([(PART, "vertices = [[0, 0], [1, 1], [1, 0], [0, 1]]")],
         ["outline: outline crosses or touches itself near (0.5, 0.5); it must be a simple closed curve"]),
        ([("friction = 0.6", "")], ["friction: a required key is missing"]),
        ([("friction = 0.6", "friction = -1.0\ncontacts = []"), ("force = [0.0, -2.0]", "torque = 1.0")],
         ["friction: expected a number of at least 0, got -1.0",
          "load.force: a required key is missing",
          "load.torque: unknown key; known here: force, disturbance",
          "contacts: unknown key; known here: title, friction, load, outline, start, goal, motions, task"]),
        ([("[load]", "[[load]]\ntime = 0.0")],
         ["load: expected a table, got [{'time': 0.0, 'force': [0.0, -2.0]}]"]),
        ([("[start] ", "[start]\narc_lengths = [0.0, 0.1, 0.2]\n")],
         ["start: expected either arc_lengths or positions, found both"]),
        ([(START_POINT + ",", "")],
         ["start.positions: expected at least 3 entries, got [[0.02, 0.007], [0.05, -0.007]]"]),
        ([(START_POINT, "[-10.0, -7.0]"), ("[-0.04, 0.007]", "[40.0, 7.0]")],
         ["start.positions[0]: (-10, -7) is 12.1 m from the outline; positions are relative to its centre of "
          "mass, in metres",
          "goal.positions[0]: (40, 7) is 40.5 m from the outline; positions are relative to its centre of "
          "mass, in metres"]),
        ([(PART, BOX.replace("0.1]", "0.01]")), (START_POINT, "[0.02, 0.006]")],
         ["start: contacts 'P1' and 'P2' coincide at [0.01999999999999999, 0.004999999999999999]; "
          "place them at different points"]),
        ([(PART, BOX.replace("0.1]", "0.01]")), (START_POINT, "[-0.1, -0.005]")],
         ["start.positions[0]: arc length 0 is at a corner, where no normal is defined"]),
        ([("goal_degrees = 180.0", "goal_degrees = 50.0")],
         ["task: goal_degrees must be a multiple of 360 / orientations = 15, got 50"]),
        ([("orientations = 24", "orientations = 0\nangles = 3"), ("max_turn_degrees = 90.0",
                                                                    "max_turn_degrees = 180"),
          ("min_distance = 0.02", "min_distance = -1"), ("candidates = 120", "candidates = 1.5")],
         ["task.min_distance: expected a number of at least 0, got -1",
          "task.orientations: expected a number of at least 1, got 0",
          "task.candidates: Input should be a valid integer, got 1.5",
          "task.max_turn_degrees: expected a number less than 180, got 180",
          f"task.angles: unknown key; known here: {TASK_KEYS}"]),
    ],
)  # fmt: skip
def test_bad_regrasp(
    changes: list[tuple[str, str]], lines: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    check_bad(changed(WHOLE, *changes), lines, capsys, tmp_path)


def test_outline_file_that_is_not_there(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    missing = tmp_path / "part.svg"
    line = f"outline: {missing}: expected a file with an outline, found none"
    check_bad(changed(WHOLE, (PART, 'file = "part.svg"')), [line], capsys, tmp_path)


def test_regrasp_that_cannot_be(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "slippery.toml"
    path.write_text(
        changed(
            WHOLE,
            ("friction = 0.6", "friction = 0.001"),
            ("[0.0, -2.0]", "[-2.0, 0.0]"),
            ("orientations = 24", "orientations = 1"),
            ("goal_degrees = 180.0", "goal_degrees = 0.0"),
        )
    )
    status, out, err = regrasp(capsys, "plan", path, "-o", tmp_path / "out")
    assert (status, out) == (3, "")
    assert err == (
        f"Error: {path}: no two fingers of the start hold the load at 0 deg, "
        "so none of its fingers can leave or arrive; there would be one with friction 2.21 instead of 0.001\n"
    )


# -- end to end -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["rotation", "regrasp"])
def test_examples_from_file_to_files(name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    status, out, err = regrasp(capsys, "plan", EXAMPLES / f"{name}.toml", "-o", tmp_path / "out")
    assert (status, err) == (0, "")
    plan = read_plan(tmp_path / "out" / "plan.json")
    assert plan == plan_scenario(read_scenario(EXAMPLES / f"{name}.toml"))
    assert str(plan) in out
    pictures = sorted(path.stem for path in (tmp_path / "out").glob("*.png"))
    if isinstance(plan, rg.RegraspPlan):
        assert pictures == ["overview", *(f"step_{k}" for k in range(1, len(plan.steps) + 1))]
    else:
        assert {"overview", "object", "load"} <= set(pictures)
    status, out, err = regrasp(capsys, "verify", tmp_path / "out")
    assert (status, err) == (0, "")
    assert "set-points in" in out
    table = tmp_path / "out" / "setpoints.csv"
    *lines, last = table.read_text().splitlines()
    cells = last.split(",")
    cells[-1] = repr(float(cells[-1]) + 1e-3)
    table.write_text("\n".join([*lines, ",".join(cells)]))
    status, _, err = regrasp(capsys, "verify", tmp_path / "out")
    assert status == 1
    assert "not in equilibrium" in err


def test_states_together_and_a_least_margin_reach_the_planner() -> None:
    kind = 'kind = "regrasp"'
    joint = plan_scenario(scenario((kind, f'{kind}\nstates = "joint"')))
    assert joint.steps[1].record.choices[0].objective == "joint force"
    with pytest.raises(rg.Infeasible, match=r"keeps angle margins of 1\.396 rad"):
        plan_scenario(scenario((kind, f"{kind}\nleast_margin_degrees = 80.0")))


def test_arcs_weights_and_single_fingers_reach_the_planner() -> None:
    kind = 'kind = "regrasp"'
    lazy = plan_scenario(scenario((kind, f"{kind}\nweights = {{ moves = 0.0, turning = 1.0 }}")))
    usual = plan_scenario(scenario())
    assert abs(np.diff(lazy.orientations)).sum() <= abs(np.diff(usual.orientations)).sum() + 1e-9
    assert abs(np.diff(lazy.orientations)).sum() == pytest.approx(np.pi)  # as far as it must turn
    with pytest.raises(rg.InvalidInput, match="is not on the arc of finger 2"):
        plan_scenario(scenario((kind, f"{kind}\narcs = [[], [[0.0, 1e-4]], []]")))
    free = plan_scenario(scenario((kind, f"{kind}\narcs = [[], [], []]\none_finger = false")))
    assert (len(free.moves), free.margin) == (len(usual.moves), pytest.approx(usual.margin, abs=1e-6))
    assert scenario((kind, f"{kind}\none_finger = true")).task.one_finger


def test_bad_weights_and_arcs(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    kind = 'kind = "regrasp"'
    changes = [(kind, f"{kind}\nweights = {{ moves = 0.0 }}\narcs = [[], []]")]
    lines = [
        "task.weights: at least one must be greater than 0",
        "task.arcs: expected at least 3 entries, got [[], []]",
    ]
    check_bad(changed(WHOLE, *changes), lines, capsys, tmp_path)
