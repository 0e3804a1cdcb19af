"""A dozen plans of all kinds, every number, name, row and order in their files changed by little and by much.

``plan_truth`` decides from the JSON alone which changes make the file lie. Each lie is refused on reading or
does not verify; nothing true is called false.
"""

import copy
import json
import random
from collections import Counter
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from plan_truth import truth
from regrasp.files import read_plan, write_plan, write_setpoints
from regrasp.files.plans.setpoints import checked, read_setpoints

pytestmark = pytest.mark.oracle

GRASP = rg.Grasp(
    rg.Contact(r, n, 0.3, name=name)
    for name, r, n in (("P1", [-4, -4], [1, 1]), ("P2", [4, -5], [-1, 2]), ("P3", [0, 8], [0, -1]))
)
BALL = rg.Grasp(
    rg.Contact(p, [-x for x in p], 0.7)
    for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
)
LOAD, WEIGHT = rg.Wrench([-1.5, -3.5]), rg.Wrench([0, 0, -1.0])
ELLIPSE = rg.Outline.ellipse(2, 1)


def limited(grasp, most) -> rg.Grasp:
    return rg.Grasp(c.changed(max_force=most) for c in grasp)


def fingers(*places) -> rg.Grasp:
    return rg.Grasp(ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5) for s in places)


def swinging(t) -> rg.Wrench:
    return rg.Wrench([-1.5 + t, -3.5 - 2 * t * (1 - t)])


def plans():
    two, effort = GRASP.without("P3"), {"objective": "effort", "whole_objective": "effort"}
    yield "removal", rg.plan_removal(GRASP, "P3", load=LOAD)
    yield "on the edge", rg.plan_removal(GRASP, "P3", load=LOAD, **effort)
    yield "addition", rg.plan_addition(limited(two, 9.0), GRASP["P3"].changed(max_force=9.0), load=LOAD)
    yield "load in time", rg.plan_removal(GRASP, "P3", load=swinging, instants=5)
    yield (
        "rates",
        rg.plan_removal(GRASP, "P3", load=LOAD, rate_limit=10.0, min_normal=0.5, duration=1.0, instants=4),
    )
    yield "turn", rg.plan_rotation(two, 0.2, load=LOAD)
    yield "turn back", rg.plan_rotation(limited(two, 6.0), -0.2, load=LOAD)
    yield "turn with torque", rg.plan_rotation(two, 0.1, load=rg.Wrench([-1.5, -3.5], 0.5))
    yield "space", rg.plan_removal(BALL, "P4", load=WEIGHT)
    yield "turn in space", rg.plan_rotation(BALL, 0.5, axis=[1, 0, 0], load=WEIGHT)
    yield "tilt in space", rg.plan_rotation(BALL, -0.5, axis=[1, 0, 0.5], load=WEIGHT)
    yield "regrasp", rg.plan_regrasp(
        ELLIPSE, fingers(0.02, 0.35, 0.7), fingers(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]), friction=0.5,
        orientations=24, candidates=60, goal_orientation=pi / 6,
    )  # fmt: skip
    yield "regrasp in space", in_space()


def in_space() -> rg.RegraspPlan:
    """One finger leaves, the object turns in the others, and the finger comes back."""
    angle = 0.3
    away = rg.plan_removal(BALL, "P4", load=WEIGHT)
    turn = rg.plan_rotation(away.end.without("P4"), angle, axis=[1, 0, 0])
    back = rg.plan_addition(turn.end, BALL["P4"], load=turn.end.load)
    turned = [[1.0, 0, 0], [0, cos(angle), -sin(angle)], [0, sin(angle), cos(angle)]]
    margin = min(away.end.margins.least_angle, turn.end.margins.least_angle)
    rotations = np.array([np.eye(3), np.eye(3), turned, turned])
    return rg.RegraspPlan((away, turn, back), (0.0, 0.0, angle, angle), margin, rotations=rotations)


PLANS = dict(plans())
FACTORS = (
    1 + 2.0**-51,
    1 - 2.0**-50,
    1 + 1e-14,
    1 - 1e-13,
    1 + 1e-9,
    1 - 1e-9,
    1 + 1e-6,
    0.99,
    1.1,
    -1.0,
    0.0,
    1e3,
)
WORDS = ("removal", "addition", "exchange", "rotation", "start", "end", "angle", "x", "", "P1", "P2", "P9")


