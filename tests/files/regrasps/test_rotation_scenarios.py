"""Turns in scenarios are planned as by the verb, or refused to the word."""

import re
from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from places import EXAMPLES
from regrasp.files import (
    parse_scenario,
    plan_scenario,
)
from scenarios import changed, check_bad
from written_regrasps import WEIGHT

pytestmark = pytest.mark.contract

TURN = (EXAMPLES / "rotation.toml").read_text(encoding="utf-8")


def rotation(*changes: tuple[str, str]) -> rg.Transition:
    plan = plan_scenario(parse_scenario(changed(TURN, *changes)))
    assert plan.turn is not None
    assert rg.verify(plan).ok
    return plan


def test_rotation_scenario_plans_what_the_same_call_plans() -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([-0.04, 0.0], [1, 0], 0.6, max_force=20, name="thumb"),
            rg.Contact([0.04, 0.02], [-1, 0], 0.6, max_force=20, name="index"),
            rg.Contact([0.04, -0.02], [-1, 0], 0.6, max_force=20, name="middle"),
        ]
    )
    scaling = rg.TimeScaling.minimum_jerk(2.0)
    assert rotation() == rg.plan_rotation(grasp, radians(150), load=WEIGHT, scaling=scaling)


@pytest.mark.parametrize(
    ("line", "seen", "expected"),
    [
        ("degrees = -400.0", lambda p: p.turn.angle, radians(-400)),
        ('objective = "force"', lambda p: p.record.choices[1].objective, "force"),
        ('method = "clarabel"', lambda p: p.record.choices[0].method, "clarabel"),
        ("max_force = 12.5", lambda p: p.grasp.max_forces.tolist(), [12.5] * 3),
        ("reserve = 0.25", lambda p: p.record.reserve, 0.25),
        ("duration = 0.5", lambda p: p.duration, 0.5),
        ('scaling = "linear"', lambda p: p.scaling, rg.TimeScaling.linear(2.0)),
    ],
)
def test_option_of_a_rotation_reaches_the_plan(
    line: str, seen: Callable[[rg.Transition], Any], expected: Any
) -> None:
    key = line.split(" ")[0]
    text = TURN
    if key in ("degrees", "objective", "duration", "scaling"):
        text = re.sub(rf"(?m)^{key} = .*$", "", text)
    plan = plan_scenario(parse_scenario(f"{text}\n{line}\n"))
    assert plan.turn is not None
    assert seen(plan) == expected
    assert rg.verify(plan).ok


def with_forces(plan: rg.Transition, *keys: tuple[str, np.ndarray]) -> str:
    """The scenario of the turn with the forces of a plan, to five decimals."""
    text = TURN
    for i, name in enumerate(plan.grasp.names):
        lines = "\n".join(f"{key} = {np.round(forces[i], 5).tolist()}" for key, forces in keys)
        text = changed(text, (f'name = "{name}"', f'name = "{name}"\n{lines}'))
    return text


def test_given_forces_of_a_rotation_are_used() -> None:
    plan = rotation()
    text = with_forces(plan, ("force", plan.start.forces), ("end_force", plan.end.forces))
    again = plan_scenario(parse_scenario(text))
    assert again.turn is not None
    assert rg.verify(again).ok
    assert again.record.choices == ()
    assert 0 < again.record.balancing < 1e-4
    assert again.start.forces == pytest.approx(plan.start.forces, abs=1e-4)
    assert again.end.forces == pytest.approx(plan.end.forces, abs=1e-4)


ROTATION_KEYS = (
    "objective, method, facets, duration, rate, scaling, control, max_force, peak_ratio, reserve, "
    "balance_tolerance, min_normal, stiffness, degrees, axis, kind"
)


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ([("degrees = 150.0", "degrees = 0.0")],
         ["task.degrees: expected an angle other than 0, there is nothing to turn"]),
        ([("degrees = 150.0", "")], ["task.degrees: a required key is missing"]),
        ([("degrees = 150.0", "degrees = nan\nangle = 2.0")],
         ["task.degrees: expected a finite number, got nan",
          f"task.angle: unknown key; known here: {ROTATION_KEYS}"]),
        ([("degrees = 150.0", 'degrees = 150.0\ncontact = "thumb"')],
         [f"task.contact: unknown key; known here: {ROTATION_KEYS}"]),
        ([("friction = 0.6", "friction = 0.6\nforce = [1.0, 0.0]")],
         ["contacts[1].force: a required key is missing; others have it, so give it to all or none",
          "contacts[2].force: a required key is missing; others have it, so give it to all or none"]),
        ([("[load]", "[[load]]\ntime = 1.0\nforce = [0.0, -3.0]\n\n[[load]]\ntime = 0.0")],
         ["load: times of a load must rise from 0, two or more; got [1.0, 0.0]"]),
        ([("[load]", "[[load]]\ntime = 0.0\nforce = [0.0, -3.0]\n\n[[load]]\ntime = 1.0")],
         ["load: a rotation needs one load, [load], which turns as seen from the object"]),
        ([("duration = 2.0", "duration = -2.0"), ("rate = 500.0", "rate = 0")],
         ["task.duration: expected a number greater than 0, got -2.0",
          "task.rate: expected a number greater than 0, got 0"]),
        ([('scaling = "minimum_jerk"', 'scaling = "linear"\ncontrol = [1.0, 0.0]')],
         ["task: control belongs to scaling 'spline', got scaling 'linear'"]),
    ],
)  # fmt: skip
def test_bad_rotation(
    changes: list[tuple[str, str]], lines: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    check_bad(changed(TURN, *changes), lines, capsys, tmp_path)
