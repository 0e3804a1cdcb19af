"""The picture of a regrasp tells, for every step, who holds, leaves and arrives, and how the object turns."""

import numpy as np
import pytest
from matplotlib.patches import Wedge

import regrasp as rg
from paper import STATE
from regrasp import plots

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


def by_gid(ax, gid):
    return [artist for artist in ax.get_children() if artist.get_gid() == gid]


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
