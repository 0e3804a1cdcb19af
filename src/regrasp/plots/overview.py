"""Every picture of a transition: one figure at a glance, and all of them by name."""

from io import BytesIO

from matplotlib.figure import Figure

from regrasp.planning.locus import EquilibriumLocus
from regrasp.planning.transition import Transition
from regrasp.plots.history import plot_angles, plot_magnitudes, plot_margins
from regrasp.plots.iso_torque import plot_iso_torque
from regrasp.plots.locus import plot_locus
from regrasp.plots.object import force_scale_of, plot_state, plot_transition
from regrasp.plots.style import (
    TEXT,
    WIDTH,
    contact_colours,
    new_figure,
    refuse_space,
    tidy,
)
from regrasp.plots.timing import plot_scaling
from regrasp.plots.wrench_loop import plot_wrench_loop, plot_wrench_paths


def transition_figure(transition: Transition) -> Figure:
    """The object with its force paths, magnitudes, angles and T(t), two by two.

    Raises ``InvalidInput`` for a grasp in space.
    """
    refuse_space(transition.grasp.dimension)
    figure = new_figure(2 * WIDTH, 5.2)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.25, 1))
    plot_transition(transition, tidy(figure.add_subplot(grid[0, 0])))
    plot_magnitudes(transition, tidy(figure.add_subplot(grid[0, 1])))
    plot_scaling(transition.scaling, tidy(figure.add_subplot(grid[1, 0])))
    plot_angles(transition, tidy(figure.add_subplot(grid[1, 1])))
    return figure


def transition_png(transition: Transition) -> bytes:
    """``transition_figure`` as a PNG image, for display in notebooks."""
    return png(transition_figure(transition))


def png(figure: Figure) -> bytes:
    """A figure as a PNG image."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()


def figures(transition: Transition) -> dict[str, Figure]:
    """Every figure of a transition by file stem.

    ``overview``, ``states``, ``object``, ``iso_torque``, ``wrench_loop``, ``wrench_paths``, ``time_scaling``,
    ``magnitudes``, ``angles``, ``margins``; and ``locus`` where two contacts remain.
    Raises ``InvalidInput`` for a grasp in space.
    """
    refuse_space(transition.grasp.dimension)
    fewer = transition.end if transition.kind == "removal" else transition.start
    rest = fewer.without(transition.contact)
    colours = contact_colours(transition.grasp)
    drawn = {
        "overview": transition_figure(transition),
        "states": states_figure(transition),
        "object": plot_transition(transition).figure,
        "iso_torque": iso_torque_figure(transition),
        "wrench_loop": plot_wrench_loop(rest, colours=colours).figure,
        "wrench_paths": plot_wrench_paths(transition).figure,
        "time_scaling": plot_scaling(transition.scaling, control=True).figure,
        "magnitudes": plot_magnitudes(transition).figure,
        "angles": plot_angles(transition).figure,
        "margins": plot_margins(transition).figure,
    }
    if len(rest.grasp) == 2:
        locus = EquilibriumLocus(rest.grasp, rest.load)
        drawn["locus"] = plot_locus(
            locus, objective=_objective(transition), chosen=rest, colours=colours
        ).figure
    return drawn


def states_figure(transition: Transition) -> Figure:
    """Both states side by side at one scale of force (Fig. 1)."""
    refuse_space(transition.grasp.dimension)
    figure = new_figure(2 * WIDTH, 3.4)
    scale = force_scale_of(transition.start, transition.end)
    for i, (title, state) in enumerate((("start", transition.start), ("end", transition.end))):
        ax = plot_state(state, tidy(figure.add_subplot(1, 2, i + 1)), force_scale=scale)
        ax.set_title(title, fontsize=TEXT, loc="left")
    return figure


def iso_torque_figure(transition: Transition) -> Figure:
    """Iso-torque lines of every contact, with its forces at the state of all fingers (Fig. 2)."""
    refuse_space(transition.grasp.dimension)
    state = transition.start if transition.kind == "removal" else transition.end
    colours = contact_colours(state.grasp)
    shown = [
        name for name, contact in zip(state.grasp.names, state.grasp, strict=True) if contact.position.any()
    ]
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    figure = new_figure(0.75 * WIDTH * columns, 2.6 * rows)
    for i, name in enumerate(shown):
        ax = tidy(figure.add_subplot(rows, columns, i + 1))
        plot_iso_torque(state.grasp[name], ax, force=state.force(name), colour=colours[name])
    return figure


def _objective(transition: Transition) -> str:
    """What the state of fewer fingers was chosen for; ``angle`` where it was given."""
    end = "end" if transition.kind == "removal" else "start"
    return next((c.objective for c in transition.record.choices if c.end == end), "angle")
