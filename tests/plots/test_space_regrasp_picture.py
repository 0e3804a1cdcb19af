"""Pictures and films of a regrasp in space: the world frame, who holds and moves, how the object turns."""

from dataclasses import replace
from itertools import combinations
from math import pi

import numpy as np
import pytest
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.proj3d import proj_transform
from PIL import Image

import regrasp as rg
from drawn import by_gid
from regrasp import plots
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.mesh import Mesh
from regrasp.plots.look.arrows import Arrow3D
from regrasp.plots.look.units import Units
from regrasp.plots.pages.film import moments
from regrasp.plots.pages.page_regrasp import regrasp_figure
from regrasp.plots.regrasps.moments import as_regrasp, moment_of

pytestmark = pytest.mark.contract

BOX = Mesh.box(0.06, 0.05, 0.04)
WEIGHT = rg.Wrench([0, 0, -2.0])
LAST = rotation_matrix(np.array([1, 0.3, 0]) / np.hypot(1, 0.3), pi / 2)


def grasp(*places):
    return rg.Grasp(BOX.contact_at(place, friction=0.6) for place in places)


START = grasp([-0.03, 0.01, 0], [0.03, 0.012, 0.005], [0.03, -0.012, -0.004], [0.002, -0.025, 0.003])
GOAL = grasp([-0.03, -0.008, 0.004], [0.004, 0.025, 0.006], [-0.01, -0.025, 0.002], [0.015, -0.025, -0.003])


@pytest.fixture(scope="module")
def plan():
    return rg.plan_regrasp(
        BOX, START, GOAL, WEIGHT, friction=0.6, goal_rotation=LAST,
        candidates=12, orientations=36, min_distance=0.01,
    )  # fmt: skip


def starting_with(ax, words):
    return [artist for artist in ax.get_children() if str(artist.get_gid()).startswith(words)]


@pytest.mark.parametrize("backwards", [False, True])
def test_every_step_is_told_in_the_world_frame(plan, backwards):
    whole = plan.reversed() if backwards else plan
    assert sum(step.turn is not None for step in whole.steps) >= 1
    figure = plots.plot_regrasp(whole, BOX)
    figure.canvas.draw()
    panels = figure.axes
    assert [ax.get_gid() for ax in panels] == [f"step {k + 1}" for k in range(len(whole.steps) + 1)]
    titles = [text.get_text() for text in figure.texts]
    assert titles[: len(panels)] == [*(f"{k} {s.kind}" for k, s in enumerate(whole.steps, 1)), "end"]
    down = whole.steps[0].start.load.force / 2.0
    for ax in panels:  # gravity keeps its direction and length
        (load,) = by_gid(ax, "load")
        assert load.ends[1] == pytest.approx(np.linalg.norm(load.ends[1]) * down, abs=1e-12)
        assert load.ends == pytest.approx(by_gid(panels[0], "load")[0].ends, abs=1e-12)
    for k, (step, ax) in enumerate(zip(whole.steps, panels, strict=False)):
        turn = whole.rotations[k]
        (solid,) = by_gid(ax, "mesh")
        assert isinstance(solid, Poly3DCollection)
        vertices, faces = BOX.surface()
        drawn = np.vstack(solid._faces)
        assert drawn == pytest.approx((vertices @ turn.T)[faces].reshape(-1, 3), abs=1e-12)
        sticks = [line.get_data_3d() for line in starting_with(ax, "finger ")]
        assert sorted(np.round(np.array(s)[:, -1], 9).tolist() for s in sticks) == sorted(
            np.round(step.grasp.positions @ turn.T, 9).tolist()
        )
        arrows = starting_with(ax, "force ")
        assert len(arrows) == len(step.start.in_use)
        total = sum(arrow.ends[1] - arrow.ends[0] for arrow in [*arrows, *by_gid(ax, "load")])
        assert total == pytest.approx(np.zeros(3), abs=1e-9)  # they are in equilibrium
        words = [text.get_text() for text in ax.texts]
        assert words.count("leaves") == len(step.idle_at_end)
        assert words.count("arrives") == len(step.idle_at_start)
        assert len(by_gid(ax, "turn")) == (step.turn is not None)
        if step.turn is not None:
            (text,) = by_gid(ax, "turned")
            assert float(text.get_text().rstrip("°")) == pytest.approx(
                abs(np.degrees(step.turn.angle)), abs=0.06
            )
            (line,) = by_gid(ax, "axis")
            ends = np.array(line.get_data_3d())
            along = ends[:, 1] - ends[:, 0]
            axis = turn @ step.turn.axis
            assert np.cross(along, axis) == pytest.approx(np.zeros(3), abs=1e-12)
        moves = [move for move in whole.moves if move.step == k]
        for move in moves:
            (arrow,) = by_gid(ax, f"move {move.finger}")
            away = np.linalg.norm(arrow.ends - np.array([move.origin, move.target]) @ turn.T, axis=1)
            assert away == pytest.approx(np.full(2, 0.04 * 2 * np.linalg.norm(vertices[0])), rel=1e-6)
        assert len(starting_with(ax, "move ")) == len(moves)


