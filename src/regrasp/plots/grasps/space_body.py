"""The object in space: its mesh, contacts, normals, friction cones and centre of mass."""

from collections.abc import Collection
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.plots.look.solids import Triangles, cone, creases, face_normals
from regrasp.plots.look.space_axes import include
from regrasp.plots.look.style import GREY, INK, SMALL, Colours, literal
from regrasp.plots.look.view import projection

_LIGHT = np.array([0.35, -0.5, 0.79])  # from where the mesh is lit
_SURFACE = "#c9ced3"
RIM = withStroke(linewidth=1.5, foreground="white")


def draw_body_in_space(
    ax: Any,
    grasp: Grasp,
    colours: Colours,
    cone_length: float,
    size: float,
    *,
    mesh: Triangles | None,
    absent: Collection[str] = (),
    names: Collection[str] | None = None,
) -> None:
    """Mesh, normals and cones whose sides are ``cone_length`` [m] long, and the centre of mass.

    absent: names of contacts of which only an open grey circle is drawn. names: to write beside the contacts.
    """
    if mesh is not None:
        draw_mesh(ax, mesh)
    for contact, label in zip(grasp, grasp.names if names is None else names, strict=True):
        name, r, n = str(contact.name), contact.position, contact.normal
        shown, colour = literal(label), colours[name]
        if name in absent:
            shown, colour = f"({shown})", GREY
            dot(ax, r, gid=f"absent {name}", color="white", markeredgecolor=GREY, markersize=4.5)
        else:
            _draw_cone(ax, contact, cone_length, colour)
            dot(ax, r, gid=f"contact {name}", color=colour, markeredgecolor="white", markersize=4.5)
        write(ax, shown, r, -n, 0.03 * size, gid=f"name {name}", color=colour)
        include(ax, r - 0.1 * size * n)
    dot(ax, np.zeros(3), gid="centre of mass", color="white", markeredgecolor=INK, markersize=5)
    ax.plot(0, 0, 0, marker="+", color=INK, markersize=5, markeredgewidth=0.7, zorder=5)


def draw_mesh(ax: Any, mesh: Triangles, edges: Array | None = None) -> None:
    """The surface, translucent so that what happens behind and inside it is seen, and its sharp edges.

    edges: (k, 2, 3), found if not given.
    """
    vertices, faces = mesh
    light = 0.72 + 0.28 * abs(face_normals(mesh) @ _LIGHT)
    colours = np.column_stack([light[:, None] * to_rgb(_SURFACE), np.full(len(faces), 0.3)])
    surface = Poly3DCollection(vertices[faces], facecolors=colours, edgecolors="none", zorder=0)
    surface.set_gid("mesh")
    ax.add_collection3d(surface)
    draw_edges(ax, creases(mesh) if edges is None else edges, GREY, gid="edges")
    include(ax, vertices)


def draw_edges(ax: Any, edges: Array, colour: str, *, gid: str) -> None:
    """Thin segments (k, 2, 3), which a smooth surface may have none of."""
    if len(edges):
        lines = Line3DCollection(edges, colors=colour, linewidths=0.6, alpha=0.7, zorder=1)
        lines.set_gid(gid)
        ax.add_collection3d(lines)
        include(ax, edges)


def dot(ax: Any, at: Array, *, gid: str, zorder: float = 4, **look: Any) -> None:
    """A round mark at a point."""
    base: dict[str, Any] = {"marker": "o", "linestyle": "none", "markeredgewidth": 0.8}
    ax.plot(*at[:, None], gid=gid, zorder=zorder, **(base | look))


def write(ax: Any, text: str, at: Array, towards: Array, gap: float, *, gid: str, color: str = INK) -> None:
    """A short text with a white rim beside a point, ``gap`` [m] away from it in the picture.

    It stands where the direction ``towards`` points to as seen now, below if that points at the reader.
    """
    picture = projection(ax.elev, ax.azim)  # rows: right and up
    x, y = picture @ towards / (np.linalg.norm(towards) or 1.0)
    x, y = (0.0, -1.0) if np.hypot(x, y) < 0.1 else np.array([x, y]) / np.hypot(x, y)
    ax.text(
        *(at + gap * (np.array([x, y]) @ picture)),
        text,
        gid=gid,
        color=color,
        fontsize=SMALL,
        ha="left" if x > 0.4 else "right" if x < -0.4 else "center",
        va="bottom" if y > 0.4 else "top" if y < -0.4 else "center",
        zorder=8,
        path_effects=[RIM],
    )


def cone_surface(contact: Contact, length: float) -> Triangles:
    """The friction cone with sides of ``length`` [m]; a needle where there is no friction."""
    along, across = np.cos(contact.half_angle), np.sin(contact.half_angle)
    return cone(contact.position, contact.normal, length * along, length * across)


def _draw_cone(ax: Any, contact: Contact, length: float, colour: str) -> None:
    r, n = contact.position, contact.normal
    vertices, faces = cone_surface(contact, length)
    if contact.friction:
        side = Poly3DCollection(vertices[faces], facecolor=colour, edgecolor="none", alpha=0.16, zorder=2)
        side.set_gid(f"cone {contact.name}")
        ax.add_collection3d(side)
        rim = np.vstack([vertices[1:], vertices[1]])
        ax.plot(*rim.T, color=colour, linewidth=0.6, alpha=0.7, zorder=2)
    include(ax, vertices)
    ax.plot(*np.array([r, r + length * n]).T, color=GREY, linewidth=0.8, linestyle=":", zorder=2)
