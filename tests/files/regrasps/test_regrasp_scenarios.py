"""Whole regrasps in scenarios are planned as by the verb, or refused to the word."""

import re
from math import radians
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from places import EXAMPLES
from regrasp.files import (
    RegraspScenario,
    parse_scenario,
    plan_scenario,
    read_plan,
    read_scenario,
)
from regrasp.outline import parts
from scenarios import changed, check_bad, regrasp

pytestmark = pytest.mark.contract

WHOLE = (EXAMPLES / "regrasp.toml").read_text(encoding="utf-8")
PART = 'part = "wrench"'
BOX = "vertices = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]]"


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
    named = scenario(("candidates = 120", "candidates = [0.031, 0.052]"))
    assert named.task.candidates == [0.031, 0.052]
    outline, given = named.outline.value, (named.start_grasp, named.goal_grasp)
    task = {
        "orientations": 24,
        "goal_orientation": radians(180),
        "max_turn": radians(90),
        "min_distance": 0.02,
    }
    same = rg.plan_regrasp(
        outline,
        *given,
        rg.Wrench([0, -2]),
        friction=0.6,
        candidates=[0.031, 0.052],
        step_duration=0.5,
        **task,
    )
    assert plan_scenario(named) == same
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
        ([("candidates = 120", "candidates = []")], ["task.candidates: expected at least 1 entries, got []"]),
        ([("candidates = 120", 'candidates = [0.1, "b"]')],
         ["task.candidates[1]: expected a number, got 'b'"]),
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
