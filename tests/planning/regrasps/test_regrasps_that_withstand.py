"""Regrasps whose states and steps withstand a set, and keep linear limits, in the plane and in space."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.regrasps.kept_holds import kept_pairs

pytestmark = pytest.mark.laws

OUTLINE = rg.Outline([[0, 0], [3, 0], [3, 2.2], [0, 2.1]])
BOX, WEIGHT = rg.Mesh.box(2, 1.5, 1), rg.Wrench([0, -3.0])
SET = rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.2, torque=0.2)
PADS = rg.ForceLimits([[1, 0], [0, 1], [0, -1]], [16.0, 6.0, 6.0])


def grasp(*shares):
    return rg.Grasp(OUTLINE.contact_at(s * OUTLINE.length, friction=0.5) for s in shares)


ENDS = grasp(0.02, 0.35, 0.7), grasp(0.2, 0.5, 0.85)


def planar(**asked):
    return rg.plan_regrasp(OUTLINE, *ENDS, WEIGHT, friction=0.5, **{"candidates": 40, **asked})


@pytest.mark.parametrize(
    "asked",
    [
        {"orientations": 1},
        {"goal_orientation": 1.0, "objective": "force"},
        {"states": "joint"},
        {"stiffness": [[1.0, 2.0], [2.0, 1.0], [9.0, 4.0]], "objective": "effort"},
        {"objective": rg.Criteria("force", disturbance=SET, stiffness=[5.0, 1.0, 1.0], max_force=25.0)},
        {"limits": PADS, "states": "joint", "max_force": 18.0},
    ],
)
def test_every_step_withstands_the_set(asked):
    given = asked if isinstance(asked.get("objective"), rg.Criteria) else {"disturbance": SET, **asked}
    plan = planar(**given)
    springs = asked.get("stiffness", [5.0, 1.0, 1.0] if given is asked else None)
    assert rg.verify(plan).ok
    assert rg.verify(plan, disturbance=SET, stiffness=springs).ok
    assert not rg.verify(plan, disturbance=SET.scaled(40), stiffness=springs).ok
    assert all(not (step.leaving and step.arriving) for step in plan.steps)
    if "limits" in asked:
        names = [c for step in plan.steps for c in step.grasp]
        assert all(c.limits == PADS for c in names)


def test_stiffness_goes_with_the_finger():
    """The set is withstood with one finger stiffer than others, and not with another one."""
    loads = SET.scaled(3.5)
    stiff = [1.0, 1.0, 8.0]
    plan = planar(disturbance=loads, stiffness=stiff, orientations=1)
    assert rg.verify(plan, disturbance=loads, stiffness=stiff).ok
    moved = {move.finger for move in plan.moves}
    assert moved == {0, 1, 2}
    others = [np.roll(stiff, k) for k in (1, 2)]
    assert all(not rg.verify(plan, disturbance=loads, stiffness=other).ok for other in others)
    with pytest.raises(rg.InvalidInput, match="a row for each of 3 fingers"):
        planar(disturbance=loads, stiffness=[1.0, 2.0])
    with pytest.raises(rg.InvalidInput, match="a row for each of 3 fingers"):
        rg.verify(plan, disturbance=loads, stiffness=[1.0, 2.0])


def test_early_loss_is_withstood_too():
    plain, safe = (planar(disturbance=SET, early_loss=early, orientations=1) for early in (False, True))
    assert rg.verify(safe, disturbance=SET, early_loss=True).ok
    assert not rg.verify(plain, disturbance=SET, early_loss=True).ok


@pytest.mark.parametrize(
    "asked",
    [
        {"disturbance": SET.scaled(2)},
        {"limits": rg.ForceLimits([[1, 0], [0, 1]], [3.0, 1.0])},
        {"disturbance": rg.LoadSet.hull([rg.Wrench([0, 0], t) for t in (-0.4, 0.0, 0.4)]), "limits": PADS},
    ],
)
def test_pairs_are_judged_as_states_are(asked):
    problem = rg.RegraspProblem(OUTLINE, *ENDS, WEIGHT, friction=0.5, orientations=5, candidates=9, **asked)
    said, graph = kept_pairs(problem, problem.graph), problem.graph
    rng, agreed = np.random.default_rng(3), {True: 0, False: 0}
    for p, o in zip(rng.integers(0, len(said), 50), rng.integers(0, 5, 50), strict=True):
        i, j = (int(ends[p]) for ends in graph.pairs)
        two = rg.Grasp([problem.contacts[i], problem.contacts[j]])
        load = problem.setting.seen(problem.setting.orientations[o])
        more = {"disturbance": asked["disturbance"]} if "disturbance" in asked else {}
        try:
            rg.choose_state(two, load, "effort", **more)
            held = True
        except (rg.Infeasible, rg.InvalidInput):  # at one point, nothing answers
            held = False
        assert bool(said[p, o]) == held
        agreed[held] += 1
    assert min(agreed.values()) >= 2


def test_what_is_refused_says_so():
    with pytest.raises(rg.Infeasible, match="withstand the disturbance"):
        planar(disturbance=SET.scaled(16), orientations=1)
    with pytest.raises(rg.InvalidInput, match="must hold the deviation zero"):
        planar(disturbance=rg.LoadSet.hull([rg.Wrench([0.1, 0])]))
    with pytest.raises(rg.InvalidInput, match="leave controlled out"):
        planar(objective=rg.Criteria("force", disturbance=SET, controlled=[0]))
    with pytest.raises(rg.InvalidInput, match="limits must be a ForceLimits"):
        planar(limits=[[1, 0]])


def on_box(*points):
    centre = BOX.centre_of_mass
    return rg.Grasp(BOX.contact_at(np.array(p, float) + centre, friction=0.6) for p in points)


@pytest.mark.parametrize("states", ["each", "joint"])
def test_regrasps_in_space_withstand(states):
    start = on_box((1, 0.1, 0.1), (-1, 0.1, 0), (0.1, 0.75, 0.1), (0, -0.75, 0.1))
    goal = on_box((1, -0.3, -0.1), (-1, 0.2, 0.1), (-0.3, 0.75, 0.1), (-0.1, -0.75, -0.1))
    c, s = np.cos(0.5), np.sin(0.5)
    turn = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    loads = rg.LoadSet.ball(rg.Wrench([0, 0, 0]), force=0.4, torque=0.4)
    pads = rg.ForceLimits([[1, 0, 0], [0, 1, 0], [0, 0, -1]], [40.0, 15.0, 15.0])
    springs = [1.0, 2.0, 3.0, 4.0]
    plan = rg.plan_regrasp(
        BOX, start, goal, rg.Wrench([0, 0, -2.0]), friction=0.6, disturbance=loads, stiffness=springs,
        limits=pads, states=states, goal_rotation=turn, orientations=6, candidates=12,
    )  # fmt: skip
    assert rg.verify(plan, disturbance=loads, stiffness=springs).ok
    assert not rg.verify(plan, disturbance=loads.scaled(40), stiffness=springs).ok
    assert {contact.limits for step in plan.steps for contact in step.grasp} == {pads}
    assert all(not (step.leaving and step.arriving) for step in plan.steps)
