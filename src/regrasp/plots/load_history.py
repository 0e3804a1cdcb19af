"""The load over time."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from regrasp.errors import InvalidInput
from regrasp.planning.transition import Transition
from regrasp.plots.style import PALETTE, axes_or_new, label_axis, legend, refuse_space
from regrasp.plots.units import SI, Units


def plot_load(transition: Transition, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """External force and torque on the object over time, in the object frame; dots where it is given.

    The torque has its own axis on the right. Raises ``InvalidInput`` for a straight path, whose load is one.
    """
    refuse_space(transition.grasp.dimension)
    course = transition.course
    if course is None:
        raise InvalidInput("the load of a straight path is constant; there is nothing to draw over time")
    ax = axes_or_new(ax)
    look: dict[str, Any] = {
        "linewidth": 1.4,
        "marker": "." if course.times.size <= 60 else "",
        "markersize": 4,
    }
    for axis, name in enumerate("xy"):
        ax.plot(course.times, course.loads[:, axis], color=PALETTE[axis], label=f"$f_{name}$", **look)
    right = ax.twinx()
    lines = right.plot(
        course.times, course.loads[:, 2], color=PALETTE[2], linestyle="--", label=r"$\tau$ (right)", **look
    )
    right.spines["right"].set_visible(True)
    ax.set_xlim(0, transition.duration)
    label_axis(ax.xaxis, "$t$", units.time, transition.duration)
    label_axis(ax.yaxis, "load", units.force, float(np.abs(course.loads[:, :2]).max()))
    label_axis(right.yaxis, "torque", units.torque, float(np.abs(course.loads[:, 2]).max()))
    right.tick_params(labelsize=ax.yaxis.get_ticklabels()[0].get_fontsize())
    legend(ax, [*ax.get_lines(), *lines])
    return ax
