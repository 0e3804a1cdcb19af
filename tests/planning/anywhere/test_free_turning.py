"""With free turning and without limits a regrasp always exists: a law of any outline."""

import numpy as np
import pytest

import regrasp as rg

pytestmark = pytest.mark.laws


def star(rng):
    """A polygon around its first origin, with reflex corners: some see the centre of mass from no side."""
    count = int(rng.integers(3, 12))
    angles = np.sort(rng.uniform(0, 2 * np.pi, count)) + 0.0
    if (np.diff(angles, append=angles[0] + 2 * np.pi) > 3.0).any() or np.diff(angles).min() < 0.05:
        return None
    radii = np.where(np.arange(count) % 2, rng.uniform(0.2, 1.0), 1.0) * rng.uniform(0.8, 1.2, count)
    return rg.Outline(radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1))


def held(rng, outline, friction, load):
    """Three places whose fingers hold a load; None where few of many do."""
    for _ in range(60):
        places = rng.uniform(0, outline.length, 3)
        try:
            grasp = rg.Grasp(outline.contact_at(s, friction=friction) for s in places)
            rg.choose_state(grasp, load, "effort")
        except (rg.Infeasible, rg.InvalidInput):
            continue
        return grasp
    return None


def test_any_two_grasps_are_joined_by_their_own_contacts():
    """The forces of a contact turn an object either way, or one way: two that are not both of one way hold.

    Three that hold have both ways among them, so of any two pairs that hold each turn one way and the other.
    """
    rng = np.random.default_rng(16)
    turned = found = 0
    while found < 25:
        outline, friction = star(rng), float(10 ** rng.uniform(-1.7, 0.0))
        angle, turn = rng.uniform(0, 2 * np.pi), rng.uniform(-np.pi, np.pi)
        load = rg.Wrench([np.cos(angle), np.sin(angle)])
        if outline is None:
            continue
        start = held(rng, outline, friction, load)
        goal = held(rng, outline, friction, load.rotated(-turn))
        if start is None or goal is None:
            continue
        plan = rg.plan_regrasp(
            outline, start, goal, load, friction=friction, goal_orientation=turn, candidates=1, min_normal=0.0
        )
        assert rg.verify(plan).ok
        found += 1
        held_by_two = [not rg.EquilibriumLocus(start.without(name), load).is_empty for name in start.names]
        turned += not any(held_by_two)
    assert turned >= 3  # all three have to turn it before any can leave
