"""The exact map of holds of two fingers anywhere on an outline, with a walk on it."""

from typing import cast

from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from regrasp.mechanics.checks import instance
from regrasp.planning.anywhere.results import OutlineRegrasps
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.look.png import png
from regrasp.plots.look.style import GREY, INK, PALETTE, TEXT, axes_or_new, label_axis, legend
from regrasp.plots.look.units import SI, Units
from regrasp.plots.regrasps.path_on_map import PATH, by_fingers, draw_path, path_of

_MOST_NAMED = 3
_COLOURS = (PALETTE[0], *PALETTE[2:])


def plot_outline_map(
    found: OutlineRegrasps,
    ax: Axes | None = None,
    *,
    plan: RegraspPlan | None = None,
    units: Units = SI,
) -> Axes:
    """All holds of two fingers: the arc length of the one against that of the other, in exact polygons.

    Polygons of one colour are one component: regrasps lead from each to all others of it. The walk, if there
    is one, or the holds of a plan go from the square to the disc, along one axis where one finger moves; that
    moves through the air, so what the line crosses means nothing. Thin lines are corners of the outline.

    Args:
        found: what ``regrasp.regrasps_on_outline`` found.
        ax: the axes to draw on; new ones if not given.
        plan: a regrasp on this outline whose holds are drawn in the place of the walk, such as
            ``found.plan()``.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(found, "found", OutlineRegrasps)
    if plan is not None:
        instance(plan, "plan", RegraspPlan)
    ax = axes_or_new(ax, height=3.75)
    length = found.outline.length
    for corner in found.outline.boundary.corners:
        for line in (ax.axhline, ax.axvline):
            line(float(corner), color=GREY, linewidth=0.3, alpha=0.6, zorder=0)
    sizes = [found.components.count(k) for k in range(len(set(found.components)))]
    order = sorted(range(len(sizes)), key=lambda k: -sizes[k])
    handles = []
    for rank, component in enumerate(order):
        colour = _COLOURS[min(rank, _MOST_NAMED) % len(_COLOURS)]
        own = [p for p, c in zip(found.regions, found.components, strict=True) if c == component]
        shown = PolyCollection([*own, *(p[:, ::-1] for p in own)], facecolor=colour, edgecolor=colour)
        shown.set(alpha=0.75, linewidth=0.5, zorder=1, gid="holds")
        ax.add_collection(shown)
        if rank < _MOST_NAMED:
            handles.append(_key(colour, f"component {component}"))
    if len(order) > _MOST_NAMED:
        handles.append(_key(_COLOURS[_MOST_NAMED % len(_COLOURS)], "others, each by itself"))
    path = by_fingers(found.walk) if plan is None else path_of(plan, found.outline)
    if len(path):
        draw_path(ax, path)
        label = f"a walk of {len(path)} holds" if plan is None else f"a plan of {len(path)} holds"
        handles.append(Line2D([], [], color=PATH, label=label))
    ax.set(xlim=(0, length), ylim=(0, length))
    ax.set_aspect("equal", adjustable="box")
    label_axis(ax.xaxis, "one finger at arc length", units.length, length)
    label_axis(ax.yaxis, "the other at", units.length, length)
    words = {True: "a regrasp exists", False: "no regrasp exists", None: "open"}[found.exists]
    ax.set_title(words, fontsize=TEXT, loc="left", color=INK, pad=18)
    if handles:
        legend(ax, handles)
    return ax


def _key(colour: str, label: str) -> Line2D:
    return Line2D([], [], color=colour, alpha=0.75, linewidth=5, label=label)


def outline_map_png(found: OutlineRegrasps) -> bytes:
    """``plot_outline_map`` as a PNG image.

    Args:
        found: what ``regrasp.regrasps_on_outline`` found.
    """
    return png(cast(Figure, plot_outline_map(found).figure))
