"""Regrasps in space: every instant checked, refusals with reasons."""

from itertools import combinations, pairwise
from math import pi

import numpy as np
import pytest

import regrasp as rg
from box import BOX, GOAL, MU, START, WEIGHT, on_box
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.mesh import Mesh, parts
from regrasp.planning.holds.margin_search import WideEnd
from regrasp.planning.holds.sequences import preferred
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.triples import TripleGraph, directions

pytestmark = pytest.mark.oracle


def check_all_along(plan, start, goal, load, count=101):
    """Everything that must hold of a regrasp, from contacts, forces, load and time only."""
    steps = plan.steps
    assert set(places(steps[0].grasp)) == set(places(start))
    assert set(places(steps[-1].grasp)) == set(places(goal))
    before = None
    for k, step in enumerate(steps):
        grasp = step.grasp
        assert len(grasp) <= 4
        t = np.linspace(0, step.duration, count)
        forces, loads = step.forces(t), step.load(t)
        scale = max(abs(forces).max(), abs(loads).max())
        assert abs(forces.sum(axis=1) + loads[:, :3]).max() < 1e-12 * scale
        assert abs(np.cross(grasp.positions, forces).sum(axis=1)).max() < 1e-12 * scale
        normal = np.einsum("mnd,nd->mn", forces, grasp.normals)
        tangential = np.linalg.norm(forces - normal[..., None] * grasp.normals, axis=-1)
        assert (tangential <= grasp.frictions * normal + 1e-12 * scale).all()
        whole = k * step.duration + t
        world = np.einsum("tij,tj->ti", plan.rotation(whole), loads[:, :3])
        assert abs(world - load.force).max() < 1e-12 * scale
        if before is not None:
            now = held(grasp, forces[0])
            assert now.keys() == before.keys()
            assert all(abs(now[at] - before[at]).max() <= 1e-15 * scale for at in now)
        before = held(grasp, forces[-1])
    for a, b in pairwise(steps):
        shared = set(places(a.grasp)) & set(places(b.grasp))
        assert len(shared) >= 3
    for move in plan.moves:  # a finger moves only where it carries nothing
        step = steps[move.step]
        if move.target_name in step.grasp.names:
            assert not step.start.force(move.target_name).any()


def places(grasp):
    return [tuple(c.position.tolist()) for c in grasp]


def held(grasp, forces):
    return {at: f for at, f in zip(places(grasp), forces, strict=True) if f.any()}


@pytest.mark.parametrize("states", ["each", "joint"])
@pytest.mark.parametrize("turn", [None, ([0, 0, 1], 0.7), ([1, 0, 0], 1.2), ([1, 1, -1], 2.8)])
def test_a_box_is_regrasped(states, turn):
    goal_rotation = (
        None if turn is None else rotation_matrix(np.array(turn[0]) / np.linalg.norm(turn[0]), turn[1])
    )
    plan = rg.plan_regrasp(
        BOX, START, GOAL, WEIGHT, friction=MU, orientations=20, candidates=16, states=states,
        goal_rotation=goal_rotation,
    )  # fmt: skip
    check_all_along(plan, START, GOAL, WEIGHT)
    assert rg.verify(plan).ok
    assert plan.margin > 0
    expected = np.eye(3) if goal_rotation is None else goal_rotation
    assert plan.rotation(plan.duration) == pytest.approx(expected, abs=1e-9)
    assert plan.rotations[-1] == pytest.approx(expected, abs=1e-9)
    back = plan.reversed()
    seen = rg.Wrench(expected.T @ WEIGHT.force)
    check_all_along(back, GOAL, START, seen)
    assert rg.verify(back).ok
    assert "finger moves" in str(plan)


def test_more_moves_for_a_wider_margin():
    plans = rg.plan_regrasps(BOX, START, GOAL, WEIGHT, friction=MU, orientations=1, candidates=24, extra=2)
    assert all(rg.verify(plan).ok for plan in plans)
    moves = [len(plan.moves) for plan in plans]
    assert moves == sorted(set(moves))
    few = plans[0]
    wide = rg.plan_regrasp(
        BOX, START, GOAL, WEIGHT, friction=MU, orientations=1, candidates=24, least_margin=0.9 * few.margin
    )
    assert wide.margin >= 0.9 * few.margin


