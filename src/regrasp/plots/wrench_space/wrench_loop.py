"""The wrench loop of a state and the paths of a transition in wrench space (Fig. 4-7)."""

from math import cos
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, instance
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench_space import WrenchLoop
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.plans.transition import Transition
from regrasp.plots.look.arrows import arrow3d
from regrasp.plots.look.style import INK, SMALL, Colours, contact_colours, legend, literal, refuse_space
from regrasp.plots.look.units import SI, Units
from regrasp.plots.wrench_space.locus import shown_interval
from regrasp.plots.wrench_space.planes_and_cones import (
    cone_corners,
    finish,
    plot_locus_segment,
    plot_wrench_cone,
    wrench_axes,
)

_DASHED: dict[str, Any] = {"linestyle": (0, (3, 1.5)), "linewidth": 1.0}
_LETTERS = 8  # of a name that fits beside its arrow


def plot_wrench_loop(
    state: GraspState,
    ax: Any = None,
    *,
    order: tuple[str, ...] = (),
    colours: Colours | None = None,
    units: Units = SI,
) -> Any:
    """The load and the finger wrenches tail to head, each cone where its wrench starts (Fig. 4 and 6).

    The last cone of the loop is inverted and starts at the origin, where its wrench ends. Cones are cut off
    a little beyond their forces. Two contacts meet in LS_B, drawn bold (Fig. 5).

    Args:
        state: the planar state to draw.
        ax: the axes to draw on; new ones if not given.
        order: of the contacts after the load; as in the grasp by default.
        colours: of the contacts by name; by their place in the grasp if not given. New axes are seen from
            where no surface is edge-on; axes that are given keep their view.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For a grasp in space.
    """
    instance(state, "state", GraspState)
    refuse_space(state.grasp.dimension)
    colours = contact_colours(state.grasp) if colours is None else colours
    loop = WrenchLoop(state, order)
    ordered = GraspState(
        state.grasp.subset(loop.order), state.load, [state.force(name) for name in loop.order]
    )
    ax = _draw_sets(ax, [loop], ordered, colours)
    _draw_load(ax, loop)
    _draw_wrenches(ax, loop, colours, "wrench")
    _name_wrenches(ax, loop)
    legend(ax, [_key(literal(name), colours[name]) for name in loop.order])
    return finish(ax, units)


