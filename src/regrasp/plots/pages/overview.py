"""Every picture of a transition: one figure at a glance, and all of them by name."""

from typing import Any

from matplotlib.figure import Figure

from regrasp.mechanics.checks import instance
from regrasp.outline.outline import Outline
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.plans.transition import Transition
from regrasp.plots.grasps.state import force_scale_of, plot_state, plot_transition, shape_of
from regrasp.plots.look.png import png
from regrasp.plots.look.space_axes import space_panel
from regrasp.plots.look.style import (
    TEXT,
    WIDTH,
    contact_colours,
    new_figure,
    refuse_space,
    tidy,
)
from regrasp.plots.look.units import SI, Units
from regrasp.plots.look.view import facing_view
from regrasp.plots.over_time.components import plot_force_components, plot_wrench_components
from regrasp.plots.over_time.load import plot_load
from regrasp.plots.over_time.magnitudes import plot_angles, plot_magnitudes, plot_margins
from regrasp.plots.over_time.rates import plot_rates
from regrasp.plots.over_time.scaling import plot_scaling
from regrasp.plots.wrench_space.iso_torque import plot_iso_torque
from regrasp.plots.wrench_space.locus import plot_locus
from regrasp.plots.wrench_space.wrench_loop import plot_wrench_loop, plot_wrench_paths


def transition_figure(
    transition: Transition, *, mesh: Any = None, outline: Outline | None = None, units: Units = SI
) -> Figure:
    """The object with its force paths, magnitudes, angles and T(t), or the load if it varies, two by two.

    Args:
        transition: the transition to draw.
        mesh: the object of a grasp in space, as for ``plot_state``.
        outline: that of a planar grasp.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    figure = new_figure(2 * WIDTH, 5.2)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.25, 1))
    ax = _panel(figure, grid[0, 0], (0.0, 0.46, 0.47, 0.49), transition)
    plot_transition(transition, ax, mesh=mesh, outline=outline, units=units)
    plot_magnitudes(transition, tidy(figure.add_subplot(grid[0, 1])), units=units)
    below = tidy(figure.add_subplot(grid[1, 0]))
    if transition.load_varies:
        plot_load(transition, below, units=units)
    else:
        plot_scaling(transition.scaling, below, units=units)
    plot_angles(transition, tidy(figure.add_subplot(grid[1, 1])), units=units)
    return figure


def _panel(
    figure: Figure, place: Any, room: tuple[float, float, float, float], transition: Transition
) -> Any:
    """Axes for the object: flat in its cell of the grid, or in space in its room, which no grid can judge."""
    if transition.grasp.dimension == 2:
        return tidy(figure.add_subplot(place))
    ax = space_panel(figure, room)
    ax.view_init(*facing_view(transition.grasp.positions, transition.grasp.normals))
    return ax


def transition_png(transition: Transition) -> bytes:
    """``transition_figure`` as a PNG image, for display in notebooks.

    Args:
        transition: the transition to draw.
    """
    instance(transition, "transition", Transition)
    return png(transition_figure(transition))


def figures(
    transition: Transition, *, mesh: Any = None, outline: Outline | None = None, units: Units = SI
) -> dict[str, Figure]:
    """Every figure of a transition by file stem.

    ``overview``, ``states``, ``object``, ``time_scaling``, ``magnitudes``, ``angles``, ``margins``; ``rates``
    where they were limited, ``load`` where it varies. In the plane, of a removal or an addition,
    ``iso_torque``, ``wrench_loop``, ``wrench_paths``, and ``locus`` where two contacts remain; in space
    ``components`` and ``wrenches``.

    Args:
        transition: the transition to draw.
        mesh: the object of a grasp in space, as for ``plot_state``.
        outline: that of a planar grasp.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    drawn: dict[str, Any] = {
        "overview": transition_figure(transition, mesh=mesh, outline=outline, units=units),
        "states": states_figure(transition, mesh=mesh, outline=outline, units=units),
        "object": plot_transition(transition, mesh=mesh, outline=outline, units=units).figure,
        "time_scaling": plot_scaling(transition.scaling, control=True, units=units).figure,
        "magnitudes": plot_magnitudes(transition, units=units).figure,
        "angles": plot_angles(transition, units=units).figure,
        "margins": plot_margins(transition, units=units).figure,
    }
    if transition.record.rate_limits:
        drawn["rates"] = plot_rates(transition, units=units).figure
    if transition.load_varies:
        drawn["load"] = plot_load(transition, units=units).figure
    if transition.grasp.dimension == 3:
        drawn["components"] = plot_force_components(transition, units=units).figure
        drawn["wrenches"] = wrenches_figure(transition, units=units)
    elif len(moving := (*transition.leaving, *transition.arriving)) == 1:
        drawn |= _of_one_finger(transition, moving[0], units)
    return drawn


