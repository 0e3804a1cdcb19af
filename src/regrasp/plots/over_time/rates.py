"""How fast every finger's force changes over time."""

from math import inf
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from regrasp.mechanics.checks import Array, ArrayLike, instance, limits
from regrasp.plans.transition import Transition
from regrasp.plots.look.style import GREY, axes_or_new, contact_colours, label_axis, steady
from regrasp.plots.look.units import SI, Units
from regrasp.plots.over_time.magnitudes import draw_lines
from regrasp.plots.over_time.moments import moments

_SHOWN = 2.5  # limits up to this many times the fastest change are drawn


def plot_rates(
    transition: Transition,
    ax: Axes | None = None,
    *,
    rate_limit: ArrayLike | None = None,
    units: Units = SI,
) -> Axes:
    """|f_i'(t)| of every finger, below the rate limit it was planned under, dashed; grey where all share one.

    What is far above every rate is left out.

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        rate_limit: of all fingers or of each (n,), greater than 0, as given to ``fastest`` [N/s]; those of
            the plan's record if not given.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For limits that are none.
    """
    instance(transition, "transition", Transition)
    most = _limits(transition, rate_limit)
    ax = axes_or_new(ax)
    t = moments(transition.duration)
    rates = np.linalg.norm(transition.rates(t)[..., : transition.grasp.dimension], axis=-1)
    draw_lines(ax, transition, t, rates, units)
    largest, one = float(rates.max()), len(set(most.tolist())) == 1
    for (name, colour), limit in zip(contact_colours(transition.grasp).items(), most.tolist(), strict=True):
        if limit <= _SHOWN * largest or (largest == 0 and limit < inf):
            look: dict[str, Any] = {
                "color": GREY if one else colour,
                "linewidth": 0.9,
                "linestyle": "--",
                "zorder": 1.9,
            }
            ax.axhline(limit, gid=f"limit {name}", **look)
        if one:
            break
    steady(ax, rates)
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0], -0.03 * largest))
    label_axis(ax.yaxis, r"$|f_i'|$", f"{units.force}/{units.time}", ax.get_ylim()[1])
    return ax


def _limits(transition: Transition, given: ArrayLike | None) -> Array:
    count = len(transition.grasp)
    if given is not None:
        return limits(given, "rate_limit", count)
    return np.array(transition.record.rate_limits or [inf] * count)
