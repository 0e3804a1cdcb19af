"""The object in space with its friction cones, forces and load."""

from collections.abc import Collection
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.plans.transition import Transition
from regrasp.plots.grasps.space_body import draw_body_in_space, write
from regrasp.plots.look.arrows import arrow3d
from regrasp.plots.look.solids import Triangles, circle
from regrasp.plots.look.space_axes import equal_scale, space_axes
from regrasp.plots.look.style import INK, SMALL, Colours, quantity
from regrasp.plots.look.units import Units
from regrasp.plots.look.view import facing_view

CONE, TURN = 0.3, 0.13
"""Length of a friction cone's sides and radius of a turning arrow, as fractions of the object's extent."""
_SAMPLES = 101

END_LOOK: dict[str, Any] = {"linestyle": (0, (2, 1)), "linewidth": 1.0, "facecolor": "white"}
"""Of the forces at the end of a transition."""


def draw_state(
    state: GraspState,
    ax: Any,
    *,
    size: float,
    reach: float,
    scale: float,
    colours: Colours,
    absent: Collection[str],
    mesh: Triangles | None,
    units: Units,
) -> Any:
    """``plot_state`` in space. size: the object's extent, reach: its width [m]. scale: of a force [m/N]."""
    ax = _scene(ax, state, size, reach, scale, colours, mesh, absent)
    _forces(ax, state, scale, colours, "force")
    longest = max(*state.magnitudes, float(np.linalg.norm(state.load.force)))
    return _finish(ax, longest, units)


def draw_transition(
    transition: Transition,
    ax: Any,
    *,
    size: float,
    reach: float,
    scale: float,
    colours: Colours,
    mesh: Triangles | None,
    units: Units,
) -> Any:
    """``plot_transition`` in space without its legend."""
    ends = (transition.start, transition.end)
    ax = _scene(ax, transition.start, size, reach, scale, colours, mesh)
    _forces(ax, transition.start, scale, colours, "start force")
    _forces(ax, transition.end, scale, colours, "end force", **END_LOOK)
    pushes = transition.wrenches(np.linspace(0, transition.duration, _SAMPLES))[..., :3]
    heads = transition.grasp.positions + scale * pushes
    for i, name in enumerate(transition.grasp.names):
        ax.plot(*heads[:, i].T, color=colours[name], linewidth=2.6, alpha=0.45, gid=f"path {name}", zorder=3)
    longest = max(*(m for s in ends for m in s.magnitudes), float(np.linalg.norm(ends[0].load.force)))
    return _finish(ax, longest, units)


def draw_load_in_space(ax: Any, load: Wrench, scale: float, radius: float) -> None:
    """The force at ``scale`` [m/N], and the torque turning at ``radius`` [m]; nothing for what is zero."""
    f, tau = load.force, load.vector[3:]
    if f.any():
        head = scale * f
        arrow3d(ax, np.zeros(3), head, gid="load", color=INK, zorder=5)
        write(ax, r"$f_\mathrm{ext}$", head, head, 0.2 * radius, gid="name load")
    if tau.any():
        turning(ax, np.zeros(3), tau / np.linalg.norm(tau), radius, gid="load torque", color=INK)
        towards = -f if f.any() else tau
        write(ax, r"$\tau_\mathrm{ext}$", np.zeros(3), towards, 1.3 * radius, gid="name load torque")


def turning(ax: Any, centre: Array, axis: Array, radius: float, *, gid: str, color: str) -> None:
    """An arrow around a unit vector, in the right-handed sense."""
    points = circle(centre, axis, radius, 40, turn=5 * np.pi / 3)
    ax.plot(*points[:-3].T, color=color, linewidth=1.2, zorder=5)
    arrow3d(ax, points[-4], points[-1], gid=gid, color=color, zorder=5)


def _scene(
    ax: Any,
    state: GraspState,
    size: float,
    reach: float,
    scale: float,
    colours: Colours,
    mesh: Triangles | None,
    absent: Collection[str] = (),
) -> Any:
    """Everything but the finger forces; new axes look from where the contacts are best seen."""
    new, ax = ax is None, space_axes(ax)
    if new:
        ax.view_init(*facing_view(state.grasp.positions, state.grasp.normals))
    draw_body_in_space(
        ax, state.grasp, colours, min(CONE * size, 0.8 * reach), size, mesh=mesh, absent=absent
    )
    draw_load_in_space(ax, state.load, scale, min(TURN * size, 0.4 * reach))
    return ax


def _forces(ax: Any, state: GraspState, scale: float, colours: Colours, what: str, **look: object) -> None:
    used = state.in_use
    for name, r, f in zip(state.grasp.names, state.grasp.positions, state.wrenches[:, :3], strict=True):
        if name in used:
            base = {"facecolor": colours[name], "edgecolor": colours[name], "zorder": 5}
            arrow3d(ax, r, r + scale * f, gid=f"{what} {name}", **(base | look))


def _finish(ax: Any, longest: float, units: Units) -> Any:
    """One scale on all axes, and in the corner what the longest arrow means."""
    if longest:
        text = f"longest arrow: {quantity(longest, units.force)}"
        ax.text2D(1.0, 0.99, text, transform=ax.transAxes, fontsize=SMALL, ha="right", va="top", gid="scale")
    return equal_scale(ax, units)
