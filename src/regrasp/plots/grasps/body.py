"""The object in the plane: its surface at the contacts, normals, friction cones and centre of mass."""

from collections.abc import Collection
from math import atan2, degrees, hypot

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch, Polygon, Wedge
from matplotlib.path import Path

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.outline.outline import Outline
from regrasp.plots.look.style import GREY, INK, PALE, Colours, literal, note

_DETAIL = 2e-4  # of the object's size: chords of a smooth outline stay this near


def extent(grasp: Grasp, vertices: Array | None = None) -> float:
    """The largest side of the box around the contacts, the centre of mass and ``vertices`` (v, d) [m].

    1 if that is a point.
    """
    others = np.zeros((1, grasp.dimension)) if vertices is None else vertices
    points = np.vstack([grasp.positions, np.zeros(grasp.dimension), others])
    return float(np.ptp(points, axis=0).max()) or 1.0


def breadth(grasp: Grasp, vertices: Array | None = None) -> float:
    """How long an arrow may be to stay in proportion to the object [m].

    Its second largest side along its principal axes where ``vertices`` (v, d) are known, of a slender part
    its width. Else its extent.
    """
    size = extent(grasp, vertices)
    if vertices is None:
        return size
    across = vertices - vertices.mean(axis=0)
    axes = np.linalg.svd(across.T @ across)[0]
    # Principal axes of a square section are any; those of the frame then are as good.
    width = min(float(np.sort(np.ptp(points, axis=0))[-2]) for points in (across, across @ axes))
    return min(size, width or size)


def draw_body(
    ax: Axes,
    grasp: Grasp,
    colours: Colours,
    cone_length: float,
    absent: Collection[str] = (),
    named: bool = True,
    outline: Outline | None = None,
) -> None:
    """Surface, normals and cones of length ``cone_length`` [m] at the contacts, and the centre of mass.

    absent: names of contacts of which only the surface and an open grey circle are drawn.
    named: write the names beside the contacts.
    outline: drawn in the place of the tangents.
    """
    size = extent(grasp, vertices_of(outline))
    surface = _surface(grasp, 0.09 * size)
    if outline is not None:
        _draw_outline(ax, outline, size)
        surface = surface[:0]
    elif _convex(surface.reshape(-1, 2)):
        ax.add_patch(Polygon(surface.reshape(-1, 2), facecolor=PALE, edgecolor="none", zorder=0, gid="body"))
    if surface.size:
        ax.update_datalim(surface.reshape(-1, 2))
    for ends in surface:
        ax.plot(*ends.T, color=INK, linewidth=1.2, solid_capstyle="butt", zorder=2)
    for name, contact in zip(grasp.names, grasp, strict=True):
        r, n = contact.position, contact.normal
        label, colour = literal(name), colours[name]
        ax.update_datalim([r + cone_length * n])
        if name in absent:
            ax.plot(
                *r, "o", color="white", markeredgecolor=GREY, markersize=4.5, zorder=4, gid=f"absent {name}"
            )
            label, colour = f"({label})", GREY
        else:
            _cone(ax, contact, cone_length, colour, gid=f"cone {name}")
            ax.plot(*r, "o", color=colour, markersize=3.5, zorder=4)
        if named:
            label_contact(ax, label, r, -n, size, color=colour)
    ax.plot(0, 0, marker="o", color="white", markeredgecolor=INK, markersize=5, zorder=4)
    ax.plot(0, 0, marker="+", color=INK, markersize=5, markeredgewidth=0.7, zorder=5)


def label_contact(
    ax: Axes, label: str, at: Array, towards: Array, size: float, *, gap: float = 4.0, color: str
) -> None:
    """A short text beside a contact, with room for it; ``size`` is the extent of the grasp [m]."""
    note(ax, label, at, towards, gap=gap, color=color)
    room = np.array([0.06 + 0.033 * max(map(len, label.split("\n"))), 0.12]) * size
    ax.update_datalim([at + room * towards / hypot(*towards)])


def vertices_of(outline: Outline | None) -> Array | None:
    """(v, 2) of an outline, relative to the centre of mass [m]; None without one."""
    return None if outline is None else outline.polygon()


def _draw_outline(ax: Axes, outline: Outline, size: float) -> None:
    """The material with its holes."""
    rings = (outline.polygon(_DETAIL * size), *(h[::-1] for h in outline.hole_polygons(_DETAIL * size)))
    paths = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in rings]
    material = PathPatch(Path.make_compound_path(*paths), zorder=0, gid="body")
    material.set(facecolor=PALE, edgecolor=INK, linewidth=0.9)
    ax.add_patch(material)
    ax.update_datalim(rings[0])


def _cone(ax: Axes, contact: Contact, length: float, colour: str, gid: str) -> None:
    r, n = contact.position, contact.normal
    middle, half = degrees(atan2(n[1], n[0])), degrees(contact.half_angle)
    cone = Wedge(tuple(r), length, middle - half, middle + half, zorder=1, gid=gid)
    cone.set(facecolor=colour, edgecolor=colour, alpha=0.2, linewidth=0.6)
    ax.add_patch(cone)
    ax.plot(*np.array([r, r + length * n]).T, color=GREY, linewidth=0.8, linestyle=":", zorder=2)


def _surface(grasp: Grasp, half: float) -> Array:
    """(n, 2, 2): a short piece of the tangent at each contact, counter-clockwise around the contacts."""
    middle = grasp.positions.mean(axis=0)
    x, y = (grasp.positions - middle).T
    order = np.argsort(np.arctan2(y, x))
    r, n = grasp.positions[order], grasp.normals[order]
    tangent = np.column_stack([n[:, 1], -n[:, 0]])  # the object lies on its left
    return np.stack([r - half * tangent, r + half * tangent], axis=1)


def _convex(corners: Array) -> bool:
    """Whether a polygon turns left at every corner, so that joining the tangents suggests a true body."""
    sides = np.roll(corners, -1, axis=0) - corners
    following = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    return bool((turns > 0).all())
