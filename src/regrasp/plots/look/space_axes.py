"""Axes for pictures in space, with one scale along x, y and z."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import ArrayLike
from regrasp.plots.look.style import SMALL, label_axis, new_figure
from regrasp.plots.look.units import Units
from regrasp.plots.look.view import projection

# The largest extent of the box in the picture, as a fraction of the axes, with room for numbers and labels.
_FILL = 0.84
# The least side of the box beside its longest, so that a flat grasp is not drawn on a sheet.
_THINNEST = 0.25

# No tick nearer than this to an end of its axis, as a fraction of it.
_CORNER = 0.07


class _ClearOfCorners(MaxNLocator):
    """Ticks that keep away from the ends of their axis, where the numbers of two axes would run together."""

    def tick_values(self, vmin: float, vmax: float) -> Any:
        ticks = np.asarray(super().tick_values(vmin, vmax))
        room = _CORNER * (vmax - vmin)
        return ticks[(ticks >= vmin + room) & (ticks <= vmax - room)]


def space_axes(ax: Any, height: float = 3.4) -> Any:
    """The axes given, which must be 3-D, made to draw in our order; or new ones in a figure of their own."""
    if ax is None:
        figure = new_figure(height=height)
        figure.set_layout_engine("none")  # it reserves room for the whole box around a 3-D picture
        return space_panel(figure, (0.0, 0.04, 0.93, 0.86))
    in_space(ax).computed_zorder = False  # else the object, which is translucent, hides the arrows inside it
    return ax


def space_panel(figure: Figure, place: tuple[float, float, float, float]) -> Any:
    """New 3-D axes at a place of the figure: left, bottom, width and height, as fractions."""
    ax = boxed(figure.add_axes(place, projection="3d", computed_zorder=False))
    ax.set_proj_type("ortho")  # parallel arrows of equal length look it, near or far
    return ax


def in_space(ax: Any) -> Any:
    """The axes given; raises ``InvalidInput`` unless they are 3-D."""
    if getattr(ax, "name", None) != "3d":
        raise InvalidInput("ax must be 3-D for a grasp in space: figure.add_subplot(projection='3d')")
    return ax


def boxed(ax: Any) -> Any:
    """3-D axes with our font sizes, a faint grid and no walls."""
    ax.tick_params(labelsize=SMALL, pad=-3)
    ax.tick_params(axis="z", pad=0)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.pane.fill = False
        axis.pane.set_edgecolor("#dddddd")
        axis._axinfo["grid"].update(color="#e6e6e6", linewidth=0.5)
        axis.set_major_locator(_ClearOfCorners(4, steps=[1, 2, 5, 10]))
    return ax


def include(ax: Any, points: ArrayLike) -> None:
    """Make room for points (m, 3)."""
    ax.auto_scale_xyz(*np.asarray(points, dtype=float).reshape(-1, 3).T, ax.has_data())


def equal_scale(ax: Any, units: Units) -> Any:
    """Limits around everything drawn at one scale on all axes, and labels with units."""
    axes = (ax.xaxis, ax.yaxis, ax.zaxis)
    low, high = np.array([axis.get_data_interval() for axis in axes]).T
    longest = float((high - low).max()) or 1.0
    middle, spans = (low + high) / 2, np.maximum(high - low, _THINNEST * longest)
    for axis, name in enumerate("xyz"):
        getattr(ax, f"set_{name}lim")(*(middle[axis] + spans[axis] * np.array([-0.5, 0.5])))
    box = spans / np.linalg.norm(spans)
    seen = abs(projection(ax.elev, ax.azim)) @ box  # width and height
    ax.set_box_aspect(box, zoom=_FILL / float(seen.max()))
    for axis, name in zip(axes, "xyz", strict=True):
        label_axis(axis, f"${name}$", units.length, longest)
        axis.labelpad = -4 if axis is ax.zaxis else -6
    return ax