def plot_wrench_paths(transition: Transition, ax: Any = None, *, units: Units = SI) -> Any:
    """The wrench loops at both ends of a transition and the straight paths between them (Fig. 7).

    Solid arrows close the loop at the start, dashed ones at the end. The finger that leaves or arrives comes
    next to last in the loop; thin lines show its wrench on the way, keeping its direction while it grows or
    shrinks, and the bold translucent lines are the paths of the others: of the heads of their wrenches, and
    for the last one, which ends at the origin, of its tail. Two other contacts show their LS_B.

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    grasp = transition.grasp
    refuse_space(grasp.dimension)
    colours = contact_colours(grasp)
    moving = (*transition.leaving, *transition.arriving)
    if len(moving) != 1:
        raise InvalidInput(
            f"wrench paths are drawn where one finger leaves or arrives, got {transition.in_words}"
        )
    (moves,) = moving
    others = [name for name in grasp.names if name != moves]
    order = (*others[:-1], moves, *others[-1:])
    start, end = WrenchLoop(transition.start, order), WrenchLoop(transition.end, order)
    loops = [start, end] if transition.leaving else [end, start]
    ax = _draw_sets(ax, loops, loops[1].state.without(moves), colours)
    for t in np.linspace(0, transition.duration, 7)[1:-1]:
        state = GraspState(grasp, transition.start.load, transition.forces(t))
        rung = WrenchLoop(state, order).vertices[-3:-1]
        ax.plot(
            *rung.T,
            color=colours[moves],
            linewidth=0.7,
            zorder=2,
            gid=f"path {moves}",
        )
    for owner, a, b in zip((*others[:-1], others[-1]), *_corners(start, end), strict=True):
        path = np.array([a, b])
        ax.plot(*path.T, color=colours[owner], linewidth=3, alpha=0.5, zorder=4, gid=f"path {owner}")
    _draw_load(ax, start)
    _draw_wrenches(ax, start, colours, "start wrench")
    _name_wrenches(ax, loops[0], 0.2)
    _draw_wrenches(ax, end, colours, "end wrench", **_DASHED)
    legend(ax, [_key(literal(name), colours[name]) for name in grasp.names])
    ax.add_artist(ax.get_legend())
    ends = [_key("start", INK), _key("end", INK, **_DASHED), _key("path", INK, linewidth=3, alpha=0.5)]
    legend(ax, ends, bbox_to_anchor=(0, 0.92))
    return finish(ax, units)


def _corners(start: WrenchLoop, end: WrenchLoop) -> tuple[Array, Array]:
    """The vertices that move: heads of the other wrenches, and the tail of the last one."""
    n = len(start.order)
    moving = [*range(2, n), n]
    return start.vertices[moving], end.vertices[moving]


def _draw_sets(ax: Any, loops: list[WrenchLoop], rest: GraspState, colours: Colours) -> Any:
    """The cones of the first loop, and the locus of ``rest`` if of two contacts, in the loop's order.

    The cones are a little longer than the forces of all loops and of the locus as shown.
    """
    grasp = loops[0].state.grasp
    lengths = dict(zip(grasp.names, np.max([loop.state.magnitudes for loop in loops], axis=0), strict=True))
    locus = EquilibriumLocus(rest.grasp, rest.load) if len(rest.grasp) == 2 else None
    if locus is not None and not locus.is_empty:
        ends = np.linalg.norm(locus.forces(np.array(shown_interval(locus, rest))), axis=-1).max(axis=0)
        lengths |= {name: max(lengths[name], end) for name, end in zip(rest.grasp.names, ends, strict=True)}
    least = 0.3 * max(lengths.values()) or 1.0

    cones = loops[0].cones()
    reaches = [_reach(cone.contact, max(lengths[str(cone.contact.name)], least)) for cone in cones]
    shapes = [cone_corners(cone, reach) for cone, reach in zip(cones, reaches, strict=True)]
    ax = wrench_axes(ax, [*_outlines(loops), *shapes])
    for cone, reach in zip(cones, reaches, strict=True):
        plot_wrench_cone(cone, ax, reach=reach, colour=colours[str(cone.contact.name)])
    if locus is not None and not locus.is_empty:
        plot_locus_segment(locus, ax, chosen=rest)
    return ax


def _reach(contact: Contact, force: float) -> float:
    """Length of the edges of a cone that holds a force of any direction inside it, with a little room."""
    return 1.05 * force / cos(contact.half_angle)


def _outlines(loops: list[WrenchLoop]) -> list[Array]:
    """Polygons to see openly: the loops and, between two, what the next to last wrench sweeps."""
    outlines = [loop.vertices[:-1] for loop in loops]  # the last corner is the first
    if len(loops) == 2:
        outlines.append(np.vstack([loops[0].vertices[-3:-1], loops[1].vertices[-2:-3:-1]]))
    return outlines


def _draw_load(ax: Any, loop: WrenchLoop) -> None:
    corners = loop.vertices
    if loop.state.load.vector.any():
        arrow3d(ax, corners[0], corners[1], gid="load", color=INK, zorder=5)
        outwards = 0.5 * corners[1] - corners[:-1].mean(axis=0)
        at = 0.5 * corners[1] + 0.3 * outwards
        ax.text(*at, r"$w_\mathrm{ext}$", fontsize=SMALL, ha="center", va="center", zorder=8)


def _draw_wrenches(ax: Any, loop: WrenchLoop, colours: Colours, what: str, **look: Any) -> None:
    """The arrows of a loop; a contact without force has none."""
    corners, used = loop.vertices, loop.state.in_use
    for name, tail, head in zip(loop.order, corners[1:], corners[2:], strict=False):
        if name in used:
            arrow3d(ax, tail, head, gid=f"{what} {name}", color=colours[name], zorder=6, **look)


def _name_wrenches(ax: Any, loop: WrenchLoop, out: float = 0.08) -> None:
    """Fingers' names beside their arrows, nearer the heads, so that a picture in grey is read, too."""
    corners, used = loop.vertices, loop.state.in_use
    middle = corners[:-1].mean(axis=0)
    for name, tail, head in zip(loop.order, corners[1:], corners[2:], strict=False):
        if name in used and len(name) <= _LETTERS:
            at = (1 + out) * (0.35 * tail + 0.65 * head) - out * middle
            words = ax.text(*at, literal(name), fontsize=SMALL, ha="center", va="center", zorder=9)
            words.set_path_effects([withStroke(linewidth=1.8, foreground="white")])


def _key(label: str, colour: str, **look: Any) -> Line2D:
    return Line2D([], [], color=colour, label=label, **({"linewidth": 1.4} | look))