def _of_one_finger(transition: Transition, moves: str, units: Units) -> dict[str, Figure]:
    """The figures of Section III, for one finger that leaves or arrives."""
    fewer = transition.end if transition.leaving else transition.start
    rest, colours = fewer.without(moves), contact_colours(transition.grasp)
    drawn = {
        "iso_torque": iso_torque_figure(transition, units=units),
        "wrench_loop": plot_wrench_loop(rest, colours=colours, units=units).figure,
        "wrench_paths": plot_wrench_paths(transition, units=units).figure,
    }
    if len(rest.grasp) == 2:
        objective, limits = _chosen_for(transition)
        drawn["locus"] = plot_locus(
            EquilibriumLocus(rest.grasp, rest.load),
            objective=objective,
            chosen=rest,
            colours=colours,
            force_limits=limits,
            units=units,
        ).figure
    return drawn


def states_figure(
    transition: Transition, *, mesh: Any = None, outline: Outline | None = None, units: Units = SI
) -> Figure:
    """Both states side by side at one scale of force (Fig. 1); an open circle where the finger is not.

    Args:
        transition: the transition to draw.
        mesh: the object of a grasp in space, as for ``plot_state``.
        outline: that of a planar grasp.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    figure = new_figure(2 * WIDTH, 3.4)
    grid = figure.add_gridspec(1, 2)
    if transition.grasp.dimension == 3:
        figure.set_layout_engine("none")  # it has nothing to lay out
    shape = shape_of(transition.grasp, mesh, outline)
    scale = force_scale_of(transition.start, transition.end, vertices=shape)
    ends = (
        ("start", transition.start, transition.idle_at_start),
        ("end", transition.end, transition.idle_at_end),
    )
    for i, (title, state, absent) in enumerate(ends):
        ax = _panel(figure, grid[i], (0.5 * i, 0.04, 0.47, 0.88), transition)
        plot_state(state, ax, force_scale=scale, absent=absent, mesh=mesh, outline=outline, units=units)
        ax.set_title(title, fontsize=TEXT, loc="left")
    return figure


def wrenches_figure(transition: Transition, *, units: Units = SI) -> Figure:
    """The wrench of every finger about the centre of mass over time, a panel for each.

    Args:
        transition: the transition to draw.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    columns = min(2, len(transition.grasp))
    rows = -(-len(transition.grasp) // columns)
    figure = new_figure(WIDTH * columns, 2.4 * rows)
    for i in range(len(transition.grasp)):
        plot_wrench_components(transition, i, tidy(figure.add_subplot(rows, columns, i + 1)), units=units)
    return figure


def iso_torque_figure(transition: Transition, *, units: Units = SI) -> Figure:
    """Iso-torque lines of every contact, with its forces at the state of all fingers (Fig. 2).

    Args:
        transition: the transition to draw.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    refuse_space(transition.grasp.dimension)
    state = transition.start if transition.leaving else transition.end
    colours = contact_colours(state.grasp)
    shown = [
        name for name, contact in zip(state.grasp.names, state.grasp, strict=True) if contact.position.any()
    ]
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    figure = new_figure(0.75 * WIDTH * columns, 2.6 * rows)
    for i, name in enumerate(shown):
        ax = tidy(figure.add_subplot(rows, columns, i + 1))
        plot_iso_torque(state.grasp[name], ax, force=state.force(name), colour=colours[name], units=units)
    return figure


def _chosen_for(transition: Transition) -> tuple[str, tuple[float, ...] | None]:
    """Objective and force limits of the state of fewer fingers; ``angle`` and None where it was given."""
    end = "end" if transition.leaving else "start"
    chosen = next((c for c in transition.record.choices if c.end == end), None)
    return ("angle", None) if chosen is None else (chosen.objective, chosen.force_limits)