def test_a_part_is_regrasped_and_every_hold_confirmed_with_exact_cones():
    mesh = parts.nut()
    contacts = mesh.contacts(30, friction=0.7)
    load = rg.Wrench([0, 0, -0.1])
    problem = None
    for chosen in combinations(range(12), 4):
        start = rg.Grasp([contacts[i] for i in chosen])
        goal = rg.Grasp([contacts[i + 12] for i in chosen])
        problem = rg.RegraspProblem(mesh, start, goal, load, 0.7, orientations=1, candidates=30)
        if problem.sequences():
            break
    plan = problem.plans()[0]
    check_all_along(plan, start, goal, load)
    assert rg.verify(plan).ok
    for step in plan.steps[:-1]:
        assert step.end.margins.least_angle > 0


@pytest.mark.parametrize(("length", "force"), [(1e-6, 1e6), (1e6, 1e-6)])
def test_units_change_nothing(length, force):
    mesh = Mesh.box(0.06 * length, 0.04 * length, 0.05 * length)

    def scaled(grasp):
        return rg.Grasp(rg.Contact(length * c.position, c.normal, c.friction, name=c.name) for c in grasp)

    options = {
        "friction": MU,
        "orientations": 12,
        "candidates": 12,
        "goal_rotation": rotation_matrix([1, 0, 0], 1.0),
    }
    plan = rg.plan_regrasp(BOX, START, GOAL, WEIGHT, **options)
    same = rg.plan_regrasp(mesh, scaled(START), scaled(GOAL), force * WEIGHT, **options)
    assert [step.grasp.names for step in same.steps] == [step.grasp.names for step in plan.steps]
    assert same.margin == pytest.approx(plan.margin, abs=1e-6)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"start": rg.Grasp(list(START)[:3])}, "start must be a Grasp of four contacts in space"),
        ({"friction": None}, "friction is missing"),
        ({"weight": None}, "unknown option 'weight'; a regrasp takes friction"),
        (
            {"goal_orientation": 1.0},
            "goal_orientation is an angle in the plane; on a mesh give goal_rotation",
        ),
        ({"one_finger": True}, "one_finger is of pairs of fingers on an outline"),
        ({"arcs": [None] * 3}, "arcs must have an entry for each of four fingers"),
        ({"arcs": [lambda points: [True], None, None, None]}, "arcs: finger 1 must return which of"),
        ({"goal_rotation": 2 * np.eye(3)}, "goal_rotation must be a rotation matrix"),
        ({"goal_rotation": np.eye(2)}, "goal_rotation must have shape"),
        (
            {"orientations": 1, "goal_rotation": rotation_matrix([1, 0, 0], 1.0)},
            "orientations=1 forbids turning",
        ),
        ({"orientations": 0}, "orientations must be a whole number of at least 1"),
        ({"max_turn": pi}, "max_turn must be above 0 and below pi"),
        ({"load": rg.Wrench([0, 0, -1], [0, 0.1, 0])}, "a force in space through the centre of mass"),
        ({"facets": 5}, "facets must be an even whole number"),
        ({"candidates": 0}, "candidates must be a whole number"),
        ({"least_margin": -1}, "least_margin must be at least 0"),
        ({"mesh": 3}, "a regrasp needs an Outline or a Mesh, got 3"),
    ],
)
def test_bad_input(options, words):
    given = {"mesh": BOX, "start": START, "goal": GOAL, "load": WEIGHT, "friction": MU} | options
    given = {key: value for key, value in given.items() if key != "friction" or value is not None}
    mesh, start, goal, load = (given.pop(key) for key in ("mesh", "start", "goal", "load"))
    with pytest.raises(rg.InvalidInput, match=words):
        rg.plan_regrasp(mesh, start, goal, load, **given)


