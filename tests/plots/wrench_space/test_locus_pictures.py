"""Loci, cones, planes and loops of wrenches are drawn where they are."""

import numpy as np
import pytest

import regrasp as rg
from drawn import by_gid, lines_by_label
from pictured import TRANSITIONS, box_addition, paper_removal
from regrasp import plots
from regrasp.mechanics.wrench_space import WrenchCone, WrenchLoop
from regrasp.plots.look.view import best_view

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def removal():
    return paper_removal()


@pytest.fixture(scope="module")
def locus(removal):
    return rg.EquilibriumLocus(removal.grasp.without("P3"), removal.start.load)


VALUES = {
    "angle": lambda state: np.degrees(state.margins.angle),
    "force": lambda state: state.margins.force,
    "effort": lambda state: state.magnitudes**2,
    "peak": lambda state: state.magnitudes,
    "peak_normal": lambda state: (state.forces * state.grasp.normals).sum(axis=1),
    "friction_use": lambda state: state.margins.friction_use,
}


@pytest.mark.parametrize(
    ("objective", "together", "combine"),
    [
        ("angle", "least", min),
        ("force", "least", min),
        ("effort", "sum", sum),
        ("peak", "largest", max),
        ("peak_normal", "largest", max),
        ("friction_use", "largest", max),
    ],
)
def test_the_locus_shows_each_contact_their_objective_and_the_chosen_state(
    locus, objective, together, combine
):
    best = locus.best(objective)
    ax = plots.plot_locus(locus, objective=objective, chosen=best)
    lines = lines_by_label(ax)
    x = lines["P1"].get_xdata()
    for k in (40, 200, 360):
        values = VALUES[objective](locus.state(x[k]))
        np.testing.assert_allclose([lines[name].get_ydata()[k] for name in ("P1", "P2")], values)
        assert lines[together].get_ydata()[k] == pytest.approx(combine(values))
    marked_x, marked_value = lines["chosen"].get_data()
    assert marked_x == pytest.approx(locus.squeeze(best))
    best_value = np.degrees(best.value) if objective == "angle" else best.value
    assert marked_value == pytest.approx(best_value)
    assert [line.get_xdata()[0] for line in by_gid(ax, "end")] == list(locus.interval)


def test_an_infinite_locus_shows_its_end_and_the_chosen_state():
    addition = box_addition()
    rest = addition.start.without("middle")
    locus = rg.EquilibriumLocus(rest.grasp, rest.load)
    assert np.isinf(locus.interval[1])
    ax = plots.plot_locus(locus, chosen=rest)
    (end,) = by_gid(ax, "end")
    assert end.get_xdata()[0] == locus.interval[0]
    assert ax.get_xlim()[0] < locus.interval[0] < locus.squeeze(rest) < ax.get_xlim()[1]


def test_a_locus_of_one_point_is_drawn_and_an_empty_one_refused():
    down = [rg.Contact([-1, 0], [0, 1], 0.0), rg.Contact([1, 0], [0, 1], 0.0)]
    point = rg.EquilibriumLocus(rg.Grasp(down), rg.Wrench([0, -1]))
    assert len(by_gid(plots.plot_locus(point), "end")) == 2
    assert by_gid(plots.plot_locus_segment(point), "locus")
    empty = rg.EquilibriumLocus(rg.Grasp(down), rg.Wrench([0, 1]))
    for function in (plots.plot_locus, plots.plot_locus_segment):
        with pytest.raises(rg.Infeasible, match="the equilibrium locus of P1, P2 is empty: nothing to draw"):
            function(empty)


def test_the_loop_closes_through_the_wrenches(removal):
    state, order = removal.start, ("P1", "P3", "P2")
    ax = plots.plot_wrench_loop(state, order=order)
    head = state.load.vector
    np.testing.assert_allclose(by_gid(ax, "load")[0].ends, [np.zeros(3), head])
    for name in order:
        (arrow,) = by_gid(ax, f"wrench {name}")
        np.testing.assert_allclose(arrow.ends[0], head, atol=1e-9)
        np.testing.assert_allclose(arrow.ends[1] - arrow.ends[0], state.wrenches[state.grasp.index(name)])
        head = arrow.ends[1]
    np.testing.assert_allclose(head, 0, atol=1e-9)
    assert len([c for c in ax.collections if (c.get_gid() or "").startswith("cone ")]) == 3


@pytest.mark.parametrize("order", [("P1", "P2"), ("P2", "P1")])
def test_two_contacts_meet_in_their_locus(removal, order):
    rest = removal.end.without("P3")
    ax = plots.plot_wrench_loop(rest, order=order)
    (segment,) = by_gid(ax, "locus")
    first, last = WrenchLoop(rest, order).cones()
    for point in np.transpose(segment.get_data_3d()):
        assert first.contains(point)
        assert last.contains(point)


def test_the_locus_of_the_others_is_ls_a(removal):
    """Fig. 6: w_1 known, LS_A lies on S Pi_3 from the head of w_1 and on S Pi_2 inverted from the origin."""
    grasp, load = removal.grasp, removal.start.load
    first = rg.Wrench.from_vector(removal.start.wrenches[0])
    ls_a = rg.EquilibriumLocus(grasp.subset(["P3", "P2"]), load + first)
    (segment,) = by_gid(plots.plot_locus_segment(ls_a, label="$LS_A$"), "locus")
    for point in np.transpose(segment.get_data_3d()):
        assert WrenchCone(grasp["P3"], (load + first).vector).contains(point)
        assert WrenchCone(grasp["P2"], np.zeros(3), -1).contains(point)


