"""Pictures in space show the numbers of the values they draw; the page draws itself in a real browser."""

import json
import re
import shutil
import subprocess
import sys
from math import inf

import numpy as np
import pytest
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

import regrasp as rg
from regrasp import plots
from regrasp.mesh import Mesh
from regrasp.plans.record import Record
from regrasp.plots.escapes.screw_motion import amount_for, moved
from regrasp.plots.look.arrows import Arrow3D
from regrasp.plots.look.solids import cone, creases, triangles_of
from regrasp.plots.surveys import held_sphere

pytestmark = pytest.mark.contract

PNG = b"\x89PNG\r\n\x1a\n"


def box(x, y, z):
    """(vertices, faces) of a box around the origin."""
    v = np.array([[a, b, c] for a in (-x, x) for b in (-y, y) for c in (-z, z)]) / 2
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return v, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def removal(length=1.0, force=1.0, names=("thumb", "index", "middle", "ring")):
    """A block held by a thumb against two fingers, while a fourth leaves."""
    places = [[-0.03, 0.008, 0], [0.03, 0.012, 0.005], [0.03, -0.012, -0.004], [0, -0.02, 0.006]]
    normals = [[1, 0, 0], [-1, 0, 0], [-1, 0, 0], [0, 1, 0]]
    grasp = rg.Grasp(
        rg.Contact(length * np.array(r), n, 0.6, name=name)
        for r, n, name in zip(places, normals, names, strict=True)
    )
    load = rg.Wrench([0, 0, -5 * force], [0, 0.01 * force * length, 0])
    start = rg.GraspState(grasp, load, 8 * force * grasp.normals).balanced()
    rest = rg.GraspState(grasp.without(3), load, force * np.array([[12.0, 0, 0], [-6, 0, 0], [-6, 0, 0]]))
    end = rg.GraspState(grasp, load, np.vstack([rest.balanced().forces, np.zeros(3)]))
    return rg.Transition(start, end, rg.TimeScaling.spline(2.0), Record(1e-9), leaving=(names[3],))


@pytest.fixture(scope="module")
def lift():
    return removal()


@pytest.fixture(scope="module")
def block():
    return box(0.06, 0.04, 0.03)


def by_gid(ax, gid, kind=object):
    return [artist for artist in ax.get_children() if artist.get_gid() == gid and isinstance(artist, kind)]


def one(ax, gid, kind=object):
    (artist,) = by_gid(ax, gid, kind)
    return artist


def points_of(line):
    return np.transpose(line.get_data_3d())


def corners(collection):
    """(m, 3) corners of a collection of polygons in space, as they were given."""
    return np.vstack(collection._faces)


# -- states and transitions ---------------------------------------------------------------------------


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
    state = removal(scale, 1 / scale).start
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


# -- over time ----------------------------------------------------------------------------------------


def test_components_over_time_are_the_transitions_numbers(lift):
    ax = plots.plot_force_components(lift)
    for i, name in enumerate(lift.grasp.names):
        for k, axis in enumerate("xyz"):
            t, drawn = one(ax, f"f{axis} {name}").get_data()
            np.testing.assert_allclose(drawn, lift.forces(t)[:, i, k])
    assert {t.get_text() for t in ax.get_legend().get_texts()} == set(lift.grasp.names)
    assert "[N]" in ax.get_ylabel()


def test_the_wrench_of_a_finger_has_six_components_with_their_units(lift):
    ax = plots.plot_wrench_components(lift, "index")
    right = next(other for other in ax.figure.axes if other is not ax)
    lines = [*ax.get_lines(), *right.get_lines()]
    assert [len(ax.get_lines()), len(right.get_lines())] == [3, 3]
    for k, line in enumerate(lines):
        np.testing.assert_allclose(line.get_ydata(), lift.wrenches(line.get_xdata())[:, 1, k])
    assert ax.get_ylabel() == "force [N]"
    assert right.get_ylabel().endswith("N m]")
    with pytest.raises(rg.InvalidInput, match="no contact 'toe'"):
        plots.plot_wrench_components(lift, "toe")


def test_lines_over_time_hold_in_space(lift):
    for ax, values in (
        (plots.plot_magnitudes(lift), lambda t: np.linalg.norm(lift.forces(t), axis=-1)),
        (plots.plot_margins(lift), lambda t: np.degrees(lift.margins(t).angle)),
        (plots.plot_margins(lift, objective="force"), lambda t: lift.margins(t).force),
    ):
        lines = {line.get_label(): line for line in ax.get_lines()}
        for i, name in enumerate(lift.grasp.names):
            t, drawn = lines[name].get_data()
            np.testing.assert_allclose(drawn, values(t)[:, i])


