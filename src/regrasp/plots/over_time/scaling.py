"""The time function T(t) (Fig. 8)."""

from matplotlib.axes import Axes

from regrasp.mechanics.checks import instance
from regrasp.plans.timing import TimeScaling
from regrasp.plots.look.style import GREY, PALETTE, axes_or_new, label_axis, legend
from regrasp.plots.look.units import SI, Units
from regrasp.plots.over_time.moments import moments


def plot_scaling(
    scaling: TimeScaling, ax: Axes | None = None, *, control: bool = False, units: Units = SI
) -> Axes:
    """T(t) over the duration (Fig. 8), with its control values if ``control``.

    Args:
        scaling: the time function to draw.
        ax: the axes to draw on; new ones if not given.
        control: whether to draw its control values.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(scaling, "scaling", TimeScaling)
    ax = axes_or_new(ax)
    t = moments(scaling.duration)
    ax.plot(t, scaling(t), color=PALETTE[0], linewidth=1.4, label="$T(t)$")
    if control:
        ax.plot(
            scaling.abscissae,
            scaling.control,
            "o--",
            color=GREY,
            linewidth=0.7,
            markersize=3,
            clip_on=False,
            label="control values",
        )
        legend(ax)
    ax.set_xlim(0, scaling.duration)
    label_axis(ax.xaxis, "$t$", units.time, scaling.duration)
    label_axis(ax.yaxis, "$T$", "-", 1.0)
    return ax
