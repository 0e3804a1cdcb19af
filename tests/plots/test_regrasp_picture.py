"""The picture of a regrasp tells, for every step, who holds, leaves and arrives, and how the object turns."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.patches import Wedge

import regrasp as rg
from drawn import by_gid
from paper import STATE
from regrasp import plots
from regrasp.outline import parts
from regrasp.plots.look.labels import Labels
from regrasp.plots.regrasps.trade_off import plot_trade_off

pytestmark = pytest.mark.contract

ELLIPSE = rg.Outline.ellipse(2, 1)
WEIGHT = rg.Wrench([0, -3.0])


def grasp_on(places, prefix, scale=1.0):
    outline = rg.Outline.ellipse(2 * scale, scale)
    return rg.Grasp(
        outline.contact_at(s * outline.length, friction=0.5, name=f"{prefix}{i}")
        for i, s in enumerate(places)
    )


def planned(goal_orientation=1.5, scale=1.0):
    return rg.plan_regrasp(
        rg.Outline.ellipse(2 * scale, scale),
        grasp_on((0.02, 0.35, 0.7), "A", scale),
        grasp_on((0.2, 0.5, 0.85), "B", scale),
        WEIGHT,
        friction=0.5,
        orientations=12,
        candidates=40,
        goal_orientation=goal_orientation,
    )


@pytest.mark.parametrize("goal_orientation", [0.0, 1.5, -2.0])
@pytest.mark.parametrize("backwards", [False, True])
def test_every_step_is_told(goal_orientation, backwards):
    plan = planned(goal_orientation)
    plan = plan.reversed() if backwards else plan
    figure = plots.plot_regrasp(plan, ELLIPSE)
    panels = [ax for ax in figure.axes if str(ax.get_gid()).startswith("step")]
    assert len(panels) == len(plan.steps) + 1
    for k, (step, ax) in enumerate(zip(plan.steps, panels, strict=False)):
        words = [text.get_text() for text in ax.texts]
        assert words.count("leaves") == len(step.idle_at_end)
        assert words.count("arrives") == len(step.idle_at_start)
        assert ax.get_title(loc="left").startswith(f"{k + 1} {step.kind}")
        turn = np.degrees(plan.orientations[k + 1] - plan.orientations[k])
        assert len(by_gid(ax, "turn")) == bool(turn)
        assert [float(w.rstrip("°").replace("−", "-")) for w in words if w.endswith("°")] == (
            pytest.approx([turn], abs=0.06) if turn else []
        )
        c, s = np.cos(plan.orientations[k]), np.sin(plan.orientations[k])
        tips = {
            artist.get_gid(): artist.center
            for artist in ax.patches
            if isinstance(artist, Wedge) and str(artist.get_gid()).startswith("cone")
        }
        assert len(tips) == len(step.grasp)
        expected = step.grasp.positions @ np.array([[c, s], [-s, c]])
        assert sorted(map(tuple, np.round(list(tips.values()), 9))) == sorted(
            map(tuple, np.round(expected, 9))
        )
        pushing = sum(bool(np.hypot(*f) > 1e-3) for f in step.start.forces)
        assert len([a for a in ax.get_children() if str(a.get_gid()).startswith("force")]) == pushing
    assert panels[-1].get_title(loc="left").startswith("end")
    figure.canvas.draw()


def test_in_other_units_and_in_notebooks():
    plan = planned(scale=1e-3)
    figure = plots.plot_regrasp(plan, units=plots.Units("km", "N"))  # without an outline, too
    labels = {ax.get_ylabel() for ax in figure.axes} - {""}
    assert len(labels) == 1
    assert "km]" in labels.pop()
    assert plan._repr_png_().startswith(b"\x89PNG")


def test_bad_input():
    with pytest.raises(
        rg.InvalidInput, match="plan must be a RegraspPlan, got Transition; see plot_transition"
    ):
        plots.plot_regrasp(rg.plan_removal(STATE, "P3"))


# -- labels and the trade-off -------------------------------------------------------------------------------


def test_words_keep_clear_of_one_another():
    labels = Labels(points_per_unit=10.0, gap=1.0)
    labels.occupy((0, 0), 0.5)
    up = np.array([0.0, 1.0])
    ways = [labels.direction("leaves", (x, 0.6), up, 6.5) for x in (0.0, 1.0, -1.0)]
    assert ways[0] == pytest.approx(up)  # nothing is in the way
    assert all(way @ up < 0.9 for way in ways[1:])
    for a, b in combinations(labels.taken, 2):
        assert min(a[2], b[2]) <= max(a[0], b[0]) or min(a[3], b[3]) <= max(a[1], b[1])


def test_words_of_fingers_that_stand_close_do_not_collide():
    outline = parts.bracket()

    def grasp(places, prefix):
        contacts = (outline.contact_at(s * outline.length, friction=0.4) for s in places)
        return rg.Grasp(c.named(f"{prefix}{i}") for i, c in enumerate(contacts, 1))

    plan = rg.plan_regrasp(
        outline, grasp((0.25, 0.31, 0.79), "A"), grasp((0.27, 0.52, 0.58), "B"), rg.Wrench([0, -2.0]),
        friction=0.4, orientations=1, candidates=80,
    )  # fmt: skip
    figure = plots.plot_regrasp(plan, outline)
    figure.canvas.draw()
    pairs = 0
    for ax in figure.axes:
        words = [text for text in ax.texts if text.get_text() in ("leaves", "arrives")]
        for a, b in combinations(words, 2):
            pairs += 1
            assert not a.get_window_extent().overlaps(b.get_window_extent())
    assert pairs >= 2


def test_the_trade_off_is_a_staircase_of_plans():
    ends = grasp_on((0.52, 0.85, 0.2), "A"), grasp_on((0.2, 0.5, 0.85), "B")
    plans = rg.plan_regrasps(ELLIPSE, *ends, WEIGHT, friction=0.5, orientations=1, candidates=40, extra=6)
    assert len(plans) >= 2
    ax = plot_trade_off(plans[::-1])
    (discs,) = by_gid(ax, "plans")
    moves, margins = discs.get_data()
    assert list(moves) == [len(plan.moves) for plan in plans]
    assert margins == pytest.approx([np.degrees(plan.margin) for plan in plans])
    assert list(np.diff(moves) > 0) == [True] * (len(plans) - 1)
    (stairs,) = by_gid(ax, "stairs")
    assert stairs.get_drawstyle() == "steps-post"
    words = [text.get_text() for text in ax.texts]
    assert words == [f"{np.degrees(p.margin):.3g}°\n{len(p.steps)} steps" for p in plans]
    assert ax.get_xlabel() == "finger moves"
    assert ax.get_ylabel() == "worst angle margin [deg]"
    ax.figure.canvas.draw()
    for bad in ([], [STATE], plans[0]):
        with pytest.raises(rg.InvalidInput, match=r"plans must be (RegraspPlans|a list)"):
            plot_trade_off(bad)
