"""What was planned and what physics measured, over time."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from regrasp.execution.measured import SLIPPED, Execution
from regrasp.mechanics.checks import Array, instance
from regrasp.plots.look.png import png
from regrasp.plots.look.style import (
    GREY,
    INK,
    PALETTE,
    TEXT,
    WIDTH,
    axes_or_new,
    label_axis,
    legend,
    literal,
    marks,
    new_figure,
    tidy,
)
from regrasp.plots.look.units import SI, Units

_PLANNED: dict[str, Any] = {"color": INK, "linewidth": 0.8, "linestyle": (0, (2, 2))}


def plot_measured_forces(execution: Execution, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """|f_i| of every contact as measured, and in black dashes as planned.

    Args:
        execution: the run to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(execution, "execution", Execution)
    ax = axes_or_new(ax)
    measured, planned = (np.linalg.norm(f, axis=2) for f in (execution.forces, execution.planned))
    keys = _measured_and_planned(ax, execution, measured, planned)
    dashes = Line2D([], [], **_PLANNED, label="planned")
    _over_time(ax, execution, units)
    label_axis(ax.yaxis, "$|f_i|$ measured", units.force, float(planned.max()))
    legend(ax, [*keys, dashes], ncols=4)
    return ax


def plot_friction_use(execution: Execution, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """|f_t| / (mu f_n) under the true friction, measured, and planned in dashes; above 1 a contact slides.

    Args:
        execution: the run to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(execution, "execution", Execution)
    ax = axes_or_new(ax)
    measured, planned = execution.margins.friction_use, execution.planned_margins.friction_use
    _measured_and_planned(ax, execution, measured, planned)
    ax.axhline(1.0, color=GREY, linewidth=0.9, linestyle="--")
    _over_time(ax, execution, units)
    finite = planned[np.isfinite(planned)]
    ax.set_ylim(0, 1.1 * max(1.0, float(finite.max(initial=1.0))))
    label_axis(ax.yaxis, "friction use", "-", 1.0)
    return ax


def plot_slip(execution: Execution, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """How far every contact has slid, on a logarithmic scale, with the object's drift; dashed: slipped.

    Args:
        execution: the run to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(execution, "execution", Execution)
    ax = axes_or_new(ax)
    size = max(float(np.linalg.norm(c.position)) for c in execution.contacts)
    least = 1e-6 * size
    for i, column in enumerate(execution.slip.T):
        look = {"color": PALETTE[i % len(PALETTE)], "linewidth": 1.4} | marks(i, len(column))
        ax.semilogy(execution.times, np.maximum(column, least), **look)
    ax.semilogy(execution.times, np.maximum(execution.drift, least), color=INK, linewidth=1.0, label="drift")
    ax.axhline(SLIPPED * size, color=GREY, linewidth=0.9, linestyle="--")
    _over_time(ax, execution, units)
    ax.set_ylabel(f"slip, drift [{units.length}]", fontsize=TEXT)
    ax.annotate("drift", (execution.times[-1], max(float(execution.drift[-1]), least)), (-2, 2),
                textcoords="offset points", ha="right", fontsize=7)  # fmt: skip
    return ax


def execution_figure(execution: Execution, *, units: Units = SI) -> Figure:
    """Forces, friction use and slip over the time of the run, one above the other.

    Args:
        execution: the run to draw.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(execution, "execution", Execution)
    figure = new_figure(1.6 * WIDTH, 5.6)
    panels = [tidy(ax) for ax in figure.subplots(3, 1, sharex=True)]
    plot_measured_forces(execution, panels[0], units=units)
    plot_friction_use(execution, panels[1], units=units)
    plot_slip(execution, panels[2], units=units)
    for ax in panels[:2]:
        ax.set_xlabel("")
    return figure


def execution_png(execution: Execution) -> bytes:
    """``execution_figure`` as a PNG image, for display in notebooks."""
    return png(execution_figure(execution))


def _measured_and_planned(ax: Axes, execution: Execution, measured: Array, planned: Array) -> list[Line2D]:
    """Lines of (m, n) values of every contact, those planned over all of them; the lines measured."""
    lines: list[Line2D] = []
    for i, (name, column) in enumerate(zip(execution.names, measured.T, strict=True)):
        look: dict[str, Any] = {"color": PALETTE[i % len(PALETTE)], "linewidth": 1.6}
        look |= marks(i, len(column))
        lines += ax.plot(execution.times, column, label=literal(name), **look)
    for column in planned.T:
        ax.plot(execution.times, column, **_PLANNED)
    return lines


def _over_time(ax: Axes, execution: Execution, units: Units) -> None:
    ax.set_xlim(0, float(execution.times[-1]))
    label_axis(ax.xaxis, "time of the run", units.time, float(execution.times[-1]))
