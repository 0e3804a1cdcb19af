"""The motion along which an object escapes from its grasp."""

from math import hypot
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from regrasp.mechanics.checks import Array, instance
from regrasp.mechanics.escape import EscapeTwist
from regrasp.plots.escapes.space_escape import draw_escape
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
from regrasp.plots.grasps.body import draw_body, extent, label_contact
from regrasp.plots.grasps.load import draw_load
from regrasp.plots.grasps.state import surface_of
from regrasp.plots.look.arrows import arrow
from regrasp.plots.look.png import png
from regrasp.plots.look.style import (
    SMALL,
    axes_or_new,
    label_axis,
    legend,
    new_figure,
    note,
    short,
    tidy,
)
from regrasp.plots.look.units import SI, Units

_HEIGHT = 3.9  # [in]
_ROWS = 9  # of arrows in the field of motion


def plot_escape(twist: EscapeTwist, ax: Axes | None = None, *, mesh: Any = None, units: Units = SI) -> Axes:
    """How the object escapes from the contacts, and which of them cannot oppose it.

    Green arrows are velocities of the object: thin ones over its surroundings, bold ones, at a scale of their
    own, at the contacts. A green disc is the centre of rotation; where it lies far outside, a dotted arrow
    points to it. A contact marked by an orange cross cannot oppose the motion with any force in its cone; one
    marked by a blue disc can oppose the work written beside it and no more. The load is drawn at no scale.
    The title compares the work of the load with the most that all contacts together can oppose, per radian
    where the motion turns the object and per metre where it does not.

    In space a dash-dotted green line is the screw axis, with the sense of the turn; thin lines are the ways
    of the contacts, and thin edges the object a little later. The title gives the pitch.

    Args:
        twist: the certificate of ``Infeasible``.
        ax: the axes to draw on; new ones if not given.
        mesh: the object of a grasp in space, as for ``plot_state``.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For flat axes and a grasp in space, and for a mesh and a planar grasp.
    """
    instance(twist, "twist", EscapeTwist)
    triangles = surface_of(mesh, twist.grasp)
    if twist.grasp.dimension == 3:
        drawn: Axes = draw_escape(twist, ax, mesh=triangles, units=units)
        return drawn
    ax = axes_or_new(ax, height=_HEIGHT)
    size = extent(twist.grasp)
    colours = {
        name: HELPLESS if helpless else OPPOSES
        for name, helpless in zip(twist.grasp.names, twist.helpless, strict=True)
    }
    draw_body(ax, twist.grasp, colours, 0.3 * size, named=False)
    draw_load(ax, twist.load, 0.35 * size / (hypot(*twist.load.force) or 1.0), 0.1 * size)
    low, high = _frame(twist, size)
    ax.update_datalim([low, high])
    _draw_motion(ax, twist, low, high)
    _draw_contacts(ax, twist, size, units)
    _draw_centre(ax, twist, low, high, size)
    ax.set_aspect("equal", adjustable="datalim")
    ax.autoscale_view()
    label_axis(ax.xaxis, "$x$", units.length, size)
    label_axis(ax.yaxis, "$y$", units.length, size)
    ax.set_title(title(twist, units), fontsize=SMALL, loc="left", pad=16)
    legend(ax, key(twist))
    return ax


def escape_png(twist: EscapeTwist) -> bytes:
    """``plot_escape`` as a PNG image, for display in notebooks."""
    if twist.grasp.dimension == 3:
        return png(plot_escape(twist).figure)  # type: ignore[arg-type]
    figure = new_figure(height=_HEIGHT)
    plot_escape(twist, tidy(figure.add_subplot()))
    return png(figure)


def velocity(twist: EscapeTwist, points: Array) -> Array:
    """(m, 2) velocity v + omega x r of the object at points (m, 2)."""
    vx, vy, omega = twist.twist
    moved: Array = np.array([vx, vy]) + omega * np.column_stack([-points[:, 1], points[:, 0]])
    return moved


