"""Films show the plan in the world frame: gravity stays, equilibrium holds, fingers do not jump."""

import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from PIL import Image

import regrasp as rg
from paper import STATE
from regrasp import plots
from regrasp.plots.pages.film import moments
from regrasp.plots.regrasps.moments import as_regrasp

pytestmark = pytest.mark.contract

ELLIPSE = rg.Outline.ellipse(2, 1)
WEIGHT = rg.Wrench([0, -3.0])


def grasp_on(places, prefix):
    return rg.Grasp(
        ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5, name=f"{prefix}{i}")
        for i, s in enumerate(places)
    )


@pytest.fixture(scope="module")
def plan():
    start, goal = grasp_on((0.02, 0.35, 0.7), "A"), grasp_on((0.2, 0.5, 0.85), "B")
    return rg.plan_regrasp(
        ELLIPSE, start, goal, WEIGHT, friction=0.5, orientations=12, candidates=40, goal_orientation=1.5
    )


def test_every_frame_is_in_equilibrium_in_the_world(plan):
    frames = moments(plan, 20, 0.5, 2.0)
    assert len(frames) == sum(round(20 * s.duration) + 1 for s in plan.steps) + 10 * len(plan.moves)
    angles = np.array([m.angle for _, m in frames])
    assert angles[0] == 0
    assert angles[-1] == pytest.approx(plan.orientations[-1])
    assert abs(np.diff(np.unwrap(angles))).max() < 0.2
    for _, moment in frames:
        assert moment.load == pytest.approx([0, -3.0], abs=1e-12)
        assert sum(f.force for f in moment.fingers) + moment.load == pytest.approx([0, 0], abs=1e-11)
        torque = sum(f.at[0] * f.force[1] - f.at[1] * f.force[0] for f in moment.fingers)
        assert torque == pytest.approx(0, abs=1e-11)
        for f in moment.fingers:
            if np.hypot(*f.force) > 1e-6:
                angle = np.arccos(np.clip(f.force @ f.normal / np.hypot(*f.force), -1, 1))
                assert angle <= f.half_angle + 1e-6


def test_fingers_move_without_jumps(plan):
    before = {}
    for _, moment in moments(plan, 50, 1.0, 2.0):
        assert len({f.number for f in moment.fingers}) == len(moment.fingers) == 3
        for f in moment.fingers:
            lifted = 0.08 * 4 + 0.4  # it lifts off in one frame
            assert np.hypot(*(f.at - before.get(f.number, f.at))) < lifted
            before[f.number] = f.at


def test_the_way_stays_outside_the_object(plan):
    flying = [(f, m.angle) for _, m in moments(plan, 20, 1.0, 2.0) for f in m.fingers if f.normal is None]
    assert flying
    for f, angle in flying:
        c, s = np.cos(angle), np.sin(angle)
        x, y = c * f.at[0] + s * f.at[1], c * f.at[1] - s * f.at[0]
        assert (x / 2) ** 2 + y**2 > 1


def test_a_gif_has_every_frame(plan, tmp_path):
    path = plots.animate(plan, ELLIPSE, path=tmp_path / "plan.gif", frames_per_second=5)
    with Image.open(path) as film:
        assert film.n_frames == len(moments(plan, 5, 0.6, 2.0))
        assert film.size == (340, 360)
        film.seek(0)
        first = np.array(film.convert("L"))
        film.seek(film.n_frames // 2)
        assert abs(np.array(film.convert("L")).astype(int) - first).max() > 100


def test_a_transition_and_a_page(tmp_path):
    removal = rg.plan_removal(STATE, "P3")
    path = plots.animate(removal, path=tmp_path / "removal.html", frames_per_second=4)
    text = path.read_text(encoding="utf-8")
    assert text.count("data:image/png;base64") == 5
    turn = rg.plan_rotation(STATE.grasp, -0.5, load=STATE.load)
    assert as_regrasp(turn).orientations == pytest.approx((0, -0.5))
    assert moments(as_regrasp(turn), 4, 0.5, 2.0)[-1][1].load == pytest.approx(STATE.load.force)


def test_titles_tell_the_time_in_its_unit():
    removal = rg.plan_removal(STATE, "P3", duration=2e-4)
    titles = [title for title, _ in moments(as_regrasp(removal), 2e4, 0.5, 9.0, plots.Units(time="ms"))]
    assert titles == [f"{t} ms: removal of P3" for t in ("0", "5e−05", "0.0001", "0.00015", "0.0002")]


def test_bad_requests(tmp_path, monkeypatch):
    removal = rg.plan_removal(STATE, "P3")
    with pytest.raises(rg.InvalidInput, match=r"path must end in \.gif, \.html or \.mp4"):
        plots.animate(removal, path=tmp_path / "film.avi")
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(rg.InvalidInput, match="MP4 needs the program ffmpeg, which is not found"):
        plots.animate(removal, path=tmp_path / "film.mp4")
    with pytest.raises(rg.InvalidInput, match=r"frames_per_second must be at least 0\.01"):
        plots.animate(removal, path=tmp_path / "film.gif", frames_per_second=0)
    with pytest.raises(rg.InvalidInput, match="of which at most 10000 are drawn"):
        plots.animate(removal, path=tmp_path / "film.gif", frames_per_second=1e9)
    for missing in (tmp_path / "none" / "film.gif", tmp_path / "none" / "film.html"):
        with pytest.raises(rg.InvalidInput, match="cannot be written"):
            plots.animate(removal, path=missing, frames_per_second=1)
    assert not list(tmp_path.iterdir())
