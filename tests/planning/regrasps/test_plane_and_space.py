"""Every option of a regrasp, on an outline and on a mesh."""

from itertools import pairwise

import numpy as np
import pytest

import regrasp as rg
from box import BOX, GOAL, MU, START, WEIGHT
from regrasp import plots
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.planning.regrasps import planned

pytestmark = pytest.mark.oracle

ELLIPSE = rg.Outline.ellipse(2, 1)


def on_ellipse(*places):
    return rg.Grasp(ELLIPSE.contact_at(p * ELLIPSE.length, friction=0.5) for p in places)


PLANE = (ELLIPSE, on_ellipse(0.02, 0.35, 0.7), on_ellipse(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]))
SPACE = (BOX, START, GOAL, WEIGHT)
ASKED = {
    "plane": (PLANE, {"friction": 0.5, "candidates": 24, "orientations": 24}),
    "space": (SPACE, {"friction": MU, "candidates": 10, "orientations": 20}),
}
TURNED = {
    "plane": {"goal_orientation": np.pi / 2},
    "space": {"goal_rotation": rotation_matrix([1, 0, 0], 1.2)},
}


def problem(where, **options):
    ends, usual = ASKED[where]
    return rg.RegraspProblem(*ends, **{**usual, **options})


def checked(plan):
    assert rg.verify(plan).ok
    return plan


def staying(step):
    return [step.grasp.index(n) for n in step.grasp.names if n not in (*step.leaving, *step.arriving)]


def turned(plan):
    return sum(abs(step.turn.angle) for step in plan.steps if step.turn is not None)


def effort(plan):
    """The sum over holds of the least largest force."""
    holds = [[n for n in step.grasp.names if n not in step.idle_at_end] for step in plan.steps[:-1]]
    states = [
        rg.choose_state(rg.Grasp(step.grasp[n] for n in names), step.end.load, "peak", reserve=0)
        for step, names in zip(plan.steps[:-1], holds, strict=True)
        if len(names) < len(plan.steps[0].grasp)
    ]
    return sum(state.value for state in states)


both = pytest.mark.parametrize("where", ["plane", "space"])


@both
def test_moves_are_traded_for_margin_up_to_the_bottleneck(where):
    asked = problem(where, orientations=1)
    plans = [checked(plan) for plan in asked.plans(extra=3)]
    moves, margins = [len(p.moves) for p in plans], [p.margin for p in plans]
    assert moves == sorted(set(moves))
    assert margins == sorted(margins)
    limit = asked.bottleneck()
    assert limit.margin >= asked.sequences(extra=3)[-1].margin - 1e-6
    assert "limited by the hold of" in str(limit)
    assert len(limit.hold) == len(plans[0].steps[0].grasp)  # all fingers but one, and an orientation
    graph = asked.graph
    assert problem(where, orientations=1, least_margin=limit.margin * (1 - 1e-6)).plans()
    with pytest.raises(rg.Infeasible, match="the widest worst margin"):
        problem(where, orientations=1, least_margin=limit.margin + 1e-3).plans()
    assert limit.graph is graph


@both
def test_turns_are_made_smaller_where_a_step_is_refused(where, monkeypatch):
    chosen, refused = planned.chosen_states, []

    def strict(nodes, contacts, way, *rest):
        if max(way.turn(a, b) for (_, a), (_, b) in pairwise(nodes)) > 0.8:
            refused.append(nodes)
            raise rg.Infeasible("too far")
        return chosen(nodes, contacts, way, *rest)

    monkeypatch.setattr(planned, "chosen_states", strict)
    plan = checked(problem(where, **TURNED[where], orientations=60).plans()[0])
    assert refused
    assert max(abs(step.turn.angle) for step in plan.steps if step.turn is not None) <= 0.8 + 1e-9


@both
def test_weights(where):
    usual = problem(where, **TURNED[where]).plans()[0]
    lazy = checked(problem(where, **TURNED[where], weights=rg.RegraspWeights(moves=0, turning=1)).plans()[0])
    few = problem(where, **TURNED[where], weights=rg.RegraspWeights(moves=1)).plans()[0]
    assert turned(lazy) <= turned(usual) + 1e-9
    assert len(few.moves) == len(usual.moves)
    light = checked(problem(where, weights=rg.RegraspWeights(moves=0, effort=1), orientations=4).plans()[0])
    heavy = problem(where, orientations=4).plans()[0]
    assert effort(light) <= effort(heavy) + 1e-6
    short = problem(where, **TURNED[where], weights=rg.RegraspWeights(moves=0, time=1)).plans()[0]
    assert len(short.steps) <= len(usual.steps)


