"""Regrasps of which an end is left open, against those between every two grasps."""

from itertools import combinations
from math import pi

import numpy as np
import pytest

import regrasp as rg
from box import BOX, GOAL, MU, WEIGHT
from box import START as FOUR
from refusals import refusal
from regrasp.planning.placement import choosing

pytestmark = pytest.mark.laws

ELLIPSE = rg.Outline.ellipse(2, 1)
LOAD = rg.Wrench([0, -3])
OPTIONS = {"friction": 0.5, "candidates": 16, "orientations": 1}


def grasp(*shares: float) -> rg.Grasp:
    return rg.Grasp(ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5, name=f"{s:g}") for s in shares)


START = grasp(0.1, 0.45, 0.8)
GOALS = [grasp(0.2, 0.55, 0.9), grasp(0.1, 0.4, 0.7), grasp(0.1, 0.45, 0.7)]


def rank(plan: rg.RegraspPlan) -> tuple[int, float]:
    return len(plan.moves), -plan.margin


def test_of_several_goals_the_one_of_fewest_moves_and_widest_margin_is_taken() -> None:
    each = [rg.plan_regrasp(ELLIPSE, START, goal, LOAD, **OPTIONS) for goal in GOALS]  # type: ignore[arg-type]
    assert len({rank(plan) for plan in each}) > 1
    found = rg.plan_regrasp(ELLIPSE, START, GOALS, LOAD, **OPTIONS)  # type: ignore[arg-type]
    assert found == min(each, key=rank)


def test_a_torque_is_refused_before_an_end_is_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choosing, "choose_grasp", None)
    for load in rg.Wrench([0, -3], 0.1), rg.Wrench([0, 0]):
        said = refusal(lambda load=load: rg.plan_regrasp(ELLIPSE, START, None, load, **OPTIONS))  # type: ignore[arg-type, misc]
        assert "a force through the centre of mass" in str(said)


def test_of_several_starts_too_and_those_without_a_way_do_not_count() -> None:
    found = rg.plan_regrasp(ELLIPSE, [*GOALS, START], START, LOAD, **OPTIONS)  # type: ignore[arg-type]
    assert len(found.moves) == 0
    impossible = {**OPTIONS, "least_margin": 0.44}
    with pytest.raises(rg.Infeasible) as one:
        rg.plan_regrasp(ELLIPSE, START, GOALS[0], LOAD, **impossible)  # type: ignore[arg-type]
    with pytest.raises(rg.Infeasible) as three:
        rg.plan_regrasp(ELLIPSE, START, GOALS, LOAD, **impossible)  # type: ignore[arg-type]
    assert str(three.value) == f"{one.value}; nor for 2 other pairs of grasps"


@pytest.mark.parametrize("angle", [0.0, pi / 2])
def test_a_goal_left_out_is_chosen_and_holds_in_the_orientation_asked_for(angle: float) -> None:
    found = rg.plan_regrasp(ELLIPSE, START, None, LOAD, friction=0.5, goal_orientation=angle)
    assert rg.verify(found).ok
    assert float(found.orientation(found.duration)) % (2 * pi) == pytest.approx(angle)
    last = found.steps[-1].end
    assert len([f for f in last.forces if f.any()]) >= 2
    assert last.load.force == pytest.approx(LOAD.rotated(-angle).force)


@pytest.mark.parametrize("apart", [0.0, 1.8])
def test_a_goal_that_is_chosen_keeps_its_distance(apart: float) -> None:
    plan = rg.plan_regrasp(ELLIPSE, START, None, LOAD, friction=0.5, candidates=16, min_distance=apart)
    least = min(np.linalg.norm(p - q) for p, q in combinations(plan.steps[-1].grasp.positions[-3:], 2))
    assert (least >= 1.8 - 1e-9) == (apart > 0)


def test_a_goal_that_is_chosen_is_as_far_apart_as_it_must_be_and_on_the_arcs_of_the_fingers() -> None:
    length, asked = ELLIPSE.length, []

    def apart(p: np.ndarray, q: np.ndarray, angle: float) -> np.ndarray:
        asked.append(angle)
        return np.hypot(*(p - q).T) > 1.5

    def goal(**more: object) -> list[rg.Contact]:
        plan = rg.plan_regrasp(ELLIPSE, START, None, LOAD, friction=0.5, candidates=16, **more)  # type: ignore[arg-type]
        return list(plan.steps[-1].grasp)[-3:]

    free, near = goal(goal_orientation=pi / 2), goal(goal_orientation=pi / 2, keep=apart)
    assert [
        all(np.hypot(*(a.position - b.position)) > 1.5 for a, b in combinations(g, 2)) for g in (free, near)
    ] == [False, True]
    assert pi / 2 in asked
    arcs = [(-0.1 * length, 0.3 * length), (0.3 * length, 0.55 * length), (0.7 * length, 0.9 * length)]
    shares = sorted(ELLIPSE.nearest(c.position) / length % 1 for c in goal(arcs=arcs))
    low, middle, high = sorted((s + 0.1) % 1 - 0.1 for s in shares)
    assert low <= 0.3 <= middle <= 0.55
    assert 0.7 <= high <= 0.9


