"""The two-finger map shows the margins of the hold graph at the right places, and plans walk on it."""

import numpy as np
import pytest

import regrasp as rg
from box import BOX, GOAL, MU, START
from box import WEIGHT as BOX_WEIGHT
from regrasp import plots
from regrasp.outline import parts
from regrasp.planning.holds.pairs import HoldGraph, evenly, named

pytestmark = pytest.mark.contract

WEIGHT = rg.Wrench([0, -3.0])


def graph_on(outline, count=40, orientations=6, friction=0.5):
    places = outline.sample(count)
    contacts = named([outline.contact_at(float(s), friction=friction) for s in places], "c")
    return HoldGraph(tuple(contacts), WEIGHT, evenly(orientations)), places


def grasp_on(outline, places, prefix):
    return rg.Grasp(
        outline.contact_at(s * outline.length, friction=0.5, name=f"{prefix}{i}")
        for i, s in enumerate(places)
    )


def mesh(ax, gid):
    (found,) = [artist for artist in ax.get_children() if artist.get_gid() == gid]
    return found


def shown_at(ax, x, y):
    """The margin [deg] drawn at a point; -1 for no hold, None for white."""
    for gid in ("margins", "no hold"):
        drawn = mesh(ax, gid)
        edges = drawn.get_coordinates()[0, :, 0]
        values = np.ma.filled(drawn.get_array(), np.nan).reshape(len(edges) - 1, -1)
        row, column = (int(np.searchsorted(edges, v)) - 1 for v in (y, x))
        if not (0 <= row < len(edges) - 1 and 0 <= column < len(edges) - 1):
            return None
        if np.isfinite(values[row, column]):
            return values[row, column] if gid == "margins" else -1.0
    return None


@pytest.mark.parametrize("o", [None, 0, 4])
@pytest.mark.parametrize("outline", [rg.Outline.ellipse(2, 1), parts.bracket()], ids=["ellipse", "bracket"])
def test_colours_are_the_margins_of_the_graph(outline, o):
    graph, places = graph_on(outline)
    ax = plots.plot_hold_map(graph, outline, o)
    best = graph.margins.max(axis=0) if o is None else graph.margins[o]
    held = 0
    for i, x in enumerate(places):
        for j, y in enumerate(places):
            margin = -1.0 if i == j else best[graph.pair(i, j)]
            expected = np.degrees(margin) if margin >= 0 else -1.0
            assert shown_at(ax, x, y) == pytest.approx(expected, abs=1e-4)
            held += margin >= 0
    assert held > 10
    assert ax.get_aspect() == 1


def test_corners_are_white():
    square = rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    contacts = [
        square.contact_at(s, friction=0.5) for side in range(4) for s in 2 * side + np.linspace(0.5, 1.5, 9)
    ]
    graph = HoldGraph(tuple(named(contacts, "c")), WEIGHT, evenly(3))
    ax = plots.plot_hold_map(graph, square)
    for corner in (2.0, 4.0, 6.0):
        assert shown_at(ax, corner, 1.0) is None
        assert shown_at(ax, 1.0, corner) is None
    assert shown_at(ax, 3.0, 7.0) > 5


@pytest.mark.parametrize("turn", [0.0, 2.0])  # in the second one finger of a hold carries no force
def test_a_plan_walks_along_the_axes_from_hold_to_hold(turn):
    outline = rg.Outline.ellipse(2, 1)
    start, goal = grasp_on(outline, (0.02, 0.35, 0.7), "A"), grasp_on(outline, (0.2, 0.5, 0.85), "B")
    plan = rg.plan_regrasp(
        outline, start, goal, WEIGHT, friction=0.5, orientations=12, candidates=40, goal_orientation=turn
    )
    graph, _ = graph_on(outline)
    ax = plots.plot_hold_map(graph, outline, plan=plan)
    path = np.array(mesh(ax, "path").get_data()).T
    held = [step for step in plan.steps[:-1] if len(step.grasp) - len(step.idle_at_end) == 2]
    for step, here in zip(held, path, strict=True):  # not where all three hold between two steps
        expected = {
            tuple(np.round(step.grasp[name].position, 6))
            for name in step.grasp.names
            if name not in step.idle_at_end
        }
        assert {tuple(np.round(p, 6)) for p in outline.points(here)} == expected
    moved = abs(np.diff(path, axis=0)) > 1e-6
    assert (moved.sum(axis=1) <= 1).all()  # one finger stays
    assert moved.any()
    ax.figure.canvas.draw()


def test_bad_input():
    outline = rg.Outline.ellipse(2, 1)
    graph, _ = graph_on(outline, 10)
    with pytest.raises(rg.InvalidInput, match="o must be one of 6 orientations, got 6"):
        plots.plot_hold_map(graph, outline, 6)
    with pytest.raises(rg.InvalidInput, match="contact 'c1' is not on the outline"):
        plots.plot_hold_map(graph, rg.Outline.ellipse(2, 1.1))


@pytest.mark.parametrize("o", [None, 0, -1])
def test_in_space_a_pair_has_the_margin_of_its_best_third_finger(o):
    problem = rg.RegraspProblem(BOX, START, GOAL, BOX_WEIGHT, MU, orientations=4, candidates=8)
    graph = problem.graph
    ax = plots.plot_hold_map(graph, o=o, plan=problem.plans()[0])
    best = np.degrees(graph.margins.max(axis=0) if o is None else graph.margins[o])
    count = len(graph.contacts)
    for i, j in [(0, 1), (2, 7), (9, 4), (3, 3)]:
        thirds = [k for k in range(count) if len({i, j, k}) == 3]
        expected = max((best[graph.triple(i, j, k)] for k in thirds if i != j), default=-1.0)
        assert shown_at(ax, i + 1, j + 1) == pytest.approx(max(expected, -1.0), abs=1e-4)
    assert mesh(ax, "hold 1")


def test_a_map_in_space_has_no_outline():
    graph = rg.RegraspProblem(BOX, START, GOAL, BOX_WEIGHT, MU, orientations=1, candidates=4).graph
    with pytest.raises(rg.InvalidInput, match="needs no outline"):
        plots.plot_hold_map(graph, rg.Outline.ellipse(2, 1))
    with pytest.raises(rg.InvalidInput, match="outline is missing"):
        plots.plot_hold_map(graph_on(rg.Outline.ellipse(2, 1))[0])
    with pytest.raises(rg.InvalidInput, match="graph must be a HoldGraph or a TripleGraph"):
        plots.plot_hold_map(3)