def test_every_figure_of_a_transition_in_space(lift, block):
    drawn = plots.figures(lift, mesh=block)
    everywhere = ["overview", "states", "object", "time_scaling", "magnitudes", "angles", "margins"]
    assert list(drawn) == [*everywhere, "components", "wrenches"]
    for name, figure in drawn.items():
        assert plots.png(figure).startswith(PNG), name
        texts = [t for ax in figure.axes for t in [*ax.texts, *ax.get_xticklabels(), ax.xaxis.label]]
        assert min(text.get_fontsize() for text in texts) >= 7, name
    for name in ("overview", "states", "object"):
        assert by_gid(drawn[name].axes[0], "mesh"), name
    assert lift._repr_png_().startswith(PNG)


def test_a_load_that_varies_in_space_has_six_components(lift, block):
    series = rg.LoadSeries(
        [0.0, 0.5, 1.0], [[0, 0, -5, 0, 0.01, 0], [1, 0.5, -4, 0.02, 0, 0.01], [0, 0, -5, 0, 0, 0]]
    )
    varying = rg.plan_removal(lift.grasp, "ring", load=series, instants=5, max_force=40.0)
    ax = plots.plot_load(varying)
    (right,) = [other for other in ax.figure.axes if other is not ax]
    lines = [*ax.get_lines(), *right.get_lines()]
    assert len(lines) == 6
    for k, line in enumerate(lines):
        np.testing.assert_allclose(line.get_ydata(), varying.course.loads[:, k])
    assert plots.png(plots.transition_figure(varying, mesh=block)).startswith(PNG)
    heads = points_of(one(plots.plot_transition(varying, force_scale=0.002), "path thumb"))
    middle = lift.grasp["thumb"].position + 0.002 * varying.forces(varying.duration / 2)[0]
    assert np.linalg.norm(heads - middle, axis=1).min() < 1e-9


# -- escapes ------------------------------------------------------------------------------------------


def pinch(twist, load=None):
    sides = [
        rg.Contact([-0.03, 0.004, 0.01], [1, 0, 0], 0.6, name="a"),
        rg.Contact([0.03, 0, 0], [-1, 0, 0], 0.6),
    ]
    return rg.EscapeTwist(rg.Grasp(sides), load or rg.Wrench([0, 0, -5.0]), twist, (0.6, 0.6), (1.0, inf))


@pytest.mark.parametrize("seed", range(5))
def test_points_move_as_the_twist_says(seed):
    rng = np.random.default_rng(seed)
    v, omega, points = rng.normal(size=3), rng.normal(size=3), rng.normal(size=(4, 3))
    twist, h = pinch([*v, *omega]), 1e-6
    rate = (moved(twist, points, h) - moved(twist, points, -h)) / (2 * h)
    np.testing.assert_allclose(np.linalg.norm(omega) * rate, v + np.cross(omega, points), atol=1e-8)
    ways = np.linalg.norm(moved(twist, points, amount_for(twist, points, 1e-3)) - points, axis=1)
    assert ways.max() == pytest.approx(1e-3, rel=1e-5)
    slide = pinch([0, 3.0, 4, 0, 0, 0])
    np.testing.assert_allclose(moved(slide, np.zeros((1, 3)), 5.0), [[0, 3, 4]])


def test_the_screw_axis_and_the_motion_of_the_contacts_are_drawn(block):
    twist = pinch([0.001, 0.002, -0.02, 1.0, 0.2, -0.1])
    centre, direction = twist.axis
    ax = plots.plot_escape(twist, mesh=block)
    for end in points_of(one(ax, "axis")):
        np.testing.assert_allclose(np.cross(end - centre, direction), 0, atol=1e-15)
    tail, head = one(ax, "sense", Arrow3D).ends
    assert np.cross(tail - centre, head - centre) @ direction > 0
    fastest = np.linalg.norm(twist.velocities, axis=1).max()
    for name, r, v in zip(twist.grasp.names, twist.grasp.positions, twist.velocities, strict=True):
        np.testing.assert_allclose(one(ax, f"velocity {name}").ends, [r, r + 0.25 * 0.06 / fastest * v])
        way = points_of(one(ax, f"way {name}"))
        np.testing.assert_allclose(way[0], r)
        assert (way[1] - way[0]) @ v > 0.9 * np.linalg.norm(way[1] - way[0]) * np.linalg.norm(v)
    assert f"pitch {twist.pitch:.3g}".replace("-", "\N{MINUS SIGN}") in ax.get_title(loc="left")
    assert len(one(ax, "later")._segments3d) == 12


