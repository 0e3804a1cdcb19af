"""Lines over time are the numbers of the transition they are drawn from."""

import numpy as np
import pytest

import regrasp as rg
from drawn import by_gid, lines_by_label
from paper import STATE
from pictured import TRANSITIONS, box_addition, paper_removal
from regrasp import plots

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def removal():
    return paper_removal()


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
