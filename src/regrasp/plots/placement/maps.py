"""Maps of placement: values over the places of two fingers, and on the outline itself."""

from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, Flags, instance
from regrasp.planning.placement.maps.placed_values import PlacementMap
from regrasp.planning.placement.maps.rings import Rings
from regrasp.planning.placement.regions.contact_arcs import ContactRegions
from regrasp.plots.grasps.outline import plot_outline
from regrasp.plots.look.style import INK, NO_HOLD, NOT_ALLOWED, axes_or_new, label_axis, legend
from regrasp.plots.look.units import SI, Units
from regrasp.plots.placement.values import as_drawn, colour_bar, scale_of


def plot_placement_map(
    placements: PlacementMap,
    ax: Axes | None = None,
    *,
    regions: ContactRegions | None = None,
    units: Units = SI,
) -> Axes:
    """The value of two fingers over both arc lengths; grey where they do not hold, a ring at the best.

    Darker grey is where constraints let them not be. Forces grow without end: of more than some times the
    best all have one colour, as the legend says. Places in holes come after those on the outline, beyond a
    white line.

    Args:
        placements: what ``regrasp.placement_map`` found for two fingers that move.
        ax: the axes to draw on; new ones if not given.
        regions: of two fingers on the same outline: a box in which all placements hold, and how far one
            finger alone may be off, as lines through the grasp.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(placements, "placements", PlacementMap)
    if placements.values.ndim != 2:
        raise InvalidInput("expected the map of two fingers; plot_placement_outline draws that of one")
    if regions is not None:
        instance(regions, "regions", ContactRegions)
        in_holes = regions.spans is None and (regions.places >= regions.shape.length).any()
        others = len(regions.places) != 2 or bool(placements.fixed.size)
        if in_holes or others or regions.shape != placements.shape:
            raise InvalidInput(
                "regions must be those of two fingers on the outline of the map, which are all"
            )
    length, values = placements.rings.length, as_drawn(placements.objective, placements.values)
    ax = axes_or_new(ax, height=3.3, bar=True)
    edges = _edges(placements.places, length)
    forbidden = _forbidden(placements.allowed)
    for cells, colour, gid in (
        (np.isnan(values) & ~forbidden, NO_HOLD, "no hold"),
        (forbidden, NOT_ALLOWED, "not allowed"),
    ):
        none = np.where(cells, 0.0, np.nan)
        ax.pcolormesh(edges, edges, none, cmap=ListedColormap([colour]), zorder=1, gid=gid)
    for start in placements.rings.starts[1:-1]:
        for line in (ax.axhline, ax.axvline):
            line(start, color="white", linewidth=1.0, zorder=2, gid="hole")
    scale = scale_of(placements.objective, values, placements.more)
    drawn = ax.pcolormesh(edges, edges, values, cmap=scale.cmap, norm=scale.norm, zorder=1, gid="values")
    colour_bar(drawn, scale, placements.objective, units, ax=ax, fraction=0.046, pad=0.03)
    handles = [_key(NO_HOLD, f"no hold: {1 - placements.share:.0%}")]
    if forbidden.any():
        handles.append(_key(NOT_ALLOWED, "not allowed"))
    handles += scale.key()
    if regions is not None:
        handles += _draw_regions(ax, regions)
    if placements.at.size:
        best = np.array([placements.at, placements.at[::-1]]).T
        ax.plot(*best, "o", mfc="none", mec="white", ms=8, mew=2.6, zorder=5)
        ax.plot(*best, "o", mfc="none", mec=INK, ms=8, mew=1.2, zorder=6, gid="best")
    ax.set(xlim=(0, length), ylim=(0, length))
    ax.set_aspect("equal", adjustable="box")
    label_axis(ax.xaxis, "one finger at arc length", units.length, length)
    label_axis(ax.yaxis, "the other at", units.length, length)
    legend(ax, handles, ncols=2)
    return ax


def _draw_regions(ax: Axes, regions: ContactRegions) -> list[Line2D]:
    """Boxes and lines, for either finger on either axis, also where arcs run past the first vertex."""
    length, at = regions.shape.length, np.stack([regions.places, regions.places], axis=1)
    alone = at + regions.alone * [-1, 1]
    for turns in product((-length, 0.0, length), repeat=2):
        for i, j in ((0, 1), (1, 0)):
            for x, y, gid in (
                (regions.arcs[i], regions.arcs[j], "region"),
                (alone[i], at[j], "alone"),
                (at[i], alone[j], "alone"),
            ):
                low, high = np.array([x + turns[0], y + turns[1]]).T
                if (high <= 0).any() or (low >= length).any():
                    continue
                for colour, width in (("white", 2.6), (INK, 1.2)):
                    box = Rectangle(low, *(high - low), fill=False, ec=colour, lw=width)
                    box.set(zorder=3 if gid == "region" else 2, gid=gid if colour == INK else None)
                    ax.add_patch(box)
    keys = (("s", "both within"), ("+", "one alone"))
    look = {"linestyle": "none", "mfc": "none", "mec": INK, "ms": 7, "mew": 1.2}
    return [Line2D([], [], marker=marker, label=words, **look) for marker, words in keys]  # type: ignore[arg-type]


def plot_placement_outline(placements: PlacementMap, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """The best value that is reached with a finger at each place, in colour along the outline.

    Grey is where none holds, darker grey where constraints let no finger be.

    Args:
        placements: what ``regrasp.placement_map`` found.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(placements, "placements", PlacementMap)
    shape, best = placements.shape, as_drawn(placements.objective, placements.best)
    width, height = np.ptp(shape.polygon(), axis=0)
    ax = axes_or_new(ax, height=float(np.clip(0.9 + 2.2 * height / width, 1.9, 4.4)), bar=True)
    ax = plot_outline(shape, ax, units=units)
    rings = placements.rings
    back, ahead = _reach(placements.places, rings.length)
    strokes = rings.points(placements.places, np.linspace(-back, ahead, 9, axis=1))
    held = ~np.isnan(best)
    allowed = placements.allowed.reshape(len(held), -1).any(axis=1)
    look = {"linewidths": 5, "capstyle": "butt"}
    for these, colour, gid in (
        (allowed & ~held, NO_HOLD, "no hold"),
        (~allowed, NOT_ALLOWED, "not allowed"),
    ):
        ax.add_collection(LineCollection(list(strokes[these]), colors=colour, zorder=2, gid=gid, **look))
    scale = scale_of(placements.objective, best, placements.more)
    drawn = LineCollection(
        list(strokes[held]), array=best[held], zorder=3, gid="best", cmap=scale.cmap, norm=scale.norm, **look
    )
    ax.add_collection(drawn)
    colour_bar(drawn, scale, placements.objective, units, ax=ax, fraction=0.046, pad=0.03)
    handles = [_key(NO_HOLD, "no hold")]
    if not allowed.all():
        handles.append(_key(NOT_ALLOWED, "not allowed"))
    handles += scale.key()
    if placements.fixed.size:
        at = _at(rings, placements.fixed)
        ax.plot(*at.T, "o", color=INK, markersize=5, zorder=5, gid="fixed")
        handles.append(Line2D([], [], marker="o", linestyle="none", color=INK, markersize=5, label="stays"))
    if placements.at.size:
        ax.plot(*_at(rings, placements.at).T, "o", mfc="white", mec=INK, ms=7, mew=1.2, zorder=6, gid="at")
        ring = Line2D([], [], marker="o", linestyle="none", markersize=7, label="best")
        ring.set(markerfacecolor="white", markeredgecolor=INK)
        handles.append(ring)
    legend(ax, handles, ncols=3 if len(handles) < 4 else 2)
    return ax


