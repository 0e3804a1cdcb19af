"""Set-points of turns and of whole regrasps hold the object by themselves."""

import re
from collections.abc import Callable
from math import radians
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from regrasp.files import (
    write_setpoints,
)
from regrasp.files.plans.setpoints import checked, read_setpoints, setpoint_blocks
from regrasp.verification import verify_setpoints
from regrasp_moves import check_moves
from spoiling import table_of
from written_regrasps import REGRASP, ROTATION

pytestmark = pytest.mark.contract


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
