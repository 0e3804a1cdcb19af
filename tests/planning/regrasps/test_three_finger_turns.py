"""All fingers turn the object before one leaves and after the last arrives: steps, and no moves."""

import numpy as np
import pytest

import regrasp as rg
from box import BOX, GOAL, MU, WEIGHT, on_box

pytestmark = pytest.mark.laws

ELLIPSE = rg.Outline.ellipse(2, 1)
DOWN = rg.Wrench([0, -3.0])


def grasp_on(places, prefix):
    return rg.Grasp(
        ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.25, name=f"{prefix}{i}")
        for i, s in enumerate(places, 1)
    )


TIGHT, FREE = grasp_on((0.00709, 0.27405, 0.64572), "A"), grasp_on((0.2, 0.5, 0.85), "B")


def pairs_that_hold(grasp, angle):
    held = []
    for name in grasp.names:
        try:
            rg.choose_state(grasp.without(name), DOWN.rotated(-angle))
        except rg.Infeasible:
            continue
        held.append(name)
    return held


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("orientations", [24, 72])
def test_three_fingers_turn_before_one_leaves(back, orientations):
    assert pairs_that_hold(TIGHT, 0.0) == []  # none of its fingers can leave where it is
    start, goal = (FREE, TIGHT) if back else (TIGHT, FREE)
    options = {"friction": 0.25, "orientations": orientations, "max_turn": 1.0}
    plan = rg.plan_regrasp(ELLIPSE, start, goal, DOWN, **options)
    assert rg.verify(plan).ok
    assert rg.verify(plan.reversed()).ok
    turns = [k for k, s in enumerate(plan.steps) if not s.leaving and not s.arriving]
    assert len(turns) >= 1
    assert all(len(plan.steps[k].grasp) == 3 for k in turns)  # all of them hold
    assert len(plan.moves) == 3
    assert abs(np.diff(plan.orientations)).max() <= 1.0 + 1e-9


def test_without_turning_no_finger_can_leave():
    with pytest.raises(rg.Infeasible, match=r"no two fingers of the start hold the load at 0 deg, so none"):
        rg.plan_regrasp(ELLIPSE, TIGHT, FREE, DOWN, friction=0.25, orientations=1)
    with pytest.raises(rg.Infeasible, match=r"at 0 deg, nor at any of 5 others that all three may turn"):
        rg.plan_regrasp(ELLIPSE, TIGHT, FREE, DOWN, friction=0.25, orientations=6, min_distance=9.0)


def test_turns_between_take_several_steps_of_all_three():
    small = rg.plan_regrasp(ELLIPSE, FREE, grasp_on((0.1, 0.4, 0.7), "C"), DOWN, friction=0.25, max_turn=0.3)
    assert abs(np.diff(small.orientations)).max() <= 0.3 + 1e-9
    assert rg.verify(small).ok


def test_four_fingers_turn_in_space():
    tight = on_box(
        (-0.0251, -0.02, 0.0131), (0.0169, -0.0059, 0.025), (-0.03, 0.0178, -0.0208), (0.03, 0.0154, 0.0156)
    )
    for name in tight.names:
        with pytest.raises(rg.RegraspError):
            rg.choose_state(tight.without(name), WEIGHT, "effort")
    plan = rg.plan_regrasp(BOX, tight, GOAL, WEIGHT, friction=MU, candidates=12, max_turn=1.5)
    assert rg.verify(plan).ok
    first = plan.steps[0]
    assert not first.leaving
    assert len(first.grasp) == 4
    assert first.turn is not None
    assert len(plan.moves) == 4
    with pytest.raises(rg.Infeasible, match="no three fingers of the start hold the load there"):
        rg.plan_regrasp(BOX, tight, GOAL, WEIGHT, friction=MU, candidates=12, orientations=1)


def test_holds_half_a_turn_apart_follow_one_another():
    """Where all orientations but six are left out, the widest way turns by half a turn between two holds."""
    places = (0.43436173, 0.45102840, 0.20102840, 0.91769507, 0.78436173, 0.16769507)
    outline = rg.Outline([[0, 0], [3, 0], [4, 2], [1, 3], [-1, 1]])
    length = outline.length
    contacts = [outline.contact_at(s * length, friction=0.6) for s in places]
    plan = rg.plan_regrasp(
        outline, rg.Grasp(contacts[:3]), rg.Grasp(contacts[3:]), rg.Wrench([-1.973813, -2.0]), friction=0.6,
        orientations=6, goal_orientation=5 * np.pi / 3, candidates=[places[0] * length], min_normal=0,
        peak_ratio=1e9,
    )  # fmt: skip
    assert rg.verify(plan).ok
    assert (len(plan.moves), len(plan.steps)) == (3, 5)
    assert plan.margin == pytest.approx(0.421297, abs=2e-6)  # 0.2874 with turns of less alone
