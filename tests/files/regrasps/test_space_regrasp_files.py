"""Regrasps in space in plan files, bit for bit, and set-points with quaternions."""

from collections.abc import Callable
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from places import EXAMPLES
from regrasp.files import (
    plan_scenario,
    read_plan,
    read_scenario,
    write_plan,
    write_setpoints,
)
from regrasp.files.plans.setpoints import checked, read_setpoints, setpoint_blocks
from regrasp.mechanics.orientation.quaternion import about, conjugate, product, quaternion
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.plans.regrasp_plan import RegraspPlan, accumulated
from regrasp_moves import check_moves
from space import random_rotation
from spoiling import damaged, put, table_of

pytestmark = pytest.mark.contract

EXAMPLE = EXAMPLES / "space-regrasp.toml"
SCENARIO = read_scenario(EXAMPLE)


@pytest.fixture(scope="module")
def plan() -> RegraspPlan:
    planned = plan_scenario(SCENARIO)
    assert planned.rotations is not None
    return planned


def matrix_of(q: np.ndarray) -> np.ndarray:
    """The rotation matrix of a unit quaternion, from its definition q v q*."""
    basis = np.column_stack([np.zeros(3), np.eye(3)])
    return product(product(np.tile(q, (3, 1)), basis), np.tile(conjugate(q), (3, 1)))[:, 1:].T


@given(seed=st.integers(0, 10**6), angle=st.floats(-7, 7))
def test_quaternions_are_rotations(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    a, b = random_rotation(rng), random_rotation(rng)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    half_turn = rotation_matrix(axis, pi) @ a @ a.T  # w = 0: the sign of the rest is free
    for matrix in (a, b, half_turn, np.eye(3)):
        q = quaternion(matrix)
        assert q @ q == pytest.approx(1, abs=1e-14)
        assert q[0] >= 0
        assert matrix_of(q) == pytest.approx(matrix, abs=1e-14)
    assert matrix_of(product(quaternion(a), quaternion(b))) == pytest.approx(a @ b, abs=1e-14)
    assert matrix_of(about(axis, angle)) == pytest.approx(rotation_matrix(axis, angle), abs=1e-14)
    assert product(about(axis, angle), conjugate(about(axis, angle))) == pytest.approx(
        [1, 0, 0, 0], abs=1e-15
    )


@pytest.mark.parametrize("backwards", [False, True])
def test_a_regrasp_in_space_is_read_back_bit_for_bit(
    plan: RegraspPlan, backwards: bool, tmp_path: Path
) -> None:
    whole = plan.reversed() if backwards else plan
    write_plan(whole, tmp_path / "plan.json")
    back = read_plan(tmp_path / "plan.json")
    assert back.rotations is not None
    assert back == whole
    assert back.rotations.tobytes() == whole.rotations.tobytes()
    assert not back.rotations.flags.writeable
    for ours, theirs in zip(whole.steps, back.steps, strict=True):
        assert theirs == ours
        assert theirs.end.forces.tobytes() == ours.end.forces.tobytes()
    assert str(back) == str(whole)
    assert rg.verify(back) == rg.verify(whole)
    assert rg.verify(back).ok
    first = (tmp_path / "plan.json").read_bytes()
    write_plan(back, tmp_path / "plan.json")
    assert (tmp_path / "plan.json").read_bytes() == first


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put(None, "rotations"), "rotations: a required key is missing, for the steps are in space"),
        (lambda data: data.pop("rotations"), "rotations: a required key is missing, for the steps are in "
                                             "space"),
        (put(3.0, "rotations", 0), "rotations[0]: expected a list, got 3.0"),
        (put("x", "rotations", 0, 1, 2), "rotations[0][1][2]: expected a number, got 'x'"),
        (lambda data: data["rotations"].pop(), "rotations must have shape (7, 3, 3), got (6, 3, 3): [[["),
        (lambda data: data["rotations"][0].pop(), "rotations must be numbers of shape (7, 3, 3), got [[["),
        (put([0.0], "orientations"), "orientations: expected 7 angles, one more than the steps, got 1"),
    ],
)  # fmt: skip
def test_damaged_plans(
    plan: RegraspPlan, change: Callable[[dict[str, Any]], None], message: str, tmp_path: Path
) -> None:
    path = damaged(plan, change, tmp_path / "plan.json")
    with pytest.raises(rg.InvalidInput) as raised:
        read_plan(path)
    assert str(raised.value).startswith(f"{path}: {message}")


