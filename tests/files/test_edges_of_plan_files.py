"""Plan files at the edge of their form: several fingers at once, one step, long headers."""

import json
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from regrasp.files import read_plan, write_plan, write_setpoints
from regrasp.files.plans.plan_file import plan_document, plan_of
from regrasp.files.plans.setpoints import checked, read_setpoints
from regrasp.mechanics.robust.withstood import Withstood

pytestmark = pytest.mark.contract

FEET = rg.Grasp(rg.Contact([x, 0], [0, 1], 0.5, name=f"P{k}") for k, x in enumerate((-2, -1, 1, 2)))
LOAD = rg.Wrench([0, -4])


def both(kind: str) -> rg.Transition:
    """Two feet of four leave, or arrive."""
    four = rg.GraspState(FEET, LOAD, [[0, 1.0]] * 4)
    two = rg.GraspState(FEET, LOAD, [[0, 0.0], [0, 2], [0, 2], [0, 0]])
    ends, moving = (four, two) if kind == "removal" else (two, four), ("P0", "P3")
    scaling, record = rg.TimeScaling.linear(1.0), rg.plan_hold(four).record
    leaving, arriving = (moving, ()) if kind == "removal" else ((), moving)
    return rg.Transition(*ends, scaling, replace(record, choices=()), leaving, arriving)


@pytest.mark.parametrize("kind", ["removal", "addition"])
@pytest.mark.parametrize("empty", ["kept", "left out"])
def test_several_fingers_at_once_are_kept(kind, empty, tmp_path: Path) -> None:
    """Both lists are written; one alone reads as well, whichever it is."""
    plan, file = both(kind), tmp_path / "plan.json"
    write_plan(plan, file)
    document = json.loads(file.read_text(encoding="utf-8"))
    assert {key: document[key] for key in ("leaving", "arriving")} == {
        "leaving": list(plan.leaving),
        "arriving": list(plan.arriving),
    }
    if empty == "left out":
        del document["arriving" if kind == "removal" else "leaving"]
        file.write_text(json.dumps(document), encoding="utf-8")
    again = read_plan(file)
    assert (again.leaving, again.arriving) == (plan.leaving, plan.arriving)
    assert rg.verify(again).ok


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        ({"disturbance": None}, "must be a disturbance or an early loss, got neither"),
        ({"disturbance": {"center": 1, "factor": 1.0, "body": {}}}, "wrench must have shape"),
        ({"early_loss": 1}, "early_loss must be True or False"),
        ({"other": 1}, "unknown key 'other'"),
        ({"stiffness": float("nan")}, "stiffness must be"),
    ],
)
def test_what_is_withstood_is_read_in_full_or_refused(edit, words) -> None:
    plan = both("removal")
    old = plan_document(plan)
    assert "withstands" not in old["record"]
    assert plan_of(old).record.withstands is None
    said = Withstood(rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.1, torque=0.1))
    document = plan_document(replace(plan, record=replace(plan.record, withstands=said)))
    assert plan_of(document).record.withstands == said
    document["record"]["withstands"] |= edit
    with pytest.raises(rg.InvalidInput, match=f"record.withstands: .*{words}"):
        plan_of(document)


def one_step(angle: float, rotation=None) -> rg.RegraspPlan:
    """A regrasp that is one hold, of an object that starts at an angle."""
    if rotation is None:
        hold = rg.plan_hold(rg.GraspState(FEET, LOAD, [[0, 1.0]] * 4))
        return rg.RegraspPlan((hold,), (angle, angle), 0.0)
    feet = rg.Grasp(rg.Contact([x, y, 0], [0, 0, 1], 0.5) for x, y in ((-1, 0), (1, 0), (0, 1), (0, -1)))
    hold = rg.plan_hold(rg.GraspState(feet, rg.Wrench([0, 0, -4.0]), [[0, 0, 1.0]] * 4))
    return rg.RegraspPlan((hold,), (0.0, 0.0), 0.0, rotations=np.array([rotation, rotation]))


QUARTER = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


@pytest.mark.parametrize("plan", [one_step(0.3), one_step(0.0, np.eye(3)), one_step(0.0, QUARTER)])
def test_a_regrasp_of_one_step_is_written_and_read(plan, tmp_path: Path) -> None:
    write_plan(plan, tmp_path / "plan.json")
    write_setpoints(plan, tmp_path / "setpoints.csv", 10.0)
    again = read_plan(tmp_path / "plan.json")
    assert again.steps[0] == plan.steps[0]
    assert (again.rotations is None) is (plan.rotations is None)
    rows = read_setpoints(tmp_path / "setpoints.csv", again)
    assert len(rows) == 1
    assert checked(again, rows[0]).ok
    if plan.rotations is not None:
        header, first, *_ = (tmp_path / "setpoints.csv").read_text(encoding="utf-8").splitlines()
        numbers = dict(zip(header.split(","), map(float, first.split(",")), strict=True))
        turned = [numbers[name] for name in header.split(",") if name in ("qw", "qx", "qy", "qz")]
        half = pi / 4 if plan.rotations[0, 0, 0] == 0 else 0.0
        assert turned == pytest.approx([np.cos(half), 0, 0, np.sin(half)], abs=1e-15)


def test_rotations_are_for_space_alone(tmp_path: Path) -> None:
    for plan, words in (
        (one_step(0.3), "leave them out in the plane"),
        (one_step(0.0, QUARTER), "is missing"),
    ):
        write_plan(plan, tmp_path / "plan.json")
        document = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
        if "rotations" in document:
            del document["rotations"]
        else:
            document["rotations"] = [np.eye(3).tolist()] * 2
        (tmp_path / "plan.json").write_text(json.dumps(document), encoding="utf-8")
        with pytest.raises(rg.InvalidInput, match=words):
            read_plan(tmp_path / "plan.json")


def test_a_long_header_is_shown_in_part(tmp_path: Path) -> None:
    plan = one_step(0.0)
    write_setpoints(plan, tmp_path / "setpoints.csv", 10.0)
    many = ",".join(f"column{k}" for k in range(1000))
    (tmp_path / "setpoints.csv").write_text(f"{many}\n{many}\n", encoding="utf-8")
    with pytest.raises(rg.InvalidInput, match="expected") as refused:
        read_setpoints(tmp_path / "setpoints.csv", plan)
    assert len(str(refused.value)) < 600 + len(str(tmp_path))