def test_two_fingers_that_leave_the_turn_about_their_line_free_stand_still_in_it():
    a, b = [-0.03, 0.004, 0.01], [0.03, 0, 0]
    omega = np.subtract(b, a)
    twist = pinch([*np.cross(a, omega), *omega], rg.Wrench([0, 0, 0], [0.1, 0, 0]))
    assert twist.is_proof
    ax = plots.plot_escape(twist)
    assert "pitch 0 m/rad" in ax.get_title(loc="left")
    for name in twist.grasp.names:
        assert not by_gid(ax, f"velocity {name}")
        assert by_gid(ax, f"helpless {name}")


def test_a_slide_has_no_axis_and_a_far_one_is_pointed_to():
    slide = plots.plot_escape(pinch([0, 0, -1.0, 0, 0, 0]))
    assert "sliding" in slide.get_title(loc="left")
    assert not by_gid(slide, "axis")
    far = plots.plot_escape(pinch([0, 0, -0.3, 0, 1.0, 0]))
    tail, head = one(far, "towards axis", Arrow3D).ends
    np.testing.assert_allclose((head - tail) / np.linalg.norm(head - tail), [-1, 0, 0], atol=1e-12)
    labels = [t.get_text() for t in far.get_legend().get_texts()]
    assert "to the axis at (\N{MINUS SIGN}0.3, 0, 0)" in labels


# -- load directions ----------------------------------------------------------------------------------


def evenly(count):
    k = np.arange(count) + 0.5
    z, a = 1 - 2 * k / count, np.pi * (1 + np.sqrt(5)) * k
    return np.column_stack([np.sqrt(1 - z**2) * np.cos(a), np.sqrt(1 - z**2) * np.sin(a), z])


def colour_at(ax, direction):
    """The colour of the map's patch in a direction."""
    mesh = one(ax, "map")
    x, y, z = direction / np.linalg.norm(direction)
    colours = mesh.get_facecolor().reshape(*mesh.get_coordinates()[:-1, :-1, 0].shape, 4)
    rows, columns = colours.shape[:2]
    row = int((np.arcsin(z) / np.pi + 0.5) * rows * (1 - 1e-12))
    column = int((np.arctan2(y, x) / (2 * np.pi) + 0.5) * columns * (1 - 1e-12))
    return colours[row, column]


def test_the_map_shows_the_value_of_the_nearest_direction():
    directions = 3.0 * evenly(200)
    margins = np.where(directions[:, 2] < 0, 10 - 2 * directions[:, 0], np.nan)
    ax = plots.plot_load_map(directions, margins)
    ax.figure.draw_without_rendering()
    (bar,) = [other for other in ax.figure.axes if other is not ax]
    low, high = bar.get_xlim()
    assert (low, high) == pytest.approx((0, np.nanmax(margins)))
    from matplotlib import colormaps

    for direction, margin in zip(directions, margins, strict=True):
        pale = held_sphere.to_rgba(held_sphere.NOT_HELD)
        wanted = pale if np.isnan(margin) else colormaps["viridis"](margin / high)
        np.testing.assert_allclose(colour_at(ax, direction), wanted, atol=0.006)
    assert bar.get_xlabel() == "least angle margin [deg]"
    assert by_gid(ax, "not held")
    assert "not held" in [t.get_text() for legend in ax.figure.legends for t in legend.get_texts()]


def test_held_or_not_needs_no_colour_bar():
    directions = evenly(100)
    figure = plots.load_sphere_figure(directions, directions[:, 0] > 0)
    assert len(figure.axes) == 2
    assert [t.get_text() for legend in figure.legends for t in legend.get_texts()] == ["held", "not held"]
    everything = plots.load_sphere_figure(directions, np.full(100, True))
    assert [t.get_text() for legend in everything.legends for t in legend.get_texts()] == ["held"]
    nothing = plots.load_sphere_figure(directions, np.full(100, np.nan))
    assert len(nothing.axes) == 2
    assert plots.png(nothing).startswith(PNG)


def test_the_sphere_carries_the_colours_of_the_map():
    directions = evenly(400)
    ax = plots.plot_load_sphere(directions, directions[:, 2] < 0)
    sphere = one(ax, "sphere", Poly3DCollection)
    held = np.isclose(sphere._facecolor3d, held_sphere.to_rgba(held_sphere.HELD)).all(axis=1)
    heights = np.array([face[:, 2].mean() for face in sphere._faces])
    assert held[heights < -0.2].all()
    assert not held[heights > 0.2].any()


def test_load_directions_are_checked():
    for directions, values, said in (
        ([[0, 0, 0]], [1.0], "none of them zero"),
        (np.empty((0, 3)), [], "one or more"),
        ([[1, 0, 0]], [1.0, 2.0], "for each of 1 directions"),
        ([[1, 0, 0]], ["yes"], "number or a boolean"),
        ([[1, 0, 0]], [inf], "must be finite"),
    ):
        for draw in (plots.plot_load_sphere, plots.plot_load_map, plots.load_sphere_figure):
            with pytest.raises(rg.InvalidInput, match=said):
                draw(directions, values)
    flat = Figure().add_subplot()
    with pytest.raises(rg.InvalidInput, match="ax must be 3-D"):
        plots.plot_load_sphere([[1, 0, 0]], [1.0], flat)
    with pytest.raises(rg.InvalidInput, match="projection='hammer'"):
        plots.plot_load_map([[1, 0, 0]], [1.0], flat)