def _forbidden(allowed: Flags) -> Flags:
    """(m, m) where constraints let two fingers not be; at one place, where they may not be beside it."""
    beside = np.roll(np.eye(len(allowed), dtype=bool), 1, axis=1)
    alone = (allowed & (beside | beside.T)).any(axis=1)
    result: Flags = ~allowed & ~np.diag(alone)
    return result


def _key(colour: str, words: str) -> Line2D:
    return Line2D([], [], color=colour, linewidth=5, label=words)


def _at(rings: Rings, places: Array) -> Array:
    """(m, 2) points at arc lengths."""
    return rings.points(places % rings.length, np.zeros((len(places), 1)))[:, 0]


def _reach(places: Array, length: float) -> tuple[Array, Array]:
    """How far the cells of places go back and ahead: half way to the next, or half of what is usual."""
    gaps = np.diff(places, append=places[0] + length)
    reach = np.minimum(gaps, 1.01 * float(np.median(gaps))) / 2
    return np.roll(reach, 1), reach


def _edges(places: Array, length: float) -> Array:
    """(m + 1,) edges of cells around places."""
    middles = 0.5 * (places[1:] + places[:-1])
    return np.concatenate([[max(1.5 * places[0] - 0.5 * places[1], 0.0)], middles, [length]])
