"""Regrasps are planned with the ways of their fingers, and others are taken where the best has none."""

import numpy as np
import pytest

import regrasp as rg
from motion_checks import star
from regrasp.motions import ShutIn, plan_motions

pytestmark = pytest.mark.laws

LOAD = rg.Wrench([0, -1.0])
AIR = {"tip_radius": 0.003, "clearance": 0.002}
WITH = {"motions": True, **AIR}
OPTIONS = {"friction": 0.9, "candidates": 30, "orientations": 1}
SLOT = rg.Outline(
    [[0, 0], [0.1, 0], [0.1, 0.06], [0.054, 0.06], [0.054, 0.02], [0.046, 0.02], [0.046, 0.06], [0, 0.06]]
)


def ends(outline: rg.Outline, seed: int) -> tuple[rg.Grasp, rg.Grasp]:
    rng = np.random.default_rng(seed)
    start, goal = (
        rg.Grasp(outline.contact_at(x * outline.length, friction=0.9) for x in rng.uniform(size=3))
        for _ in range(2)
    )
    return start, goal


def test_where_the_best_sequence_has_no_ways_the_next_is_taken() -> None:
    outline = star()
    start, goal = ends(outline, 21)
    best = rg.plan_regrasp(outline, start, goal, LOAD, **OPTIONS)
    with pytest.raises(rg.Infeasible, match="before step 2 finger 3 finds no way") as caught:
        plan_motions(best, outline, **AIR)
    found = caught.value.certificate
    assert isinstance(found, ShutIn)
    assert (found.step, found.finger, found.alone) == (1, 2, False)
    assert len(found.held) == 2
    motions = rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **OPTIONS)
    plan = motions.plan
    assert isinstance(plan, rg.RegraspPlan)
    assert rg.verify(plan).ok
    assert len(plan.moves) >= len(best.moves)
    assert plan_motions(plan, outline, **AIR) == motions
    assert motions.touching(np.linspace(0, motions.duration, 500)).sum(axis=1).min() >= 2


def test_where_the_best_has_ways_it_is_taken() -> None:
    ellipse = rg.Outline.ellipse(0.04, 0.02)
    start, goal = (
        rg.Grasp(ellipse.contact_at(p * ellipse.length, friction=0.5) for p in places)
        for places in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    options = {"friction": 0.5, "min_distance": 0.008}
    motions = rg.plan_regrasp(ellipse, start, goal, LOAD, **WITH, **options)
    assert motions.plan == rg.plan_regrasp(ellipse, start, goal, LOAD, **options)


def test_what_is_shut_in_for_good_is_said_at_once() -> None:
    """A finger that starts in a slot too narrow for it, whatever comes after."""
    start, goal = ends(SLOT, 0)
    said = r"a tip of radius 0\.003 is shut in at start P1, \(.*\): along .* gets no clearance of 0\.002$"
    with pytest.raises(rg.Infeasible, match=said):
        rg.plan_regrasp(SLOT, start, goal, LOAD, **WITH, **OPTIONS)


def test_where_none_has_ways_the_first_reason_is_given() -> None:
    outline = star()
    start, goal = ends(outline, 41)
    options = OPTIONS | {"candidates": 6}
    said = "before step 4 finger 3 finds no way .* at goal P2, .* the tip of finger 1 is too near; "
    none = "2 sequences were tried, and none has ways; without such moves no sequence of holds leads"
    with pytest.raises(rg.Infeasible, match=said + none) as caught:
        rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **options)
    assert caught.value.certificate.near in caught.value.certificate.held
    with pytest.raises(
        rg.Infeasible, match="; 1 sequences were tried, and none has ways; give more attempts"
    ):
        rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **options, attempts=1)


def test_two_that_are_in_one_another_are_in_no_stance_together() -> None:
    outline = star()
    start, goal = ends(outline, 40)
    with pytest.raises(rg.Infeasible, match=r"during step 2 fingers 2 and 3 .* are in one another"):
        rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **OPTIONS, attempts=1)
    assert rg.verify(rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **OPTIONS).plan).ok


def test_only_the_move_without_way_is_left_out() -> None:
    """Without the hold meanwhile there is no regrasp; with other holds before or after it there is."""
    outline = star()
    start, goal = ends(outline, 33)
    best = rg.plan_regrasp(outline, start, goal, LOAD, **OPTIONS)
    with pytest.raises(rg.Infeasible, match="before step 3 finger 1 finds no way") as caught:
        plan_motions(best, outline, **AIR)
    motions = rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **OPTIONS)
    assert rg.verify(motions.plan).ok
    held = set(caught.value.certificate.held)
    assert any(held <= set(step.grasp.names) for step in motions.plan.steps)


def test_what_is_of_ways_alone_needs_motions() -> None:
    start, goal = ends(star(), 21)
    with pytest.raises(rg.InvalidInput, match="tip_radius is of ways through the air; give motions=True"):
        rg.plan_regrasp(star(), start, goal, LOAD, **AIR, **OPTIONS)
    with pytest.raises(rg.InvalidInput, match="motions=True needs tip_radius and clearance"):
        rg.plan_regrasp(star(), start, goal, LOAD, motions=True, **OPTIONS)
    with pytest.raises(rg.InvalidInput, match="motions must be True or False, got 1"):
        rg.plan_regrasp(star(), start, goal, LOAD, motions=1, **OPTIONS)


def test_the_callers_own_rule_is_kept_too() -> None:
    outline = star()
    start, goal = ends(outline, 21)

    def never(p: np.ndarray, q: np.ndarray, angle: float) -> np.ndarray:
        return np.zeros(len(p), dtype=bool)

    with pytest.raises(rg.Infeasible, match="keep"):
        rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **OPTIONS, keep=never)
    with pytest.raises(rg.InvalidInput, match="attempts must be a whole number of at least 1, got 0"):
        rg.plan_regrasp(outline, start, goal, LOAD, **WITH, **OPTIONS, attempts=0)
