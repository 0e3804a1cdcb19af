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
from regrasp.files import read_plan, write_plan, write_setpoints
from regrasp.files.setpoints import checked, read_setpoints, setpoint_blocks
from regrasp.verification import verify_setpoints

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


REGRASP = rg.plan_regrasp(
    ELLIPSE,
    fingers_at(0.02, 0.35, 0.7),
    fingers_at(0.2, 0.5, 0.85),
    WEIGHT,
    friction=0.5,
    orientations=24,
    goal_orientation=radians(90),
    max_turn=radians(15),
)


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
    "plan", [ROTATION, ROTATION.reversed(), *REGRASP.steps], ids=lambda plan: plan._kind_in_words()
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


@given(angle=st.floats(-7, 7).filter(lambda angle: abs(angle) > 1e-6), weight=st.floats(1e-3, 1e3))
def test_any_rotation_is_read_back(
    angle: float, weight: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "any-rotation.json"
    plan = rg.plan_rotation(JAR, angle, load=rg.Wrench([0.1, -weight]))
    write_plan(plan, path)
    back = read_plan(path)
    assert isinstance(back, rg.TurningTransition)
    assert back == plan
    assert same_bits(plan, back)


def test_regrasp_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    assert {step.kind for step in REGRASP.steps} >= {"removal", "exchange", "rotation", "addition"}
    assert any(isinstance(step, rg.TurningTransition) and step.arrival for step in REGRASP.steps)
    for plan in (REGRASP, REGRASP.reversed()):
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
        (put([0.0, 1.0, 0.2], "load"), "a turning path holds a force through the centre of mass; this load "
                                       "has a torque: plan it with a load function of time"),
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
        (put(3, "step"), "step: unknown key; known here: format, version, kind, steps, orientations, margin"),
        (drop("steps", 1, "record"), "steps[1].record: a required key is missing"),
        (put(1, "steps", 0, "version"), "steps[0].version: unknown key; known here: kind, contact, load, "
                                        "contacts, start, end, scaling, course, record, arrival, turn"),
        (put("P9", "steps", 0, "contact"),
         f"steps[0]: no contact 'P9' in this grasp; it has {', '.join(REGRASP.steps[0].grasp.names)}"),
        (put(None, "steps", 1, "arrival"), f"steps[1]: a exchange names the wrong fingers: "
                                           f"{REGRASP.steps[1].contact!r} and None"),
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
    turned = replace(REGRASP, steps=REGRASP.steps[1:-1], orientations=REGRASP.orientations[1:-1])
    more = replace(turned, steps=(ROTATION, *turned.steps), orientations=(0.0, *turned.orientations))
    write_plan(more, path)
    with pytest.raises(rg.InvalidInput, match=r"plan.json: step 2 has more contacts than there are fingers"):
        read_plan(path)


def test_what_is_no_plan_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput) as raised:
        write_plan("plan", tmp_path / "plan.json")  # type: ignore[arg-type]
    assert str(raised.value) == "write_plan writes a Transition or a RegraspPlan, got 'plan'"
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
    moved = (np.diff(points, axis=0) != 0).any(axis=-1)
    joints = np.diff(step) == 1
    assert not moved[~joints].any()  # a finger moves between two steps only,
    assert (moved.sum(axis=1) <= 1).all()  # one at a time,
    assert moved.sum() == len(plan.moves)
    for row, finger in np.argwhere(moved):  # without force
        assert not forces[row, finger].any()
        assert not forces[row + 1, finger].any()
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
