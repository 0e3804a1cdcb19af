"""The hold map: which two places on an outline, or contacts in space, hold the load, and how well."""

from math import degrees

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, instance
from regrasp.outline.outline import Outline
from regrasp.planning.holds.graphs import widest_of_pairs
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.triples import TripleGraph
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.look.style import INK, NO_HOLD, SMALL, TEXT, axes_or_new, label_axis, note, short
from regrasp.plots.look.units import SI, Units
from regrasp.plots.regrasps.path_on_map import PATH, draw_path, path_of, place_of

# A place stands for the boundary around it up to this many times half the usual spacing.
_SPREAD = 1.5


def plot_hold_map(
    graph: HoldGraph | TripleGraph,
    outline: Outline | None = None,
    o: int | None = None,
    ax: Axes | None = None,
    *,
    plan: RegraspPlan | None = None,
    units: Units = SI,
) -> Axes:
    """Margins of all two-finger holds: the place of one finger against that of the other along the outline.

    In space, of a ``TripleGraph``, one contact against another by their numbers, with the margin of the best
    hold of three fingers that has both.

    Args:
        graph: of a ``RegraspProblem``, or your own; in the plane its contacts lie on the outline.
        outline: the outline whose boundary the contacts lie on; None in space.
        o: the place of one orientation in ``graph.angles``, in space in ``graph.loads``; by default the best
            margin over all of them is shown. Grey: no hold; white: not sampled, as near corners.
        ax: the axes to draw on; new ones if not given.
        plan: its holds of two fingers, drawn as a path from the square to the disc. An exchange is a line
            along one axis: the other finger stays. It moves through the air, so what the line crosses means
            nothing. In space a hold of three fingers is three joined discs, one a pair, and a number aside.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    if plan is not None:
        instance(plan, "plan", RegraspPlan)
    if not isinstance(graph, (HoldGraph, TripleGraph)):
        raise InvalidInput(f"graph must be a HoldGraph or a TripleGraph, got {shown(graph)}")
    if o is not None and not -len(graph.loads) <= o < len(graph.loads):
        raise InvalidInput(f"o must be one of {len(graph.loads)} orientations, got {shown(o)}")
    if isinstance(graph, TripleGraph):
        if outline is not None:
            raise InvalidInput("in space a hold map needs no outline; leave it out")
        return _in_space(graph, None if o is None else o % len(graph.loads), ax, plan)
    if outline is None:
        raise InvalidInput("outline is missing; a hold map of the plane shows places along it")
    instance(outline, "outline", Outline)
    places = np.array([place_of(outline, contact) for contact in graph.contacts])
    edges, values = _cells(places, outline.length, widest_of_pairs(graph, o))
    ax = axes_or_new(ax, height=3.3, bar=True)
    _draw_margins(ax, edges, values)
    if plan is not None:
        draw_path(ax, path_of(plan, outline))
    ax.set(xlim=(0, outline.length), ylim=(0, outline.length))
    ax.set_aspect("equal", adjustable="box")
    label_axis(ax.xaxis, "one finger at arc length", units.length, outline.length)
    label_axis(ax.yaxis, "the other at", units.length, outline.length)
    count = len(graph.angles)
    title = (
        f"best of {count} orientations" if o is None else f"object at {short(degrees(graph.angles[o]))} deg"
    )
    ax.set_title(title, fontsize=TEXT, loc="left")
    return ax


def _draw_margins(ax: Axes, edges: Array, values: Array) -> None:
    """Cells of margins [rad], negative for no hold, NaN for not sampled, with a bar beside them."""
    none = np.where(values < 0, 0.0, np.nan)
    ax.pcolormesh(edges, edges, none, cmap=ListedColormap([NO_HOLD]), zorder=1, gid="no hold")
    held = np.degrees(np.where(values >= 0, values, np.nan))
    top = max(float(np.nanmax(np.degrees(values))), 0.0) or 1.0
    mesh = ax.pcolormesh(edges, edges, held, cmap="viridis", vmin=0, vmax=top, zorder=1, gid="margins")
    bar = ax.figure.colorbar(mesh, ax=ax, fraction=0.046, pad=0.03)
    bar.ax.tick_params(labelsize=SMALL, length=2.5, width=0.6)
    bar.outline.set_linewidth(0.6)
    bar.set_label("least angle margin [deg]", fontsize=TEXT)


def _in_space(graph: TripleGraph, o: int | None, ax: Axes | None, plan: RegraspPlan | None) -> Axes:
    """Contacts by their numbers; a plan's hold is the three cells of its pairs below the diagonal, joined."""
    count, ways = len(graph.contacts), len(graph.loads)
    ax = axes_or_new(ax, height=3.3, bar=True)
    _draw_margins(ax, 0.5 + np.arange(count + 1.0), widest_of_pairs(graph, o))
    numbers = {contact.name: k for k, contact in enumerate(graph.contacts, 1)}
    seen: dict[tuple[float, float], list[str]] = {}
    for k, names in enumerate(_held(plan) if plan else (), 1):
        if not set(names) <= set(numbers):
            raise InvalidInput(f"the plan's contacts {shown(names)} are not those of the graph")
        i, j, m = sorted(numbers[name] for name in names)
        seen.setdefault((m, i), []).append(str(k))
        x, y = (j, m, m), (i, i, j)
        ax.plot(x, y, "o-", color=PATH, markersize=4, linewidth=0.8, zorder=5, gid=f"hold {k}")
    for k, (cell, words) in enumerate(sorted(seen.items())):
        # Cells may be lower than a word, so that words above one another step aside.
        note(ax, ", ".join(words), cell, (1, 0), gap=4 + 8 * (k % 3), color=INK)
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlabel("one finger at contact", fontsize=TEXT)
    ax.set_ylabel("another at", fontsize=TEXT)
    title = f"best of {ways} load directions" if o is None else f"load direction {o + 1}"
    ax.set_title(f"{title}, best third finger", fontsize=TEXT, loc="left")
    return ax


def _held(plan: RegraspPlan) -> list[tuple[str, ...]]:
    """The contacts of every hold that leaves a finger free."""
    every = [tuple(n for n in step.grasp.names if n not in step.idle_at_end) for step in plan.steps[:-1]]
    return list(dict.fromkeys(names for names in every if len(names) == 3))


def _cells(places: Array, length: float, values: Array) -> tuple[Array, Array]:
    """Edges (k + 1,) and values (k, k) of cells around places: half way to the next, or not that far."""
    order = np.argsort(places)
    s = places[order]
    gaps = np.diff(s, append=s[0] + length)
    reach = np.minimum(gaps, _SPREAD * float(np.median(gaps))) / 2
    low, high = s - np.roll(reach, 1), s + reach
    edges, rows = [low[0]], []
    for k in range(len(s)):
        if low[k] - edges[-1] > 1e-9 * length:
            rows.append(-1)  # a gap
            edges.append(low[k])
        rows.append(int(order[k]))
        edges.append(high[k])
    index = np.array(rows)
    cells = np.where((index < 0)[:, None] | (index < 0), np.nan, values[np.ix_(index, index)])
    return np.array(edges), cells
