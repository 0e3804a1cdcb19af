"""Fingers that move at once: in time they keep apart, cross by waiting, and use the steps they are not in."""

from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from motion_checks import axes, instants
from regrasp.motions import Motions, plan_motions
from regrasp.plans.record import Record

pytestmark = pytest.mark.laws

RADIUS, CLEARANCE = 0.003, 0.002
ELLIPSE = rg.Outline.ellipse(0.04, 0.02)
BOX = rg.Mesh.box(0.08, 0.05, 0.03)
CLOCK, RECORD = rg.TimeScaling.spline(1.0), Record(reserve=0.0)


def idle(contacts: list[rg.Contact], **change: tuple[str, ...]) -> rg.Transition:
    """A step without forces, for ways depend on places only."""
    d = contacts[0].dimension
    state = rg.GraspState(rg.Grasp(contacts), rg.Wrench(-np.eye(d)[-1]), np.zeros((len(contacts), d)))
    return rg.Transition(state, state, CLOCK, RECORD, **change)


def both(contacts: list[rg.Contact], wait: bool = False) -> rg.RegraspPlan:
    """Fingers 1 and 2 go from the first contacts to the last, over a step without them if they wait."""
    first, standing, last = contacts[:2], contacts[2:-2], contacts[-2:]
    leaving, arriving = (tuple(str(c.name) for c in part) for part in (first, last))
    steps = [idle([*first, *standing], leaving=leaving)]
    steps += [idle(standing)] if wait else []
    steps += [idle([*standing, *last], arriving=arriving)]
    return rg.RegraspPlan(tuple(steps), (0.0,) * (len(steps) + 1), 0.0)


def around(*places: float) -> list[rg.Contact]:
    return [ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.8, name=f"C{k}") for k, s in enumerate(places)]


def on_box(*places: tuple[float, ...]) -> list[rg.Contact]:
    return [BOX.contact_at(p, friction=0.8, name=f"C{k}") for k, p in enumerate(places)]


def keeps_apart(motions: Motions) -> None:
    """No two fingers nearer than told, at a tenth of the clearance, whenever one of them moves."""
    t = instants(motions, CLEARANCE / 10)
    at, touching = motions.positions(t), motions.touching(t)
    fingers = axes(motions, at, CLEARANCE / 2)
    for i, j in combinations(range(at.shape[1]), 2):
        moves = ~(touching[:, i] & touching[:, j])
        between = np.linalg.norm(fingers[i][moves][:, :, None] - fingers[j][moves][:, None], axis=-1)
        assert between.min(initial=np.inf) >= 2 * RADIUS + CLEARANCE - 1e-9
    for m in motions.motions:
        during = (t >= m.start) & (t <= m.end)
        for j in range(at.shape[1]):
            if j != m.finger:
                away = np.linalg.norm(at[during, m.finger] - at[during, j], axis=1).min()
                assert away - 2 * RADIUS >= m.to_tips - 1e-9


def overlaps(motions: Motions) -> bool:
    """Whether two fingers move at a time."""
    return any(a.start < b.end and b.start < a.end for a, b in combinations(motions.motions, 2))


def test_two_fingers_far_from_one_another_move_at_once() -> None:
    plan = both(around(0.02, 0.52, 0.25, 0.75, 0.15, 0.65))
    motions = plan_motions(plan, ELLIPSE, tip_radius=RADIUS, clearance=CLEARANCE)
    moving = [m for m in motions.motions if m.origin != m.target]
    assert [m.start for m in moving] == [moving[0].start] * 2
    assert motions.pause(1) == pytest.approx(max(m.duration for m in moving))
    keeps_apart(motions)


@pytest.mark.parametrize("places", [(0.05, 0.15, 0.5, 0.75, 0.3, 0.02), (0.02, 0.2, 0.5, 0.75, 0.2, 0.02)])
def test_fingers_that_cross_wait_or_go_round(places: tuple[float, ...]) -> None:
    """One passes the other; and two change places, for which one stands aside meanwhile."""
    motions = plan_motions(both(around(*places)), ELLIPSE, tip_radius=RADIUS, clearance=CLEARANCE)
    assert {(m.finger, m.target) for m in motions.motions} >= {(0, "C4"), (1, "C5")}
    keeps_apart(motions)


def test_fingers_that_change_places_in_space() -> None:
    a, b = (0.0, 0, 0.015), (0.02, 0, 0.015)
    contacts = on_box(a, b, (-0.04, 0, 0), (0, 0.025, 0), (0, -0.025, 0), b, a)
    motions = plan_motions(both(contacts), BOX, tip_radius=RADIUS, clearance=CLEARANCE)
    assert len([m for m in motions.motions if m.step == 1]) == 3  # one of them waits aside
    assert overlaps(motions)
    keeps_apart(motions)


def test_fingers_in_the_air_move_while_others_hold_or_turn_the_object() -> None:
    plan = both(around(0.02, 0.52, 0.25, 0.75, 0.15, 0.65), wait=True)
    motions = plan_motions(plan, ELLIPSE, tip_radius=RADIUS, clearance=CLEARANCE)
    begun, over = motions.starts[1], motions.starts[1] + plan.steps[1].duration
    late = [m for m in motions.motions if m.step == 2]
    assert len(late) == 2
    assert all(begun <= m.start < over < m.end for m in late)
    assert motions.pause(2) < max(m.duration for m in late) / 2
    t = np.linspace(begun, over, 200)
    assert motions.touching(t).tolist() == [[False, False, True, True]] * 200  # they land after the step
    assert motions.plan_time(np.array([begun, over])) == pytest.approx([1.0, 2.0])
    keeps_apart(motions)


def test_velocities_are_those_of_positions_through_all_of_it() -> None:
    places = (0.02, 0.2, 0.5, 0.75, 0.2, 0.02)
    motions = plan_motions(both(around(*places), wait=True), ELLIPSE, tip_radius=RADIUS, clearance=CLEARANCE)
    t = np.linspace(0, motions.duration, 20_001)
    dt = t[1]
    at, velocity = motions.positions(t), motions.velocities(t)
    assert np.diff(at, axis=0) / dt == pytest.approx((velocity[1:] + velocity[:-1]) / 2, abs=1e-3)
    assert np.linalg.norm(velocity, axis=2).max() <= 0.1 * (1 + 1e-9)
    touching = motions.touching(t)
    assert not (touching & (np.linalg.norm(velocity, axis=2) > 0)).any()
