"""The sets of Section III in wrench space (Fig. 3-5): planes, cones and the equilibrium locus.

Forces and torques have different units, so each axis has a scale of its own. Every function adds to the
axes it is given, so that a figure is built step by step.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array, instance
from regrasp.mechanics.wrench_space import WrenchCone, WrenchPlane
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.plots.look.space_axes import boxed
from regrasp.plots.look.style import GREY, INK, PALETTE, SMALL, label_axis, new_figure
from regrasp.plots.look.units import SI, Units
from regrasp.plots.look.view import best_view
from regrasp.plots.wrench_space.locus import shown_interval


def wrench_axes(ax: Any, shapes: Sequence[Array] = ()) -> Any:
    """The 3-D axes given as they are; or new ones, seen from where polygons ``shapes`` (k, 3) lie open."""
    if ax is None:
        figure = new_figure(height=3.1)
        figure.set_layout_engine("none")  # it reserves room for the whole box around a 3-D picture
        ax = figure.add_axes((0.05, 0.07, 0.88, 0.84), projection="3d", computed_zorder=False)
        ax.set_box_aspect((1, 1, 0.85), zoom=1.02)
        boxed(ax)
        if shapes:
            elevation, azimuth = best_view(shapes)
            ax.view_init(elevation, azimuth)
    return ax


def finish(ax: Any, units: Units) -> Any:
    """Label the axes for the limits they have now."""
    for axis, name, unit in (
        (ax.xaxis, "$f_x$", units.force),
        (ax.yaxis, "$f_y$", units.force),
        (ax.zaxis, r"$\tau$", units.torque),
    ):
        label_axis(axis, name, unit, float(max(abs(axis.get_data_interval()))))
        axis.labelpad = -4 if axis is ax.zaxis else -6
    return ax


def plot_wrench_plane(
    plane: WrenchPlane,
    ax: Any = None,
    *,
    reach: float = 1.0,
    colour: str = PALETTE[0],
    units: Units = SI,
) -> Any:
    """Pi_i: wrenches of all forces at a contact, shown for |f_x|, |f_y| up to ``reach`` [N] (Fig. 3).

    Args:
        plane: the plane to draw.
        ax: the axes to draw on; new ones if not given.
        reach: largest force shown [N].
        colour: of Matplotlib.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(plane, "plane", WrenchPlane)
    corners = plane.wrench(reach * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]))
    ax = wrench_axes(ax, [corners])
    _surface(ax, corners, colour, 0.1, gid=f"plane {plane.contact.name}")
    return finish(ax, units)


def plot_wrench_cone(
    cone: WrenchCone,
    ax: Any = None,
    *,
    reach: float = 1.0,
    colour: str = PALETTE[0],
    shadow: bool = False,
    units: Units = SI,
) -> Any:
    """S Pi_i, a flat sector of the plane Pi_i from its apex, for forces up to ``reach`` [N] (Fig. 3-5).

    Args:
        cone: the cone to draw.
        ax: the axes to draw on; new ones if not given.
        reach: largest force shown [N].
        colour: of Matplotlib.
        shadow: draw the friction cone C_i too, the sector's projection along tau onto the plane of the apex.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(cone, "cone", WrenchCone)
    corners = cone_corners(cone, reach)
    ax = wrench_axes(ax, [corners])
    _surface(ax, corners, colour, 0.22, gid=f"cone {cone.contact.name}")
    if shadow:
        flat = corners.copy()
        flat[:, 2] = cone.apex[2]
        _surface(ax, flat, GREY, 0.18, gid=f"friction cone {cone.contact.name}")
    return finish(ax, units)


def plot_locus_segment(
    locus: EquilibriumLocus,
    ax: Any = None,
    *,
    chosen: Any = None,
    label: str = "$LS_B$",
    colour: str = INK,
    units: Units = SI,
) -> Any:
    """LS_B, a bold segment where both cones of the loop meet: the head of w_1 after the load (Fig. 5).

    With the wrenches of other fingers added to the load of the locus it is LS_A (Fig. 6). An infinite side is
    cut off as in ``plot_locus``.

    Args:
        locus: of two planar contacts.
        ax: the axes to draw on; new ones if not given.
        chosen: a state of the two contacts to mark; none if not given.
        label: the words beside it.
        colour: of Matplotlib.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        Infeasible: For an empty locus.
    """
    instance(locus, "locus", EquilibriumLocus)
    if locus.is_empty:
        raise Infeasible(f"the equilibrium locus of {', '.join(locus.grasp.names)} is empty: nothing to draw")
    ax = wrench_axes(ax)
    ends = locus.load.vector + locus.wrenches(np.array(shown_interval(locus, chosen)))[:, 0]
    ax.plot(*ends.T, color=colour, linewidth=2.4, marker="o", markersize=2.4, gid="locus", zorder=3)
    ax.text(*ends[1], f"  {label}", fontsize=SMALL, color=colour, va="bottom", zorder=8)
    return finish(ax, units)


def cone_corners(cone: WrenchCone, reach: float) -> Array:
    """(3, 3) apex and the ends of both edges, as long as a force of ``reach``."""
    return np.vstack([cone.apex, cone.apex + reach * cone.edges])


def _surface(ax: Any, corners: Array, colour: str, alpha: float, gid: str) -> None:
    patch = Poly3DCollection(
        [corners], facecolor=colour, edgecolor=colour, alpha=alpha, linewidth=0.6, zorder=1
    )
    patch.set_gid(gid)
    had_data = ax.has_data()
    ax.add_collection3d(patch)
    ax.auto_scale_xyz(*corners.T, had_data)
