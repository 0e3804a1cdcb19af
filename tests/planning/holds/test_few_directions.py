"""Few directions of the load come first, and contacts of both ends: sequences are those among all."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.triples import TripleGraph, directions
from regrasp.planning.regrasps import sampled

pytestmark = pytest.mark.oracle

BOX, LOAD = rg.Mesh.box(0.06, 0.04, 0.05), rg.Wrench([0, 0, -1.0])


def problems(friction, count, **options):
    """Random regrasps of a box that four fingers hold at both ends."""
    rng, found = np.random.default_rng(5), 0
    while found < count:
        places = BOX.contacts(60, friction=friction, seed=found)
        start, goal = (rg.Grasp([places[i] for i in rng.choice(60, 4, replace=False)]) for _ in "ab")
        try:
            for grasp in (start, goal):
                rg.choose_state(grasp, LOAD, "force")
        except rg.RegraspError:
            continue
        found += 1
        options = {"candidates": 12, "seed": found, **options}
        yield rg.RegraspProblem(BOX, start, goal, LOAD, friction, **options)


def among_all(problem, extra):
    """Every direction and every contact at once."""
    stances = problem.setting.stances(
        problem.graph, problem.largest_turn, np.pi - 1e-6, problem.allowed, problem.least_margin
    )
    every = np.arange(len(problem.setting.orientations))
    return sampled._searched(problem, problem.graph, stances, every, extra, {}, None)


@pytest.mark.parametrize(
    ("friction", "extra", "options"),
    [
        (0.6, 0, {"orientations": 70}),
        (0.25, 1, {"orientations": 55}),
        (0.3, 0, {"orientations": 60, "max_force": 1.5}),
        (0.35, 0, {"least_margin": 0.1}),
        (0.35, 0, {"orientations": 55, "min_normal": 0.02}),
    ],
)
def test_sequences_are_those_among_all_directions_and_contacts(friction, extra, options):
    moves = set()
    for problem in problems(friction, 3, **options):
        found = problem.sequences(extra)
        assert found == among_all(problem, extra)
        moves.update(one.moves for one in found)
    assert moves


def test_margins_below_a_least_one_are_not_looked_for():
    """What is ruled out at a level is below it, and what is not ruled out has the margin it has."""
    rng = np.random.default_rng(8)
    points = rng.normal(size=(12, 3))
    contacts = tuple(rg.Contact(p, -p + 0.3 * rng.normal(size=3), 0.6, max_force=4.0) for p in points)
    whole, some = (TripleGraph(contacts, directions(30)) for _ in range(2))
    every = np.arange(len(whole.triples))
    for least in (0.3, 0.1, 0.0):  # the lower ones are found anew
        margins, mine = whole.margins.T, some.margins_of(every, least)
        assert (mine[margins >= least] == margins[margins >= least]).all()
        assert (mine[margins < least] < least).all() or least == 0
        if least > 0:
            assert (some.bounds_of(every, least)[margins >= least] == 0).all()
            assert (some.bounds_of(every, least) == -1).sum() > 0.8 * (margins < least).sum()
            assert ((mine < 0) & (margins >= 0)).any()


def test_what_a_hold_was_lowered_to_stays_as_it_is_looked_at():
    contacts = tuple(rg.Contact(p, -p, 0.8) for p in np.vstack([np.eye(3), -np.eye(3)]))
    loads = directions(4)
    fingers = Quads(TripleGraph(contacts, loads), loads[:, :3], 1.0)
    row, o = (int(k) for k in np.argwhere(fingers.graph.margins.T > 0.1)[0])
    fingers.lower(row, o, 0.05)
    fingers.look_at_all()
    assert fingers.margins[row, o] == np.float32(0.05)
    fingers.lower(row, o, -1.0)
    fingers.look_at(np.array([row]))
    assert fingers.margins[row, o] == -1
