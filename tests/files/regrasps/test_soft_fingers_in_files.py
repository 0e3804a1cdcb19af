"""Soft fingers in scenarios and set-points."""

from pathlib import Path

import pytest

import regrasp as rg
from places import EXAMPLES
from regrasp.files import (
    parse_scenario,
    plan_scenario,
    write_setpoints,
)
from regrasp.files.plans.setpoints import checked, read_setpoints
from scenarios import changed
from spoiling import table_of

pytestmark = pytest.mark.contract

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
