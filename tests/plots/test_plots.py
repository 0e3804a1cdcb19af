"""Pictures show the numbers of the values they draw, on the axes they are given."""

import re
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.patches import FancyArrowPatch, Wedge
from mpl_toolkits.mplot3d import Axes3D

import regrasp as rg
from paper import STATE
from regrasp import plots
from regrasp.mechanics.wrench_space import WrenchCone, WrenchLoop, WrenchPlane, iso_torque_line
from regrasp.plots.look.style import round_below
from regrasp.plots.look.view import best_view

pytestmark = pytest.mark.contract

PNG = b"\x89PNG\r\n\x1a\n"


def paper_removal(length=1.0, force=1.0):
    grasp = rg.Grasp(
        [
            rg.Contact([-4 * length, -4 * length], normal=[1, 1], friction=0.3, name="P1"),
            rg.Contact([4 * length, -5 * length], normal=[-1, 2], friction=0.3, name="P2"),
            rg.Contact([0, 8 * length], normal=[0, -1], friction=0.3, name="P3"),
        ]
    )
    forces = force * np.array([[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]])
    return rg.plan_removal(rg.GraspState(grasp, rg.Wrench([-1.5 * force, -3.5 * force]), forces), "P3")


def box_addition():
    """Different frictions, a load torque, and an infinite locus."""
    pair = rg.Grasp(
        [
            rg.Contact([-0.05, 0.002], [1, 0], 0.6, name="thumb"),
            rg.Contact([0.05, 0.01], [-1, 0], 0.5, name="index"),
        ]
    )
    middle = rg.Contact([0.01, -0.03], [0, 1], 0.4, name="middle")
    return rg.plan_addition(pair, middle, load=rg.Wrench([0.0, -8.0], 0.05), duration=0.4)


def five_fingers():
    angles = np.radians([10, 80, 150, 220, 300])
    grasp = rg.Grasp(
        [rg.Contact([3 * np.cos(a), 2 * np.sin(a)], [-2 * np.cos(a), -3 * np.sin(a)], 0.5) for a in angles]
    )
    return rg.plan_removal(grasp, "P2", load=rg.Wrench([1.0, -3.0], -1.5))


def unloaded():
    grasp = rg.Grasp(
        [
            rg.Contact([-1, 0], [1, 0], 0.5),
            rg.Contact([1, 0], [-1, 0], 0.5),
            rg.Contact([0, 1], [0, -1], 0.5),
        ]
    )
    return rg.plan_removal(grasp, "P3", load=rg.Wrench([0, 0]), max_force=5.0)


TRANSITIONS = {
    "paper": paper_removal,
    "tiny": lambda: paper_removal(1e-6, 1e-6),
    "huge": lambda: paper_removal(1e6, 1e6),
    "addition": box_addition,
    "five": five_fingers,
    "unloaded": unloaded,
}


@pytest.fixture(scope="module")
def removal():
    return paper_removal()


@pytest.fixture(scope="module")
def locus(removal):
    return rg.EquilibriumLocus(removal.grasp.without("P3"), removal.start.load)


def by_gid(ax, gid, kind=object):
    return [artist for artist in ax.get_children() if artist.get_gid() == gid and isinstance(artist, kind)]


def lines_by_label(ax):
    return {line.get_label(): line for line in ax.get_lines()}


def ends(arrow):
    return np.array(arrow._posA_posB)


def drawable(removal, locus):
    """Every public function on flat axes, with a value it draws."""
    return {
        plots.plot_state: removal.start,
        plots.plot_transition: removal,
        plots.plot_iso_torque: removal.grasp["P1"],
        plots.plot_scaling: removal.scaling,
        plots.plot_magnitudes: removal,
        plots.plot_rates: removal,
        plots.plot_angles: removal,
        plots.plot_margins: removal,
        plots.plot_locus: locus,
    }