@both
def test_hold_maps(where):
    asked = problem(where)
    ax = plots.plot_hold_map(asked.graph, ELLIPSE if where == "plane" else None, plan=asked.plans()[0])
    assert {artist.get_gid() for artist in ax.get_children()} & {"path", "hold 1"}
    widest = max(asked.graph.margins.max(), 0.0)
    (drawn,) = (artist for artist in ax.get_children() if artist.get_gid() == "margins")
    assert np.nanmax(np.ma.filled(drawn.get_array(), np.nan)) == pytest.approx(np.degrees(widest), abs=1e-4)


@both
def test_fingers_keep_to_their_arcs(where):
    ends = ASKED[where][0]
    if where == "plane":
        arcs = [(0.85 * ELLIPSE.length, 0.3 * ELLIPSE.length), None, None]

        def may(point):
            place = ELLIPSE.nearest(point + ELLIPSE.centre_of_mass) / ELLIPSE.length
            return place >= 0.85 - 1e-6 or place <= 0.3 + 1e-6
    else:
        arcs = [[[0.0, -1, -1], [1, 1, 1]], lambda points: points[:, 0] <= 0.01, None, None]

        def may(point):
            return point[0] >= -1e-9

    plan = checked(problem(where, arcs=arcs).plans()[0])
    for step, names in zip(plan.steps, plan.fingers, strict=True):
        if names[0] is not None:
            assert may(step.grasp[names[0]].position)
    assert may(ends[1].positions[0])
    away = (0.5, 0.6) if where == "plane" else (lambda points: points[:, 0] < 0)
    with pytest.raises(rg.InvalidInput, match="is not on the arc of finger 1"):
        problem(where, arcs=[away, *[None] * (len(ends[1]) - 1)])


@both
def test_candidates_may_be_places(where):
    shape, _, _, _ = ASKED[where][0]
    usual = problem(where, candidates=10)
    places = ELLIPSE.sample(10) if where == "plane" else shape.sample(10) - shape.centre_of_mass
    asked = problem(where, candidates=places.tolist())
    points = [np.array([c.position for c in each.contacts]) for each in (usual, asked)]
    assert np.allclose(*(p[np.lexsort(p.T.round(9))] for p in points))
    assert asked == problem(where, candidates=places)
    assert asked.sequences()[0].moves == usual.sequences()[0].moves
    if where == "space":
        with pytest.raises(rg.InvalidInput, match="candidates must have shape"):
            problem(where, candidates=[0.1, 0.2])
        with pytest.raises(rg.InvalidInput, match="surface"):
            problem(where, candidates=[[9.0, 0.0, 0.0]])


@both
def test_refusals_say_what_would_make_it_possible(where):
    ends, usual = ASKED[where]
    friction, force = (0.3, 40.0) if where == "plane" else (MU, 0.7)
    slippery = [rg.Grasp(c.changed(friction=friction) for c in grasp) for grasp in ends[1:3]]
    options = usual | {"friction": friction, "orientations": 1, "max_force": force}
    with pytest.raises(rg.Infeasible, match="there would be one with friction") as caught:
        rg.plan_regrasp(ends[0], *slippery, ends[3], **options)
    obstacle = caught.value.certificate
    assert isinstance(obstacle, rg.RegraspObstacle)
    enough = [rg.Grasp(c.changed(friction=obstacle.friction) for c in grasp) for grasp in ends[1:3]]
    assert rg.plan_regrasps(ends[0], *enough, ends[3], **options | {"friction": obstacle.friction})
    nothing = {"keep": lambda a, b, c: np.zeros(len(a), dtype=bool), "min_distance": 99.0}
    for name, value in nothing.items():
        with pytest.raises(rg.Infeasible, match=f"without {name}") as caught:
            problem(where, orientations=1, **{name: value}).plans()
        assert name in caught.value.certificate.without


@both
@pytest.mark.parametrize("states", ["each", "joint"])
def test_fingers_push(where, states):
    free = problem(where, min_normal=0.0, states=states).plans()[0]
    load = np.linalg.norm(ASKED[where][0][3].force)
    asked = problem(where, min_normal=0.2 * load, states=states)
    plan = checked(asked.plans()[0])
    for step in plan.steps:
        for state in (step.start, step.end):
            normal = (state.forces * step.grasp.normals).sum(axis=1)
            assert normal[staying(step)].min() >= 0.2 * load * (1 - 1e-9)
    assert len(plan.moves) >= len(free.moves)
    if states == "each":
        assert len(plan.moves) > len(free.moves) or plan.margin <= free.margin + 2e-3
        usual = problem(where, states=states).plans()[0]
        assert not [note for note in usual.notes if "pushes with" in note]
