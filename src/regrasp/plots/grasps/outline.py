"""The outline of an object, its arc length and candidate contacts."""

from math import floor

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from regrasp.mechanics.checks import Array, ArrayLike, instance
from regrasp.outline.outline import Outline
from regrasp.plots.look.style import (
    GREY,
    INK,
    PALE,
    PALETTE,
    axes_or_new,
    label_axis,
    note,
    round_below,
    short,
)
from regrasp.plots.look.units import SI, Units

_TICKS = 12  # at most
_TICK, _NORMAL = 0.02, 0.06  # lengths, as fractions of the outline's size
_DETAIL = 2e-4
_BESIDE = 1e-6  # of the length, from a mark


def plot_outline(
    outline: Outline,
    ax: Axes | None = None,
    *,
    arc_lengths: ArrayLike | None = None,
    units: Units = SI,
) -> Axes:
    """The material, its holes, its centre of mass at the origin, and the arc length in round steps outside.

    Args:
        outline: the shape to draw.
        ax: the axes to draw on; new ones if not given.
        arc_lengths: (m,) of candidate contacts [m], drawn as dots with their inward normals.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(outline, "outline", Outline)
    outer = outline.polygon()
    size = float(np.ptp(outer, axis=0).max())
    outer, holes = outline.polygon(_DETAIL * size), outline.hole_polygons(_DETAIL * size)
    width, height = np.ptp(outer, axis=0)
    ax = axes_or_new(ax, height=float(np.clip(0.9 + 2.5 * height / width, 1.9, 4.4)))
    material = PathPatch(Path.make_compound_path(*map(_ring, (outer, *(hole[::-1] for hole in holes)))))
    material.set(facecolor=PALE, edgecolor=INK, linewidth=1.0, gid="material", zorder=1)
    ax.add_patch(material)
    _ticks(ax, outline, size)
    if arc_lengths is not None:
        _candidates(ax, outline, np.atleast_1d(np.asarray(arc_lengths, dtype=float)), _NORMAL * size)
    ax.plot(
        0, 0, marker="o", color="white", markeredgecolor=INK, markersize=5, zorder=4, gid="centre of mass"
    )
    ax.plot(0, 0, marker="+", color=INK, markersize=5, markeredgewidth=0.7, zorder=5)
    ax.set_aspect("equal", adjustable="datalim")
    room = np.array([0.14, 0.1]) * size  # for the numbers outside
    ax.update_datalim([outer.min(axis=0) - room, outer.max(axis=0) + room])
    ax.margins(0)
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    label_axis(ax.xaxis, "$x$", units.length, size)
    label_axis(ax.yaxis, "$y$", units.length, size)
    return ax


def _ring(polygon: Array) -> Path:
    return Path(np.vstack([polygon, polygon[:1]]), closed=True)


def _ticks(ax: Axes, outline: Outline, size: float) -> None:
    """Marks outside the boundary at round arc lengths, numbers beside them."""
    step = round_below(2 * outline.length / _TICKS)
    s = step * np.arange(floor(outline.length / step * (1 - 0.3 / _TICKS)) + 1)
    # at a corner along its bisector: beside a concave one the normal of either side is the other side
    off = _BESIDE * outline.length
    normals = outline.normals((s - off) % outline.length) + outline.normals(s + off)
    for at, r, n in zip(s, outline.points(s), normals / np.hypot(*normals.T)[:, None], strict=True):
        ax.plot(*np.array([r, r - _TICK * size * n]).T, color=GREY, linewidth=0.8, zorder=2, gid="tick")
        note(ax, f"{short(float(at))}", r - _TICK * size * n, -n, gap=1.5, color=GREY)


def _candidates(ax: Axes, outline: Outline, s: Array, length: float) -> None:
    r, n = outline.points(s), outline.normals(s)
    ax.quiver(
        *r.T, *(length * n).T, angles="xy", scale_units="xy", scale=1, color=PALETTE[0],
        width=0.005, headwidth=3.5, headlength=4, zorder=3, gid="normals",
    )  # fmt: skip
    ax.plot(*r.T, "o", color=PALETTE[0], markersize=2.5, linestyle="none", zorder=4, gid="candidates")
