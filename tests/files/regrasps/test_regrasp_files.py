"""Turns and whole regrasps in plan files: read back bit for bit, damaged ones refused."""

import json
from collections.abc import Callable
from dataclasses import replace
from math import nan, radians
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from regrasp.files import (
    read_plan,
    write_plan,
)
from spoiling import damaged, drop, put
from written_regrasps import ELLIPSE, JAR, REGRASP, ROTATION, WEIGHT, fingers_at

pytestmark = pytest.mark.contract

TURNED = rg.plan_regrasp(
    ELLIPSE,
    fingers_at(0.02, 0.35, 0.7),
    fingers_at(0.2, 0.5, 0.85),
    WEIGHT,
    friction=0.5,
    orientations=24,
    goal_orientation=radians(75),
)
EXCHANGE = next(k for k, step in enumerate(REGRASP.steps) if step.kind == "exchange")


def same_bits(ours: rg.Transition, theirs: rg.Transition) -> bool:
    def bits(plan: rg.Transition) -> list[bytes]:
        arrays = [plan.grasp.positions, plan.grasp.normals, plan.grasp.frictions]
        for state in (plan.start, plan.end):
            arrays += [state.forces, state.load.vector]
        if plan.turn is not None:
            arrays += [plan.turn.angles, plan.turn.forces]
        return [array.tobytes() for array in arrays]

    return bits(ours) == bits(theirs)


@pytest.mark.parametrize(
    "plan", [ROTATION, ROTATION.reversed(), *REGRASP.steps], ids=lambda plan: plan.in_words
)
def test_turning_plans_are_read_back_bit_for_bit(plan: rg.Transition, tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(plan, path)
    back = read_plan(path)
    assert isinstance(back, rg.Transition)
    assert back == plan
    assert same_bits(plan, back)
    assert rg.verify(back) == rg.verify(plan)
    assert rg.verify(back).ok


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
@given(angle=st.floats(-7, 7).filter(lambda angle: abs(angle) > 1e-6), weight=st.floats(1e-3, 1e3))
def test_any_rotation_is_read_back(
    angle: float, weight: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "any-rotation.json"
    plan = rg.plan_rotation(JAR, angle, load=rg.Wrench([0.1, -weight]))
    write_plan(plan, path)
    back = read_plan(path)
    assert isinstance(back.path, rg.TurningPath)
    assert back == plan
    assert same_bits(plan, back)


def test_regrasp_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    assert {step.kind for step in REGRASP.steps} >= {"removal", "exchange", "rotation", "addition"}
    assert any(step.turn and step.arrival for step in TURNED.steps)
    for plan in (REGRASP, REGRASP.reversed(), TURNED):
        write_plan(plan, tmp_path / "plan.json")
        back = read_plan(tmp_path / "plan.json")
        assert back == plan
        assert isinstance(back, rg.RegraspPlan)
        assert all(same_bits(a, b) for a, b in zip(plan.steps, back.steps, strict=True))
        assert str(back) == str(plan)
        assert rg.verify(back) == rg.verify(plan)
        assert rg.verify(back).ok
        first = (tmp_path / "plan.json").read_bytes()
        write_plan(back, tmp_path / "plan.json")
        assert (tmp_path / "plan.json").read_bytes() == first


def test_straight_plans_are_written_as_before(tmp_path: Path) -> None:
    write_plan(REGRASP.steps[0], tmp_path / "plan.json")
    assert list(json.loads((tmp_path / "plan.json").read_text())) == [
        "format", "version", "kind", "contact", "load", "contacts", "start", "end", "scaling", "course",
        "record",
    ]  # fmt: skip


COURSE = {
    "times": [0.0, 1.0],
    "forces": [ROTATION.start.forces.tolist()] * 2,
    "loads": [[0.0, -3.0, 0.0]] * 2,
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("A", "contact"), "a rotation names the wrong fingers: 'A' and None"),
        (drop("contact"), "contact: a required key is missing"),
        (drop("turn", "end_load"), "turn.end_load: a required key is missing"),
        (put(nan, "turn", "angles", 1), "turn.angles[1]: expected a finite number, got nan"),
        (put([0.0, 4.0], "turn", "angles"), "angles of a turn must go one way from 0 in steps below pi, "
                                            "got [0.0, 4.0]"),
        (put([], "turn", "angles"), "angles of a turn must go one way from 0 in steps below pi, got []"),
        (put("x", "turn", "forces", 0, 1, 0), "turn.forces[0][1][0]: expected a number, got 'x'"),
        (put([1.0], "turn", "end_load"), "a wrench must have 3 (plane) or 6 (space) numbers, got 1"),
        (put(COURSE, "course"), "a plan has a course or a turn, not both"),
        (put([0.0, 1.0, 0.2], "load"), "a part of the load, Wrench(force=(0, 0), torque=0.2), does not turn: "
                                       "middles are needed, states between angles"),
    ],
)  # fmt: skip
def test_damaged_rotation(change: Callable[[dict[str, Any]], None], message: str, tmp_path: Path) -> None:
    check_damaged(ROTATION, change, message, tmp_path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put([], "steps"), "steps: expected at least 1 entries, got []"),
        (put([0.0], "orientations"), f"orientations: expected {len(REGRASP.steps) + 1} angles, one more than "
                                     "the steps, got 1"),
        (drop("margin"), "margin: a required key is missing"),
        (put("wide", "margin"), "margin: expected a number, got 'wide'"),
        (put(3, "step"), "step: unknown key; known here: format, version, kind, steps, orientations, margin, "
                         "rotations"),
        (put([], "rotations"), "rotations: leave them out in the plane"),
        (drop("steps", 1, "record"), "steps[1].record: a required key is missing"),
        (put(1, "steps", 0, "version"), "steps[0].version: unknown key; known here: kind, contact, load, "
                                        "contacts, start, end, scaling, course, record, arrival, leaving, "
                                        "arriving, turn"),
        (put("P9", "steps", 0, "contact"),
         f"steps[0]: no contact 'P9' in this grasp; it has {', '.join(REGRASP.steps[0].grasp.names)}"),
        (put(None, "steps", EXCHANGE, "arrival"), f"steps[{EXCHANGE}]: an exchange names the wrong fingers: "
                                                  f"{REGRASP.steps[EXCHANGE].contact!r} and None"),
    ],
)  # fmt: skip
def test_damaged_regrasp(change: Callable[[dict[str, Any]], None], message: str, tmp_path: Path) -> None:
    check_damaged(REGRASP, change, message, tmp_path)


