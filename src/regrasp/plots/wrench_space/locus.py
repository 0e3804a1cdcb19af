"""The value of a state along the equilibrium locus, against the squeeze."""

from collections.abc import Sequence
from math import inf, isfinite, nan

import numpy as np
from matplotlib.axes import Axes

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array, instance
from regrasp.mechanics.state import GraspState
from regrasp.planning.states.objectives import Objective, objective_of
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.plots.look.style import (
    GREY,
    INK,
    PALE,
    Colours,
    axes_or_new,
    contact_colours,
    label_axis,
    legend,
    literal,
    marks,
)
from regrasp.plots.look.units import SI, Units
from regrasp.plots.wrench_space.force_limits import draw_limits, limited_interval, limits_of

_SAMPLES = 401
_COMBINED = {"least": np.fmin, "largest": np.fmax, "sum": np.add}


def plot_locus(
    locus: EquilibriumLocus,
    ax: Axes | None = None,
    *,
    objective: str | Objective = "angle",
    chosen: GraspState | None = None,
    colours: Colours | None = None,
    force_limits: Sequence[float] | None = None,
    units: Units = SI,
) -> Axes:
    """An objective along the locus against the squeeze, with each contact's part in it.

    The locus is shaded and its finite ends are marked; an infinite side is shown for a stretch that holds
    ``chosen``, a state of the two contacts to mark. The curves go on a little beyond the ends, where
    margins are negative. Where a force exceeds its limit the locus is hatched.

    Args:
        locus: of two planar contacts.
        ax: the axes to draw on; new ones if not given.
        objective: a word, or an objective with a value per contact.
        chosen: a state of the two contacts to mark; none if not given.
        colours: of the contacts by name; by their place in the grasp if not given.
        force_limits: (2,) [N], infinite for none. By default those that ``chosen`` was chosen under, where it
            records them as ``locus.best`` does; else the contacts' own.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        Infeasible: For an empty locus.
    """
    instance(locus, "locus", EquilibriumLocus)
    sought = objective_of(objective)
    if locus.is_empty:
        raise Infeasible(f"the equilibrium locus of {', '.join(locus.grasp.names)} is empty: nothing to draw")
    ax = axes_or_new(ax)
    colours = contact_colours(locus.grasp) if colours is None else colours
    combine = _COMBINED[sought.together]
    limited = limited_interval(locus, limits_of(locus, chosen) if force_limits is None else force_limits)
    lo, hi = shown_interval(locus, chosen, limited)
    pad = 0.08 * (hi - lo) or 0.05 * abs(lo) or 1.0
    ends = locus.interval
    x = np.linspace(lo - pad * isfinite(ends[0]), hi + pad * isfinite(ends[1]), _SAMPLES)
    values = _values(locus, x, sought)
    ax.axvspan(lo, hi, color=PALE, linewidth=0, zorder=0)
    ax.plot(
        x, combine.reduce(values, axis=1), color=INK, linewidth=4, alpha=0.25, label=sought.together, zorder=1
    )
    for i, (name, column) in enumerate(zip(locus.grasp.names, values.T, strict=True)):
        ax.plot(x, column, color=colours[name], linewidth=1.3, label=literal(name), **marks(i, len(x)))
    if sought.maximise:
        ax.axhline(0, color=GREY, linewidth=0.7)
        bottom, top = ax.get_ylim()
        ax.set_ylim(max(bottom, -0.4 * abs(top)), top)  # far outside the cones there is nothing to read
    if sought.unit == "-":
        ax.axhline(1, color=GREY, linewidth=0.7)
        ax.set_ylim(0, 1.3)
    for end in ends:
        if isfinite(end):
            ax.axvline(end, color=GREY, linewidth=0.9, linestyle="--", gid="end")
    draw_limits(ax, (lo, hi), limited)
    ax.set_xlim(x[0], x[-1])
    if chosen is not None:
        at = locus.squeeze(chosen)
        value = combine.reduce(_values(locus, np.array([at]), sought), axis=1)[0]
        ax.plot(at, value, "o", color=INK, markersize=5, zorder=5, label="chosen", gid="chosen")
    label_axis(ax.xaxis, "squeeze $x$", units.force, max(abs(x)))
    label_axis(ax.yaxis, sought.quantity, _unit(sought, units), float(np.nanmax(abs(values))))
    legend(ax)
    return ax


def shown_interval(
    locus: EquilibriumLocus,
    chosen: GraspState | None = None,
    limited: tuple[float, float] = (-inf, inf),
) -> tuple[float, float]:
    """The locus with infinite ends cut off where the squeeze is a few times the other forces in play [N].

    The ends of ``limited``, the squeezes within force limits, come into sight where they are not far.
    """
    lo, hi = locus.interval
    known = [2 * float(np.linalg.norm(locus.forces(0.0), axis=-1).max())]
    known += [2 * abs(end) for end in (lo, hi) if isfinite(end)]
    if chosen is not None:
        known.append(1.3 * abs(locus.squeeze(chosen)))
    far = 3 * max(known)
    known += [1.1 * abs(end) for end in limited if abs(end) <= far]
    reach = max(known) or 1.0
    return max(lo, -reach), min(hi, reach)


def _values(locus: EquilibriumLocus, x: Array, objective: Objective) -> Array:
    """(m, 2) what each contact adds to an objective, angles in degrees."""
    values = objective.of_contacts(locus.forces(x), locus.grasp)
    values = np.where(np.isfinite(values), values, nan)
    return np.degrees(values) if objective.unit == "rad" else values


def _unit(objective: Objective, units: Units) -> str:
    return "deg" if objective.unit == "rad" else units.of(objective.unit)
