"""Lines over time in space are the numbers of the transition they are drawn from."""

import numpy as np
import pytest

import regrasp as rg
from drawn import PNG, by_gid, one, points_of
from pictured import box, lifted
from regrasp import plots

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def lift():
    return lifted()


@pytest.fixture(scope="module")
def block():
    return box(0.06, 0.04, 0.03)


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