def check_damaged(
    plan: rg.Transition | rg.RegraspPlan,
    change: Callable[[dict[str, Any]], None],
    message: str,
    tmp_path: Path,
) -> None:
    path = damaged(plan, change, tmp_path / "plan.json")
    with pytest.raises(rg.InvalidInput) as raised:
        read_plan(path)
    assert str(raised.value) == f"{path}: {message}"


def changed_force(data: dict[str, Any]) -> None:
    data["steps"][1]["start"][0][0] += 1e-6


@pytest.mark.parametrize(
    "change", [put(0.1, "orientations", 1), put(-0.2, "orientations", -1), changed_force]
)
def test_readable_regrasp_that_is_wrong_does_not_verify(
    change: Callable[[dict[str, Any]], None], tmp_path: Path
) -> None:
    assert not rg.verify(read_plan(damaged(REGRASP, change, tmp_path / "plan.json"))).ok


def test_a_step_with_more_contacts_than_fingers(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    turned = replace(
        REGRASP, steps=REGRASP.steps[EXCHANGE:-1], orientations=REGRASP.orientations[EXCHANGE:-1]
    )
    more = replace(turned, steps=(ROTATION, *turned.steps), orientations=(0.0, *turned.orientations))
    write_plan(more, path)
    with pytest.raises(rg.InvalidInput, match=r"plan.json: step 2 has more contacts than there are fingers"):
        read_plan(path)


def test_what_is_no_plan_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput) as raised:
        write_plan("plan", tmp_path / "plan.json")  # type: ignore[arg-type]
    assert str(raised.value) == "write_plan writes a Transition, a RegraspPlan or a ChosenGrasp, got 'plan'"
    with pytest.raises(rg.InvalidInput) as raised:
        write_plan(replace(REGRASP, margin=nan), tmp_path / "plan.json")
    assert str(raised.value) == f"{tmp_path / 'plan.json'}: margin: expected a finite number, got nan"
    assert list(tmp_path.iterdir()) == []
