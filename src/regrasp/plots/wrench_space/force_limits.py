"""Force limits along the equilibrium locus of two contacts."""

from collections.abc import Sequence
from math import inf

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from regrasp.closed_form.locus import within_limit
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.state import GraspState
from regrasp.planning.states.criteria import ChosenState
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.plots.look.style import GREY, INK, SMALL


def limits_of(locus: EquilibriumLocus, chosen: GraspState | None) -> Sequence[float]:
    """(2,) limits [N]: those ``chosen`` records, or else the contacts' own; infinite for none."""
    if isinstance(chosen, ChosenState):
        return chosen.force_limits
    return [float(limit) for limit in locus.grasp.max_forces]


def limited_interval(locus: EquilibriumLocus, limits: Sequence[float]) -> tuple[float, float]:
    """(lo, hi) of the squeeze [N] where both forces keep their limits, cones left aside; empty as lo > hi."""
    if len(limits) != 2:
        raise InvalidInput(f"force_limits must be two numbers, one per contact, got {shown(limits)}")
    along = locus.direction
    first, second = locus.forces(0.0)
    across = np.array([-along[1], along[0]])
    lo1, hi1 = within_limit(-inf, inf, float(first @ across), limits[0])
    lo2, hi2 = within_limit(-inf, inf, float(second @ across), limits[1])
    fixed = float(second @ along)  # f_2 has the component fixed - x along the line of contacts
    return max(lo1, fixed - hi2), min(hi1, fixed - lo2)


def draw_limits(ax: Axes, shown: tuple[float, float], limited: tuple[float, float]) -> None:
    """Hatch what is shown of the locus beyond the limits, and mark their ends in sight."""
    lo, hi = shown
    left, right = limited if limited[0] <= limited[1] else (hi, hi)
    for start, end in ((lo, min(left, hi)), (max(right, lo), hi)):
        if start < end:
            span = ax.axvspan(start, end, linewidth=0, zorder=0, gid="over limit")
            span.set(facecolor="white", edgecolor="#bbbbbb", hatch="////")
    for end in limited:
        if lo <= end <= hi:
            ax.axvline(end, color=GREY, linewidth=0.9, linestyle="-.", gid="force limit")
            ax.annotate(
                "force limit",
                (end, 0.03),
                (-2, 0),
                xycoords=ax.get_xaxis_transform(),
                textcoords="offset points",
                rotation=90,
                ha="right",
                fontsize=SMALL,
                color=INK,
                path_effects=[withStroke(linewidth=1.5, foreground="white")],
            )