def drawable_in_space(removal, locus):
    return {
        plots.plot_wrench_plane: WrenchPlane(removal.grasp["P1"]),
        plots.plot_wrench_cone: WrenchCone(removal.grasp["P1"]),
        plots.plot_locus_segment: locus,
        plots.plot_wrench_loop: removal.start,
        plots.plot_wrench_paths: removal,
    }


# -- axes --------------------------------------------------------------------------------------------


def test_each_function_draws_on_the_axes_it_is_given(removal, locus):
    for function, value in drawable(removal, locus).items():
        ax = Figure().add_subplot()
        assert function(value, ax) is ax
        assert ax.has_data()


def test_each_wrench_space_function_draws_on_the_axes_it_is_given_and_keeps_their_view(removal, locus):
    for function, value in drawable_in_space(removal, locus).items():
        ax = Figure().add_subplot(projection="3d")
        ax.view_init(11, 17)
        assert function(value, ax) is ax
        assert ax.has_data()
        assert (ax.elev, ax.azim) == (11, 17)


def test_new_axes_have_a_figure_of_a_columns_width_and_labels_with_units(removal, locus):
    everything = drawable(removal, locus) | drawable_in_space(removal, locus)
    for function, value in everything.items():
        ax = function(value)
        assert ax.figure.get_figwidth() == pytest.approx(3.4)
        labels = [ax.get_xlabel(), ax.get_ylabel(), *([ax.get_zlabel()] if isinstance(ax, Axes3D) else [])]
        assert all(label.endswith("]") and "[" in label for label in labels), (function, labels)


def test_the_units_are_those_of_the_conventions(removal, locus):
    expected = {
        plots.plot_state: ("m", "m"),
        plots.plot_transition: ("m", "m"),
        plots.plot_iso_torque: ("N", "N"),
        plots.plot_scaling: ("s", "-"),
        plots.plot_magnitudes: ("s", "N"),
        plots.plot_rates: ("s", "N/s"),
        plots.plot_angles: ("s", "deg"),
        plots.plot_margins: ("s", "deg"),
        plots.plot_locus: ("N", "deg"),
    }
    for function, value in drawable(removal, locus).items():
        ax = function(value)
        units = tuple(label.split("[")[1].rstrip("]") for label in (ax.get_xlabel(), ax.get_ylabel()))
        assert units == expected[function], function
    ax = plots.plot_wrench_loop(removal.start)
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()) == ("$f_x$ [N]", "$f_y$ [N]", r"$\tau$ [N m]")


def test_text_is_at_least_seven_points(removal):
    for name, figure in plots.figures(removal).items():
        figure.draw_without_rendering()
        for ax in figure.axes:
            texts = [*ax.texts, ax.xaxis.label, ax.yaxis.label, *ax.get_xticklabels(), *ax.get_yticklabels()]
            texts += ax.get_legend().get_texts() if ax.get_legend() else []
            assert min(text.get_fontsize() for text in texts) >= 7, name


def test_tiny_and_huge_numbers_share_a_power_of_ten_in_the_label():
    for length, power in ((1e-6, "10^{-6}"), (1e6, "10^{6}")):
        transition = paper_removal(length, 1.0)
        ax = plots.plot_transition(transition)
        assert power in ax.get_xlabel()
        ax.figure.draw_without_rendering()
        ticks = [label.get_text() for label in ax.get_xticklabels()]
        assert all(len(tick) <= 5 for tick in ticks)
        assert "0" in ticks


# -- the object --------------------------------------------------------------------------------------