def test_the_arc_of_a_turn_goes_the_way_of_the_turn(plan):
    figure = plots.plot_regrasp(plan, BOX)
    seen = 0
    for step, ax, turn in zip(plan.steps, figure.axes, plan.rotations, strict=False):
        if step.turn is not None:
            (arrow,) = by_gid(ax, "turn")
            tail, head = arrow.ends
            axis = np.sign(step.turn.angle) * (turn @ step.turn.axis)
            assert np.cross(tail, head) @ axis > 0
            seen += 1
    assert seen


def test_a_bar_measures_and_arrows_have_their_scale(plan):
    figure = plots.plot_regrasp(plan, BOX, units=plots.Units("km", "kN"))
    (bar,) = by_gid(figure.axes[0], "bar")
    ends = np.array(bar.get_data_3d()).T
    (text,) = by_gid(figure.axes[0], "length")
    length, unit = text.get_text().split()
    assert unit == "km"
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(float(length))
    (scale,) = (t for t in figure.texts if t.get_gid() == "scale")
    longest = max(
        np.linalg.norm(step.forces(np.linspace(0, step.duration, 33)), axis=-1).max() for step in plan.steps
    )
    assert scale.get_text() == f"longest arrow: {longest:.4g} kN"
    # one scale on all axes: what is measured along the picture fills the panel
    ax = figure.axes[0]
    figure.canvas.draw()
    spans = [np.ptp(limits) for limits in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())]
    assert spans == pytest.approx([spans[0]] * 3)


def seen(ax, text):
    """Where a text in space is drawn, which it forgets afterwards."""
    x, y, _ = proj_transform(*text.get_position_3d(), ax.M)
    moved = ax.transData.transform((x, y)) - ax.transData.transform(text.get_position())
    return text.get_window_extent().translated(*moved)


@pytest.mark.parametrize("mesh", [BOX, None])
def test_words_stay_in_their_panels_and_keep_clear_of_one_another(plan, mesh):
    figure = plots.plot_regrasp(plan, mesh)
    figure.canvas.draw()
    for ax in figure.axes:
        words = [seen(ax, text) for text in ax.texts if str(text.get_gid()).startswith(("word", "turned"))]
        for box in words:
            assert ax.bbox.x0 - 3 <= box.x0 < box.x1 <= ax.bbox.x1 + 3
        for a, b in combinations(words, 2):
            assert not a.overlaps(b)


def test_without_a_mesh_and_in_notebooks(plan):
    figure = plots.plot_regrasp(plan)  # the hull of all contacts, without edges
    (hull,) = by_gid(figure.axes[0], "mesh")
    contacts = np.concatenate([step.grasp.positions for step in plan.steps])
    corners = np.unique(np.vstack(hull._faces), axis=0)
    assert all(np.linalg.norm(contacts - corner, axis=1).min() < 1e-12 for corner in corners)
    assert not by_gid(figure.axes[0], "edges")
    assert by_gid(figure.axes[0], "load")
    assert plan._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(rg.InvalidInput, match=r"mesh must have a surface\(\) or be \(vertices, faces\)"):
        plots.plot_regrasp(plan, rg.Outline.ellipse(2, 1))


# -- films ----------------------------------------------------------------------------------------------


def test_every_frame_is_in_equilibrium_in_the_world(plan):
    frames = moments(plan, 20, 0.5, 0.05)
    assert len(frames) == sum(round(20 * s.duration) + 1 for s in plan.steps) + 10 * len(plan.moves)
    before = np.eye(3)
    for _, moment in frames:
        assert moment.load == pytest.approx([0, 0, -2.0], abs=1e-12)
        assert sum(f.force for f in moment.fingers) + moment.load == pytest.approx(np.zeros(3), abs=1e-11)
        torque = sum(np.cross(f.at, f.force) for f in moment.fingers)
        assert torque == pytest.approx(np.zeros(3), abs=1e-12)
        assert np.linalg.norm(moment.turn - before) < 0.4  # it does not jump
        before = moment.turn
        assert sorted(f.number for f in moment.fingers) == [0, 1, 2, 3]
        for f in moment.fingers:
            if np.linalg.norm(f.force) > 1e-6:
                angle = np.arccos(np.clip(f.force @ f.normal / np.linalg.norm(f.force), -1, 1))
                assert angle <= f.half_angle + 1e-6
    assert before == pytest.approx(LAST)