def _frame(twist: EscapeTwist, size: float) -> tuple[Array, Array]:
    """Opposite corners of a square: contacts, centre of mass, and the centre of rotation where it is near."""
    points = np.vstack([twist.grasp.positions, np.zeros(2)])
    if twist.centre is not None and (abs(twist.centre - points) <= 1.5 * size).all():
        points = np.vstack([points, twist.centre])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2, float((high - low).max()) / 2 + 0.25 * size
    return middle - half, middle + half


def _draw_motion(ax: Axes, twist: EscapeTwist, low: Array, high: Array) -> None:
    """The field of velocities, its longest arrow as long as the arrows are apart."""
    spacing = float((high - low).max()) / _ROWS
    x, y = (np.arange(a + spacing / 2, b, spacing) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    v = velocity(twist, points)
    look: dict[str, Any] = {"width": 0.004, "color": MOTION, "alpha": 0.45, "zorder": 1, "pivot": "mid"}
    scale = float(np.hypot(*v.T).max()) / spacing
    ax.quiver(*points.T, *v.T, angles="xy", scale_units="xy", scale=scale, gid="motion", **look)


def _draw_contacts(ax: Axes, twist: EscapeTwist, size: float, units: Units) -> None:
    """Velocities of the contacts, the fastest a quarter of the extent long, and who can oppose them."""
    fastest = float(np.hypot(*twist.velocities.T).max()) or 1.0
    bold: dict[str, Any] = {"color": MOTION, "linewidth": 1.8, "zorder": 5}
    for contact, v, helpless, label in zip(
        twist.grasp, twist.velocities, twist.helpless, labels(twist, units), strict=True
    ):
        name, r = contact.name, contact.position
        if hypot(*v) > 1e-9 * fastest:
            arrow(ax, r, r + 0.25 * size / fastest * v, gid=f"velocity {name}", **bold)
        what, look = ("helpless", HELPLESS_LOOK) if helpless else ("opposes", OPPOSES_LOOK)
        ax.plot(*r, linestyle="none", zorder=6, gid=f"{what} {name}", **look)
        towards, gap = -contact.normal, 6.0
        if twist.centre is not None and 0 < (near := hypot(*(r - twist.centre))) < 0.15 * size:
            towards, gap = (r - twist.centre) / near, 9.0  # clear of the mark of the centre
        label_contact(ax, label, r, towards, size, gap=gap, color=look["color"])


def _draw_centre(ax: Axes, twist: EscapeTwist, low: Array, high: Array, size: float) -> None:
    """The centre of rotation with its sense; an arrow towards it from the edge where it is out of sight."""
    middle, centre = (low + high) / 2, twist.centre
    if centre is None:
        return
    if (low < centre).all() and (centre < high).all():
        ax.plot(*centre, "o", color=MOTION, markersize=5, zorder=5, gid="centre")
        angles = np.sign(twist.twist[2]) * np.linspace(0, 1.5 * np.pi, 40)
        x, y = centre[:, None] + 0.08 * size * np.array([np.cos(angles), np.sin(angles)])
        ax.plot(x[:-4], y[:-4], color=MOTION, linewidth=1.4, zorder=5)
        arrow(ax, (x[-5], y[-5]), (x[-1], y[-1]), gid="sense", color=MOTION, zorder=5)
        note(ax, "centre", centre, (0, -1), gap=14, color=MOTION)
    else:
        towards = (centre - middle) / hypot(*(centre - middle))
        edge = middle + towards * float(((high - low) / 2 / np.maximum(abs(towards), 1e-9)).min())
        arrow(
            ax, edge - 0.2 * size * towards, edge, gid="towards centre", color=MOTION, linestyle=":", zorder=7
        )
        where = ", ".join(short(float(f"{x:.3g}")) for x in centre)
        note(ax, f"centre at ({where})", edge - 0.1 * size * towards, (-towards[1], towards[0]), color=MOTION)
