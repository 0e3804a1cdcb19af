"""Scenarios, plans and set-points in space: read, written, read back, and refused with the reason."""

import numpy as np
import pytest

import regrasp as rg
from places import ROOT
from regrasp.files import parse_scenario, plan_scenario, read_plan, read_scenario, write_plan, write_setpoints
from regrasp.files.plans.setpoints import checked, read_setpoints

pytestmark = pytest.mark.contract

EXAMPLES = ROOT / "examples"
TEXT = """
[load]
force = [0.1, 0.0, -1.0]
torque = [0.0, 0.05, 0.1]
[[contacts]]
name = "A"
position = [1, 0, 0]
normal = [-1, 0, 0]
friction = 0.7
[[contacts]]
name = "B"
position = [-0.5, 0.8, 0.1]
normal = [0.5, -0.8, -0.1]
friction = 0.7
[[contacts]]
name = "C"
position = [-0.5, -0.8, -0.1]
normal = [0.5, 0.8, 0.1]
friction = 0.7
[[contacts]]
name = "D"
position = [0, 0.1, 1]
normal = [0, -0.1, -1]
friction = 0.7
[task]
"""
REMOVAL = 'kind = "removal"\ncontact = "D"\nrate = 100\n'
ROTATION = 'kind = "rotation"\ndegrees = 75\naxis = [0, 2, 1]\nrate = 100\n'
VARYING = TEXT.replace("[load]", "[[load]]\ntime = 0").replace(
    "[[contacts]]", "[[load]]\ntime = 1.5\nforce = [0.2, 0.1, -1.2]\n[[contacts]]", 1
)


@pytest.mark.parametrize("text", [TEXT + REMOVAL, TEXT + ROTATION, VARYING + REMOVAL])
def test_plans_survive_their_files(tmp_path, text):
    plan = plan_scenario(parse_scenario(text))
    assert rg.verify(plan).ok
    write_plan(plan, tmp_path / "plan.json")
    again = read_plan(tmp_path / "plan.json")
    assert again == plan
    assert rg.verify(again).ok
    write_setpoints(plan, tmp_path / "setpoints.csv", 100)
    header = (tmp_path / "setpoints.csv").read_text().splitlines()[0].split(",")
    assert [name for name in header if name.startswith("D")] == ["D_fx", "D_fy", "D_fz"]
    (rows,) = read_setpoints(tmp_path / "setpoints.csv", again)
    assert (rows.forces == plan.forces(rows.times)).all()
    assert checked(again, rows).ok
    wrong = rows._replace(forces=rows.forces * 1.001)
    assert not checked(again, wrong).ok


def test_a_load_in_space_has_the_torque_given():
    scenario = parse_scenario(TEXT + REMOVAL)
    assert scenario.external == rg.Wrench([0.1, 0, -1], [0, 0.05, 0.1])
    without = parse_scenario(TEXT.replace("torque = [0.0, 0.05, 0.1]\n", "") + REMOVAL)
    assert without.external == rg.Wrench([0.1, 0, -1])


@pytest.mark.parametrize("name", ["space-removal", "space-rotation"])
def test_examples_in_space(name):
    scenario = read_scenario(EXAMPLES / f"{name}.toml")
    plan = plan_scenario(scenario)
    assert rg.verify(plan).ok
    mesh = scenario.object.value
    for contact in plan.grasp:
        on = mesh.nearest(contact.position + mesh.centre_of_mass) - mesh.centre_of_mass
        assert on == pytest.approx(contact.position, abs=1e-12)
        assert contact.normal @ contact.position < 0


def edited(*changes: tuple[str, str], task: str = REMOVAL) -> str:
    text = TEXT + task
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


OBJECT = ("[load]", '[object]\npart = "bracket"\n[load]')


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (edited(("normal = [-1, 0, 0]\n", "")), r"contacts\[0\].normal: a required key is missing"),
        (edited(OBJECT), r"contacts\[0\].normal: the surface of the object gives it; leave it out"),
        (edited(("[0.1, 0.0, -1.0]", "[0.1, 0.0]")), "torque: expected one number beside such a force"),
        (edited(("torque = [0.0, 0.05, 0.1]", "torque = 0.1")), "torque: expected three numbers beside"),
        (edited(("torque = [0.0, 0.05, 0.1]", "torque = [0.1]")), "load.torque: expected at least 3 entries"),
        (
            edited(("force = [0.1, 0.0, -1.0]\ntorque = [0.0, 0.05, 0.1]", "force = [0.1, -1.0]")),
            "load.force: expected 3 numbers, for this scenario is in space; got 2",
        ),
        (edited(task='kind = "rotation"\ndegrees = 75\n'), "task.axis: needed in space"),
        (edited(task=ROTATION.replace("[0, 2, 1]", "[0, 0, 0]")), "axis must not be zero"),
        (edited(task=ROTATION.replace("[0, 2, 1]", "[0, 1]")), "task.axis: expected at least 3 entries"),
        (edited(("[load]", '[object]\nmesh = "no.stl"\n[load]')), "no.stl"),
        (edited(("[load]", "[object]\n[load]")), "expected either mesh or part, found neither"),
        (
            edited(("[load]", '[object]\npart = "nut"\nscale = 2\n[load]')),
            "scale goes with mesh, found part",
        ),
    ],
)
def test_what_is_wrong_in_a_scenario_in_space(tmp_path, text, words):
    with pytest.raises(rg.InvalidInput, match=words):
        parse_scenario(text, tmp_path / "bad.toml")


def test_positions_off_the_surface():
    text = (EXAMPLES / "space-removal.toml").read_text().replace("[0.02, 0.02, -0.0105]", "[20, 20, -10.5]")
    with pytest.raises(rg.InvalidInput, match="away from the surface of an object of size"):
        parse_scenario(text)


def test_a_mesh_file_beside_the_scenario(tmp_path):
    from regrasp.mesh import parts

    parts.bracket().save_stl(tmp_path / "part.stl")
    text = (EXAMPLES / "space-removal.toml").read_text().replace('part = "bracket"', 'mesh = "part.stl"')
    (tmp_path / "s.toml").write_text(text)
    given, stored = read_scenario(EXAMPLES / "space-removal.toml"), read_scenario(tmp_path / "s.toml")
    for a, b in zip(given.grasp, stored.grasp, strict=True):
        assert a.position == pytest.approx(b.position, abs=1e-8)  # STL is in single precision
        assert np.degrees(np.arccos(min(a.normal @ b.normal, 1.0))) < 1e-3


def test_an_axis_in_the_plane_is_refused():
    text = (
        (EXAMPLES / "rotation.toml")
        .read_text()
        .replace('kind = "rotation"', 'kind = "rotation"\naxis = [0, 0, 1]')
    )
    with pytest.raises(rg.InvalidInput, match=r"task.axis: leave it out in the plane"):
        parse_scenario(text)
