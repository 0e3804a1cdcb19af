"""Arcs of holds over the object's angle: sectors are where pairs hold, curves are their margins."""

import numpy as np
import pytest

import regrasp as rg
from regrasp import plots
from regrasp.planning.holds.pairs import HoldGraph, evenly, named

pytestmark = pytest.mark.laws

OUTLINE, WEIGHT = rg.Outline.ellipse(2, 1), rg.Wrench([0, -3.0])


def graph_on(count, angles=(0.0,), **options):
    places = OUTLINE.sample(count)
    contacts = named([OUTLINE.contact_at(float(s), friction=0.4) for s in places], "c")
    return HoldGraph(tuple(contacts), WEIGHT, np.asarray(angles), **options), places


def drawn(ax, gid):
    return next(artist for artist in ax.get_children() if artist.get_gid() == gid)


@pytest.mark.parametrize("options", [{}, {"min_distance": 1.0, "min_normal": 0.5}])
def test_sectors_are_the_angles_that_hold_and_below_those_that_keep_a_margin(options):
    """Against margins at many angles of the graph, which know nothing of arcs."""
    count, level = 9, 0.2
    graph, places = graph_on(count, evenly(180), **options)
    ax = plots.plot_hold_arcs(graph, OUTLINE, level=level)
    inside = [(p, np.ptp(p.vertices, axis=0)) for p in drawn(ax, "sectors").get_paths()]
    radius = 0.47 * np.median(np.diff(places))
    seen = 0
    for i in range(count):
        for j in range(i):
            margins = graph.margins[:, graph.pair(i, j)]
            for at, least in (((places[j], places[i]), 0.0), ((places[i], places[j]), level)):
                own = [
                    p
                    for p, size in inside
                    if p.contains_point(at, radius=1e-3) and size.max() <= 2.1 * radius
                ]
                for k in range(0, 180, 7):
                    near = margins[[(k + d) % 180 for d in range(-3, 4)]] >= least
                    if near.all() or not near.any():  # sectors of one angle are drawn 6 deg wide
                        way = 0.6 * radius * np.array([np.cos(graph.angles[k]), np.sin(graph.angles[k])])
                        assert any(p.contains_point(at + way) for p in own) == near[0]
                        seen += near[0]
    assert seen > 50


def test_curves_are_the_margins_of_a_plan_s_holds():
    ends = (
        rg.Grasp(OUTLINE.contact_at(p * OUTLINE.length, friction=0.4) for p in places)
        for places in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    problem = rg.RegraspProblem(OUTLINE, *ends, WEIGHT, 0.4, goal_orientation=2.0, candidates=20)
    plan = problem.plans()[0]
    ax = plots.plot_hold_margins(plan, problem.graph)
    held = {
        tuple(sorted(set(step.grasp.names) - set(step.idle_at_end)))
        for step in plan.steps[:-1]
        if len(step.grasp) - len(step.idle_at_end) == 2
    }
    curves = [line for line in ax.lines if line.get_gid() == "margin"]
    assert {tuple(line.get_label().split(" and ")) for line in curves} == held
    contacts = {c.name: c for c in problem.contacts}
    for line in curves:
        pair = rg.Grasp(contacts[name] for name in line.get_label().split(" and "))
        for angle, margin in line.get_xydata()[::60].tolist():
            try:
                state = rg.choose_state(pair, WEIGHT.rotated(-np.radians(angle)), "angle")
            except rg.Infeasible:
                assert np.isnan(margin)
            else:
                assert margin == pytest.approx(np.degrees(state.value), abs=1e-6)
    least = min(y for _, y in drawn(ax, "holds").get_xydata())
    assert least >= np.degrees(plan.margin) - 1e-6
    with pytest.raises(rg.InvalidInput, match="must be those of the graph"):
        plots.plot_hold_margins(plan, graph_on(5)[0])


def test_filters_are_of_single_angles():
    graph, _ = graph_on(5, keep=lambda p, q, angle: np.ones(len(p), dtype=bool))
    with pytest.raises(rg.InvalidInput, match="leave it out"):
        plots.plot_hold_arcs(graph, OUTLINE)
