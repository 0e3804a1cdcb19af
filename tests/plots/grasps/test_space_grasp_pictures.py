"""Pictures of grasps in space show forces, cones, meshes and paths where they are."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

import regrasp as rg
from drawn import by_gid, corners, one, points_of
from pictured import box, lifted, pinch
from regrasp import plots
from regrasp.mesh import Mesh
from regrasp.plots.look.arrows import Arrow3D
from regrasp.plots.look.solids import cone, creases, triangles_of

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def lift():
    return lifted()


@pytest.fixture(scope="module")
def block():
    return box(0.06, 0.04, 0.03)


def test_forces_in_space_stand_at_their_contacts_in_one_scale(lift, block):
    ax = plots.plot_state(lift.start, force_scale=0.002, mesh=block)
    for name, r, f in zip(lift.grasp.names, lift.grasp.positions, lift.start.forces, strict=True):
        np.testing.assert_allclose(one(ax, f"force {name}", Arrow3D).ends, [r, r + 0.002 * f])
        np.testing.assert_allclose(points_of(one(ax, f"contact {name}")), [r])
        assert one(ax, f"name {name}").get_text() == name
    np.testing.assert_allclose(one(ax, "load", Arrow3D).ends, [[0, 0, 0], [0, 0, -0.01]])
    assert one(ax, "scale").get_text() == f"longest arrow: {lift.start.magnitudes.max():.4g} N"


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_the_longest_force_in_space_spans_a_fixed_part_of_the_object_in_any_unit(scale):
    state = lifted(scale, 1 / scale).start
    slender = box(0.1 * scale, 0.02 * scale, 0.02 * scale)
    for mesh, longest in (None, 0.45 * 0.06), (slender, 0.02):  # not longer than a slender body is wide
        ax = plots.plot_state(state, mesh=mesh)
        lengths = [np.linalg.norm(np.diff(one(ax, f"force {n}").ends, axis=0)) for n in state.grasp.names]
        assert max(lengths) == pytest.approx(longest * scale)


def test_cones_in_space_have_the_contacts_opening_and_direction(lift):
    ax = plots.plot_state(lift.start)
    for name, contact in zip(lift.grasp.names, lift.grasp, strict=True):
        arms = corners(one(ax, f"cone {name}", Poly3DCollection)) - contact.position
        arms = arms[np.linalg.norm(arms, axis=1) > 1e-9]
        along = arms @ contact.normal
        across = np.linalg.norm(arms - along[:, None] * contact.normal, axis=1)
        np.testing.assert_allclose(across, contact.friction * along)


def test_the_mesh_and_its_sharp_edges_are_drawn_in_the_objects_frame(lift, block):
    class Part:
        def surface(self):
            return block

    for mesh in (block, Part()):
        ax = plots.plot_state(lift.start, mesh=mesh)
        drawn = corners(one(ax, "mesh", Poly3DCollection))
        np.testing.assert_allclose(np.unique(drawn, axis=0), np.unique(block[0], axis=0))
        assert len(one(ax, "edges", Line3DCollection)._segments3d) == 12
    assert not by_gid(plots.plot_state(lift.start), "mesh")


def test_one_scale_holds_along_all_axes(lift, block):
    ax = plots.plot_state(lift.start, mesh=block)
    spans = np.array([np.ptp(lim) for lim in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())])
    np.testing.assert_allclose(ax._box_aspect / spans, (ax._box_aspect / spans)[0])
    assert [ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()] == [f"${a}$ [m]" for a in "xyz"]
    named = plots.plot_state(lift.start, units=plots.Units("mm", "kN"))
    assert named.get_zlabel().endswith("mm]")
    assert one(named, "scale").get_text().endswith("kN")
    assert ax.figure.get_figwidth() == pytest.approx(3.4)


def test_numbers_of_two_axes_do_not_run_together(lift, block):
    ax = plots.plot_state(lift.start, mesh=block)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        low, high = axis.get_view_interval()
        ticks = axis.get_majorticklocs()
        assert len(ticks) > 1
        assert (np.minimum(ticks - low, high - ticks) >= 0.069 * (high - low)).all()


def test_an_absent_finger_in_space_is_an_open_circle(lift):
    ax = plots.plot_state(lift.end, absent=["ring"])
    np.testing.assert_allclose(points_of(one(ax, "absent ring")), [lift.grasp["ring"].position])
    assert one(ax, "name ring").get_text() == "(ring)"
    assert not by_gid(ax, "force ring")
    assert not by_gid(ax, "cone ring")


def test_a_load_torque_turns_right_handed_about_its_axis():
    grasp = rg.Grasp([rg.Contact([1, 0, 0], [-1, 0, 0], 0.5)])
    for torque in ([0, 0, 2.0], [1.0, -2, 0.5]):
        ax = plots.plot_state(rg.GraspState(grasp, rg.Wrench([0, 0, 0], torque), [[0, 0, 0]]))
        tail, head = one(ax, "load torque", Arrow3D).ends
        assert np.cross(tail, head) @ torque > 0
        np.testing.assert_allclose([tail @ torque, head @ torque], 0, atol=1e-12)
        assert not by_gid(ax, "load")


def test_paths_in_space_join_the_heads_of_both_states(lift):
    ax = plots.plot_transition(lift, force_scale=0.002)
    for i, name in enumerate(lift.grasp.names):
        r = lift.grasp.positions[i]
        path = points_of(one(ax, f"path {name}"))
        for at, state in ((path[0], lift.start), (path[-1], lift.end)):
            np.testing.assert_allclose(at, r + 0.002 * state.forces[i])
    assert [len(by_gid(ax, f"end force {name}")) for name in lift.grasp.names] == [1, 1, 1, 0]
    assert {t.get_text() for t in ax.get_legend().get_texts()} == {"start", "end", "path"}


def test_axes_in_space_are_kept_with_their_view_and_flat_ones_refused(lift, block):
    ax = Figure().add_subplot(projection="3d")
    ax.view_init(11, 17)
    for draw, value in ((plots.plot_state, lift.start), (plots.plot_transition, lift)):
        assert draw(value, ax, mesh=block) is ax
        assert not ax.computed_zorder  # arrows inside the translucent object are drawn over it
        assert (ax.elev, ax.azim) == (11, 17)
        with pytest.raises(rg.InvalidInput, match=r"ax must be 3-D .*projection='3d'"):
            draw(value, Figure().add_subplot())


def test_meshes_are_checked(lift, block):
    vertices, faces = block
    planar = rg.GraspState(rg.Grasp([rg.Contact([1, 0], [-1, 0], 0.5)]), rg.Wrench([0, 0]), [[0, 0]])
    with pytest.raises(rg.InvalidInput, match="this grasp is planar"):
        plots.plot_state(planar, mesh=block)
    for mesh, said in (
        (7, "surface"),
        ((vertices, faces[:0]), "one face or more"),
        ((vertices, faces + 1), "from 0 to 7"),
        ((vertices, faces + 0.5), "whole numbers"),
        ((vertices[:, :2], faces), "mesh vertices must have shape"),
    ):
        with pytest.raises(rg.InvalidInput, match=said):
            plots.plot_state(lift.start, mesh=mesh)


def test_only_sharp_edges_count_as_edges():
    side = cone([0, 0, 0], [0, 0, 1], 1.0, 1.0, sides=48)
    assert len(creases(side)) == 48  # the open rim; its smooth side has none
    vertices, faces = box(1, 2, 3)
    loose = vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)  # as STL files have it
    for triangles in ((vertices, faces), loose):
        lengths = np.linalg.norm(np.diff(creases(triangles_of(triangles)), axis=1), axis=2)
        np.testing.assert_allclose(np.sort(lengths.ravel()), [1] * 4 + [2] * 4 + [3] * 4)


def test_a_smooth_object_has_no_edges_to_draw(lift):
    ball = Mesh.sphere(0.05)
    assert len(creases(triangles_of(ball))) == 0
    ax = plots.plot_state(lift.start, mesh=ball)
    assert by_gid(ax, "mesh")
    assert not by_gid(ax, "edges")
    plots.plot_escape(pinch([0, 0, -1.0, 0, 0, 0]), mesh=ball)