def places(data, place=()):
    """Keys of every value, whole tables and lists included."""
    if place:
        yield place
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield from places(value, (*place, key))


def changed(data, place, rng):
    """A copy of the document with the value at a place changed, and how."""
    data = copy.deepcopy(data)
    at = data
    for key in place[:-1]:
        at = at[key]
    key, value = place[-1], at[place[-1]]
    if isinstance(value, bool) or value is None:
        at[key] = rng.choice([1.0, "x", [], None])
    elif isinstance(value, (int, float)):
        at[key] = (
            value * rng.choice(FACTORS)
            if rng.random() < 0.8
            else value + rng.choice([1.0, -1.0, 1e-9, 1e-15])
        )
        if isinstance(value, int) and isinstance(at[key], float) and at[key].is_integer():
            at[key] = int(at[key])
    elif isinstance(value, str):
        at[key] = rng.choice(WORDS)
    elif isinstance(value, list) and value and rng.random() < 0.8:
        how = rng.choice(["drop", "twice", "swap", "turn"])
        k = rng.randrange(len(value))
        if how == "drop":
            del value[k]
        elif how == "twice":
            value.insert(k, copy.deepcopy(value[k]))
        elif how == "swap":
            j = rng.randrange(len(value))
            value[j], value[k] = value[k], value[j]
        else:
            value.reverse()
    elif isinstance(at, dict):
        del at[key]
    else:
        at[key] = None
    return data


@pytest.mark.parametrize("name", PLANS)
def test_every_change_that_makes_a_plan_lie_is_caught(name, tmp_path: Path) -> None:
    file, rng, seen = tmp_path / "plan.json", random.Random(name), Counter()
    write_plan(PLANS[name], file)
    document = json.loads(file.read_text(encoding="utf-8"))
    assert truth(document) is True
    assert rg.verify(read_plan(file)).ok
    every = list(places(document))
    chosen = [place for place in every if len(every) <= 150 or rng.random() < 150 / len(every)]
    for place in chosen:
        for _ in range(2):
            other = changed(document, place, rng)
            if place[-1] in ("format", "version") or other == document:
                continue
            expected = truth(other)
            file.write_text(json.dumps(other), encoding="utf-8")
            try:
                found = rg.verify(read_plan(file)).ok
            except rg.InvalidInput:
                found = False
            seen[expected] += 1
            assert expected is None or found == expected, (place, at(document, place), at(other, place))
    assert seen[True] >= 5
    assert seen[False] >= 50
    assert seen[None] <= 0.05 * sum(seen.values())


def at(data, place):
    """The value at a place, or None where there is none."""
    for key in place:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return None
    return data


@pytest.mark.parametrize("name", PLANS)
def test_every_change_of_a_set_point_is_judged_by_its_size(name, tmp_path: Path) -> None:
    """Twenty numbers of the rows: by a part in 1e14, which is rounding, and by a part in 1e8 or more."""
    plan, file, rng = PLANS[name], tmp_path / "setpoints.csv", random.Random(name)
    write_setpoints(plan, file, 8.0)
    header, *rows = file.read_text(encoding="utf-8").splitlines()
    table = [[float(x) for x in row.split(",")] for row in rows]

    def verifies(change) -> bool:
        file.write_text("\n".join([header, *(",".join(map(repr, row)) for row in change)]), encoding="utf-8")
        try:
            return all(checked(plan, rows).ok for rows in read_setpoints(file, plan))
        except rg.InvalidInput:
            return False

    assert verifies(table)
    for _ in range(10):
        k, column = rng.randrange(len(table)), rng.randrange(len(header.split(",")))
        size = max(abs(row[column]) for row in table) or 1.0
        if size > 1e-9:
            other = copy.deepcopy(table)
            other[k][column] += rng.choice([-1, 1]) * size * rng.choice([1e-8, 1e-6, 0.1, 100.0])
            assert not verifies(other), (k, header.split(",")[column])
        forces = [i for i, title in enumerate(header.split(",")) if "_f" in title and abs(table[k][i]) > 1e-9]
        other = copy.deepcopy(table)
        other[k][rng.choice(forces)] *= 1 + rng.choice([-1e-14, 1e-14])
        assert verifies(other), k


def test_there_are_enough_changes(tmp_path: Path) -> None:
    count = 0
    for plan in PLANS.values():
        write_plan(plan, tmp_path / "plan.json")
        data = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
        count += 2 * min(150, len(list(places(data)))) + 20
    assert count > 2500