def test_forces_stand_at_their_contacts_in_one_scale(removal):
    state = removal.start
    ax = plots.plot_state(state, force_scale=0.5)
    for name, r, f in zip(state.grasp.names, state.grasp.positions, state.forces, strict=True):
        (arrow,) = by_gid(ax, f"force {name}", FancyArrowPatch)
        np.testing.assert_allclose(ends(arrow), [r, r + 0.5 * f])
    (load,) = by_gid(ax, "load", FancyArrowPatch)
    np.testing.assert_allclose(ends(load), [[0, 0], 0.5 * state.load.force])
    assert ax.get_aspect() == 1


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_the_longest_force_spans_a_fixed_part_of_the_grasp_in_any_unit(scale):
    state = paper_removal(scale, 1 / scale).start
    ax = plots.plot_state(state)
    lengths = [
        np.linalg.norm(np.diff(ends(by_gid(ax, f"force {name}")[0]), axis=0)) for name in state.grasp.names
    ]
    assert max(lengths) == pytest.approx(0.45 * 13 * scale)  # P2 at y = -5, P3 at y = 8


def test_cones_have_the_contacts_opening_and_direction(removal):
    ax = plots.plot_state(removal.start)
    for name, contact in zip(removal.grasp.names, removal.grasp, strict=True):
        (cone,) = by_gid(ax, f"cone {name}", Wedge)
        half = np.degrees(np.arctan(contact.friction))
        assert cone.theta2 - cone.theta1 == pytest.approx(2 * half)
        middle = np.radians((cone.theta1 + cone.theta2) / 2)
        np.testing.assert_allclose([np.cos(middle), np.sin(middle)], contact.normal, atol=1e-12)


def test_a_contact_without_force_has_no_arrow(removal):
    ax = plots.plot_state(removal.end)
    assert [len(by_gid(ax, f"force {name}")) for name in ("P1", "P2", "P3")] == [1, 1, 0]


def test_paths_join_the_heads_of_both_states(removal):
    ax = plots.plot_transition(removal, force_scale=0.5)
    for i, name in enumerate(removal.grasp.names):
        (path,) = by_gid(ax, f"path {name}")
        r = removal.grasp.positions[i]
        heads = [r + 0.5 * removal.start.forces[i], r + 0.5 * removal.end.forces[i]]
        np.testing.assert_allclose(np.transpose(path.get_data()), heads)


def test_the_scale_key_names_the_force_its_bar_is_long(removal):
    ax = plots.plot_state(removal.start, force_scale=0.5)
    (key,) = [a for a in ax.artists if hasattr(a, "size_bar")]
    (bar,) = key.size_bar.get_children()
    force = float(key.txt_label.get_text().removesuffix(" N"))
    assert bar.get_width() == pytest.approx(0.5 * force)


def test_a_load_torque_turns_in_its_sense():
    contact = rg.Contact([1, 0], [-1, 0], 0.5)
    for torque in (2.0, -2.0):
        state = rg.GraspState(rg.Grasp([contact]), rg.Wrench([0, -1], torque), [[0, 0]])
        (arrow,) = by_gid(plots.plot_state(state), "load torque")
        tail, head = ends(arrow)
        assert np.sign(tail[0] * head[1] - tail[1] * head[0]) == np.sign(torque)
    assert not by_gid(
        plots.plot_state(rg.GraspState(state.grasp, rg.Wrench([0, -1]), [[0, 0]])), "load torque"
    )


def test_a_body_is_suggested_only_where_the_tangents_make_one():
    outside = [
        rg.Contact([1, 0], [-1, 0], 0.5),
        rg.Contact([-1, 0], [1, 0], 0.5),
        rg.Contact([0, 1], [0, -1], 0.5),
    ]
    inside = [rg.Contact(c.position, -c.normal, 0.5) for c in outside]
    for contacts, count in ((outside, 1), (inside, 0)):
        state = rg.GraspState(rg.Grasp(contacts), rg.Wrench([0, -1]), np.zeros((3, 2)))
        assert len(by_gid(plots.plot_state(state), "body")) == count


# -- iso-torque lines --------------------------------------------------------------------------------


def test_every_point_of_an_iso_torque_line_makes_its_torque(removal):
    contact, torques = removal.grasp["P2"], [-3.0, 1.5, 7.0]
    ax = plots.plot_iso_torque(contact, torques=torques)
    drawn = by_gid(ax, "line")
    assert len(drawn) == 3
    (x, y) = contact.position
    for line, torque in zip(drawn, torques, strict=True):
        fx, fy = line.get_data()
        np.testing.assert_allclose(x * fy - y * fx, torque)
    assert {"−3 N m", "1.5 N m", "7 N m"} <= {text.get_text() for text in ax.texts}