def test_fingers_move_through_the_air_to_the_goal_that_is_taken() -> None:
    found = rg.plan_regrasp(
        ELLIPSE,
        START,
        GOALS[1:],
        LOAD,
        motions=True,
        tip_radius=0.05,
        clearance=0.02,
        **OPTIONS,  # type: ignore[arg-type]
    )
    assert (
        rank(found.plan)
        == min(
            rank(rg.plan_regrasp(ELLIPSE, START, goal, LOAD, min_distance=0.12, **OPTIONS))  # type: ignore[arg-type]
            for goal in GOALS[1:]
        )
    )


IN_SPACE = {"friction": MU, "orientations": 12, "candidates": 16}


def test_on_a_mesh_three_fingers_of_least_force_and_a_fourth_are_the_goal() -> None:
    c, s = np.cos(1.2), np.sin(1.2)
    turned = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    plan = rg.plan_regrasp(BOX, FOUR, None, WEIGHT, goal_rotation=turned, **IN_SPACE)  # type: ignore[arg-type]
    assert rg.verify(plan).ok
    assert plan.rotation(plan.duration) == pytest.approx(turned, abs=1e-9)
    seen = rg.Wrench(turned.T @ WEIGHT.force)
    best = rg.choose_grasp(BOX, 3, seen, friction=MU, objective="peak", tolerance=0.01)
    last = plan.steps[-1].grasp
    three = rg.Grasp(c for c in last if not (c.name or "").endswith("F4"))
    assert rg.choose_state(three, seen, "peak").value <= 2 * best.value
    assert rg.choose_state(last, seen, "peak").value <= rg.choose_state(three, seen, "peak").value + 1e-9
    assert all(
        BOX.contact_at(c.position + BOX.centre_of_mass, friction=MU).normal @ c.normal > 0.99 for c in last
    )


def test_on_a_mesh_a_start_is_chosen_and_a_goal_that_is_the_start_needs_no_move() -> None:
    plan = rg.plan_regrasp(BOX, None, GOAL, WEIGHT, **IN_SPACE)  # type: ignore[arg-type]
    assert rg.verify(plan).ok
    assert len(plan.steps[0].grasp) == 4
    stays = rg.plan_regrasp(BOX, FOUR, [GOAL, FOUR], WEIGHT, **IN_SPACE)  # type: ignore[arg-type]
    assert len(stays.moves) == 0


def test_open_ends_that_mean_nothing_are_refused() -> None:
    box = rg.Mesh.box(1, 1, 1)
    for given, words in (
        ({"goal": []}, "goal must be a Grasp, several of them, or None for any; got []"),
        ({"goal": [START, 3]}, "goal must be a Grasp, several of them"),
        ({"start": "any"}, "start must be a Grasp, several of them"),
        ({"goal": None, "weights": rg.RegraspWeights()}, "give one start and one goal"),
        ({"goal": [START] * 101}, "1 starts and 101 goals are more than 100 pairs"),
        (
            {"outline": BOX, "start": FOUR, "goal": None, "keep": print, "arcs": [None] * 4},
            "keep and arcs cannot",
        ),
        ({"goal": None, "arcs": [None] * 2}, "arcs must have an entry for each of three fingers"),
        ({"goal": None, "goal_orientation": "up"}, "goal_orientation must be a number, got 'up'"),
        ({"goal": None, "goal_orientation": float("nan")}, "goal_orientation must be finite, got nan"),
        ({"goal": None, "goal_orientation": 1.0, "load": "down"}, "load must be a Wrench or a LoadSet, got"),
        ({"goal": None, "keep": "left"}, "keep must be a function of first points, second points"),
        ({"outline": box, "goal": None}, "the shape is in space and load in the plane"),
    ):
        call = {"outline": ELLIPSE, "start": START, "goal": START, "load": LOAD, **OPTIONS, **given}
        assert words in str(refusal(lambda call=call: rg.plan_regrasp(**call)))  # type: ignore[misc]