def test_fingers_in_the_air_do_not_jump_and_stay_outside(plan):
    radius = float(np.linalg.norm(BOX.size)) / 2
    before, flying = {}, 0
    for _, moment in moments(plan, 50, 1.0, radius):
        for f in moment.fingers:
            assert np.linalg.norm(f.at - before.get(f.number, f.at)) < 0.25 * radius
            before[f.number] = f.at
            if f.normal is None:
                flying += 1
                assert (abs(moment.turn.T @ f.at) > BOX.size / 2).any()
    assert flying >= 40 * len(plan.moves)


def test_films_of_regrasps_and_of_transitions(plan, tmp_path):
    short = replace(
        plan, steps=plan.steps[:2], orientations=plan.orientations[:3], rotations=plan.rotations[:3]
    )
    path = plots.animate(short, BOX, path=tmp_path / "plan.gif", frames_per_second=3, move_time=0.4)
    with Image.open(path) as film:
        assert film.n_frames == len(moments(short, 3, 0.4, 1.0))
        first = np.array(film.convert("L"))
        film.seek(film.n_frames - 1)
        assert abs(np.array(film.convert("L")).astype(int) - first).max() > 100
    turn = rg.plan_rotation(START, -0.8, axis=[0, 1, 1], load=WEIGHT)
    page = plots.animate(turn, path=tmp_path / "turn.html", frames_per_second=3)
    assert page.read_text(encoding="utf-8").count("data:image/png;base64") == 4
    whole = as_regrasp(turn)
    assert rg.verify(whole).ok
    end = moment_of(whole, 0, 1.0)
    assert end.turn == pytest.approx(rotation_matrix(np.array([0, 1, 1]) / np.sqrt(2), -0.8))
    with pytest.raises(rg.InvalidInput, match="outline must be an Outline, or in space a mesh"):
        plots.animate(turn, 3.0, path=tmp_path / "bad.gif")
    assert not (tmp_path / "bad.gif").exists()


def test_a_solid_is_no_outline(tmp_path):
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.8), rg.Contact([1, 0.1], [-1, 0], 0.8)])
    turn = rg.plan_rotation(pair, 0.5, load=rg.Wrench([0, -1.0]))
    with pytest.raises(rg.InvalidInput, match="a regrasp in the plane is drawn on an Outline, got Mesh"):
        plots.plot_regrasp(as_regrasp(turn), BOX)
    with pytest.raises(rg.InvalidInput, match="a plan in the plane is drawn on an Outline, got Mesh"):
        plots.animate(turn, BOX, path=tmp_path / "film.gif")


def test_arrows_of_the_worlds_axes(plan):
    ax = plots.plot_regrasp(plan, BOX).axes[0]
    for name, axis in zip("xyz", np.eye(3), strict=True):
        (arrow,) = by_gid(ax, f"axis {name}")
        assert isinstance(arrow, Arrow3D)
        along = arrow.ends[1] - arrow.ends[0]
        assert along / np.linalg.norm(along) == pytest.approx(axis, abs=1e-12)


def test_a_page_shows_every_step_of_a_regrasp(plan):
    pytest.importorskip("plotly")
    figure = regrasp_figure(plan, None, Units("mm", "N", "s"))
    words = [frame["layout"]["annotations"][0]["text"] for frame in figure["frames"]]
    assert list(dict.fromkeys(words)) == [
        f"step {k} of {len(plan.steps)}: {step.in_words}" for k, step in enumerate(plan.steps, 1)
    ]
    load = next(trace for trace in figure["frames"][-1]["data"] if trace["name"] == "load")
    end = plan.steps[-1].load(plan.steps[-1].duration)[:3]
    tail, neck = np.array([load[axis] for axis in "xyz"]).T
    np.testing.assert_allclose(np.cross(neck - tail, end), 0, atol=1e-9)
    for trace in figure["frames"][0]["data"]:
        assert len(trace["x"]) == len(trace["y"])
    assert plots.html(plan, title="<b>").count("&lt;b&gt;") >= 1