def turned_more(data: dict[str, Any]) -> None:
    data["rotations"][3] = (np.array(data["rotations"][3]) @ rotation_matrix([0, 0, 1], 1e-6)).tolist()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (put(1.001, "rotations", 2, 0, 0), "rotation 3 is not orthonormal"),
        (turned_more, "step 3: its turn does not lead to the next rotation"),
    ],
)
def test_readable_plans_that_are_wrong_do_not_verify(
    plan: RegraspPlan, change: Callable[[dict[str, Any]], None], words: str, tmp_path: Path
) -> None:
    read = read_plan(damaged(plan, change, tmp_path / "plan.json"))
    assert words in "; ".join(rg.verify(read).violations)


@pytest.mark.parametrize("backwards", [False, True])
def test_setpoints_hold_the_object_by_themselves(plan: RegraspPlan, backwards: bool, tmp_path: Path) -> None:
    """Nothing is used but the table, the mesh, the friction and the weight."""
    whole, path = plan.reversed() if backwards else plan, tmp_path / "setpoints.csv"
    write_setpoints(whole, path, 40.0)
    header, table = table_of(path)
    assert header[:9] == ["t", "qw", "qx", "qy", "qz", "step", "F1_x", "F1_y", "F1_z"]
    assert header[-3:] == ["F4_fx", "F4_fy", "F4_fz"]
    assert path.read_text().splitlines()[1].split(",")[5] == "1"
    t, q, step = table[:, 0], table[:, 1:5], table[:, 5]
    fingers = table[:, 6:].reshape(len(table), 4, 6)
    points, forces = fingers[..., :3], fingers[..., 3:]
    assert (t[0], t[-1]) == (0.0, whole.duration)
    assert np.linalg.norm(q, axis=1) == pytest.approx(np.ones(len(q)), abs=1e-14)
    assert q[0] == pytest.approx([1, 0, 0, 0], abs=1e-14)
    assert (q[1:] * q[:-1]).sum(axis=1).min() > 0.99  # neither orientation nor sign jumps
    rotations = np.array([matrix_of(row) for row in q])
    weight = whole.steps[0].start.load.force
    load = np.einsum("mji,j->mi", rotations, weight)  # in the world it stays
    assert abs(forces.sum(axis=1) + load).max() < 1e-11
    assert abs(np.cross(points, forces).sum(axis=1)).max() < 1e-12
    mesh = SCENARIO.object.value
    inward = mesh.normals(points + mesh.centre_of_mass)
    normal = (forces * inward).sum(axis=-1)
    across = np.linalg.norm(forces - normal[..., None] * inward, axis=-1)
    assert (across <= 0.6 * normal + 1e-9).all()
    check_moves(points, forces, step, len(whole.moves))
    last = rotation_matrix([0, -1, 0], pi / 2)
    assert rotations[-1] == pytest.approx(last.T if backwards else last, abs=1e-12)


def test_setpoints_are_read_back_and_verify(plan: RegraspPlan, tmp_path: Path) -> None:
    path = tmp_path / "setpoints.csv"
    write_setpoints(plan, path, 40.0)
    steps = read_setpoints(path, plan)
    assert sum(rows.times.size for rows in setpoint_blocks(plan, 40.0)) == 41 * len(plan.steps)
    turning = 0
    for k, (rows, step) in enumerate(zip(steps, plan.steps, strict=True)):
        assert rows.step == k
        assert rows.forces == pytest.approx(step.forces(rows.times), abs=1e-12)
        assert rows.angles == pytest.approx(step.orientation(rows.times), abs=1e-14)
        assert checked(plan, rows).ok
        assert not checked(plan, rows._replace(forces=1.001 * rows.forces)).ok
        if step.turn is not None:
            turning += 1
            off = rows.angles + 1e-4
            assert not checked(plan, rows._replace(angles=off)).ok  # about the load, too
    assert turning == 6


