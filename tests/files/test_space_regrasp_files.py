"""Regrasps in space in files: scenarios, plans bit for bit, set-points with quaternions; soft fingers."""

import json
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
from places import ROOT
from regrasp.files import (
    SpaceRegraspScenario,
    parse_scenario,
    plan_scenario,
    read_plan,
    read_scenario,
    scenario_schema,
    write_plan,
    write_setpoints,
)
from regrasp.files.plans.setpoints import checked, read_setpoints, setpoint_blocks
from regrasp.mechanics.orientation.quaternion import about, conjugate, product, quaternion
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.plans.regrasp_plan import RegraspPlan, accumulated
from regrasp_moves import check_moves
from scenarios import regrasp
from space import random_rotation

pytestmark = pytest.mark.contract

EXAMPLES = ROOT / "examples"
EXAMPLE = EXAMPLES / "space-regrasp.toml"
TEXT = EXAMPLE.read_text(encoding="utf-8")
SCENARIO = read_scenario(EXAMPLE)


@pytest.fixture(scope="module")
def plan() -> RegraspPlan:
    planned = plan_scenario(SCENARIO)
    assert planned.rotations is not None
    return planned


# -- quaternions ----------------------------------------------------------------------------------------


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


# -- plan files -----------------------------------------------------------------------------------------


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


def put(value: Any, *keys: str | int) -> Callable[[dict[str, Any]], None]:
    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value

    return change


def damaged(plan: rg.RegraspPlan, change: Callable[[dict[str, Any]], None], path: Path) -> Path:
    write_plan(plan, path)
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


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


# -- set-points -----------------------------------------------------------------------------------------


def table_of(path: Path) -> tuple[list[str], np.ndarray]:
    header, *rows = path.read_text(encoding="utf-8").splitlines()
    return header.split(","), np.array([[float(x) for x in row.split(",")] for row in rows])


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
            assert checked(plan, rows._replace(angles=off)).ok == (step.kind == "rotation")  # about the load
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


# -- scenarios ------------------------------------------------------------------------------------------