def test_bold_parts_of_the_lines_are_inside_the_cone(removal):
    contact = removal.grasp["P1"]
    ax = plots.plot_iso_torque(contact, torques=[-5.0, -0.5, 2.0], force=removal.start.force("P1"))
    bold = by_gid(ax, "inside the cone")
    assert len(bold) == 4
    for line in bold:
        f = np.transpose(line.get_data())
        normal = f @ contact.normal
        tangential = np.abs(f @ [-contact.normal[1], contact.normal[0]])
        assert (tangential <= contact.friction * normal + 1e-9).all()


def test_the_distance_and_the_line_of_a_force_are_marked(removal):
    contact, force = removal.grasp["P1"], removal.start.force("P1")
    ax = plots.plot_iso_torque(contact, force=force)
    own = iso_torque_line(contact, force)
    (arrow,) = by_gid(ax, "distance")
    assert np.linalg.norm(np.diff(ends(arrow), axis=0)) == pytest.approx(abs(own.distance))
    (line,) = by_gid(ax, "line of force")
    x, y = contact.position
    np.testing.assert_allclose(x * line.get_ydata() - y * line.get_xdata(), own.torque)
    np.testing.assert_allclose(ends(by_gid(ax, "force")[0]), [[0, 0], force])


def test_iso_torque_lines_need_an_arm_and_a_plane():
    with pytest.raises(rg.InvalidInput, match="centre of mass makes no torque"):
        plots.plot_iso_torque(rg.Contact([0, 0], [1, 0], 0.5))
    with pytest.raises(rg.InvalidInput, match="this picture is of the plane, got dimension 3; in space"):
        plots.plot_iso_torque(rg.Contact([0, 1, 0], [1, 0, 0], 0.5))


# -- over time ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("build", TRANSITIONS.values(), ids=TRANSITIONS)
def test_lines_over_time_are_the_transitions_numbers(build):
    transition = build()
    magnitudes = lines_by_label(plots.plot_magnitudes(transition))
    angles = lines_by_label(plots.plot_angles(transition))
    margins = lines_by_label(plots.plot_margins(transition, objective="force"))
    for i, name in enumerate(transition.grasp.names):
        t, drawn = magnitudes[name].get_data()
        assert (t[0], t[-1]) == (0, transition.duration)
        forces = transition.forces(t)[:, i]
        np.testing.assert_allclose(drawn, np.hypot(*forces.T))
        np.testing.assert_allclose(margins[name].get_ydata(), transition.margins(t).force[:, i])

        f, n = forces.T, transition.grasp.normals[i]
        between = np.degrees(np.arctan2(abs(n[0] * f[1] - n[1] * f[0]), n @ f))
        shown = np.isfinite(angles[name].get_ydata())
        np.testing.assert_allclose(angles[name].get_ydata()[shown], between[shown], atol=1e-9)
        idle = np.hypot(*f) <= 1e-12 * np.abs(transition.forces(t)).max()
        assert not (shown & idle).any()
        assert shown[~idle].all()


def test_angle_limits_are_the_cones_and_one_where_they_are_equal(removal):
    ax = plots.plot_angles(removal)
    (limit,) = [line for line in ax.get_lines() if (line.get_gid() or "").startswith("limit")]
    assert limit.get_ydata()[0] == pytest.approx(np.degrees(np.arctan(0.3)))
    addition = box_addition()
    ax = plots.plot_angles(addition)
    for contact in addition.grasp:
        (limit,) = by_gid(ax, f"limit {contact.name}")
        assert limit.get_ydata()[0] == pytest.approx(np.degrees(np.arctan(contact.friction)))
        assert limit.get_color() == lines_by_label(ax)[contact.name].get_color()


