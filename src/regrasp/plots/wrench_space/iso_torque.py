"""Iso-torque lines of a contact (Fig. 2)."""

import re

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Wedge
from matplotlib.ticker import MaxNLocator

from regrasp.mechanics.checks import Array, ArrayLike, array, instance
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench_space import IsoTorqueLine, WrenchCone, iso_torque_line
from regrasp.plots.look.arrows import arrow
from regrasp.plots.look.style import (
    GREY,
    INK,
    PALETTE,
    SMALL,
    axes_or_new,
    label_axis,
    literal,
    note,
    quantity,
    refuse_space,
)
from regrasp.plots.look.units import SI, Units


def plot_iso_torque(
    contact: Contact,
    ax: Axes | None = None,
    *,
    torques: ArrayLike | None = None,
    force: ArrayLike | None = None,
    colour: str = PALETTE[0],
    units: Units = SI,
) -> Axes:
    """Lines L_i of forces that make one torque, in the plane of forces at the contact (Fig. 2).

    A force drawn from the origin, the contact, makes the torque of the line its head is on. The lines are
    parallel to r_i, which is drawn towards the contact at no scale. A line is bold where forces on it are
    inside the friction cone. The distance d_i to the contact is marked for the line of ``force``, or for the
    outermost one.

    Args:
        contact: a planar contact, not at the centre of mass.
        ax: the axes to draw on; new ones if not given.
        torques: of the lines [N m]; round values over the friction cone by default.
        force: (2,) a force at the contact to draw with its line [N].
        colour: of Matplotlib.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For a contact in space and for one at the centre of mass, which makes no torque.
    """
    instance(contact, "contact", Contact)
    refuse_space(contact.dimension)
    ax = axes_or_new(ax, height=3.0)
    shown = None if force is None else array(force, "force", (2,))
    if shown is not None and not shown.any():
        shown = None
    own = None if shown is None else _clean(iso_torque_line(contact, shown), shown)
    lines = _lines(contact, torques, own, 1.0 if shown is None else float(np.hypot(*shown)))
    reach = _reach(lines, shown)

    n, half = contact.normal, np.degrees(contact.half_angle)
    middle = np.degrees(np.arctan2(n[1], n[0]))
    ax.add_patch(
        Wedge((0, 0), reach, middle - half, middle + half, color=colour, alpha=0.15, linewidth=0, gid="cone")
    )
    ends = _ends(contact, reach)
    for line in lines:
        _draw_line(ax, line, ends, colour, units, gid="line", color=GREY)
    if own is not None and shown is not None:
        _draw_line(ax, own, ends, colour, units, gid="line of force", color=INK)
        arrow(ax, (0, 0), shown, gid="force", color=colour, zorder=4)
        note(ax, "$f_i$", 0.7 * shown, np.sign(own.distance or 1.0) * _left(own.direction), color=colour)
    marked = own or max(lines, key=lambda line: abs(line.distance), default=None)
    _draw_arm(ax, contact, reach, marked)
    if marked is not None and marked.distance:
        _draw_distance(ax, marked, ends[0])
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.1)
    ax.autoscale_view()
    label_axis(ax.xaxis, "$f_x$", units.force, reach)
    label_axis(ax.yaxis, "$f_y$", units.force, reach)
    return ax


def _lines(
    contact: Contact, torques: ArrayLike | None, own: IsoTorqueLine | None, size: float
) -> list[IsoTorqueLine]:
    """The lines asked for; or round torques of forces up to ``size`` [N], clear of the line ``own``."""
    if torques is not None:
        values = array(np.atleast_1d(np.asarray(torques, dtype=float)), "torques", (None,))
        return [IsoTorqueLine(contact, float(tau)) for tau in values]
    lowest, *_, highest = sorted((0.0, *(size * WrenchCone(contact).edges[:, 2])))
    ticks = MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(lowest, highest)
    near = 0.6 * (ticks[1] - ticks[0])
    values = ticks[(ticks >= lowest) & (ticks <= highest)]
    return [
        IsoTorqueLine(contact, float(tau)) for tau in values if own is None or abs(tau - own.torque) > near
    ]


def _clean(line: IsoTorqueLine, force: Array) -> IsoTorqueLine:
    """The line of a force, through the contact where its distance is rounding."""
    rounding = abs(line.distance) <= 1e-12 * np.hypot(*force)
    return IsoTorqueLine(line.contact, 0.0) if rounding else line