def changed(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert old in text, f"{old!r} is not in the scenario"
        text = text.replace(old, new, 1)
    return text


def test_the_example_plans_what_the_same_call_plans(plan: RegraspPlan) -> None:
    assert isinstance(SCENARIO, SpaceRegraspScenario)
    mesh = SCENARIO.object.value

    def grasp(positions: list[list[float]]) -> rg.Grasp:
        places = np.array(positions) + mesh.centre_of_mass
        return rg.Grasp(mesh.contact_at(place, friction=0.6) for place in places)

    same = rg.plan_regrasp(
        mesh,
        grasp(SCENARIO.start.positions),
        grasp(SCENARIO.goal.positions),
        rg.Wrench([0, 0, -1.82]),
        friction=0.6,
        goal_rotation=rotation_matrix([0, -1, 0], pi / 2),
        candidates=30,
        min_distance=0.01,
    )
    assert plan == same
    assert rg.verify(plan).ok
    assert np.degrees(plan.margin) > 10
    assert sum(step.turn is not None for step in plan.steps) == 6


def test_every_key_arrives(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    calls: list[dict[str, Any]] = []
    monkeypatch.setattr(
        "regrasp.files.scenarios.planned.plan_regrasp", lambda *args, **options: calls.append(options)
    )
    SCENARIO.object.value.save_stl(tmp_path / "part.stl")
    text = changed(
        TEXT,
        ('part = "bracket"', 'mesh = "part.stl"\nscale = 2.0\n#'),
        (
            "orientations = 42",
            "orientations = 17\nseed = 3\nfacets = 12\nstates = 'joint'",
        ),
        ('kind = "regrasp"', 'kind = "regrasp"\nmax_force = 9.0\nstiffness = 800.0\nearly_loss = true'),
        ("candidates = 30", "candidates = 21\nleast_margin_degrees = 2.0\npeak_ratio = 2.5\nreserve = 0.1"),
        ("max_turn_degrees = 90.0", "max_turn_degrees = 45.0"),
        ('objective = "angle"', 'objective = "effort"'),
        ("step_duration = 1.0", "step_duration = 0.5"),
        ("min_distance = 0.01", "min_distance = 0.02"),
    )
    near = [("0.02, 0.02, -0.0105", "0.04, 0.04, -0.021"), ("-0.0156, 0.02, 0.015", "-0.0312, 0.04, 0.03")]
    near += [
        ("-0.005, -0.02, -0.0105", "-0.01, -0.04, -0.021"),
        ("-0.0156, -0.02, 0.02", "-0.0312, -0.04, 0.04"),
    ]
    near += [
        ("0.024, 0.014, -0.0135", "0.048, 0.028, -0.027"),
        ("0.024, -0.014, -0.0135", "0.048, -0.028, -0.027"),
    ]
    near += [("0.036, 0.0, -0.0075", "0.072, 0.0, -0.015"), ("0.028, 0.0, -0.0075", "0.056, 0.0, -0.015")]
    scenario = parse_scenario(changed(text, *near), tmp_path / "scenario.toml")
    assert scenario.object.value.size == pytest.approx(2 * SCENARIO.object.value.size, rel=1e-6)
    plan_scenario(scenario)
    (options,) = calls
    assert options.pop("goal_rotation") == pytest.approx(rotation_matrix([0, -1, 0], pi / 2))
    assert options.pop("max_turn") == pytest.approx(pi / 4)
    assert options.pop("least_margin") == pytest.approx(np.radians(2))
    assert options == {
        "friction": 0.6, "orientations": 17, "candidates": 21, "objective": "effort", "states": "joint",
        "stiffness": 800.0, "early_loss": True, "disturbance": None, "limits": None,
        "min_distance": 0.02, "max_force": 9.0, "peak_ratio": 2.5, "reserve": 0.1, "step_duration": 0.5,
        "facets": 12, "seed": 3, "min_normal": None, "weights": None,
    }  # fmt: skip
    still = changed(TEXT, ("goal_axis", "# goal_axis"), ("goal_degrees", "# goal_degrees"))
    plan_scenario(parse_scenario(still))
    assert (calls[1]["goal_rotation"] == np.eye(3)).all()


GOAL = "goal_axis = [0.0, -1.0, 0.0]"
TASK_KEYS = (
    "kind, objective, states, least_margin_degrees, min_distance, min_normal, stiffness, early_loss, "
    "limits, weights, max_force, peak_ratio, reserve, step_duration, rate, orientations, "
    "goal_degrees, goal_axis, candidates, "
    "seed, max_turn_degrees, facets"
)


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ([('part = "bracket"', "")], ["object: expected either mesh or part, found neither"]),
        ([('part = "bracket"', 'part = "spoon"')],
         ["object.part: expected 'bracket', 'wrench', 'cam', 'nut' or 'bottle', got 'spoon'"]),
        ([("[load]", "[outline]\npart = 'wrench'\n[load]")],
         ["outline: unknown key; known here: title, friction, load, object, start, goal, motions, task"]),
        ([("friction = 0.6", "")], ["friction: a required key is missing"]),
        ([("[0.0, 0.0, -1.82]", "[0.0, -1.82]")],
         ["load.force: expected at least 3 entries, got [0.0, -1.82]"]),
        ([("[0.0, 0.0, -1.82]", "[0.0, 0.0, 0.0]")],
         ["load.force: expected a force other than zero, which says what the fingers hold"]),
        ([("    [0.02, 0.02, -0.0105],\n", "")],
         ["start.positions: expected at least 4 entries, got [[-0.0156, 0.02, 0.015], "
          "[-0.005, -0.02, -0.0105], [-0.01..."]),
        ([("[0.02, 0.02, -0.0105]", "[0.02, 0.02]")],
         ["start.positions[0]: expected at least 3 entries, got [0.02, 0.02]"]),
        ([("[0.02, 0.02, -0.0105]", "[-0.0156, 0.02, 0.015]")],
         ["start.positions: contacts 'P1' and 'P2' coincide at [-0.0156, 0.020000000000000007, 0.015]; place "
          "them at different points"]),
        ([("goal_degrees = 90.0", "")],
         ["task: goal_degrees: expected the turn about goal_axis, an angle other than 0"]),
        ([(GOAL, "")],
         ["task: goal_axis: needed for a turn by goal_degrees = 90; give three numbers"]),
        ([(GOAL, "goal_axis = [0.0, 0.0, 0.0]")],
         ["task: goal_axis must not be zero; give the direction about which the object turns"]),
        ([("orientations = 42", "orientations = 1")],
         ["task.orientations: 1 forbids turning the load, but goal_axis and goal_degrees do; give more"]),
        ([("orientations = 42", "orientations = 0\nfacets = 7\narcs = []"), ("candidates = 30", "seed = -1"),
          ("max_turn_degrees = 90.0", "max_turn_degrees = 180"),
          ("min_distance = 0.01", "min_distance = -1")],
         ["task.min_distance: expected a number of at least 0, got -1",
          "task.orientations: expected a number of at least 1, got 0",
          "task.seed: expected a number of at least 0, got -1",
          "task.max_turn_degrees: expected a number less than 180, got 180",
          "task.facets: expected a multiple of 2, got 7",
          f"task.arcs: unknown key; known here: {TASK_KEYS}"]),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_scenario(
    changes: list[tuple[str, str]], lines: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(changed(TEXT, *changes), encoding="utf-8")
    status, out, err = regrasp(capsys, "plan", path, "-o", tmp_path / "out")
    assert err == "Error: " + "".join(f"{path}: {line}\n" for line in lines)
    assert (status, out) == (2, "")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("position", "words"),
    [
        (
            "[20.0, 20.0, -10.5]",
            r"start.positions\[0\], from the centre of mass: point .* is 30.* away from the",
        ),
        ("[0.0414, 0.02, -0.0105]", r"start.positions\[0\], from the centre of mass: point .* is at an edge"),
    ],
)
def test_positions_off_the_object(position: str, words: str) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        parse_scenario(changed(TEXT, ("[0.02, 0.02, -0.0105]", position)))


def test_what_no_fingers_hold_is_infeasible(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "slippery.toml"
    path.write_text(changed(TEXT, ("friction = 0.6", "friction = 0.05")), encoding="utf-8")
    status, out, err = regrasp(capsys, "plan", path, "-o", tmp_path / "out")
    assert (status, out) == (3, "")
    assert err.startswith(f"Error: {path}: the fingers of the goal cannot hold the load there")


def test_the_schema_has_regrasps_in_space() -> None:
    schema = scenario_schema()
    assert "SpaceRegraspScenario" in schema["$defs"]
    keys = schema["$defs"]["SpaceRegraspTask"]["properties"]
    assert set(TASK_KEYS.split(", ")) == set(keys)
    assert schema["$defs"]["SpacePlaces"]["properties"]["positions"]["minItems"] == 4
    assert "torsion" in schema["$defs"]["ContactEntry"]["properties"]


# -- soft fingers ---------------------------------------------------------------------------------------

SOFT = """
[load]
force = [0.0, 0.0, -1.0]
torque = [0.05, 0.0, 0.0]
[[contacts]]
name = "A"
position = [-1, 0, 0]
normal = [1, 0, 0]
friction = 0.5
torsion = 0.2
[[contacts]]
name = "B"
position = [1, 0, 0.1]
normal = [-1, 0, 0]
friction = 0.5
torsion = 0.2
[[contacts]]
name = "C"
position = [0, 0, 1]
normal = [0, 0, -1]
friction = 0.5
[task]
kind = "removal"
contact = "C"
rate = 50
"""


def with_forces(text: str, plan: rg.Transition) -> str:
    """The scenario with the forces of a plan: four numbers of a soft finger, three of a point contact."""
    for name, start, end in zip(plan.grasp.names, plan.start.forces, plan.end.forces, strict=True):
        soft = plan.grasp[name].torsion is not None
        lines = f"force = {start[: 4 if soft else 3].tolist()}\n"
        lines += f"end_force = {end.tolist()}\n" if soft else ""
        text = changed(text, (f'name = "{name}"\n', f'name = "{name}"\n{lines}'))
    return text


def test_soft_fingers_in_scenarios_and_setpoints(tmp_path: Path) -> None:
    plan = plan_scenario(parse_scenario(SOFT))
    assert isinstance(plan, rg.Transition)
    assert [c.torsion for c in plan.grasp] == [0.2, 0.2, None]
    assert rg.verify(plan).ok
    path = tmp_path / "setpoints.csv"
    write_setpoints(plan, path, 50.0)
    header, table = table_of(path)
    assert header == ["t", *(f"{n}_{k}" for n in "ABC" for k in ("fx", "fy", "fz", "mn"))]
    forces = table[:, 1:].reshape(len(table), 3, 4)
    assert (forces == plan.forces(table[:, 0])).all()
    assert abs(forces[:, :2, 3]).min() > 0
    assert not forces[:, 2, 3].any()
    (rows,) = read_setpoints(path, plan)
    assert checked(plan, rows).ok
    spoiled = rows.forces.copy()
    spoiled[3, 0, 3] += 1e-6
    assert checked(plan, rows._replace(forces=spoiled)).violations[0].startswith("set-point 3: not in eq")
    again = plan_scenario(parse_scenario(with_forces(SOFT, plan)))
    assert again.start == plan.start
    assert again.end == plan.end
    assert rg.verify(again).ok


def test_soft_fingers_on_an_object() -> None:
    text = changed(
        (EXAMPLES / "space-removal.toml").read_text(encoding="utf-8"),
        ("friction = 0.8", "friction = 0.8\ntorsion = 0.003"),
    )
    scenario = parse_scenario(text)
    assert [c.torsion for c in scenario.grasp] == [0.003, None, None, None]
    assert rg.verify(plan_scenario(scenario)).ok


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([("torsion = 0.2", "torsion = 0.0")],
         r"contacts\[0\].torsion: expected a number greater than 0, got 0"),
        ([("friction = 0.5", "friction = 0.0")], "a contact without friction has no torsion"),
        ([("torsion = 0.2", "torsion = 0.2\nforce = [1.0, 0.0, 0.0]")],
         r"contacts\[0\].force: expected 4 numbers, for a soft finger in space; got 3"),
        ([('name = "C"', 'name = "C"\nforce = [1.0, 0.0, 0.0, 0.0]')],
         r"contacts\[2\].force: expected 3 numbers, for this scenario is in space; got 4"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_soft_fingers(changes: list[tuple[str, str]], words: str) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        parse_scenario(changed(SOFT, *changes))


def test_a_regrasp_that_is_not_finite_is_not_written(plan: RegraspPlan, tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match="margin: expected a finite number, got nan"):
        write_plan(replace(plan, margin=float("nan")), tmp_path / "plan.json")
    assert not list(tmp_path.iterdir())


def test_the_example_from_the_command_line(
    plan: RegraspPlan, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    status, out, err = regrasp(capsys, "plan", EXAMPLE, "-o", tmp_path)
    assert (status, err) == (0, "")
    assert str(plan) in out
    assert {file.name for file in tmp_path.iterdir()} == {
        "overview.png",
        "plan.json",
        "setpoints.csv",
        *(f"step_{k}.png" for k in range(1, len(plan.steps) + 1)),
    }
    status, out, err = regrasp(capsys, "verify", tmp_path)
    assert (status, err) == (0, "")
    assert "verified in exact arithmetic" in out
    assert f"each of {101 * len(plan.steps)} set-points" in out
