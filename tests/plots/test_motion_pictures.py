"""Pictures and films of ways show the ways."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import regrasp as rg
from finger_moves import moved
from regrasp import plots
from regrasp.motions import Motions, plan_motions
from regrasp.plots.regrasps.ways import motion_moments

pytestmark = pytest.mark.contract

BAR = rg.Outline([[-0.05, -0.01], [0.05, -0.01], [0.05, 0.01], [-0.05, 0.01]])
BOX = rg.Mesh.box(0.08, 0.05, 0.03)
AIR = {"tip_radius": 0.003, "clearance": 0.002}


@cache
def planar() -> Motions:
    places = ([0.02, -0.01], [-0.02, 0.01], [0.03, 0.01], [0.04, 0.01], [-0.04, -0.01], [0.01, -0.01])
    contacts = [BAR.contact_at(BAR.nearest(p), friction=0.8, name=f"C{k}") for k, p in enumerate(places)]
    return plan_motions(moved(contacts), BAR, **AIR)


@cache
def spatial() -> Motions:
    places = ([0.03, 0, 0.015], [0, 0.025, 0.01], [0, -0.025, 0.01], [-0.04, 0, 0.01], [0.02, 0.01, 0.015])
    contacts = [BOX.contact_at(p, friction=0.8, name=f"C{k}") for k, p in enumerate(places)]
    one = moved([*contacts[:4], contacts[4], *contacts[1:4]]).steps[:2]
    plan = rg.RegraspPlan(one, (0.0,) * 3, 0.0, rotations=np.array([np.eye(3)] * 3))
    return plan_motions(plan, BOX, **AIR, capsules=[0, 0, 0.02])


def drawn(ax) -> dict[str, np.ndarray]:
    return {line.get_gid(): np.array(line.get_data()).T for line in ax.lines if line.get_gid()}


def test_ways_in_the_plane_are_drawn_as_they_are() -> None:
    free = planar()
    ax = plots.plot_motions(free, BAR)
    lines = drawn(ax)
    for number, motion in enumerate(free.motions):
        line = lines[f"way {number}"]
        assert line[0] == pytest.approx(motion.way.points[0])
        assert line[-1] == pytest.approx(motion.way.points[-1])
    assert ax.get_aspect() == 1
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["finger 1", "finger 2", "finger 3"]


def test_ways_in_space_are_drawn_as_they_are() -> None:
    ax = plots.plot_motions(spatial(), BOX)
    ways = [line for line in ax.lines if str(line.get_gid()).startswith("way")]
    assert len(ways) == len(spatial().motions)
    curve = np.array(ways[0].get_data_3d()).T
    assert curve[-1] == pytest.approx(spatial().motions[0].way.points[-1])


def test_shapes_of_the_other_dimension_are_refused() -> None:
    with pytest.raises(rg.InvalidInput, match="these ways go around a Mesh, got Outline"):
        plots.plot_motions(spatial(), BAR)
    with pytest.raises(rg.InvalidInput, match="these ways go around an Outline, got Mesh"):
        plots.plot_motions(planar(), BOX)


@pytest.mark.parametrize("made", [planar, spatial])
def test_a_film_shows_the_tips_where_they_are(made) -> None:
    motions = made()
    t = np.linspace(0, motions.duration, 50)
    at, touching = motions.positions(t), motions.touching(t)
    for moment, tips, on in zip(motion_moments(motions, t), at, touching, strict=True):
        assert len(moment.fingers) == len(tips)
        for finger in moment.fingers:
            if not on[finger.number]:
                assert finger.normal is None
                assert finger.at == pytest.approx(moment.turn @ tips[finger.number])


def test_a_film_of_motions_lasts_as_long_as_they_do(tmp_path: Path) -> None:
    free = planar()
    path = plots.animate(free, BAR, path=tmp_path / "ways.gif", frames_per_second=1)
    with Image.open(path) as film:
        assert abs(film.n_frames - free.duration) <= 2
