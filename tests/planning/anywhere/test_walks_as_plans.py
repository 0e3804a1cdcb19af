"""Walks of holds anywhere on an outline are regrasps: planned, verified, written and read."""

from itertools import pairwise

import numpy as np
import pytest
from test_turns_and_forbidden_arcs import BOWL, DOWN, GOAL, START
from test_turns_and_forbidden_arcs import asked as task

import regrasp as rg
from regrasp.files import read_plan, write_plan

pytestmark = pytest.mark.laws


def asked(friction=0.4, *more, **options):
    return task(friction, *more, **options)


def holds_of(plan):
    """Arc lengths of the two fingers between any two steps."""
    for step in plan.steps[:-1]:
        names = [n for n in step.grasp.names if n not in step.idle_at_end]
        yield {round(BOWL.nearest(step.grasp[n].position + BOWL.centre_of_mass), 6) for n in names}


def random_task(rng):
    """What is found between two random grasps of which two fingers hold a load; None for others."""
    friction, angle = float(rng.uniform(0.05, 0.2)), rng.uniform(0, 2 * np.pi)
    load = rg.Wrench([np.cos(angle), np.sin(angle)])
    s, t = rng.uniform(0, BOWL.length, (2, 2000))
    lo, hi = rg.locus_intervals(
        BOWL.points(s), BOWL.normals(s), friction, BOWL.points(t), BOWL.normals(t), friction, load.force
    )
    k = np.flatnonzero(lo < hi)[:2]
    if len(k) < 2:
        return None
    found = asked(friction, *[(s[i], t[i], rng.uniform(0, BOWL.length)) for i in k.tolist()], load)
    return found if found.exists else None


def sampled(found, count, **options):
    """The best sequence among so many places; None without any."""
    problem = rg.RegraspProblem(
        BOWL, found.start, found.goal, found.load, found.friction, orientations=1, candidates=count,
        min_normal=0.0, **options,
    )  # fmt: skip
    return next(iter(problem.sequences()), None)


def test_plans_are_found_where_sampled_places_miss_them(tmp_path):
    rng = np.random.default_rng(5)
    missed = 0
    while missed < 4:
        found = random_task(rng)
        if found is None or sampled(found, 60):
            continue
        missed += 1
        plan = found.plan()
        assert rg.verify(plan).ok
        assert plan.margin > 0
        held = list(holds_of(plan))
        assert len(held) == len(found.walk)
        assert all(one & other for one, other in pairwise(held))
        write_plan(plan, tmp_path / "plan.json")
        assert read_plan(tmp_path / "plan.json") == plan
        again = sampled(found, found.walk.ravel())
        assert again.moves <= len(plan.moves)


def test_no_samples_are_wider_with_as_many_exchanges():
    rng, compared = np.random.default_rng(7), 0
    while compared < 8:
        found = random_task(rng)
        best = None if found is None else sampled(found, 150, peak_ratio=1e4)
        if best is None or best.exchanges > found.exchanges[1]:
            continue
        compared += 1
        assert best.exchanges == found.exchanges[0]
        plan = found.plan(peak_ratio=1e4)
        assert plan.margin >= best.margin - 2e-3 * np.arctan(found.friction)


@pytest.mark.parametrize(
    "options",
    [
        {"min_normal": 1.0},
        {"max_force": 4.8},
        {"forbidden": [(1.5, 2.5), (5.5, 6.5)]},
        {"turns": (-1.0, 1.0), "goal_orientation": 0.5},
        {"turns": (-1.5, 1.5), "friction": 0.2},
        {"turns": (-0.5, 0.5), "max_force": 5.0, "min_normal": 0.1},
    ],
)
def test_plans_keep_what_was_asked(options):
    found = asked(**options)
    plan = found.plan("force", step_duration=2.0)
    assert plan.duration == 2.0 * len(plan.steps)
    lo, hi = found.turns
    assert rg.verify(plan).ok
    assert all(lo - 1e-9 <= a <= hi + 1e-9 for a in plan.orientations)
    assert plan.orientations[-1] == options.get("goal_orientation", 0.0)
    for step in plan.steps:
        normal = (step.forces([0.0, step.duration]) * step.grasp.normals).sum(axis=-1)
        for names, row in zip((step.idle_at_start, step.idle_at_end), normal, strict=True):
            pushes = row[[n not in names for n in step.grasp.names]]
            assert (pushes >= found.min_normal * (1 - 1e-9)).all()
        if found.max_force:
            forces = step.forces(np.linspace(0, step.duration, 41))
            assert np.linalg.norm(forces, axis=-1).max() <= found.max_force * (1 + 1e-9)
        for contact in step.grasp:
            s = BOWL.nearest(contact.position + BOWL.centre_of_mass)
            assert not any(a + 1e-9 < s < b - 1e-9 for a, b in options.get("forbidden", ()))


def test_the_object_turns_no_more_than_the_walk_needs():
    assert not asked(turns=(-1.0, 1.0)).angles.any()
    limited = asked(turns=(-1.5, 1.5), max_force=6.0)
    assert limited.exchanges == (2, 2)
    assert not limited.angles.any()
    turned = asked(0.2, turns=(-1.5, 1.5))
    assert abs(np.diff(turned.angles)).sum() > 0
    for k, (hold, angle) in enumerate(zip(turned.walk.tolist(), turned.angles.tolist(), strict=True)):
        before = 0.0 if k == 0 else turned.angles[k - 1]
        after = 0.0 if k == len(turned.walk) - 1 else turned.angles[k + 1]
        p = BOWL.points(hold), BOWL.normals(hold)
        for nearer in (before, after):  # neither of these angles would do with less turning
            if abs(nearer - before) + abs(after - nearer) < abs(angle - before) + abs(after - angle) - 1e-9:
                load = DOWN.rotated(-nearer).force
                lo, hi = rg.locus_intervals(p[0][0], p[1][0], 0.2, p[0][1], p[1][1], 0.2, load)
                assert lo > hi


def test_grasps_alike_turn_alone():
    for turn in (0.0, 0.4):
        found = asked(start=START, goal=START[::-1], turns=(0.0, turn), goal_orientation=turn)
        assert found.exists
        plan = found.plan()
        assert rg.verify(plan).ok
        assert plan.orientations[-1] == turn
        assert not plan.moves


def test_all_three_fingers_of_both_ends_push():
    assert asked(min_normal=3.0).exists
    for places, name in (({}, "start"), ({"start": GOAL, "goal": START}, "goal")):
        with pytest.raises(rg.Infeasible, match=f"the three fingers of the {name} cannot hold the load"):
            asked(min_normal=5.0, **places)


def test_without_a_walk_there_is_no_plan():
    found = asked(0.2)
    with pytest.raises(rg.Infeasible, match="there is no walk to plan along: no regrasp exists") as reason:
        found.plan()
    assert rg.verify(reason.value.certificate).ok


def test_proofs_name_their_turn():
    for turns, words in (((0.0, 0.0), "at this orientation"), ((-0.05, 0.05), "within a turn of 5.73 deg")):
        found = asked(0.2, turns=turns)
        assert words in str(found.certificate)
        assert words in str(rg.verify(found.certificate))
