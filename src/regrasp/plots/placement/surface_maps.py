"""The best value through each point of a mesh, in colour."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from regrasp.mechanics.checks import Array, instance
from regrasp.planning.placement.space.surface_map import SurfaceMap
from regrasp.plots.grasps.space_body import draw_edges
from regrasp.plots.look.solids import creases, face_normals
from regrasp.plots.look.space_axes import equal_scale, include, space_axes
from regrasp.plots.look.style import GREY, NO_HOLD, legend
from regrasp.plots.look.units import SI, Units
from regrasp.plots.look.view import sight
from regrasp.plots.placement.values import as_drawn, colour_bar, scale_of

_PIECES = 10_000
_BEST = 8  # points, which new axes look at from above or below
_RAISED, _TURNED = 25.0, -55.0  # [deg]
_SHORT = 0.7  # of the longest side
_FACING = 2.0  # what a normal's difference counts, where the mesh's reach is 1


def plot_surface_map(surface: SurfaceMap, ax: Any = None, *, units: Units = SI) -> Any:
    """The mesh, each piece in the colour of the nearest point's best value; grey where no grasp holds.

    Args:
        surface: what ``regrasp.surface_map`` found.
        ax: the 3-D axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(surface, "surface", SurfaceMap)
    new, ax = ax is None, space_axes(ax, height=3.8)
    if new:
        ax.set_position((0.02, 0.04, 0.72, 0.9))
        looked_at = surface.normals[np.argsort(surface.best)[:_BEST]].mean(axis=0)
        ax.view_init(-_RAISED if looked_at[2] > 0 else _RAISED, _TURNED)
    mesh = surface.shape.surface()
    pieces, normals = _pieces(*mesh)
    towards = sight(ax.elev, ax.azim)
    seen = normals @ towards <= 0  # inward normals: those of faces that look at the reader
    reach = float(np.linalg.norm(mesh[0], axis=1).max())
    away = np.linalg.norm((pieces.mean(axis=1)[:, None] - surface.points) / reach, axis=2)
    away += _FACING * np.linalg.norm(normals[:, None] - surface.normals, axis=2)
    values = as_drawn(surface.objective, surface.best)
    scale = scale_of(surface.objective, values, more=False)
    values, drawn_as = values[away.argmin(axis=1)], ScalarMappable(scale.norm, scale.cmap)
    colours = drawn_as.to_rgba(np.nan_to_num(values))
    colours[np.isnan(values)] = to_rgba(NO_HOLD)
    drawn = Poly3DCollection(
        pieces[seen], facecolors=colours[seen], edgecolors=colours[seen], linewidths=0.3, zorder=1
    )
    drawn.set_gid("values")
    ax.add_collection3d(drawn)
    draw_edges(ax, creases((mesh[0], mesh[1][face_normals(mesh) @ towards >= 0])), GREY, gid="edges")
    include(ax, mesh[0])
    beside = ax.figure.add_axes((0.85, 0.25, 0.03, 0.5)) if new else None
    colour_bar(drawn_as, scale, surface.objective, units, ax=ax, cax=beside, shrink=0.6, pad=0.16)
    keys = scale.key()
    if np.isnan(values).any():
        keys.append(Line2D([], [], color=NO_HOLD, linewidth=5, label="no hold through here"))
    if keys:
        legend(ax, keys, bbox_to_anchor=(0, 1.12))
    equal_scale(ax, units)
    spans = [np.ptp(limits) for limits in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())]
    for axis, span in zip((ax.xaxis, ax.yaxis, ax.zaxis), spans, strict=True):
        if span < _SHORT * max(spans):  # where numbers would run together
            axis.get_major_locator().set_params(nbins=2)
    return ax


def _pieces(vertices: Array, faces: Any) -> tuple[Array, Array]:
    """(p, 3, 3) triangles, each face halved across its longest side until it is small, and inward normals."""
    normals = -face_normals((vertices, faces))
    waiting = list(zip(vertices[faces], range(len(faces)), strict=True))
    areas = np.linalg.norm(
        np.cross(
            vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]]
        ),
        axis=1,
    )
    least, done = float(areas.sum()) / _PIECES, []
    while waiting:
        triangle, on = waiting.pop()
        if np.linalg.norm(np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])) <= least:
            done.append((triangle, on))
            continue
        sides = np.linalg.norm(triangle - np.roll(triangle, -1, axis=0), axis=1)
        a, b, c = np.roll(triangle, -int(sides.argmax()), axis=0)
        middle = (a + b) / 2
        waiting += [(np.array([a, middle, c]), on), (np.array([middle, b, c]), on)]
    return np.array([t for t, _ in done]), normals[[on for _, on in done]]
