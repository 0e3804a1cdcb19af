"""Plans that withstand a set: verified exactly, refused with a member that breaks them, judged by others."""

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD, STATE
from regrasp.plans.record import Record
from robust import answers, grasp_matrix, random_stiffness, slack, worst_slack
from space import random_grasp, random_load
from strategies import comfortable_pair, comfortable_triple
from values import WEIGHT, removal, shaken, space_grasp

pytestmark = pytest.mark.oracle

NONE, STILL = rg.Wrench([0, 0]), rg.Wrench([0, 0, 0])
SMALL = rg.LoadSet.ball(NONE, force=0.1, torque=0.4)
UNEVEN = [[1000, 400], [700, 800], [900, 100]]


def held(state: rg.GraspState) -> rg.Transition:
    """A plan that stays at one state."""
    return rg.Transition(state, state, rg.TimeScaling.spline(1.0), Record(0.0))


def limited(grasp: rg.Grasp, limit: float) -> rg.Grasp:
    return rg.Grasp(c.changed(max_force=limit) for c in grasp)


def cases(count: int, seed: int):
    """Grasps with states for ``wrench``, their sets, stiffness and widest factors."""
    rng = np.random.default_rng(seed)
    while count:
        in_plane, soft = rng.random() < 0.6, rng.random() < 0.2
        if in_plane:
            grasp, load = comfortable_pair(rng) if rng.random() < 0.5 else comfortable_triple(rng)
        else:
            grasp, load = random_grasp(rng, 4, 0.7), random_load(rng)
            grasp = rg.Grasp(c.changed(torsion=0.1) for c in grasp) if soft else grasp
        center = NONE if in_plane else STILL
        stiffness = random_stiffness(rng, len(grasp), grasp.is_soft)
        kind = rng.integers(3)
        if kind == 0:
            loads = rg.LoadSet.ball(center, force=1.0, torque=0.5)
        elif kind == 1:
            spread = rng.normal(size=(5, center.vector.size))
            loads = rg.LoadSet.hull([rg.Wrench.from_vector(w) for w in spread], center=center)
        else:
            size = center.vector.size
            loads = rg.LoadSet.ellipsoid(center, rng.normal(size=(size, int(rng.integers(1, size)))))
        try:
            limit = 4 * rg.choose_state(grasp, load, "peak").value
            state = rg.choose_state(
                limited(grasp, limit), load, "wrench", disturbance=loads, stiffness=stiffness
            )
        except rg.Infeasible:
            continue
        if state.value < 1e-3:
            continue
        count -= 1
        yield state, loads, stiffness


def test_a_thousandth_less_is_withstood_and_a_thousandth_more_has_a_witness() -> None:
    rng, refuted = np.random.default_rng(0), 0
    for state, loads, stiffness in cases(40, seed=1):
        plan, change = held(state), answers(state.grasp, stiffness)
        inside, outside = loads.scaled(0.999 * state.value), loads.scaled(1.001 * state.value)
        found = rg.verify(plan, disturbance=inside, stiffness=stiffness)
        assert found.ok, str(found)
        members = np.array([inside.extreme(y).vector for y in rng.normal(size=(200, len(change.T)))])
        assert worst_slack(state.grasp, state.forces, change, members) > 0
        beyond = rg.verify(plan, disturbance=outside, stiffness=stiffness)
        assert not beyond.ok
        assert "it is not proven" not in str(beyond)
        refuted += 1
    assert refuted == 40


def test_witnesses_break_what_they_are_said_to_break() -> None:
    for state, loads, stiffness in cases(12, seed=2):
        outside = loads.scaled(1.001 * state.value)
        violation = rg.verify(held(state), disturbance=outside, stiffness=stiffness).violations[0]
        words = violation.split("under the deviation ")[1]
        member = eval(words, {"Wrench": rg.Wrench})  # printed to six digits
        if outside.vertices is not None:
            assert abs(outside.vertices - member.vector).max(axis=1).min() < 1e-4
        elif np.linalg.matrix_rank(outside.half_axes) == len(member.vector):  # no six digits lie in a plane
            assert outside.scaled(1 + 1e-4).contains(member)
        change = answers(state.grasp, stiffness)
        assert worst_slack(state.grasp, state.forces, change, member.vector[None]) < 1e-4