@pytest.mark.parametrize("build", TRANSITIONS.values(), ids=TRANSITIONS)
def test_wrench_paths_join_both_loops(build):
    transition = build()
    ax = plots.plot_wrench_paths(transition)
    others = [name for name in transition.grasp.names if name != transition.contact]
    wrenches = transition.start.wrenches, transition.end.wrenches
    first = transition.grasp.index(others[0])
    (path,) = by_gid(ax, f"path {others[0]}")
    heads = [transition.start.load.vector + w[first] for w in wrenches]
    np.testing.assert_allclose(np.transpose(path.get_data_3d()), heads, atol=1e-12 * np.abs(heads).max())
    last = transition.grasp.index(others[-1])
    (path,) = by_gid(ax, f"path {others[-1]}")
    tails = np.array([-w[last] for w in wrenches])
    scale = np.abs(tails).max(axis=0).max()
    np.testing.assert_allclose(np.transpose(path.get_data_3d()), tails, atol=1e-9 * scale)
    for end, state in (("start", transition.start), ("end", transition.end)):
        drawn = tuple(name for name in transition.grasp.names if by_gid(ax, f"{end} wrench {name}"))
        assert drawn == state.in_use
    rungs = by_gid(ax, f"path {transition.contact}")
    own = [np.ptp(rung.get_data_3d(), axis=1) for rung in rungs]
    w = wrenches[transition.kind == "addition"][transition.grasp.index(transition.contact)]
    assert len(own) == 5
    for extent in own:  # parallel to the whole wrench
        np.testing.assert_allclose(np.cross(extent, np.abs(w)), 0, atol=1e-9 * (w @ w))


def test_a_cone_is_drawn_on_its_plane_with_its_shadow_below(removal):
    cone = WrenchCone(removal.grasp["P2"], np.array([1.0, 2.0, 3.0]))
    ax = plots.plot_wrench_cone(cone, reach=2.0, shadow=True)
    shapes = {c.get_gid(): np.array(c._faces[0]) for c in ax.collections}
    sector, shadow = shapes["cone P2"], shapes["friction cone P2"]
    assert all(cone.contains(point) for point in sector)
    assert np.linalg.norm(sector[1:, :2] - cone.apex[:2], axis=1) == pytest.approx([2, 2])
    np.testing.assert_allclose(shadow[:, :2], sector[:, :2])
    np.testing.assert_allclose(shadow[:, 2], 3.0)


def test_the_view_looks_onto_a_flat_shape_and_not_along_it():
    upright = np.array([[0.0, 0, 0], [1, 1, 0], [1, 1, 1], [0, 0, 1]])  # its normal points along azimuth -45
    _, azimuth = best_view([upright, 2 * upright + 1])
    assert min(abs((azimuth - facing + 180) % 360 - 180) for facing in (135, 315)) <= 20


def test_the_locus_is_hatched_where_a_force_exceeds_its_limit(locus):
    lo, hi = locus.interval
    ax = plots.plot_locus(locus, force_limits=(3.2, np.inf))
    (line,) = by_gid(ax, "force limit")
    at = line.get_xdata()[0]
    assert lo < at < hi
    assert locus.state(at).magnitudes[0] == pytest.approx(3.2)
    (span,) = by_gid(ax, "over limit")
    start, end = span.get_x(), span.get_x() + span.get_width()
    assert (start, end) == pytest.approx((at, hi))
    assert locus.state(end).magnitudes[0] > 3.2
    (at,) = limit_lines(plots.plot_locus(locus, force_limits=(np.inf, 1.25)))
    assert locus.state(at).magnitudes[1] == pytest.approx(1.25)
    assert not by_gid(plots.plot_locus(locus), "over limit")
    assert by_gid(plots.plot_locus(locus, force_limits=(0.1, 0.1)), "over limit")  # none holds: all of it
    with pytest.raises(rg.InvalidInput, match="force_limits must be two numbers"):
        plots.plot_locus(locus, force_limits=(1.0,))


def limit_lines(ax):
    return [line.get_xdata()[0] for line in by_gid(ax, "force limit")]


def test_limits_come_from_the_choice_or_from_the_contacts():
    addition = box_addition()
    (at,) = limit_lines(plots.figures(addition)["locus"].axes[0])
    limits = addition.record.choices[0].force_limits
    rest = addition.start.without("middle")
    locus = rg.EquilibriumLocus(rest.grasp, rest.load)
    assert max(locus.state(at).magnitudes / limits[:2]) == pytest.approx(1, rel=1e-8)
    best = locus.best("angle", max_force=20.0)
    (at,) = limit_lines(plots.plot_locus(locus, chosen=best))
    assert max(locus.state(at).magnitudes) == pytest.approx(20)
    own = rg.Grasp(rg.Contact(c.position, c.normal, c.friction, max_force=15.0) for c in rest.grasp)
    (at,) = limit_lines(plots.plot_locus(rg.EquilibriumLocus(own, rest.load)))
    assert max(locus.state(at).magnitudes) == pytest.approx(15)


def test_the_locus_figure_shows_what_the_state_was_chosen_for(removal):
    assert plots.figures(removal)["locus"].axes[0].get_ylabel() == "angle margin [deg]"
    by_effort = rg.plan_removal(removal.start, "P3", objective="effort")
    assert plots.figures(by_effort)["locus"].axes[0].get_ylabel().startswith("$|f|^2$")
    given = rg.plan_removal(removal.start, "P3", end=by_effort.end)
    assert plots.figures(given)["locus"].axes[0].get_ylabel() == "angle margin [deg]"
