"""Pictures of grasps show forces, cones, loads and lines of equal torque where they are."""

import numpy as np
import pytest
from matplotlib.patches import FancyArrowPatch, Wedge

import regrasp as rg
from drawn import by_gid, ends
from pictured import paper_removal
from regrasp import plots
from regrasp.mechanics.wrench_space import iso_torque_line

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def removal():
    return paper_removal()


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


def test_a_finger_that_is_away_is_drawn_as_a_place(removal):
    for transition, away in ((removal, 1), (removal.reversed(), 0)):
        axes = plots.states_figure(transition).axes
        for i, ax in enumerate(axes):
            assert len(by_gid(ax, "absent P3")) == (i == away)
            assert len(by_gid(ax, "cone P3")) == (i != away)
            assert len(by_gid(ax, "cone P1")) == 1
        (place,) = by_gid(axes[away], "absent P3")
        np.testing.assert_allclose(np.ravel(place.get_data()), [0, 8])
