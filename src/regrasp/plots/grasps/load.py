"""The external load at the centre of mass: an arrow for its force, a turning one for its torque."""

import numpy as np
from matplotlib.axes import Axes

from regrasp.mechanics.wrench import Wrench
from regrasp.plots.look.arrows import arrow
from regrasp.plots.look.style import INK, note


def draw_load(ax: Axes, load: Wrench, scale: float, radius: float) -> None:
    """The force at ``scale`` [m/N], and the torque turning at ``radius`` [m]; nothing for what is zero."""
    if load.force.any():
        head = scale * load.force
        arrow(ax, (0, 0), head, gid="load", color=INK, zorder=3)
        note(ax, r"$f_\mathrm{ext}$", head, head)
    if load.torque[0]:
        _turn(ax, load, radius)


def _turn(ax: Axes, load: Wrench, radius: float) -> None:
    """An arrow around the centre of mass in the torque's sense, open towards the load's force."""
    towards = np.arctan2(load.force[1], load.force[0])
    sense = 1 if load.torque[0] > 0 else -1
    angles = towards + sense * np.linspace(np.pi / 3, 5 * np.pi / 3, 40)
    x, y = radius * np.cos(angles), radius * np.sin(angles)
    ax.plot(x[:-3], y[:-3], color=INK, linewidth=1.2, zorder=3)
    arrow(ax, (x[-4], y[-4]), (x[-1], y[-1]), gid="load torque", color=INK, zorder=3)
    opposite = -np.array([np.cos(towards), np.sin(towards)])
    note(ax, r"$\tau_\mathrm{ext}$", radius * opposite, opposite)
