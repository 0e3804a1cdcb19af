"""From a scenario to a chosen grasp on disk, judged again from there."""

import json
import re
from inspect import signature
from pathlib import Path

import pytest

import regrasp as rg
from regrasp.files import parse_scenario, plan_scenario, read_plan, write_plan
from regrasp.files.scenarios.grasp import GraspTask
from regrasp.files.scenarios.templates import template
from scenarios import regrasp

pytestmark = pytest.mark.end_to_end

WRITTEN = {"plan.json", "grasp.png", "regions.json", "regions.png"}


def test_a_grasp_is_chosen_written_and_verified(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "grasp.toml").write_text(template("grasp"), encoding="utf-8")
    status, out, err = regrasp(capsys, "plan", str(tmp_path / "grasp.toml"), "-o", str(tmp_path / "out"))
    assert (status, err) == (0, "")
    assert "no placement is below" in out
    assert "how far fingers may miss along the outline: all at once " in out
    assert {file.name for file in (tmp_path / "out").iterdir()} == {
        "plan.json",
        "grasp.png",
        "regions.json",
        "regions.png",
    }
    status, out, err = regrasp(capsys, "verify", str(tmp_path / "out"), "--json")
    assert (status, err) == (0, "")
    facts = json.loads(out)
    assert facts["plan"]["kind"] == "grasp"
    assert facts["verification"]["excluded"] > 0
    assert facts["plan"]["bound"] <= facts["plan"]["value"]
    file = tmp_path / "out" / "regions.json"
    status, out, err = regrasp(capsys, "verify", str(file))
    assert (status, err) == (0, "")
    assert "how far fingers may miss along the outline: all at once " in out
    file.write_text(re.sub(r'"half_width": 0', '"half_width": 1', file.read_text(encoding="utf-8")))
    status, out, err = regrasp(capsys, "verify", str(file))
    assert (status, out) == (2, "")
    assert "digest" in err


def test_two_fingers_have_a_map_too_and_what_has_no_regions_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*_: object, **__: object) -> None:
        raise rg.Infeasible("there are none")

    text = template("grasp").replace("fingers = 3", "fingers = 2").replace("friction = 0.4", "friction = 0.8")
    (tmp_path / "grasp.toml").write_text(text, encoding="utf-8")
    for folder, drawn, said in (
        ("all", {"grasp.png", "regions.json", "regions.png", "map.png"}, ""),
        ("some", {"grasp.png", "map.png"}, "no regions.json: there are none"),
    ):
        status, out, err = regrasp(capsys, "plan", str(tmp_path / "grasp.toml"), "-o", str(tmp_path / folder))
        assert (status, err) == (0, "")
        assert {file.name for file in (tmp_path / folder).iterdir()} == {"plan.json", *drawn}
        assert said in out
        monkeypatch.setattr("regrasp.planning.placement.regions.asking.contact_regions", none)


def test_every_option_of_the_verb_is_a_key_and_in_the_example() -> None:
    asked = set(signature(rg.choose_grasp).parameters)
    asked -= {"shape", "load", "friction", "disturbance", "keep", "progress"}  # elsewhere, or no data
    assert asked == set(GraspTask.model_fields) - {"kind"}
    for key in (*asked, "disturbance", "tilt_degrees"):
        assert f"{key} = " in template("grasp")