def _reach(lines: list[IsoTorqueLine], force: Array | None) -> float:
    """Length of the cone as drawn [N]."""
    if force is not None:
        return 1.15 * float(np.hypot(*force))
    return 1.15 * max((abs(line.distance) for line in lines), default=1.0) or 1.0


def _ends(contact: Contact, reach: float) -> tuple[float, float]:
    """Where lines begin and end along r_i [N]: around the cone, the longer part on the cone's side."""
    along = float(contact.normal @ contact.position) / float(np.hypot(*contact.position))
    front = 1.0 if along >= 0 else -1.0
    return -0.35 * front * reach, 1.15 * front * reach


def _left(direction: Array) -> Array:
    return np.array([-direction[1], direction[0]])


def _draw_line(
    ax: Axes, line: IsoTorqueLine, ends: tuple[float, float], colour: str, units: Units, gid: str, color: str
) -> None:
    """A line with its torque at the end; bold where forces on it are inside the friction cone."""
    first, last = (line.force + s * line.direction for s in ends)
    ax.plot(*np.array([first, last]).T, color=color, linewidth=0.8, gid=gid)
    _label(ax, quantity(line.torque, units.torque, 3), last, last - first, color)
    inside = line.friction_segment
    if inside is not None:
        infinite = ~np.isfinite(inside).all(axis=1)
        inside[infinite] = line.force
        s = np.where(infinite, (-np.inf, np.inf), (inside - line.force) @ line.direction).clip(
            min(ends), max(ends)
        )
        if s[0] == s[1]:
            return  # it enters the cone beyond what is shown
        bold = line.force + s[:, None] * line.direction
        ax.plot(*bold.T, color=color if gid != "line" else colour, linewidth=1.8, gid="inside the cone")


def _label(ax: Axes, torque: str, at: Array, along: Array, color: str) -> None:
    """The torque written along the line, beyond its end, so that near lines keep their labels apart."""
    x, y = along / np.hypot(*along)
    letters = len(re.sub(r"[$^{}]|cdot", "", torque))
    ax.update_datalim([at + 0.055 * letters * along])  # room for the text
    leftwards = x < -1e-9 or (abs(x) <= 1e-9 and y < 0)  # turned about, to be read from below or the right
    ax.annotate(
        torque,
        tuple(at),
        (3 * x, 3 * y),
        textcoords="offset points",
        rotation=np.degrees(np.arctan2(-y, -x) if leftwards else np.arctan2(y, x)),
        rotation_mode="anchor",
        ha="right" if leftwards else "left",
        va="center",
        fontsize=SMALL,
        color=color,
    )


def _draw_arm(ax: Axes, contact: Contact, reach: float, line: IsoTorqueLine | None) -> None:
    """r_i from the centre of mass to the contact, its length without scale."""
    direction = contact.position / np.hypot(*contact.position)
    tail = -0.8 * reach * direction
    side = -1.0 if line is not None and line.distance > 0 else 1.0
    arrow(ax, tail, (0, 0), gid="arm", color=INK, linewidth=1.0, linestyle=(0, (4, 2)), zorder=3)
    note(ax, "$r_i$", 0.5 * tail, side * _left(direction))
    note(ax, "CM", tail, side * _left(direction), gap=6)
    ax.plot(*tail, "o", color="white", markeredgecolor=INK, markersize=5, zorder=4)
    ax.plot(0, 0, "o", color=INK, markersize=3.5, zorder=5)
    note(ax, literal(contact.name) if contact.name else "$P_i$", (0, 0), side * _left(direction), gap=6)


def _draw_distance(ax: Axes, line: IsoTorqueLine, along: float) -> None:
    """d_i between the line through the contact and the line, at ``along`` [N] on both."""
    foot = along * line.direction
    ax.plot(*np.array([np.zeros(2), foot]).T, color=GREY, linewidth=0.6, linestyle=":")
    look = {"arrowstyle": "<|-|>,head_length=0.3,head_width=0.12", "linewidth": 0.8}
    arrow(ax, foot, foot + line.force, gid="distance", color=INK, **look)
    note(ax, "$d_i$", foot + line.force / 2, along * line.direction, color=INK)