def test_what_is_impossible_says_why():
    with pytest.raises(rg.Infeasible, match="the fingers of the start cannot hold the load there"):
        rg.plan_regrasp(
            BOX,
            on_box(*((0.03, y, z) for y in (-0.01, 0.01) for z in (-0.01, 0.01))),
            GOAL,
            WEIGHT,
            friction=MU,
        )
    slippery = [rg.Grasp(c.changed(friction=0.01) for c in grasp) for grasp in (START, GOAL)]
    with pytest.raises(rg.Infeasible, match="the fingers of the start cannot hold the load there"):
        rg.plan_regrasp(BOX, *slippery, WEIGHT, friction=0.01, orientations=1)
    for options, words in (
        ({"keep": lambda a, b, c: np.zeros(len(a), dtype=bool)}, "there would be one without keep"),
        ({"min_distance": 1.0}, "there would be one without min_distance"),
        ({"max_force": 0.1}, "the fingers of the start cannot hold the load there"),
        ({"max_force": 0.7}, "or with force limits of"),
    ):
        with pytest.raises(rg.Infeasible, match=words):
            rg.plan_regrasp(BOX, START, GOAL, WEIGHT, friction=MU, orientations=1, **options)
    with pytest.raises(rg.Infeasible, match="keeps angle margins of 1 rad; the widest worst margin"):
        rg.plan_regrasp(BOX, START, GOAL, WEIGHT, friction=MU, orientations=1, least_margin=1.0)


@pytest.mark.parametrize("seed", range(12))
def test_margins_found_when_asked_for_are_those_of_all(seed):
    rng = np.random.default_rng(100 + seed)
    points = rng.normal(size=(14, 3)) * (1.0, 0.7, 0.5)
    contacts = tuple(rg.Contact(p, -p + 0.3 * rng.normal(size=3), 0.5) for p in points)
    ways = directions(6)[:, :3]
    start, goal = (tuple(rng.choice(14, 4, replace=False).tolist()) for _ in range(2))
    allowed = rng.random((4, 14)) < 0.8 if seed % 3 == 0 else None
    if allowed is not None:
        allowed[range(4), start] = allowed[range(4), goal] = True
    lazy, eager = (TripleGraph(contacts, np.pad(ways, ((0, 0), (0, 3)))) for _ in range(2))
    _ = eager.margins
    least = 0.1 if seed % 2 else 0.0
    few, all_of = (Quads(graph, ways, 2.0, least, allowed=allowed) for graph in (lazy, eager))
    all_of.look_at_all()
    found = preferred(few, start, goal, 3, extra=2)
    assert found == preferred(all_of, start, goal, 3, extra=2)
    table, least_known = lazy._found
    known = least_known <= least
    margins = eager.margins.T[known]
    assert (np.where(table[known] < least, -1, table[known]) == np.where(margins < least, -1, margins)).all()
    if len(found) and found[0].moves <= 4:
        few = Quads(TripleGraph(contacts, lazy.loads), ways, 2.0, least, allowed=allowed)
        assert preferred(few, start, goal, 3)[:1] == found[:1]
        assert np.isfinite(few.graph._found[1]).mean() < 0.6


def meeting(fingers, start, goal, o, most):
    """The widest least margin of ways of at most so many moves, over all holds, from the start alone."""
    every, result = np.ones(fingers.rows.size, dtype=bool), []
    fingers.look_at_all()
    here, there = WideEnd(fingers, [start], 0), WideEnd(fingers, fingers.ways(goal), o)
    for _ in range(most):
        result.append(float(np.minimum(here.known, there.known).max()))
        here = here.moved(-0.5, every)
    return np.maximum.accumulate(result)


@pytest.mark.parametrize("seed", range(6))
def test_both_ends_find_what_one_finds_alone(seed):
    rng = np.random.default_rng(200 + seed)
    points = rng.normal(size=(12, 3))
    contacts = tuple(rg.Contact(p, -p + 0.4 * rng.normal(size=3), 0.4) for p in points)
    ways = directions(5)[:, :3]
    start, goal = tuple(range(4)), tuple(range(6, 10))
    fingers = Quads(TripleGraph(contacts, np.pad(ways, ((0, 0), (0, 3)))), ways, 2.0)
    found = {s.moves: s.margin for s in preferred(fingers, start, goal, 2, extra=3)}
    margins = meeting(fingers, start, goal, 2, 8)
    best = -1.0
    for moves, margin in enumerate(margins, 1):
        if found and min(found) <= moves <= min(found) + 3:
            best = max(best, found.get(moves, -1.0))
            assert best == pytest.approx(margin, abs=2e-6)
        elif not found or moves < min(found):
            assert margin < 0