def test_a_grasp_on_a_mesh_of_a_file_is_chosen_drawn_and_verified(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rg.Mesh.box(40, 30, 50).save_stl(tmp_path / "box.stl")
    text = template("space-grasp").replace('part = "bracket"', 'mesh = "box.stl"\nscale = 0.001')
    (tmp_path / "grasp.toml").write_text(text, encoding="utf-8")
    status, out, err = regrasp(capsys, "plan", str(tmp_path / "grasp.toml"), "-o", str(tmp_path / "out"))
    assert (status, err) == (0, "")
    assert "no placement is below" in out
    assert "how far fingers may miss along their faces: all at once " in out
    assert {file.name for file in (tmp_path / "out").iterdir()} == {
        "plan.json",
        "grasp.png",
        "regions.json",
        "regions.png",
    }
    status, out, err = regrasp(capsys, "verify", str(tmp_path / "out"), "--json")
    assert (status, err) == (0, "")
    assert json.loads(out)["plan"]["bound"] <= json.loads(out)["plan"]["value"]
    for change in (("force = [0.5, 0.0, -1.8]", "force = [0.5, 0.0]"), ('"peak"', '"angle"')):
        (tmp_path / "grasp.toml").write_text(text.replace(*change), encoding="utf-8")
        assert regrasp(capsys, "plan", str(tmp_path / "grasp.toml"), "-o", str(tmp_path / "out"))[0] == 2


def in_space(objective: str, *, limit: str = "max_force = 4.0\n", load: str = "") -> rg.ChosenGrasp:
    text = template("space-grasp").split("[load]")[0] + "[load]\nforce = [0.0, 0.0, -1.8]\n" + load
    text += (
        f'[task]\nkind = "grasp"\nfingers = 3\nobjective = "{objective}"\ntolerance = 0.5\nmost_boxes = 64\n'
    )
    return plan_scenario(parse_scenario(text + limit))


SHAKEN = "disturbance = {hull = [{force = [0.1, 0.0, 0.0]}, {force = [-0.1, 0.0, 0.0]}]}\n"


@pytest.mark.parametrize(
    ("objective", "load"), [("friction_use", ""), ("angle", ""), ("answered", SHAKEN)], ids=str
)
def test_scenarios_in_space_ask_for_levels(objective: str, load: str) -> None:
    found = in_space(objective, load=load)
    assert found.objective == objective
    assert found.max_force == 4.0
    assert rg.verify(found).ok
    assert (" times the disturbance; no placement is above " in str(found)) == (objective == "answered")


@pytest.mark.parametrize(
    ("objective", "load", "limit", "words"),
    [
        ("angle", "", "", "needs max_force"),
        ("answered", "", "max_force = 4.0\n", "go together"),
        ("peak", SHAKEN, "", "disturbance: on a mesh for objectives friction_use, angle, answered alone"),
        ("peak", "", "max_force = 4.0\n", "max_force: on a mesh for objectives friction_use"),
        ("force", "", "max_force = 4.0\n", "task.objective"),
        ("answered", "disturbance = {force = 0.1}\n", "max_force = 4.0\n", "disturbance: expected a hull"),
        ("answered", SHAKEN.replace("0.0, 0.0", "0.0"), "max_force = 4.0\n", "forces of 3 numbers"),
        ("angle", "", "max_force = -1.0\n", "max_force"),
        ("angle", "", "max_force = nan\n", "max_force"),
    ],
)
def test_levels_in_space_are_refused_as_the_verb_refuses_them(
    objective: str, load: str, limit: str, words: str
) -> None:
    with pytest.raises(rg.InvalidInput) as caught:
        in_space(objective, limit=limit, load=load)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_comes_back_equal_and_one_that_was_touched_does_not_verify(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    chosen = plan_scenario(parse_scenario(template("grasp")))
    assert isinstance(chosen, rg.ChosenGrasp)
    write_plan(chosen, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json") == chosen
    data = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    data["bound"] = data["value"] * 1.5
    (tmp_path / "plan.json").write_text(json.dumps(data), encoding="utf-8")
    status, _, err = regrasp(capsys, "verify", str(tmp_path / "plan.json"))
    assert (status, err.count("\n")) == (2, 1)
    assert "the digest of a chosen grasp does not fit" in err
    del data["digest"]  # of before, or of a forger
    (tmp_path / "plan.json").write_text(json.dumps(data), encoding="utf-8")
    status, _, err = regrasp(capsys, "verify", str(tmp_path / "plan.json"))
    assert status == 1
    assert "above the value" in err
    status, _, err = regrasp(capsys, "simulate", str(tmp_path / "plan.json"))
    assert status == 2
    assert "no forces over time" in err or "mujoco" in err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("fingers = 3", "fingers = 9"), "task.fingers"),
        (('objective = "peak_normal"', 'objective = "angle"'), "max_force"),
        (("force = [0.3, -1.0]", "force = [0.3, -1.0, 0.0]"), "plane"),
    ],
)
def test_what_is_wrong_is_said(
    change: tuple[str, str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = template("grasp")
    assert change[0] in text
    (tmp_path / "grasp.toml").write_text(text.replace(*change), encoding="utf-8")
    status, _, err = regrasp(capsys, "plan", str(tmp_path / "grasp.toml"), "-o", str(tmp_path / "out"))
    assert status in (2, 3)
    assert words in err


def test_every_way_to_give_loads_and_objectives() -> None:
    text = template("grasp").replace("[0.0, -1.0]\n", "[0.0, -1.0]\ntilt_degrees = 20.0\n")
    text = "\n".join(line for line in text.splitlines() if "[[load.also]]" not in line)
    text = text.replace("force = [0.3, -1.0]\n", "").replace("force = [-0.3, -1.0]\ntorque = -0.005\n", "")
    tilted = plan_scenario(parse_scenario(text))
    assert isinstance(tilted, rg.ChosenGrasp)
    assert len(tilted.states) > 1  # one for each load around the set
    answered = text.replace('objective = "peak_normal"', 'objective = "answered"\nmax_force = 3.0')
    answered = answered.replace("tilt_degrees = 20.0", "")
    answered = answered.replace(
        "[outline]", "[load.disturbance]\nhull = [{force = [0.2, 0.0]}, {force = [-0.2, 0.0]}]\n[outline]"
    )
    found = plan_scenario(parse_scenario(answered))
    assert isinstance(found, rg.ChosenGrasp)
    assert found.objective == "answered"
    assert rg.verify(found).ok