@pytest.mark.parametrize("stiffness", [None, UNEVEN])
@pytest.mark.parametrize("early", [False, True])
def test_a_removal_withstands_its_set_at_every_instant(stiffness, early: bool) -> None:
    plan = rg.plan_removal(
        GRASP, "P3", load=LOAD, disturbance=SMALL, stiffness=stiffness, max_force=20.0, early_loss=early
    )
    asked = {"disturbance": SMALL, "stiffness": stiffness}
    assert rg.verify(plan, early_loss=early, **asked).ok
    assert not rg.verify(plan, disturbance=SMALL.scaled(9), stiffness=stiffness).ok
    assert not rg.verify(rg.plan_removal(GRASP, "P3", load=LOAD, max_force=20.0), early_loss=True, **asked).ok
    rng = np.random.default_rng(0)
    members = np.array([SMALL.extreme(y).vector for y in rng.normal(size=(100, 3))])
    staying = answers(plan.grasp, stiffness, (2,))
    for t in np.linspace(0, 1, 11):
        forces = plan.forces(t)
        assert worst_slack(plan.grasp, forces, staying, members) >= 0
        if early:
            lost = forces.ravel() - staying @ (grasp_matrix(plan.grasp)[:, 4:] @ forces[2])
            after = (lost + members @ staying.T).reshape(len(members), 3, 2)
            assert min(slack(c, f) for i, c in enumerate(plan.grasp) if i < 2 for f in after[:, i]) >= 0
    assert worst_slack(plan.grasp, plan.start.forces, answers(plan.grasp, stiffness), members) >= 0


def test_an_early_loss_alone_is_planned_for() -> None:
    """Without a set, too: the option is no word that nothing listens to."""
    plan = rg.plan_removal(GRASP, "P3", load=LOAD, early_loss=True)
    assert rg.verify(plan, early_loss=True).ok
    assert rg.verify(plan.reversed(), early_loss=True).ok
    assert not rg.verify(rg.plan_removal(GRASP, "P3", load=LOAD), early_loss=True).ok
    with pytest.raises(rg.Infeasible, match="the early loss of a finger"):
        rg.plan_removal(GRASP, "P3", load=LOAD, early_loss=True, min_normal=2.5, max_force=4.2)


def test_the_removal_of_the_paper_does_not_survive_an_early_loss() -> None:
    plan = rg.plan_removal(STATE, "P3")
    found = rg.verify(plan, early_loss=True)
    assert any("P3 lost: force of P1 leaves its friction cone" in v for v in found.violations)


def test_additions_exchanges_turns_and_bent_paths_withstand_theirs() -> None:
    kept = {"disturbance": SMALL, "max_force": 20.0}
    two = GRASP.without("P3")
    plans = [
        rg.plan_addition(two, GRASP["P3"], load=LOAD, **kept),
        rg.plan_exchange(GRASP, "P3", rg.Contact([1, 8], [0, -1], 0.3), load=LOAD, **kept),
        rg.plan_rotation(GRASP, 2.4, load=LOAD, **kept),
        rg.plan_removal(GRASP, "P3", load=shaken, instants=11, **kept),
    ]
    for plan in plans:
        assert rg.verify(plan, disturbance=SMALL).ok, plan.kind
        assert not rg.verify(plan, disturbance=SMALL.scaled(30)).ok
    space = rg.plan_removal(
        space_grasp(),
        3,
        load=WEIGHT,
        disturbance=rg.LoadSet.ball(STILL, force=0.1, torque=0.01),
        max_force=20.0,
    )
    assert rg.verify(space, disturbance=rg.LoadSet.ball(STILL, force=0.1, torque=0.01)).ok


