"""The motion in which an object in space escapes is drawn as its twist says."""

import numpy as np
import pytest

import regrasp as rg
from drawn import by_gid, one, points_of
from pictured import box, pinch
from regrasp import plots
from regrasp.plots.escapes.screw_motion import amount_for, moved
from regrasp.plots.look.arrows import Arrow3D

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def block():
    return box(0.06, 0.04, 0.03)


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