@pytest.mark.parametrize("objective", ["angle", "force"])
def test_the_least_margin_line_bounds_every_margin_and_touches_one(removal, objective):
    ax = plots.plot_margins(removal, objective=objective)
    (least,) = by_gid(ax, "least")
    used = removal.grasp.names if objective == "angle" else ("P1", "P2")  # the force margin of P3 ends at 0
    lowest = min(np.nanmin(lines_by_label(ax)[name].get_ydata()) for name in used)
    assert least.get_ydata()[0] == pytest.approx(lowest)


def test_margins_refuse_other_objectives(removal):
    with pytest.raises(rg.InvalidInput, match="objective must be one of angle, force; got 'effort'"):
        plots.plot_margins(removal, objective="effort")


@pytest.mark.parametrize("scaling", [rg.TimeScaling.spline(2.0), rg.TimeScaling.minimum_jerk(0.5)])
def test_the_scaling_is_drawn_with_its_control_values(scaling):
    lines = lines_by_label(plots.plot_scaling(scaling, control=True))
    t, values = lines["$T(t)$"].get_data()
    np.testing.assert_allclose(values, scaling(t))
    assert t[-1] == scaling.duration
    assert tuple(lines["control values"].get_ydata()) == scaling.control
    assert "control values" not in lines_by_label(plots.plot_scaling(scaling))


def test_control_values_stand_where_they_reproduce_a_straight_line():
    for degree in (1, 2, 3, 5):
        shape = rg.TimeScaling(2.0, tuple(np.linspace(1, 0, 8)), degree)
        straight = rg.TimeScaling(2.0, tuple(1 - shape.abscissae / 2.0), degree)
        t = np.linspace(0, 2, 17)
        np.testing.assert_allclose(straight(t), 1 - t / 2, atol=1e-12)


# -- the locus ---------------------------------------------------------------------------------------

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


# -- wrench space ------------------------------------------------------------------------------------


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


def test_contacts_keep_their_colour_in_every_figure(removal):
    colours = plots.contact_colours(removal.grasp)
    assert len(set(colours.values())) == 3
    drawn = plots.figures(removal)
    for stem in ("magnitudes", "angles", "margins"):
        lines = lines_by_label(drawn[stem].axes[0])
        assert {name: lines[name].get_color() for name in colours} == colours
    gone_first = removal.grasp.names[0]
    transition = rg.plan_removal(five_fingers().start, "P1")
    rest = {name: c for name, c in plots.contact_colours(transition.grasp).items() if name != gone_first}
    loop = plots.figures(transition)["wrench_loop"].axes[0]
    for name, colour in rest.items():
        (key,) = [line for line in loop.get_legend().get_lines() if line.get_label() == name]
        assert key.get_color() == colour


# -- names, limits, units -----------------------------------------------------------------------------


def test_names_are_shown_letter_by_letter():
    names = ("$x$", "_hidden", "a_1$")
    grasp = rg.Grasp(
        rg.Contact(c.position, c.normal, c.friction, name=name)
        for c, name in zip(paper_removal().grasp, names, strict=True)
    )
    drawn = plots.figures(rg.plan_removal(grasp, 2, load=rg.Wrench([-1.5, -3.5])))
    for stem, count in (("magnitudes", 3), ("wrench_loop", 2), ("wrench_paths", 3), ("locus", 2)):
        ax = drawn[stem].axes[0]
        legends = [artist for artist in ax.get_children() if isinstance(artist, Legend)]
        shown = [seen(text) for legend in legends for text in legend.get_texts()]
        assert [name for name in shown if name in names] == list(names[:count]), stem
    for stem in ("object", "states", "iso_torque"):
        shown = {seen(text) for ax in drawn[stem].axes for text in ax.texts}
        assert set(names) <= shown, stem


def seen(text):
    """What matplotlib draws of a text, without the room around it."""
    drawn, is_mathematics = text._preprocess_math(text.get_text())
    return None if is_mathematics else drawn.strip()


