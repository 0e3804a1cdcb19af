"""One finger takes over from another, and several leave or arrive together."""

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD, STATE

pytestmark = pytest.mark.laws

P4 = rg.Contact([2, 6], normal=[-0.5, -1], friction=0.4, name="P4")
P5 = rg.Contact([0.3, 8], normal=[0, -1], friction=0.4, name="P5")
TWO = GRASP.without("P3")


def check(plan: rg.Transition) -> None:
    """Equilibrium and cones at many times, from contacts, forces and load alone."""
    assert rg.verify(plan).ok
    t = np.linspace(0, plan.duration, 41)
    for forces, load in zip(plan.forces(t), plan.load(t), strict=True):
        assert plan.grasp.matrix @ forces.ravel() + load == pytest.approx(0, abs=1e-9)
        for f, c in zip(forces, plan.grasp, strict=True):
            n = f @ c.normal
            assert np.linalg.norm(f - n * c.normal) <= c.friction * n + 1e-9


def test_an_exchange_starts_and_ends_with_idle_fingers() -> None:
    plan = rg.plan_exchange(STATE, "P3", P4)
    check(plan)
    assert (plan.kind, plan.leaving, plan.arriving) == ("exchange", ("P3",), ("P4",))
    assert not plan.start.force("P4").any()
    assert not plan.end.force("P3").any()
    assert [c.end for c in plan.record.choices] == ["end"]
    check(plan.reversed())


def test_an_exchange_from_a_grasp_is_two_choices() -> None:
    plan = rg.plan_exchange(GRASP, 2, P4, load=LOAD, objective="effort", start_objective="force")
    assert [(c.end, c.objective) for c in plan.record.choices] == [("start", "force"), ("end", "effort")]
    check(plan)
    same = rg.plan_exchange(GRASP, 2, P4, load=LOAD, objective="effort")
    assert [c.objective for c in same.record.choices] == ["effort", "effort"]


def test_the_end_of_an_exchange_may_be_given() -> None:
    whole = TWO.with_contact(P4)
    end = rg.choose_state(whole, LOAD, "force")
    plan = rg.plan_exchange(STATE, "P3", P4, end=end)
    assert plan.end.forces[[0, 1, 3]] == pytest.approx(end.forces, abs=1e-12)
    all_in_play = rg.GraspState(GRASP.with_contact(P4), LOAD, np.insert(end.forces, 2, 0, axis=0))
    assert rg.plan_exchange(STATE, "P3", P4, end=all_in_play) == plan
    working = np.insert(end.forces, 2, [0, -1e-3], axis=0)
    with pytest.raises(rg.InvalidInput, match="end: P3 must carry no force"):
        rg.plan_exchange(STATE, "P3", P4, end=rg.GraspState(GRASP.with_contact(P4), LOAD, working))
    with pytest.raises(rg.InvalidInput, match="end must be a GraspState of P1, P2, P4, or of the whole"):
        rg.plan_exchange(STATE, "P3", P4, end=STATE)


def test_an_exchange_under_a_load_that_varies_and_limits() -> None:
    def shaken(t: float) -> rg.Wrench:
        return rg.Wrench([-1.5, -3.5 + 0.5 * np.sin(7 * t)])

    plan = rg.plan_exchange(
        GRASP, "P3", P4, load=shaken, rate_limit=40.0, idle_from=0.8, idle_until=0.137, instants=31
    )
    check(plan)
    assert rg.verify(plan, shaken).ok
    t = np.linspace(0, 1, 501)
    forces = plan.forces(t)
    assert not forces[t >= 0.8, 2].any()
    assert not forces[t <= 0.137, 3].any()
    assert plan.steepest.max() <= 40.0 * (1 + 1e-6)


def test_several_fingers_leave_and_arrive() -> None:
    four = GRASP.with_contact(P4)
    plan = rg.plan_removal(four, ["P4", "P3"], load=LOAD)
    check(plan)
    assert set(plan.leaving) == {"P3", "P4"}
    assert not plan.end.forces[2:].any()
    back = rg.plan_addition(TWO, [GRASP["P3"], P4], load=LOAD)
    check(back)
    assert back.arriving == ("P3", "P4")
    assert back.start.forces[:2] == pytest.approx(plan.end.forces[:2], abs=1e-9)
    both = rg.plan_exchange(four, ["P3", "P4"], P5, load=LOAD)
    check(both)
    assert both.in_words == "exchange of P3, P4 for P5"


def test_load_functions_are_evaluated_at_every_inserted_instant() -> None:
    def load(t: float) -> rg.Wrench:
        return rg.Wrench([-1.5, -3.5 + np.sin(9 * t)])

    for idle in (0.905, 0.5, 1 / 3):
        plan = rg.plan_removal(GRASP, "P3", load=load, idle_from=idle, instants=41, reserve=0.1)
        assert rg.verify(plan, load).ok
        at = plan.course.times
        assert idle in at
        assert plan.course.loads[:, 1] == pytest.approx([load(t).force[1] for t in at], abs=0)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: rg.plan_removal(STATE, []), "must be one or more different ones, got"),
        (lambda: rg.plan_removal(STATE, ["P1", 0]), "must be one or more different ones, got"),
        (lambda: rg.plan_removal(STATE, ["P1", "P2", "P3"]), "the last contacts, 'P1', 'P2', 'P3', cannot"),
        (lambda: rg.plan_exchange(STATE, "P3", "P4"), "contact must be the Contact that arrives, got 'P4'"),
        (lambda: rg.plan_exchange(STATE, "P3", []), "contact must be the Contact that arrives"),
        (lambda: rg.plan_exchange(STATE, "P3", [P4, 1]), "contact must be the Contact that arrives, got 1"),
        (lambda: rg.plan_exchange(STATE, "P9", P4), "no contact 'P9' in this grasp"),
        (lambda: rg.plan_exchange(STATE, "P3", P4, idle_until=1.5), "must lie inside"),
    ],
)
def test_wrong_fingers_of_an_exchange(call, words) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        call()