def test_a_turn_takes_sets_with_zero_only() -> None:
    away = rg.LoadSet.hull([rg.Wrench([0.1, 0]), rg.Wrench([0.1, 0.1])])
    with pytest.raises(rg.InvalidInput, match="must hold the deviation zero"):
        rg.plan_rotation(GRASP, 0.4, load=LOAD, disturbance=away)
    with pytest.raises(rg.InvalidInput, match="must hold the deviation zero"):
        rg.verify(rg.plan_rotation(GRASP, 0.4, load=LOAD), disturbance=away)


def test_given_states_are_refused_where_they_do_not_withstand_the_set() -> None:
    slippery = rg.choose_state(GRASP, LOAD, "effort")
    with pytest.raises(rg.InvalidInput, match="start: the forces do not withstand the disturbance"):
        rg.plan_removal(slippery, "P3", disturbance=SMALL, max_force=20.0)


def test_friction_is_judged_by_its_factor() -> None:
    plan = removal()
    needed = plan.friction_needed / 0.3
    assert rg.verify(plan, friction=1.0001 * needed).ok
    found = rg.verify(plan, friction=0.9999 * needed)
    assert "leaves its friction cone under the deviation Wrench(force=(0, 0), torque=0)" in str(found)


def test_contacts_that_are_off_change_balance_and_normals() -> None:
    state = rg.choose_state(GRASP, LOAD, "force", max_force=8.0)
    plan = held(state)
    for curvature in (0.0, 0.2):
        lengths = np.geomspace(1e-3, 3, 20)
        good = [rg.verify(plan, position=[0, 0, s], surface=curvature).ok for s in lengths]
        expected = []
        for s in lengths:
            c = GRASP["P3"]
            t, turn = np.array([-c.normal[1], c.normal[0]]), curvature * s
            along = np.sin(turn) / curvature if curvature else s
            inwards = (1 - np.cos(turn)) / curvature if curvature else 0.0
            off = rg.Contact(
                c.position + along * t + inwards * c.normal,
                np.cos(turn) * c.normal - np.sin(turn) * t,
                c.friction,
            )
            grasp = rg.Grasp([*GRASP.contacts[:2], off])
            error = grasp_matrix(grasp) @ state.forces.ravel() + LOAD.vector
            after = (state.forces.ravel() + answers(grasp, None) @ error).reshape(3, 2)
            expected.append(min(slack(k, f) for k, f in zip(grasp, after, strict=True)) >= 0)
        assert good == expected
        assert len(set(good)) == (2 if curvature else 1)
    rows = rg.verify(plan, position=[[0, 0, 0.001], [0, 0, 3.0]], surface=0.2)
    assert rows.violations
    assert all("contacts off as in row 1" in v for v in rows.violations)


def test_what_is_asked_is_checked() -> None:
    plan = removal()
    with pytest.raises(rg.InvalidInput, match="disturbance must be a LoadSet of dimension 2"):
        rg.verify(plan, disturbance=rg.LoadSet.ball(STILL, force=1))
    with pytest.raises(rg.InvalidInput, match=r"position must have shape \(n,\)"):
        rg.verify(plan, position=[1.0, 2.0])
    with pytest.raises(rg.InvalidInput, match="surface must be one curvature or 3"):
        rg.verify(plan, position=[0, 0, 0], surface=[1.0, 2.0])
    with pytest.raises(rg.InvalidInput, match="have a row for each of 3 contacts, got 2"):
        rg.verify(plan, disturbance=SMALL, stiffness=[1.0, 2.0])
    for alone in {"stiffness": 100.0}, {"surface": 0.5}:
        with pytest.raises(rg.InvalidInput, match="give disturbance, position, friction or early_loss, too"):
            rg.verify(plan, **alone)