def test_a_finger_that_is_away_is_drawn_as_a_place(removal):
    for transition, away in ((removal, 1), (removal.reversed(), 0)):
        axes = plots.states_figure(transition).axes
        for i, ax in enumerate(axes):
            assert len(by_gid(ax, "absent P3")) == (i == away)
            assert len(by_gid(ax, "cone P3")) == (i != away)
            assert len(by_gid(ax, "cone P1")) == 1
        (place,) = by_gid(axes[away], "absent P3")
        np.testing.assert_allclose(np.ravel(place.get_data()), [0, 8])


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


def test_labels_name_the_units_they_are_told(removal, locus):
    units = plots.Units("mm", "kN", "ms")
    for function, value in (drawable(removal, locus) | drawable_in_space(removal, locus)).items():
        ax = function(value, units=units)
        labels = [ax.get_xlabel(), ax.get_ylabel(), *([ax.get_zlabel()] if isinstance(ax, Axes3D) else [])]
        named = {label.split("[")[1].rstrip("]") for label in labels}
        assert named <= {"mm", "kN", "ms", "kN mm", "kN/ms", "deg", "-"}, function
    ax = plots.plot_iso_torque(removal.grasp["P1"], torques=[3.0], units=units)
    assert "3 kN mm" in {text.get_text() for text in ax.texts}
    for figure in plots.figures(removal, units=units).values():
        for ax in figure.axes:
            assert not re.search(r"\[(N|m|s|N m)\]", ax.get_xlabel() + ax.get_ylabel())


@pytest.mark.parametrize("build", TRANSITIONS.values(), ids=TRANSITIONS)
def test_no_torque_is_written_beyond_its_panel(build):
    figure = plots.iso_torque_figure(build())
    figure.draw_without_rendering()
    for ax in figure.axes:
        frame = ax.get_window_extent()
        for text in ax.texts:
            if text.get_text().endswith("N m"):
                box = text.get_window_extent()
                assert frame.x0 <= box.x0 <= box.x1 <= frame.x1, text
                assert frame.y0 <= box.y0 <= box.y1 <= frame.y1, text


# -- all figures -------------------------------------------------------------------------------------

STEMS = {
    "overview",
    "states",
    "object",
    "iso_torque",
    "wrench_loop",
    "wrench_paths",
    "time_scaling",
    "magnitudes",
    "angles",
    "margins",
}


@pytest.mark.parametrize("build", TRANSITIONS.values(), ids=TRANSITIONS)
def test_figures_are_complete_and_can_be_written(build):
    transition = build()
    drawn = plots.figures(transition)
    assert set(drawn) == STEMS | ({"locus"} if len(transition.grasp) == 3 else set())
    for stem, figure in drawn.items():
        assert isinstance(figure, Figure)
        figure.draw_without_rendering()
        assert figure.axes, stem


def test_the_locus_figure_shows_what_the_state_was_chosen_for(removal):
    assert plots.figures(removal)["locus"].axes[0].get_ylabel() == "angle margin [deg]"
    by_effort = rg.plan_removal(removal.start, "P3", objective="effort")
    assert plots.figures(by_effort)["locus"].axes[0].get_ylabel().startswith("$|f|^2$")
    given = rg.plan_removal(removal.start, "P3", end=by_effort.end)
    assert plots.figures(given)["locus"].axes[0].get_ylabel() == "angle margin [deg]"


def test_a_contact_at_the_centre_of_mass_has_no_iso_torque_panel():
    grasp = rg.Grasp(
        [rg.Contact([0, 0], [0, 1], 0.5), rg.Contact([1, 0], [-1, 0], 0.8), rg.Contact([-1, 0], [1, 0], 0.8)]
    )
    transition = rg.plan_removal(grasp, 0, load=rg.Wrench([0, -1]))
    drawn = plots.figures(transition)
    assert len(drawn["iso_torque"].axes) == 2
    assert plots.png(drawn["iso_torque"]).startswith(PNG)


