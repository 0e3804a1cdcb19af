"""How well a grasp holds a load in every direction."""

from math import degrees, pi

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.projections.polar import PolarAxes

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array, choice, instance, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.objectives import OBJECTIVES
from regrasp.planning.surveys.held_directions import HeldDirections, held_directions
from regrasp.plots.look.style import GREY, INK, PALETTE, SMALL, TEXT, legend, new_figure, refuse_space, short
from regrasp.plots.look.units import SI, Units

HELD = PALETTE[5]
_FULL_TURN = 120  # loads


def plot_directions(
    grasp: Grasp,
    load_size: float,
    ax: Axes | None = None,
    *,
    objective: str = "angle",
    units: Units = SI,
) -> Axes:
    """The best least margin, outwards, against the direction of a load through the centre of mass, around.

    Shaded: the directions held at all, exact (``held_directions``). Line: the margin of the state
    chosen for each of them under a load of ``load_size`` [N], as ``choose_state`` does by default.

    Args:
        grasp: planar contacts.
        load_size: magnitude of the load [N].
        ax: polar.
        objective: ``angle`` [deg] or ``force`` [N].
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For a grasp in space.
    """
    instance(grasp, "grasp", Grasp)
    refuse_space(grasp.dimension)
    choice(objective, "objective", ("angle", "force"))
    number(load_size, "load_size", above=0)
    if ax is None:
        ax = new_figure(height=3.4).add_subplot(projection="polar")
    if not isinstance(ax, PolarAxes):
        raise InvalidInput("ax must be polar: figure.add_subplot(projection='polar')")
    held = held_directions(grasp)
    angles = _sampled(held)
    values = np.array([_margin(grasp, load_size, a, objective) for a in angles.tolist()])
    top = float(values.max(initial=0.0)) or 1.0
    _shade(ax, held, 1.12 * top)
    if held.kind in ("direction", "line"):
        for angle, value in zip(angles, values, strict=True):
            ax.plot([angle, angle], [0, value], color=PALETTE[0], linewidth=1.6, gid="margin")
    elif held.arc is not None:
        ax.plot(angles, values, color=PALETTE[0], linewidth=1.6, gid="margin")
    ax.set_rlim(0, 1.12 * top)
    ax.set_yticks(np.linspace(0, 1, 4)[1:] * top)
    ax.yaxis.set_major_formatter(lambda value, _: short(float(f"{value:.2g}")))
    ax.set_rlabel_position(_free_angle(held))
    ax.tick_params(labelsize=SMALL, pad=0)
    ax.tick_params(axis="y", labelcolor=INK)
    ax.grid(color=GREY, linewidth=0.4, alpha=0.5)
    ax.spines["polar"].set_linewidth(0.6)
    unit = units.of({"rad": "deg"}.get(OBJECTIVES[objective].unit, OBJECTIVES[objective].unit))
    ax.set_xlabel("direction of the load in the object frame", fontsize=TEXT)
    key = [
        Line2D([], [], color=PALETTE[0], linewidth=1.6, label=f"least {objective} margin [{unit}]"),
        Patch(facecolor=HELD, alpha=0.3, label="held"),
    ]
    legend(ax, key, loc="lower center", bbox_to_anchor=(0.5, 1.07))  # type: ignore[arg-type]
    return ax


def _sampled(held: HeldDirections) -> Array:
    """Directions to choose states for [rad], both ends of the arc included."""
    if held.arc is None:
        return np.empty(0)
    if held.kind in ("direction", "line"):
        return np.unique(held.arc)
    return np.linspace(*held.arc, max(9, round(_FULL_TURN * held.width / (2 * pi)) + 1))


def _margin(grasp: Grasp, size: float, angle: float, objective: str) -> float:
    """The best least margin [deg or N]; 0 where only the friction kept in reserve would hold."""
    load = Wrench([size * np.cos(angle), size * np.sin(angle)])
    try:
        value = choose_state(grasp, load, objective).value
    except Infeasible:
        return 0.0
    return max(0.0, degrees(value) if OBJECTIVES[objective].unit == "rad" else value)


def _shade(ax: PolarAxes, held: HeldDirections, top: float) -> None:
    if held.arc is None:
        ax.text(0, 0, "no direction\nis held", fontsize=TEXT, ha="center", va="center")
        return
    if held.width:
        around = np.linspace(*held.arc, 200)
        ax.fill_between(around, 0, top, color=HELD, alpha=0.3, linewidth=0, gid="held")
    if held.kind != "everything":
        for angle in set(held.arc):
            ax.plot([angle, angle], [0, top], color=HELD, linewidth=1.2, gid="end of arc")


def _free_angle(held: HeldDirections) -> float:
    """Where the numbers stand [deg]: outside the arc where there is room."""
    if held.arc is None or held.kind == "everything":
        return 22.5
    return degrees(held.arc[1]) + 12.0