# -- the page -----------------------------------------------------------------------------------------

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND",  # no network at all
    "--virtual-time-budget=1000000",
)
# Plays to the end, then writes what the scene holds into an attribute.
PROBE = """<script>
const probe = () => {
  const page = document.querySelector('.plotly-graph-div');
  if (!document.documentElement.hasAttribute('data-regrasp')) {
    requestAnimationFrame(probe);
    return;
  }
  const last = page._transitionData._frames.length - 1;
  Plotly.animate(page, [String(last)], {mode: 'immediate', frame: {duration: 0, redraw: true}}).then(() => {
    const lines = page._fullData.filter(d => d.type === 'scatter3d' && d.mode === 'lines' && d.showlegend);
    const held = lines.map(d => [d.name, d.x.length && d.x[0] !== null && isFinite(d.x[0])]);
    const asked = performance.getEntriesByType('resource').map(entry => entry.name);
    document.documentElement.setAttribute('data-probe', JSON.stringify({held, asked}));
  });
};
probe();
</script>"""


@pytest.fixture(scope="module")
def page(lift, block):
    pytest.importorskip("plotly")
    return plots.html(lift, mesh=block)


def test_a_page_is_written_whole_or_not_at_all(lift, tmp_path):
    pytest.importorskip("plotly")
    target = tmp_path / "lift.html"
    assert plots.html(lift.start, target) == target
    assert target.read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert [p.name for p in tmp_path.iterdir()] == ["lift.html"]
    with pytest.raises(rg.InvalidInput, match="cannot be written"):
        plots.html(lift.start, tmp_path / "nowhere" / "lift.html")


def test_a_page_shows_states_and_plans_only(lift):
    with pytest.raises(rg.InvalidInput, match="a Transition, a RegraspPlan or Motions; got Grasp"):
        plots.html(lift.grasp)


def test_without_plotly_one_line_names_the_extra(lift, monkeypatch):
    for module in ("plotly", "plotly.graph_objects"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=r"^pages need plotly: pip install 'regrasp\[html\]'$"):
        plots.html(lift.start)


def test_a_page_loads_nothing_from_elsewhere_and_sends_nothing(page):
    outside = re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)\s*=\s*[\"']?([^\"'> ]+)", page)
    assert [address for address in outside if address.startswith(("http", "//"))] == []
    assert '"showSendToCloud": false' in page or '"showSendToCloud":false' in page


def test_names_cannot_break_out_of_a_page():
    pytest.importorskip("plotly")
    page = plots.html(removal(names=("</script><b>", "a", "b", "c")).start)
    assert "</script><b>" not in page


def shown_by_browser(page, folder, *flags):
    path = folder / "page.html"
    path.write_text(page, encoding="utf-8")
    command = [CHROMIUM, *FLAGS, f"--user-data-dir={folder / 'profile'}", *flags, path.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_browser_draws_the_page_plays_it_and_asks_for_nothing(page, lift, tmp_path):
    probed = page[: page.rindex("</body>")] + PROBE + "</body></html>"
    dom = shown_by_browser(probed, tmp_path, "--dump-dom")
    assert 'data-regrasp="drawn"' in dom
    body = re.sub(r"<script.*?</script>", "", dom, flags=re.DOTALL)
    assert "main-svg" in body
    assert "<canvas" in body
    assert "WebGL is not supported" not in body
    assert "angle margin [deg]" in body
    seen = json.loads(re.search(r'data-probe="([^"]*)"', dom)[1].replace("&quot;", '"'))
    assert dict(seen["held"]) == {
        name: name in (*lift.end.in_use, "load") for name in (*lift.grasp.names, "load")
    }
    assert [url for url in seen["asked"] if not url.startswith(("file:", "data:", "blob:"))] == []


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_browser_paints_the_scene_in_the_contacts_colours(lift, block, tmp_path):
    pytest.importorskip("plotly")
    from matplotlib.colors import to_rgb
    from matplotlib.image import imread

    picture = tmp_path / "page.png"
    shown_by_browser(
        plots.html(lift.start, mesh=block), tmp_path, f"--screenshot={picture}", "--window-size=900,700"
    )
    below = imread(picture)[80:, :, :3]  # without the legend
    for name, colour in plots.contact_colours(lift.grasp).items():
        near = np.abs(below - to_rgb(colour)).max(axis=-1) < 0.2
        assert near.sum() > 30, name