BALL = rg.choose_state(
    rg.Grasp(
        rg.Contact(p, [-x for x in p], 0.7)
        for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
    ),
    rg.Wrench([0, 0, -1.0]),
    "force",
)


def whole_of(*steps: rg.Transition) -> RegraspPlan:
    turned, rotations = accumulated(list(steps))
    plan = RegraspPlan(steps, turned, 0.0, rotations=rotations)
    assert rg.verify(plan).ok
    return plan


def test_a_finger_in_the_air_stays_without_force(tmp_path: Path) -> None:
    removal = rg.plan_removal(BALL, "P4")
    plan = whole_of(removal, rg.plan_rotation(removal.end.without("P4"), 0.3, axis=[1, 0, 0]))
    path = tmp_path / "setpoints.csv"
    write_setpoints(plan, path, 10.0)
    header, table = table_of(path)
    air = table[table[:, 5] == 2][:, header.index("F4_x") :]
    assert (air == [0, 0.1, 1, 0, 0, 0]).all()
    _, second = read_setpoints(path, plan)
    assert second.forces.shape == (11, 3, 3)
    assert checked(plan, second).ok
    rows = [line.split(",") for line in path.read_text().splitlines()]
    rows[15][header.index("F4_fy")] = "1e-9"
    path.write_text("\n".join(",".join(row) for row in rows))
    with pytest.raises(rg.InvalidInput, match="F4 is in the air in step 2 and carries no force"):
        read_setpoints(path, plan)


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
def test_turns_of_any_size_are_read_back(tmp_path: Path) -> None:
    """A whole turn changes the quaternion's sign, and the next step goes on from there."""
    first = rg.plan_rotation(BALL, 7.0, axis=[1, 2, -0.5])
    plan = whole_of(first, rg.plan_rotation(first.end, -2.0, axis=[0, 1, 1]))
    write_setpoints(plan, tmp_path / "setpoints.csv", 50.0)
    _, table = table_of(tmp_path / "setpoints.csv")
    assert (table[1:, 1:5] * table[:-1, 1:5]).sum(axis=1).min() > 0.9
    assert table[:, 1].min() < -0.9
    for rows, step in zip(read_setpoints(tmp_path / "setpoints.csv", plan), plan.steps, strict=True):
        assert rows.angles == pytest.approx(step.orientation(rows.times), abs=1e-13)
        assert checked(plan, rows).ok


@pytest.mark.parametrize(
    ("row", "column", "value", "message"),
    [
        (0, 1, "angle", "expected the columns t,qw,qx,qy,qz,step,F1_x,F1_y,F1_z,F1_fx,F1_fy,F1_fz,F2_x"),
        (3, 2, "0.25", "quaternions must be the plan's at these times; one is off by 0.2"),
        (3, 5, "2", "steps must rise from 1 to 6, and each have rows"),
        (3, 0, "0.9", "times must rise from 0 to 1.0 s"),
        (3, 8, "0.5", "F1 must be at (0.019999999999999997, 0.020000000000000007, -0.0105) all through step "
                      "1"),
    ],
)  # fmt: skip
def test_damaged_setpoints(
    plan: RegraspPlan, row: int, column: int, value: str, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "setpoints.csv"
    write_setpoints(plan, path, 10.0)
    rows = [line.split(",") for line in path.read_text().splitlines()]
    rows[row][column] = value
    path.write_text("\n".join(",".join(row) for row in rows))
    with pytest.raises(rg.InvalidInput) as raised:
        read_setpoints(path, plan)
    assert str(raised.value).startswith(f"{path}: {message}")


def test_a_regrasp_that_is_not_finite_is_not_written(plan: RegraspPlan, tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match="margin: expected a finite number, got nan"):
        write_plan(replace(plan, margin=float("nan")), tmp_path / "plan.json")
    assert not list(tmp_path.iterdir())
