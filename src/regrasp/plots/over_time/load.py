"""The load over time."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import instance
from regrasp.plans.transition import Transition
from regrasp.plots.look.style import PALETTE, axes_or_new, label_axis, legend, marks, steady
from regrasp.plots.look.units import SI, Units
from regrasp.plots.over_time.components import draw_torques
from regrasp.plots.over_time.moments import moments


def plot_load(transition: Transition, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """External force and torque on the object over time, in the object frame; dots where it is given.

    The torque has its own axis on the right.

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: Where the load is constant.
    """
    instance(transition, "transition", Transition)
    if not transition.load_varies:
        raise InvalidInput("the load of this path is constant; there is nothing to draw over time")
    course = transition.course
    t = moments(transition.duration) if course is None else course.times
    load = transition.load(t)
    ax = axes_or_new(ax)
    look: dict[str, Any] = {"linewidth": 1.4, "marker": "." if t.size <= 60 else "", "markersize": 4}
    d = transition.grasp.dimension
    for axis, name in enumerate("xyz"[:d]):
        own = look if look["marker"] else look | marks(axis, t.size)
        ax.plot(t, load[:, axis], color=PALETTE[axis], label=f"$f_{name}$", **own)
    lines = draw_torques(ax, t, load[:, d:], units, **look)
    ax.set_xlim(0, transition.duration)
    label_axis(ax.xaxis, "$t$", units.time, transition.duration)
    label_axis(ax.yaxis, "load", units.force, float(np.abs(load[:, :d]).max()))
    steady(ax, load[:, :d])
    legend(ax, [*ax.get_lines(), *lines])
    return ax
