"""Regrasps in space in scenarios are planned as by the verb, or refused to the word."""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from places import EXAMPLES
from regrasp.files import (
    SpaceRegraspScenario,
    parse_scenario,
    plan_scenario,
    read_scenario,
    scenario_schema,
)
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.plans.regrasp_plan import RegraspPlan
from scenarios import changed, regrasp

pytestmark = pytest.mark.contract

EXAMPLE = EXAMPLES / "space-regrasp.toml"
TEXT = EXAMPLE.read_text(encoding="utf-8")
SCENARIO = read_scenario(EXAMPLE)


@pytest.fixture(scope="module")
def plan() -> RegraspPlan:
    planned = plan_scenario(SCENARIO)
    assert planned.rotations is not None
    return planned


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
