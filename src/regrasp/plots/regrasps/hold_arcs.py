"""The exact arcs of holds over the object's angle: of every pair on the map, and the margins of a plan's."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.patches import Circle, Wedge

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, instance, number
from regrasp.outline.outline import Outline
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.turning.hold_arcs import candidates_of, hold_arcs
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.look.style import GREY, INK, NO_HOLD, PALETTE, TEXT, axes_or_new, label_axis, legend
from regrasp.plots.look.units import SI, Units
from regrasp.plots.regrasps.path_on_map import draw_path, path_of, place_of

_FILLED = 0.47  # of the usual spacing of places: the radius of a disc
_THINNEST = 6.0  # degrees of a sector: two opposite angles, or one, are arcs of none
_ANGLES = 721
_BEYOND = 40.0  # degrees, on either side of a plan's


def plot_hold_arcs(
    graph: HoldGraph,
    outline: Outline,
    ax: Axes | None = None,
    *,
    level: float = 0.0,
    plan: RegraspPlan | None = None,
    units: Units = SI,
) -> Axes:
    """At which angles of the object each pair of places holds: sectors on the hold map, in closed form.

    A sector's directions are the object's angles, 0 to the right and counter-clockwise, over all of them and
    not those of the graph; the disc behind it is a whole turn. Above the diagonal pairs hold; below it,
    mirrored, they keep a margin of ``level``, in sectors within those above. Some 20 places are legible.

    Args:
        graph: of a ``RegraspProblem``, or your own, without a filter; its contacts lie on the outline.
        outline: the outline whose boundary the contacts lie on.
        ax: the axes to draw on; new ones if not given.
        level: angle margin that pairs keep below the diagonal [rad].
        plan: its holds of two fingers, drawn as a path from the square to the disc.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(graph, "graph", HoldGraph)
    instance(outline, "outline", Outline)
    number(level, "level", least=0)
    if plan is not None:
        instance(plan, "plan", RegraspPlan)
    places = np.array([place_of(outline, contact) for contact in graph.contacts])
    gaps = np.diff(np.sort(places))
    radius = _FILLED * float(np.median(gaps[gaps > 0]))
    sectors, discs = [], []
    for below, found in enumerate((hold_arcs(graph), hold_arcs(graph, level))):
        s, t = np.sort([places[found.pairs[0]], places[found.pairs[1]]], axis=0)
        for centre, arcs in zip(np.stack([t, s] if below else [s, t], axis=1), found.arcs, strict=True):
            discs.append(Circle(centre, radius))
            for lo, hi in np.degrees(arcs):
                wider = max(_THINNEST - (hi - lo), 0.0) / 2
                sectors.append(Wedge(centre, radius, lo - wider, hi + wider))
    ax = axes_or_new(ax, height=3.65)
    ax.add_collection(PatchCollection(discs, facecolor=NO_HOLD, linewidth=0, gid="discs", zorder=1))
    ax.add_collection(PatchCollection(sectors, facecolor=PALETTE[0], linewidth=0, gid="sectors", zorder=2))
    length = outline.length
    ax.plot([0, length], [0, length], color=GREY, linewidth=0.6, zorder=1)
    if plan is not None:
        draw_path(ax, path_of(plan, outline))
    ax.set(xlim=(0, length), ylim=(0, length))
    ax.set_aspect("equal", adjustable="box")
    label_axis(ax.xaxis, "one finger at arc length", units.length, length)
    label_axis(ax.yaxis, "the other at", units.length, length)
    kept = f", below with {np.degrees(level):.3g} deg" if level else ""
    ax.set_title(f"angles that hold{kept}", fontsize=TEXT, loc="left", color=INK)
    return ax


def plot_hold_margins(plan: RegraspPlan, graph: HoldGraph, ax: Axes | None = None) -> Axes:
    """The exact margin of each hold of a plan over the object's angle, and where the plan holds it.

    A curve ends where its pair holds no more. Discs are the plan's holds, in order along the thin line; the
    dashed line is the least margin of the plan. States may be chosen for something other than the margin:
    discs show what each hold could keep there.

    Args:
        plan: a regrasp in the plane.
        graph: of a ``RegraspProblem`` that has the plan's contacts, by their names.
        ax: the axes to draw on; new ones if not given.
    """
    instance(graph, "graph", HoldGraph)
    instance(plan, "plan", RegraspPlan)
    numbers = {contact.name: k for k, contact in enumerate(graph.contacts)}
    holds = []
    for step, angle in zip(plan.steps[:-1], plan.orientations[1:-1], strict=True):
        names = tuple(sorted(set(step.grasp.names) - set(step.idle_at_end)))
        if len(names) == 2:
            holds.append((names, angle))
    unknown = [name for names, _ in holds for name in names if name not in numbers]
    if unknown or not holds:
        raise InvalidInput(
            f"the plan's contacts must be those of the graph, got {shown(unknown or 'no holds')}"
        )
    candidates = candidates_of(graph)

    def margins(names: tuple[str, ...], angles: Array) -> Array:
        i, j = (np.full(angles.size, numbers[name]) for name in names)
        found = candidates.margins((i, j), np.radians(angles))
        return np.degrees(np.where(found >= 0, found, np.nan))

    at = np.degrees([angle for _, angle in holds])
    angles = np.linspace(at.min() - _BEYOND, at.max() + _BEYOND, _ANGLES)
    ax = axes_or_new(ax, height=2.6)
    for k, names in enumerate(dict.fromkeys(names for names, _ in holds)):
        colour, line = PALETTE[k % len(PALETTE)], "-" if k < len(PALETTE) else "--"
        label = f"{names[0]} and {names[1]}"
        ax.plot(angles, margins(names, angles), line, color=colour, linewidth=1.4, label=label, gid="margin")
    points = [(a, float(margins(names, np.array([a]))[0])) for (names, _), a in zip(holds, at, strict=True)]
    ax.add_collection(LineCollection([points], colors=INK, linewidths=0.6, zorder=3))
    ax.plot(*zip(*points, strict=True), "o", color=INK, markersize=4, zorder=4, gid="holds")
    ax.axhline(np.degrees(plan.margin), color=INK, linewidth=0.8, linestyle="--", zorder=1)
    ax.set(xlim=(angles[0], angles[-1]))
    ax.set_ylim(bottom=0)
    ax.set_xlabel("object's angle [deg]", fontsize=TEXT)
    ax.set_ylabel("widest angle margin [deg]", fontsize=TEXT)
    legend(ax, None, ncols=2)
    return ax
