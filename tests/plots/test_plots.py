"""Pictures draw on the axes they are given, with labels, units, names and colours, and are complete."""

import re
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from mpl_toolkits.mplot3d import Axes3D

import regrasp as rg
from drawn import PNG, lines_by_label
from pictured import TRANSITIONS, five_fingers, paper_removal
from regrasp import plots
from regrasp.mechanics.wrench_space import WrenchCone, WrenchPlane
from regrasp.plots.look.style import round_below

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def removal():
    return paper_removal()


@pytest.fixture(scope="module")
def locus(removal):
    return rg.EquilibriumLocus(removal.grasp.without("P3"), removal.start.load)


def drawable(removal, locus):
    """Every public function on flat axes, with a value it draws."""
    return {
        plots.plot_state: removal.start,
        plots.plot_transition: removal,
        plots.plot_iso_torque: removal.grasp["P1"],
        plots.plot_scaling: removal.scaling,
        plots.plot_magnitudes: removal,
        plots.plot_rates: removal,
        plots.plot_angles: removal,
        plots.plot_margins: removal,
        plots.plot_locus: locus,
    }


def drawable_in_space(removal, locus):
    return {
        plots.plot_wrench_plane: WrenchPlane(removal.grasp["P1"]),
        plots.plot_wrench_cone: WrenchCone(removal.grasp["P1"]),
        plots.plot_locus_segment: locus,
        plots.plot_wrench_loop: removal.start,
        plots.plot_wrench_paths: removal,
    }


def test_each_function_draws_on_the_axes_it_is_given(removal, locus):
    for function, value in drawable(removal, locus).items():
        ax = Figure().add_subplot()
        assert function(value, ax) is ax
        assert ax.has_data()


def test_each_wrench_space_function_draws_on_the_axes_it_is_given_and_keeps_their_view(removal, locus):
    for function, value in drawable_in_space(removal, locus).items():
        ax = Figure().add_subplot(projection="3d")
        ax.view_init(11, 17)
        assert function(value, ax) is ax
        assert ax.has_data()
        assert (ax.elev, ax.azim) == (11, 17)


def test_new_axes_have_a_figure_of_a_columns_width_and_labels_with_units(removal, locus):
    everything = drawable(removal, locus) | drawable_in_space(removal, locus)
    for function, value in everything.items():
        ax = function(value)
        assert ax.figure.get_figwidth() == pytest.approx(3.4)
        labels = [ax.get_xlabel(), ax.get_ylabel(), *([ax.get_zlabel()] if isinstance(ax, Axes3D) else [])]
        assert all(label.endswith("]") and "[" in label for label in labels), (function, labels)


def test_the_units_are_those_of_the_conventions(removal, locus):
    expected = {
        plots.plot_state: ("m", "m"),
        plots.plot_transition: ("m", "m"),
        plots.plot_iso_torque: ("N", "N"),
        plots.plot_scaling: ("s", "-"),
        plots.plot_magnitudes: ("s", "N"),
        plots.plot_rates: ("s", "N/s"),
        plots.plot_angles: ("s", "deg"),
        plots.plot_margins: ("s", "deg"),
        plots.plot_locus: ("N", "deg"),
    }
    for function, value in drawable(removal, locus).items():
        ax = function(value)
        units = tuple(label.split("[")[1].rstrip("]") for label in (ax.get_xlabel(), ax.get_ylabel()))
        assert units == expected[function], function
    ax = plots.plot_wrench_loop(removal.start)
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()) == ("$f_x$ [N]", "$f_y$ [N]", r"$\tau$ [N m]")


def test_text_is_at_least_seven_points(removal):
    for name, figure in plots.figures(removal).items():
        figure.draw_without_rendering()
        for ax in figure.axes:
            texts = [*ax.texts, ax.xaxis.label, ax.yaxis.label, *ax.get_xticklabels(), *ax.get_yticklabels()]
            texts += ax.get_legend().get_texts() if ax.get_legend() else []
            assert min(text.get_fontsize() for text in texts) >= 7, name


def test_tiny_and_huge_numbers_share_a_power_of_ten_in_the_label():
    for length, power in ((1e-6, "10^{-6}"), (1e6, "10^{6}")):
        transition = paper_removal(length, 1.0)
        ax = plots.plot_transition(transition)
        assert power in ax.get_xlabel()
        ax.figure.draw_without_rendering()
        ticks = [label.get_text() for label in ax.get_xticklabels()]
        assert all(len(tick) <= 5 for tick in ticks)
        assert "0" in ticks


def test_contacts_keep_their_colour_in_every_figure(removal):
    colours = plots.contact_colours(removal.grasp)
    assert len(set(colours.values())) == 3
    drawn = plots.figures(removal)
    for stem in ("magnitudes", "angles", "margins"):
        lines = lines_by_label(drawn[stem].axes[0])
        assert {name: lines[name].get_color() for name in colours} == colours
    gone_first = removal.grasp.names[0]
    transition = rg.plan_removal(five_fingers().start, "P1")
    rest = {name: c for name, c in plots.contact_colours(transition.grasp).items() if name != gone_first}
    loop = plots.figures(transition)["wrench_loop"].axes[0]
    for name, colour in rest.items():
        (key,) = [line for line in loop.get_legend().get_lines() if line.get_label() == name]
        assert key.get_color() == colour


