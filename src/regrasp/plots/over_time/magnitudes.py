"""Magnitudes, angles and margins of the finger forces over time (Fig. 9)."""

from math import inf

import numpy as np
from matplotlib.axes import Axes

from regrasp.mechanics.checks import Array, choice, instance
from regrasp.plans.transition import Transition
from regrasp.plots.look.style import (
    GREY,
    INK,
    axes_or_new,
    contact_colours,
    label_axis,
    legend,
    literal,
    marks,
)
from regrasp.plots.look.units import SI, Units
from regrasp.plots.over_time.moments import moments

_SHOWN = 2.5  # limits up to this many times the largest force are drawn


def plot_magnitudes(transition: Transition, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """|f_i(t)| of every finger (Fig. 9a), below its force limit.

    Limits are dashed, those that contacts have and those that the plan's states were chosen under; one that
    all share is grey. Linear limits are dash-dotted: how large a force in the direction of f_i(t) may be.
    What is far above every force is left out.

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    ax = axes_or_new(ax)
    t = moments(transition.duration)
    magnitudes = np.linalg.norm(transition.wrenches(t)[..., : transition.grasp.dimension], axis=-1)
    draw_lines(ax, transition, t, magnitudes, units)
    largest = float(magnitudes.max())
    _linear_limits(ax, transition, t, magnitudes, _SHOWN * largest)
    _limits(ax, transition, force_limits(transition), _SHOWN * largest)
    ax.set_ylim(bottom=min(ax.get_ylim()[0], -0.03 * largest))  # a line along zero stays visible
    label_axis(ax.yaxis, r"$|f_i|$", units.force, _largest(ax))
    return ax


def plot_angles(transition: Transition, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """The angle between f_i(t) and the normal n_i, below the limit atan(mu_i) of its cone (Fig. 9b).

    A limit that all contacts share is one grey line. A finger without force has no angle there.

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    ax = axes_or_new(ax)
    t = moments(transition.duration)
    limits = np.array([contact.half_angle for contact in transition.grasp])
    draw_lines(ax, transition, t, np.degrees(limits - transition.margins(t).angle), units)
    one = len(set(limits)) == 1
    colours = contact_colours(transition.grasp)
    for name, limit in zip(transition.grasp.names, np.degrees(limits), strict=True):
        ax.axhline(
            limit, color=GREY if one else colours[name], linewidth=0.9, linestyle="--", gid=f"limit {name}"
        )
        if one:
            break
    where = (0.0, float(np.degrees(limits.max())))
    ax.annotate(r"$\arctan\mu_i$", where, (3, 2), textcoords="offset points", fontsize=7, color=GREY)
    ax.set_ylim(-0.03 * where[1], 1.15 * where[1] or 1.0)
    label_axis(ax.yaxis, "angle to normal", "deg", where[1])
    return ax


def plot_margins(
    transition: Transition, ax: Axes | None = None, *, objective: str = "angle", units: Units = SI
) -> Axes:
    """The ``angle`` margin [deg] or the ``force`` margin [N] of every finger over time.

    The dashed line is the least margin at both ends, or at any instant of a path through instants: no margin
    falls below it in between (fact 1).

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        objective: ``angle`` or ``force``.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    choice(objective, "objective", ("angle", "force"))
    ax = axes_or_new(ax)
    t = moments(transition.duration)
    margins = transition.margins(t)
    course = transition.course
    known = transition.margins(np.array([0.0, transition.duration]) if course is None else course.times)
    if objective == "angle":
        values, least = np.degrees(margins.angle), np.degrees(known.least_angle)
    else:
        values, least = margins.force, known.least_force
    draw_lines(ax, transition, t, values, units)
    ends = [0.0, transition.duration]
    ax.plot(ends, [least, least], color=INK, linewidth=0.9, linestyle="--", gid="least", zorder=2.5)
    ax.relim()
    ax.autoscale(axis="y")
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0] if _lowest(ax) < 0 else 0.0))
    label_axis(
        ax.yaxis,
        f"{objective} margin",
        "deg" if objective == "angle" else units.force,
        _largest(ax),
    )
    return ax


def draw_lines(ax: Axes, transition: Transition, t: Array, values: Array, units: Units) -> None:
    """A line per contact from (m, n) values, the axis of time and the legend."""
    for i, (name, colour) in enumerate(contact_colours(transition.grasp).items()):
        ax.plot(t, values[:, i], color=colour, linewidth=1.4, label=literal(name), **marks(i, t.size))
    longest = max(float(np.max(line.get_xdata())) for line in ax.get_lines())  # of all plans on these axes
    ax.set_xlim(0, longest)
    label_axis(ax.xaxis, "$t$", units.time, longest)
    labelled = {str(line.get_label()): line for line in reversed(ax.get_lines())}
    legend(ax, [line for name, line in reversed(labelled.items()) if not name.startswith("_")])


def force_limits(transition: Transition) -> dict[str, float]:
    """The force limit of each finger [N]: its contact's, and that of the states chosen; infinite for none."""
    limits = {str(c.name): inf if c.max_force is None else c.max_force for c in transition.grasp}
    chosen: dict[str, float] = {}
    for choice_ in transition.record.choices:
        idle = transition.idle_at_start if choice_.end == "start" else transition.idle_at_end
        used = [name for name in transition.grasp.names if name not in idle]
        for name, limit in zip(used, choice_.force_limits, strict=False):
            chosen[name] = max(limit, chosen.get(name, 0.0))  # the path keeps the looser one
    return {name: min(limit, chosen.get(name, inf)) for name, limit in limits.items()}


def _limits(ax: Axes, transition: Transition, limits: dict[str, float], most: float) -> None:
    """A dashed line for each limit that is not above ``most``; one line where all are the same."""
    one, colours = len(set(limits.values())) == 1, contact_colours(transition.grasp)
    for name, limit in limits.items():
        if limit <= most:
            colour = GREY if one else colours[name]
            ax.axhline(limit, color=colour, linewidth=0.9, linestyle="--", gid=f"limit {name}", zorder=1.9)
        if one:
            break


def _linear_limits(ax: Axes, transition: Transition, t: Array, magnitudes: Array, most: float) -> None:
    """For each finger with linear limits the largest force in the direction it has."""
    forces = transition.forces(t)
    for i, (contact, colour) in enumerate(
        zip(transition.grasp, contact_colours(transition.grasp).values(), strict=True)
    ):
        if contact.limits is None or contact.limit_rows is None:
            continue
        rows = contact.limit_rows
        used = (forces[:, i, : rows.shape[1]] @ rows.T / contact.limits.bounds).max(axis=1)
        reach = np.divide(magnitudes[:, i], used, out=np.full(t.size, np.nan), where=used > 0)
        reach[reach > most] = np.nan
        gid = f"linear limit {contact.name}"
        ax.plot(t, reach, color=colour, linewidth=0.9, linestyle="-.", gid=gid, zorder=1.9)


def _values(ax: Axes) -> Array:
    return np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.get_lines()])


def _largest(ax: Axes) -> float:
    return float(np.nanmax(_values(ax)))


def _lowest(ax: Axes) -> float:
    return float(np.nanmin(_values(ax)))
