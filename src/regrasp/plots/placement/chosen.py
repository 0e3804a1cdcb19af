"""A chosen grasp on its outline, and regions around contacts."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from regrasp.mechanics.checks import Array, instance
from regrasp.mechanics.contact import Contact
from regrasp.outline.outline import Outline
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.planning.placement.regions.contact_arcs import ContactRegions
from regrasp.planning.placement.regions.face_patches import FaceRegions
from regrasp.plots.grasps.outline import plot_outline
from regrasp.plots.look.space_axes import equal_scale
from regrasp.plots.look.style import GREY, INK, contact_colours, legend, legend_in_columns, note, short
from regrasp.plots.look.units import SI, Units
from regrasp.plots.placement.on_meshes import draw_chosen, draw_regions
from regrasp.plots.placement.values import unit_of

_CONE = 0.16  # lengths, as fractions of the outline's size
_OTHERS = 0.04


def plot_chosen_grasp(chosen: ChosenGrasp, ax: Axes | None = None, *, units: Units = SI) -> Axes:
    """The shape, the fingers chosen with their friction cones, and grasps that were passed over in grey.

    Above stand the value and the bound that no placement is better than; arc lengths are marked outside.

    Args:
        chosen: what ``regrasp.choose_grasp`` found on an outline or a mesh.
        ax: the axes to draw on, 3-D for a mesh; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(chosen, "chosen", ChosenGrasp)
    if isinstance(chosen.shape, Outline):
        ax = _on_outline(plot_outline(chosen.shape, ax, units=units), chosen, chosen.shape)
    else:
        ax = equal_scale(draw_chosen(ax, chosen, chosen.shape), units)
    unit = units.of(unit_of(chosen.objective)).removeprefix("-")
    words = f"{chosen.objective} {short(chosen.value)}, bound {short(chosen.bound)} {unit}".strip()
    handles = [Line2D([], [], marker="o", linestyle="none", color=INK, markersize=4, label=words)]
    if chosen.others:
        passed = Line2D([], [], marker="o", linestyle="none", color="white", markersize=3.5, label="others")
        passed.set_markeredgecolor(GREY)
        handles.append(passed)
    legend_in_columns(ax, handles)
    return ax


def _on_outline(ax: Axes, chosen: ChosenGrasp, shape: Outline) -> Axes:
    size = float(np.ptp(shape.polygon(), axis=0).max())
    for other in chosen.others:
        ax.plot(
            *other.grasp.positions.T, "o", color="white", markeredgecolor=GREY, markersize=3.5, zorder=4,
            gid="other",
        )  # fmt: skip
    colours = contact_colours(chosen.grasp)
    for contact in chosen.grasp:
        _cone(ax, contact, _CONE * size, colours[contact.name or ""])
    return ax


def plot_contact_regions(
    regions: ContactRegions | FaceRegions, ax: Axes | None = None, *, units: Units = SI
) -> Axes:
    """The outline with the arc of each finger in which it may be while the others are in theirs.

    Widths are in the legend; broad and pale is where one finger alone may be, the others at their places.
    On a mesh, the polygons on its faces.

    Args:
        regions: what ``regrasp.contact_regions`` found.
        ax: the axes to draw on, 3-D for a mesh; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    if isinstance(regions, FaceRegions):
        ax = equal_scale(draw_regions(ax, regions), units)
        _say_widths(ax, regions, units)
        return ax
    instance(regions, "regions", ContactRegions)
    ax = plot_outline(regions.shape, ax, units=units)
    size = float(np.ptp(regions.shape.polygon(), axis=0).max())
    colours = contact_colours(regions.grasp)
    handles: list[Line2D] = []
    for contact, (lo, hi), width, place, (back, ahead) in zip(
        regions.grasp, regions.arcs, regions.widths, regions.places, regions.alone, strict=True
    ):
        colour, name = colours[contact.name or ""], contact.name or ""
        _cone(ax, contact, 0.6 * _CONE * size, colour)
        narrow = 3 + 0.9 * max(1 - width / regions.shape.length, 0.0)  # arcs that share an edge are all seen
        below = sum(
            other[0] < hi and lo < other[1] and (wide, -number) > (width, -len(handles))
            for number, (other, wide) in enumerate(zip(regions.arcs, regions.widths, strict=True))
        )
        for start, end, points, alpha, above, gid in (
            (place - back, place + ahead, 7, 0.3, 2.9, "alone"),
            (lo, hi, 4 * 0.55**below, 0.85, narrow, "region"),
        ):
            arc = _arc(regions, contact, np.array([start, end]) - place, place)
            look = Line2D(
                *arc.T, color=colour, linewidth=points, solid_capstyle="butt", alpha=alpha, zorder=above
            )
            look.set_gid(gid)
            ax.add_line(look)
        words = f"{name} {short(float(f'{width:.3g}'))} {units.length}"
        handles.append(_bar(colour, words))
    half = f"{short(float(f'{regions.half_width:.3g}'))} {units.length}"
    ended = ", or to its side's end" if regions.ended.any() else ""
    handles += [
        *([_bar(GREY, f"all off by {half} at once{ended}")] if regions.half_width else []),
        _bar(GREY, "one finger alone", linewidth=7, alpha=0.3),
    ]
    legend_in_columns(ax, handles)
    return ax


def _arc(regions: ContactRegions, contact: Contact, off: Array, place: float) -> Array:
    """(n, 2) points from one way off a contact to another, along its straight side or its curve."""
    if regions.spans is not None:
        return regions.shape.points(place + np.linspace(off[0], off[1], 60))
    ahead = np.array([contact.normal[1], -contact.normal[0]])
    result: Array = contact.position + off[:, None] * ahead
    return result


def _bar(colour: str, words: str, linewidth: float = 4, alpha: float = 1.0) -> Line2D:
    """A sample for the legend that ends before its words begin."""
    return Line2D([], [], color=colour, label=words, linewidth=linewidth, alpha=alpha, solid_capstyle="butt")


def _say_widths(ax: Axes, regions: FaceRegions, units: Units) -> None:
    """In the legend, how far each finger may be off, and while the others are not, and all at once."""
    radii, alone = (
        [short(float(f"{r:.2g}")) for r in each] for each in ([*regions.reach, regions.radius], regions.alone)
    )
    words = [
        f"{name} {radius}, alone {one} {units.length}"
        for name, radius, one in zip(regions.grasp.names, radii, alone, strict=False)
    ]
    ended = ", or to its face's end" if regions.ended.any() else ""
    words.append(f"all off by {radii[-1]} {units.length} at once{ended}")
    colours = [*contact_colours(regions.grasp).values(), GREY]
    legend(ax, list(map(_bar, colours, words)), ncols=1)  # two are wider than a column


def _cone(ax: Axes, contact: Contact, length: float, colour: str) -> None:
    n: Array = contact.normal
    t = np.array([-n[1], n[0]])
    edges = [n - contact.friction * t, n + contact.friction * t]
    corners = [contact.position, *(contact.position + length * e / np.hypot(*e) for e in edges)]
    ax.add_patch(
        Polygon(corners, facecolor=colour, alpha=0.25, edgecolor=colour, linewidth=0.8, zorder=3, gid="cone")
    )
    ax.plot(*contact.position, "o", color=colour, markersize=4, zorder=5, gid="contact")
    note(ax, contact.name or "", contact.position + length * n, n, gap=2.0, color=colour)