def test_notebooks_get_a_picture(removal):
    assert removal._repr_png_().startswith(PNG)


def test_pictures_of_the_plane_refuse_a_grasp_in_space():
    grasp = rg.Grasp([rg.Contact([1, 0, 0], [-1, 0, 0], 0.5), rg.Contact([-1, 0, 0], [1, 0, 0], 0.5)])
    state = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), [[-1, 0, 0], [1, 0, 0]])
    idle = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), np.zeros((2, 3)))
    transition = rg.Transition(state, idle, rg.TimeScaling.spline(1.0), None, leaving=("P1",))
    calls = [
        (plots.plot_wrench_loop, state),
        (plots.plot_wrench_paths, transition),
        (plots.iso_torque_figure, transition),
    ]
    for function, value in calls:
        with pytest.raises(rg.InvalidInput, match="this picture is of the plane, got dimension 3; in space"):
            function(value)


def test_drawing_does_not_import_pyplot():
    code = """
import sys
from regrasp import plots
import regrasp as rg
sides = [rg.Contact([-1, 0], [1, 0], 0.9), rg.Contact([1, 0], [-1, 0], 0.9)]
contacts = [*sides, rg.Contact([0, 1], [0, -1], 0.9)]
removal = rg.plan_removal(rg.Grasp(contacts), 2, load=rg.Wrench([0, -1]))
written = [plots.png(figure) for figure in plots.figures(removal).values()]
print(len(written), "matplotlib.pyplot" in sys.modules)
"""
    assert run(code) == "11 False"


def test_importing_and_planning_do_not_import_matplotlib():
    code = """
import sys
import regrasp as rg
sides = [rg.Contact([-1, 0], [1, 0], 0.9), rg.Contact([1, 0], [-1, 0], 0.9)]
contacts = [*sides, rg.Contact([0, 1], [0, -1], 0.9)]
rg.plan_removal(rg.Grasp(contacts), 2, load=rg.Wrench([0, -1]))
print(any(name.split(".")[0] in ("matplotlib", "mpl_toolkits") for name in sys.modules))
"""
    assert run(code) == "False"


def test_round_numbers_stay_below():
    assert [round_below(x) for x in (1.0, 1.9, 2.0, 7.0, 0.03, 5e-7)] == [1.0, 1.0, 2.0, 5.0, 0.02, 5e-7]


def run(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_a_load_over_time_is_drawn_where_it_varies() -> None:
    series = rg.LoadSeries([0.0, 0.5, 1.0], [[-1.5, -3.5, 0.0], [-1.0, -3.0, 0.2], [-1.5, -3.5, 0.1]])
    varying = rg.plan_removal(STATE.grasp, "P3", load=series, instants=5)
    ax = plots.plot_load(varying)
    drawn = {line.get_label(): line.get_ydata() for line in ax.get_lines()}
    assert drawn["$f_x$"] == pytest.approx([-1.5, -1.25, -1.0, -1.25, -1.5])
    assert drawn["$f_y$"] == pytest.approx(varying.course.loads[:, 1])
    (right,) = [other for other in ax.figure.axes if other is not ax]
    assert right.get_lines()[0].get_ydata() == pytest.approx(varying.course.loads[:, 2])
    assert "load" in plots.figures(varying)
    straight = rg.plan_removal(STATE, "P3")
    assert "load" not in plots.figures(straight)
    with pytest.raises(rg.InvalidInput, match="constant"):
        plots.plot_load(straight)


def test_the_dashed_margin_of_a_path_is_its_least_at_any_instant() -> None:
    path = rg.plan_removal(STATE, "P3", duration=1.0, rate_limit=5.0)
    ax = plots.plot_margins(path, objective="force")
    (least,) = [line.get_ydata()[0] for line in ax.get_lines() if line.get_gid() == "least"]
    assert least == pytest.approx(path.margins(path.course.times).least_force)
