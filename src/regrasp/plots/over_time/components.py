"""Components of the finger forces and of their wrenches over time."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from regrasp.mechanics.checks import Array, instance
from regrasp.plans.transition import Transition
from regrasp.plots.look.style import (
    INK,
    PALETTE,
    axes_or_new,
    contact_colours,
    label_axis,
    legend,
    literal,
    marks,
    steady,
)
from regrasp.plots.look.units import SI, Units
from regrasp.plots.over_time.moments import moments

_DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1, 1.2)))
"""Of the components along x, y and z."""


def plot_force_components(transition: Transition, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """f_x, f_y and in space f_z of every finger: a colour for each finger, a dash for each component.

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    ax = axes_or_new(ax)
    t = moments(transition.duration)
    forces = transition.forces(t)
    colours = contact_colours(transition.grasp)
    axes = "xyz"[: transition.grasp.dimension]
    for i, (name, colour) in enumerate(colours.items()):
        for k, axis in enumerate(axes):
            look = {"color": colour, "linestyle": _DASHES[k], "linewidth": 1.3} | marks(i, t.size)
            ax.plot(t, forces[:, i, k], gid=f"f{axis} {name}", **look)
    _finish(ax, transition, forces, units)
    keys = [
        Line2D([], [], color=c, linewidth=1.3, label=literal(n), **(marks(i, 1) | {"markevery": None}))
        for i, (n, c) in enumerate(colours.items())
    ]
    dashes = [
        Line2D([], [], color=INK, linestyle=_DASHES[k], linewidth=1.3, label=f"$f_{a}$")
        for k, a in enumerate(axes)
    ]
    legend(ax, dashes, loc="upper right", bbox_to_anchor=(1, 1), handlelength=1.8)
    inside: Any = ax.get_legend()
    legend(ax, keys)
    ax.add_artist(inside)
    ax.margins(y=0.14)
    steady(ax, forces)
    return ax


def plot_wrench_components(
    transition: Transition, contact: str | int, ax: Axes | None = None, *, units: Units = SI
) -> Axes:
    """The wrench of one finger about the centre of mass over time: forces, and torques dashed on the right.

    Six lines in space, three in the plane; a colour for each axis.

    Args:
        transition: the transition to draw.
        contact: name or index of the finger.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For an unknown contact.
    """
    instance(transition, "transition", Transition)
    i = transition.grasp.index(contact)
    ax = axes_or_new(ax)
    t, d = moments(transition.duration), transition.grasp.dimension
    wrench = transition.wrenches(t)[:, i]
    for k, axis in enumerate("xyz"[:d]):
        ax.plot(t, wrench[:, k], color=PALETTE[k], linewidth=1.4, label=f"$f_{axis}$", **marks(k, t.size))
    lines = ax.get_lines()
    right = draw_torques(ax, t, wrench[:, d:], units)
    _finish(ax, transition, wrench[:, :d], units)
    legend(ax, [*lines, *right], title=literal(transition.grasp.names[i]), title_fontsize=7)
    return ax


def draw_torques(ax: Axes, t: Array, torques: Array, units: Units, **look: Any) -> list[Line2D]:
    """(m, 1) or (m, 3) torques, dashed, on an axis of their own at the right; the lines drawn."""
    right: Any = ax.twinx()
    planar = torques.shape[1] == 1
    lines: list[Line2D] = []
    for k, column in enumerate(torques.T):
        label, colour = (r"$\tau$", PALETTE[2]) if planar else (rf"$\tau_{'xyz'[k]}$", PALETTE[k])
        shown = label if k + 1 < len(torques.T) else f"{label} (right)"
        base = {"color": colour, "linestyle": "--", "linewidth": 1.4, "label": shown} | marks(k, t.size)
        lines += right.plot(t, column, **(base | look))
    steady(right, torques)
    right.spines["right"].set_visible(True)
    right.spines["top"].set_visible(False)
    label_axis(right.yaxis, "torque", units.torque, float(np.abs(torques).max()))
    right.tick_params(labelsize=ax.yaxis.get_ticklabels()[0].get_fontsize())
    return lines


def _finish(ax: Axes, transition: Transition, forces: Array, units: Units) -> None:
    ax.set_xlim(0, transition.duration)
    label_axis(ax.xaxis, "$t$", units.time, transition.duration)
    label_axis(ax.yaxis, "force", units.force, float(np.abs(forces).max()))
    steady(ax, forces)
