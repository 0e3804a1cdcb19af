"""How an object in space escapes from its grasp: its screw axis, and the motion of the contacts."""

from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.plots.escapes.screw_motion import amount_for, moved
from regrasp.plots.escapes.words import (
    HELPLESS,
    HELPLESS_LOOK,
    MOTION,
    OPPOSES,
    OPPOSES_LOOK,
    key,
    labels,
    title,
)
from regrasp.plots.grasps.body import extent
from regrasp.plots.grasps.space_body import dot, draw_body_in_space, draw_edges
from regrasp.plots.grasps.space_state import CONE, TURN, draw_load_in_space, turning
from regrasp.plots.look.arrows import arrow3d
from regrasp.plots.look.solids import Triangles, creases
from regrasp.plots.look.space_axes import equal_scale, space_axes
from regrasp.plots.look.style import SMALL, legend, short
from regrasp.plots.look.units import Units
from regrasp.plots.look.view import facing_view

_FASTEST, _LATER, _WAY = 0.25, 0.12, 0.6
"""Length of the longest velocity, way to the object drawn later and of the contacts' paths, by the extent."""
_NEAR = 1.2
"""An axis farther from the centre of mass, by the extent, is only pointed to."""


def draw_escape(twist: EscapeTwist, ax: Any, *, mesh: Triangles | None, units: Units) -> Any:
    """``plot_escape`` in space."""
    new, ax = ax is None, space_axes(ax, height=4.0)
    if new:
        ax.set_position((0.0, 0.02, 0.93, 0.78))
        ax.view_init(*facing_view(twist.grasp.positions, twist.grasp.normals))
    size = extent(twist.grasp, None if mesh is None else mesh[0])
    colours = {
        name: HELPLESS if helpless else OPPOSES
        for name, helpless in zip(twist.grasp.names, twist.helpless, strict=True)
    }
    draw_body_in_space(
        ax, twist.grasp, colours, 0.8 * CONE * size, size, mesh=mesh, names=labels(twist, units)
    )
    force = float(np.linalg.norm(twist.load.force))
    draw_load_in_space(ax, twist.load, 0.35 * size / (force or 1.0), TURN * size)
    _draw_contacts(ax, twist, size)
    if mesh is not None:
        _draw_later(ax, twist, mesh, size)
    axis = [] if twist.axis is None else [_draw_axis(ax, *twist.axis, size)]
    ax.set_title(title(twist, units), fontsize=SMALL, loc="left", pad=14)
    legend(ax, [*key(twist), *axis], handlelength=2.2)  # long enough for a dash and a dot
    return equal_scale(ax, units)


def _draw_contacts(ax: Any, twist: EscapeTwist, size: float) -> None:
    """Marks of who can oppose the motion, velocities, and the helices along which the contacts would go."""
    points = twist.grasp.positions
    speeds = np.linalg.norm(twist.velocities, axis=1)
    still = 1e-9 * float(np.linalg.norm(twist.twist[:3]) + np.linalg.norm(twist.twist[3:]) * size)
    amounts = np.linspace(0, amount_for(twist, points, _WAY * size), 40)
    ways = np.array([moved(twist, points, a) for a in amounts.tolist()])
    for i, (name, r, v) in enumerate(zip(twist.grasp.names, points, twist.velocities, strict=True)):
        ax.plot(*ways[:, i].T, color=MOTION, linewidth=0.9, alpha=0.8, gid=f"way {name}", zorder=4)
        if speeds[i] > still:
            head = r + _FASTEST * size / float(speeds.max()) * v
            arrow3d(ax, r, head, gid=f"velocity {name}", color=MOTION, linewidth=1.8, zorder=5)
        what, look = ("helpless", HELPLESS_LOOK) if twist.helpless[i] else ("opposes", OPPOSES_LOOK)
        dot(ax, r, gid=f"{what} {name}", zorder=6, **look)


def _draw_later(ax: Any, twist: EscapeTwist, mesh: Triangles, size: float) -> None:
    """The sharp edges of the object a little later."""
    amount = amount_for(twist, mesh[0], _LATER * size)
    edges = creases(mesh)
    later = moved(twist, edges.reshape(-1, 3), amount).reshape(edges.shape)
    draw_edges(ax, later, MOTION, gid="later")


def _draw_axis(ax: Any, p: Array, n: Array, size: float) -> Line2D:
    """The screw axis with the sense of the turn; an arrow towards it where it is far away. Its key.

    p: its point nearest to the centre of mass [m]. n: its direction, unit.
    """
    away = float(np.linalg.norm(p))
    if away <= _NEAR * size:
        low, high = p - 0.7 * size * n, p + 0.7 * size * n
        ax.plot(*np.array([low, high]).T, color=MOTION, linewidth=1.2, linestyle="-.", gid="axis", zorder=5)
        turning(ax, p + 0.45 * size * n, n, 0.08 * size, gid="sense", color=MOTION)
        return Line2D([], [], color=MOTION, linewidth=1.2, linestyle="-.", label="screw axis")
    tail, head = 0.3 * size * p / away, 0.55 * size * p / away
    arrow3d(ax, tail, head, gid="towards axis", color=MOTION, linestyle=":", zorder=7)
    turning(ax, head, n, 0.08 * size, gid="sense", color=MOTION)
    where = ", ".join(short(float(f"{x:.3g}")) for x in p)
    return Line2D([], [], color=MOTION, linewidth=1.2, linestyle=":", label=f"to the axis at ({where})")