def test_names_are_shown_letter_by_letter():
    names = ("$x$", "_hidden", "a_1$")
    grasp = rg.Grasp(
        rg.Contact(c.position, c.normal, c.friction, name=name)
        for c, name in zip(paper_removal().grasp, names, strict=True)
    )
    drawn = plots.figures(rg.plan_removal(grasp, 2, load=rg.Wrench([-1.5, -3.5])))
    for stem, count in (("magnitudes", 3), ("wrench_loop", 2), ("wrench_paths", 3), ("locus", 2)):
        ax = drawn[stem].axes[0]
        legends = [artist for artist in ax.get_children() if isinstance(artist, Legend)]
        shown = [seen(text) for legend in legends for text in legend.get_texts()]
        assert [name for name in shown if name in names] == list(names[:count]), stem
    for stem in ("object", "states", "iso_torque"):
        shown = {seen(text) for ax in drawn[stem].axes for text in ax.texts}
        assert set(names) <= shown, stem


def seen(text):
    """What matplotlib draws of a text, without the room around it."""
    drawn, is_mathematics = text._preprocess_math(text.get_text())
    return None if is_mathematics else drawn.strip()


def test_labels_name_the_units_they_are_told(removal, locus):
    units = plots.Units("mm", "kN", "ms")
    for function, value in (drawable(removal, locus) | drawable_in_space(removal, locus)).items():
        ax = function(value, units=units)
        labels = [ax.get_xlabel(), ax.get_ylabel(), *([ax.get_zlabel()] if isinstance(ax, Axes3D) else [])]
        named = {label.split("[")[1].rstrip("]") for label in labels}
        assert named <= {"mm", "kN", "ms", "kN mm", "kN/ms", "deg", "-"}, function
    ax = plots.plot_iso_torque(removal.grasp["P1"], torques=[3.0], units=units)
    assert "3 kN mm" in {text.get_text() for text in ax.texts}
    for figure in plots.figures(removal, units=units).values():
        for ax in figure.axes:
            assert not re.search(r"\[(N|m|s|N m)\]", ax.get_xlabel() + ax.get_ylabel())


STEMS = {
    "overview",
    "states",
    "object",
    "iso_torque",
    "wrench_loop",
    "wrench_paths",
    "time_scaling",
    "magnitudes",
    "angles",
    "margins",
}


@pytest.mark.parametrize("build", TRANSITIONS.values(), ids=TRANSITIONS)
def test_figures_are_complete_and_can_be_written(build):
    transition = build()
    drawn = plots.figures(transition)
    assert set(drawn) == STEMS | ({"locus"} if len(transition.grasp) == 3 else set())
    for stem, figure in drawn.items():
        assert isinstance(figure, Figure)
        figure.draw_without_rendering()
        assert figure.axes, stem


def test_a_contact_at_the_centre_of_mass_has_no_iso_torque_panel():
    grasp = rg.Grasp(
        [rg.Contact([0, 0], [0, 1], 0.5), rg.Contact([1, 0], [-1, 0], 0.8), rg.Contact([-1, 0], [1, 0], 0.8)]
    )
    transition = rg.plan_removal(grasp, 0, load=rg.Wrench([0, -1]))
    drawn = plots.figures(transition)
    assert len(drawn["iso_torque"].axes) == 2
    assert plots.png(drawn["iso_torque"]).startswith(PNG)


def test_notebooks_get_a_picture(removal):
    assert removal._repr_png_().startswith(PNG)


def test_pictures_of_the_plane_refuse_a_grasp_in_space():
    grasp = rg.Grasp([rg.Contact([1, 0, 0], [-1, 0, 0], 0.5), rg.Contact([-1, 0, 0], [1, 0, 0], 0.5)])
    state = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), [[-1, 0, 0], [1, 0, 0]])
    idle = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), np.zeros((2, 3)))
    transition = rg.Transition(state, idle, rg.TimeScaling.spline(1.0), None, leaving=("P1",))
    calls = [
        (plots.plot_wrench_loop, state),
        (plots.plot_wrench_paths, transition),
        (plots.iso_torque_figure, transition),
    ]
    for function, value in calls:
        with pytest.raises(rg.InvalidInput, match="this picture is of the plane, got dimension 3; in space"):
            function(value)


def test_drawing_does_not_import_pyplot():
    code = """
import sys
from regrasp import plots
import regrasp as rg
sides = [rg.Contact([-1, 0], [1, 0], 0.9), rg.Contact([1, 0], [-1, 0], 0.9)]
contacts = [*sides, rg.Contact([0, 1], [0, -1], 0.9)]
removal = rg.plan_removal(rg.Grasp(contacts), 2, load=rg.Wrench([0, -1]))
written = [plots.png(figure) for figure in plots.figures(removal).values()]
print(len(written), "matplotlib.pyplot" in sys.modules)
"""
    assert run(code) == "11 False"


def test_importing_and_planning_do_not_import_matplotlib():
    code = """
import sys
import regrasp as rg
sides = [rg.Contact([-1, 0], [1, 0], 0.9), rg.Contact([1, 0], [-1, 0], 0.9)]
contacts = [*sides, rg.Contact([0, 1], [0, -1], 0.9)]
rg.plan_removal(rg.Grasp(contacts), 2, load=rg.Wrench([0, -1]))
print(any(name.split(".")[0] in ("matplotlib", "mpl_toolkits") for name in sys.modules))
"""
    assert run(code) == "False"


def test_round_numbers_stay_below():
    assert [round_below(x) for x in (1.0, 1.9, 2.0, 7.0, 0.03, 5e-7)] == [1.0, 1.0, 2.0, 5.0, 0.02, 5e-7]


def run(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()
