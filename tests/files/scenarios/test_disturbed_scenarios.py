"""Scenarios with a disturbance: planned so that it is withstood, and refused in one line where they are "
"wrong."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

import regrasp as rg
from regrasp.files import parse_scenario, plan_scenario, read_plan, write_plan
from regrasp.files.scenarios.templates import template

pytestmark = pytest.mark.contract

TEXT = """
[load]
force = [-1.5, -3.5]
[load.disturbance]
{set}
[[contacts]]
name = "P1"
position = [-4.0, -4.0]
normal = [1.0, 1.0]
friction = 0.3
[[contacts]]
name = "P2"
position = [4.0, -5.0]
normal = [-1.0, 2.0]
friction = 0.3
[[contacts]]
name = "P3"
position = [0.0, 8.0]
normal = [0.0, -1.0]
friction = 0.3
[task]
{task}
max_force = 20.0
"""
REMOVAL = 'kind = "removal"\ncontact = "P3"\nstiffness = [1000, 800, 600]\nearly_loss = true'


@pytest.mark.parametrize(
    ("words", "loads"),
    [
        ("force = 0.1\ntorque = 0.4", rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.1, torque=0.4)),
        ("tilt_degrees = 2.0", rg.LoadSet.tilted(rg.Wrench([-1.5, -3.5]), 0.0349).deviations),
        (
            "hull = [{force = [0.1, 0.0]}, {force = [0.0, 0.0], torque = 0.5}]",
            rg.LoadSet.hull([rg.Wrench([0.1, 0]), rg.Wrench([0, 0], 0.5)]),
        ),
        (
            "axes = [{force = [0.1, 0.1]}, {force = [0.0, 0.05], torque = 0.5}]",
            rg.LoadSet.ellipsoid(rg.Wrench([0, 0]), [[0.1, 0.0], [0.1, 0.05], [0.0, 0.5]]),
        ),
    ],
)
def test_a_plan_of_a_scenario_withstands_its_set(words: str, loads: rg.LoadSet, tmp_path: Path) -> None:
    scenario = parse_scenario(TEXT.format(set=words, task=REMOVAL))
    plan = plan_scenario(scenario)
    write_plan(plan, tmp_path / "plan.json")
    again = read_plan(tmp_path / "plan.json")
    assert again == plan
    assert "every instant withstands every deviation of the" in str(rg.verify(again))
    more = replace(plan.record.withstands, disturbance=loads.scaled(30))
    lying = replace(plan, record=replace(plan.record, withstands=more))
    assert any(v.startswith("record: start: force of") for v in rg.verify(lying).violations)
    assert rg.verify(plan, disturbance=loads, stiffness=[1000, 800, 600], early_loss=True).ok
    calm = TEXT.format(set=words, task=REMOVAL).replace("[load.disturbance]\n" + words, "")
    without = plan_scenario(parse_scenario(calm))
    assert not rg.verify(without, disturbance=loads, stiffness=[1000, 800, 600], early_loss=True).ok


@pytest.mark.parametrize("kind", ["regrasp", "space-regrasp"])
def test_regrasps_of_scenarios_withstand_their_set(kind: str) -> None:
    text = template(kind).replace("[task]", "[task]\nTASK")
    text = text.replace("orientations = ", "orientations = 1  # ")
    text = re.sub(r"(?m)^goal_(degrees|axis) = .*$", "", text).replace("[load]", "[load]\nLOAD")
    wide = 4 if kind == "space-regrasp" else 3
    springs = [1.0, 2.0, 3.0, 4.0][:wide]
    rows = [[1.0] + [0.0] * (wide - 2)]
    task = f"stiffness = {springs}\nlimits = {{rows = {rows}, bounds = [200.0]}}"
    text = text.replace("LOAD", "disturbance = {force = 0.01, torque = 0.0001}")
    plan = plan_scenario(parse_scenario(text.replace("TASK", task)))
    loads = rg.LoadSet.ball(rg.Wrench([0.0] * (wide - 1)), force=0.01, torque=0.0001)
    assert rg.verify(plan, disturbance=loads, stiffness=springs).ok
    assert "withstands every deviation" in str(rg.verify(rg.RegraspPlan.from_dict(plan.to_dict())))
    assert {step.record.withstands.disturbance for step in plan.steps} == {loads}
    assert plan.steps[0].grasp[0].limits == rg.ForceLimits(rows, [200.0])
    with pytest.raises(rg.InvalidInput, match="task: limits: expected rows and bounds; a jacobian"):
        parse_scenario(text.replace("TASK", "limits = {jacobian = [[1.0], [0.0]], torques = 1.0}"))


def test_arriving_fingers_bring_their_stiffness_and_objects_turn() -> None:
    addition = 'kind = "addition"\ncontact = "P3"\nstiffness = [1000, 800, 600]'
    loads = rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.01)
    plan = plan_scenario(parse_scenario(TEXT.format(set="force = 0.01", task=addition)))
    assert rg.verify(plan, disturbance=loads, stiffness=[1000, 800, 600]).ok
    rotation = 'kind = "rotation"\ndegrees = 20.0'
    turned = plan_scenario(parse_scenario(TEXT.format(set="force = 0.01", task=rotation)))
    assert rg.verify(turned, disturbance=loads).ok


@pytest.mark.parametrize(
    ("words", "task", "said"),
    [
        ("", REMOVAL, "load.disturbance: expected force or torque above 0, tilt_degrees, axes or hull"),
        ("force = 0.1\ntilt_degrees = 3.0", REMOVAL, "one of these four"),
        ("force = -0.1", REMOVAL, "load.disturbance.force"),
        ("hull = [{force = [0.1, 0.0, 0.0]}]", REMOVAL, "disturbance.hull: expected forces of 2 numbers"),
        ("axes = [{force = [0.1, 0.0, 0.0]}]", REMOVAL, "disturbance.axes: expected forces of 2 numbers"),
        ("force = 0.1", REMOVAL.replace("[1000, 800, 600]", "[1, 2]"), "task.stiffness: expected a number"),
    ],
)
def test_wrong_sets_are_refused(words: str, task: str, said: str) -> None:
    with pytest.raises(rg.InvalidInput, match="(?s)" + said.replace(".", r"\.").replace("[", r"\[")):
        parse_scenario(TEXT.format(set=words, task=task))


def test_a_hold_follows_its_load_and_is_written_and_read(tmp_path: Path) -> None:
    for name in ("hold", "space-hold"):
        plan = plan_scenario(parse_scenario(template(name)))
        assert plan.kind == "hold"
        assert plan.duration == 0.8
        assert rg.verify(plan).ok
        write_plan(plan, tmp_path / f"{name}.json")
        assert rg.verify(read_plan(tmp_path / f"{name}.json")).ok
    still = TEXT.format(set="force = 0.1", task='kind = "hold"\nstart_objective = "force"')
    plan = plan_scenario(parse_scenario(still))
    loads = rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.1)
    assert rg.verify(plan, disturbance=loads).ok
    assert isinstance(plan.path, rg.StraightPath)
    with pytest.raises(rg.InvalidInput, match="early_loss"):
        parse_scenario(TEXT.format(set="force = 0.1", task='kind = "hold"\nearly_loss = true'))


JOINTS = "limits = {jacobian = [[0.0, 0.06], [0.05, 0.02]], torques = 0.3}"


@pytest.mark.parametrize("words", [JOINTS, "limits = {rows = [[1.0, 0.0], [0.0, 1.0]], bounds = [3.5, 2.0]}"])
def test_linear_limits_go_through_scenarios_and_plan_files(words: str, tmp_path: Path) -> None:
    calm = TEXT.format(set="force = 0.01", task='kind = "removal"\ncontact = "P3"')
    scenario = parse_scenario(calm.replace("friction = 0.3", f"friction = 0.3\n{words}", 1))
    plan = plan_scenario(scenario)
    limits = plan.grasp["P1"].limits
    assert limits is not None
    assert plan.grasp["P2"].limits is None
    assert rg.verify(plan).ok
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json").grasp == plan.grasp


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ("limits = {rows = [[1.0, 0.0]]}", "expected rows and bounds, or jacobian and torques"),
        ("limits = {rows = [[1.0, 0.0]], bounds = [0.0]}", "bounds of limits must be greater than 0"),
        ("limits = {rows = [[1.0, 0.0, 0.0]], bounds = [1.0]}", "rows of limits must have 2 numbers"),
        ("limits = {jacobian = [[1.0]], torques = 1.0}", "jacobian must have 2, 3 or 4 rows"),
    ],
)
def test_bad_linear_limits_are_refused_in_one_message(words: str, problem: str) -> None:
    calm = TEXT.format(set="force = 0.01", task='kind = "removal"\ncontact = "P3"')
    with pytest.raises(rg.InvalidInput, match=problem):
        parse_scenario(calm.replace("friction = 0.3", f"friction = 0.3\n{words}", 1))
