"""The object with its contacts, friction cones and forces (Fig. 1 and 10)."""

from collections.abc import Collection
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar  # type: ignore[import-untyped]

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, instance
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.outline.outline import Outline
from regrasp.plans.transition import Transition
from regrasp.plots.grasps.body import breadth, draw_body, extent, vertices_of
from regrasp.plots.grasps.load import draw_load
from regrasp.plots.grasps.space_state import draw_state, draw_transition
from regrasp.plots.look.arrows import arrow
from regrasp.plots.look.solids import Triangles, triangles_of
from regrasp.plots.look.style import (
    INK,
    SMALL,
    Colours,
    axes_or_new,
    contact_colours,
    label_axis,
    legend,
    quantity,
    round_below,
)
from regrasp.plots.look.units import SI, Units

# Lengths of the longest force and of the friction cones, as fractions of the object's extent.
_LONGEST, _CONE = 0.45, 0.36


def plot_state(
    state: GraspState,
    ax: Axes | None = None,
    *,
    force_scale: float | None = None,
    colours: Colours | None = None,
    absent: Collection[str] = (),
    mesh: Any = None,
    outline: Outline | None = None,
    units: Units = SI,
) -> Axes:
    """The object with the finger forces and the load of one state (Fig. 1).

    Forces are those of the fingers on the object, drawn with their tails at the contacts, so that a force
    in equilibrium stands inside its friction cone; the load starts at the centre of mass, and a load torque
    is a turning arrow around it. Without an ``outline`` the grey body only suggests the object: its surface
    is known at the contacts, where its tangents are drawn, and nowhere else.

    In space the axes are 3-D, at one scale along x, y and z, and the object is its ``mesh``, translucent, for
    the arrows lie inside it.

    Args:
        state: the state to draw.
        ax: the axes to draw on; new ones if not given.
        force_scale: length of a unit force [m/N]; by default the longest force spans 0.45 of the object's
            extent, and no more than its width where the object is known.
        colours: of the contacts by name; by their place in the grasp if not given.
        absent: names of contacts whose finger is not there in this state: an open circle marks the place.
        mesh: of a grasp in space, anything with ``surface()``, or (vertices (v, 3), faces (f, 3)), in the
            object frame with the centre of mass at the origin.
        outline: of a planar grasp, the object its contacts are on.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For flat axes and a grasp in space, and for a mesh and a planar grasp.
    """
    instance(state, "state", GraspState)
    triangles = surface_of(mesh, state.grasp)
    colours = contact_colours(state.grasp) if colours is None else colours
    shape = _vertices(state.grasp, triangles, outline)
    scale = force_scale_of(state, vertices=shape) if force_scale is None else force_scale
    if state.grasp.dimension == 3:
        drawn: Axes = draw_state(
            state,
            ax,
            size=extent(state.grasp, shape),
            reach=breadth(state.grasp, shape),
            scale=scale,
            colours=colours,
            absent=absent,
            mesh=triangles,
            units=units,
        )
        return drawn
    ax = axes_or_new(ax, height=3.4)
    _scene(ax, state, scale, colours, units, absent, outline)
    _forces(ax, state, scale, colours, "force")
    return ax


def plot_transition(
    transition: Transition,
    ax: Axes | None = None,
    *,
    force_scale: float | None = None,
    mesh: Any = None,
    outline: Outline | None = None,
    units: Units = SI,
) -> Axes:
    """The forces at both states of a transition and the path of each force head between them (Fig. 10).

    Drawn as by ``plot_state``: solid arrows are the forces at the start, open ones those at the end.

    Args:
        transition: the transition to draw.
        ax: the axes to draw on; new ones if not given.
        force_scale: length of a unit force [m/N]; chosen if not given.
        mesh: the object of a grasp in space, as for ``plot_state``.
        outline: that of a planar grasp.
        units: what one unit of length, force and time is called; nothing is converted.
    """
    instance(transition, "transition", Transition)
    triangles = surface_of(mesh, transition.grasp)
    shape = _vertices(transition.grasp, triangles, outline)
    colours = contact_colours(transition.grasp)
    scale = force_scale
    if scale is None:
        scale = force_scale_of(transition.start, transition.end, vertices=shape)
    if transition.grasp.dimension == 3:
        size, reach = extent(transition.grasp, shape), breadth(transition.grasp, shape)
        drawn: Axes = draw_transition(
            transition, ax, size=size, reach=reach, scale=scale, colours=colours, mesh=triangles, units=units
        )
        legend(drawn, _key(), loc="upper left", bbox_to_anchor=(0, 1.08))
        return drawn
    ax = axes_or_new(ax, height=3.4)
    _scene(ax, transition.start, scale, colours, units, outline=outline)
    _forces(ax, transition.start, scale, colours, "start force")
    _forces(
        ax,
        transition.end,
        scale,
        colours,
        "end force",
        linestyle=(0, (2, 1)),
        linewidth=1.0,
        facecolor="white",
    )
    for name, r, a, b in zip(
        transition.grasp.names,
        transition.grasp.positions,
        transition.start.forces,
        transition.end.forces,
        strict=True,
    ):
        heads = np.array([r + scale * a, r + scale * b])
        ax.plot(*heads.T, color=colours[name], linewidth=2.6, alpha=0.45, gid=f"path {name}", zorder=3)
    legend(ax, _key())
    return ax


def force_scale_of(*states: GraspState, vertices: Array | None = None) -> float:
    """Length of a unit force [m/N] at which the longest force of the states is in proportion to the object.

    It spans 0.45 of the extent, but no more than the width of an object whose ``vertices`` (v, d) are known.
    """
    longest = max(max(s.magnitudes.max(), float(np.linalg.norm(s.load.force))) for s in states)
    grasp = states[0].grasp
    return min(_LONGEST * extent(grasp, vertices), breadth(grasp, vertices)) / (longest or 1.0)


def shape_of(grasp: Grasp, mesh: Any, outline: Outline | None) -> Array | None:
    """(v, d) vertices of the object given with a grasp; raises ``InvalidInput`` for one of the other kind."""
    return _vertices(grasp, surface_of(mesh, grasp), outline)


def _vertices(grasp: Grasp, triangles: Triangles | None, outline: Outline | None) -> Array | None:
    if outline is None:
        return None if triangles is None else triangles[0]
    instance(outline, "outline", Outline)
    if grasp.dimension != 2:
        raise InvalidInput("an outline is of an object in the plane, but this grasp is in space; give mesh")
    return vertices_of(outline)


def surface_of(mesh: Any, grasp: Grasp) -> Triangles | None:
    """The triangles of a mesh given with a grasp; raises ``InvalidInput`` for a mesh and a planar grasp."""
    if mesh is not None and grasp.dimension != 3:
        raise InvalidInput("a mesh is the surface of an object in space, but this grasp is planar")
    return triangles_of(mesh)


def _key() -> list[Line2D]:
    return [
        Line2D([], [], color=INK, linewidth=1.4, label="start"),
        Line2D([], [], color=INK, linewidth=1.0, linestyle=(0, (2, 1)), label="end"),
        Line2D([], [], color=INK, linewidth=2.6, alpha=0.45, label="path"),
    ]


def _scene(
    ax: Axes,
    state: GraspState,
    scale: float,
    colours: Colours,
    units: Units,
    absent: Collection[str] = (),
    outline: Outline | None = None,
) -> None:
    """Everything but the finger forces."""
    shape = vertices_of(outline)
    size, reach = extent(state.grasp, shape), breadth(state.grasp, shape)
    draw_body(ax, state.grasp, colours, min(_CONE * size, 0.8 * reach), absent, outline=outline)
    draw_load(ax, state.load, scale, 0.1 * size)
    _scale_key(ax, scale, size, units)
    ax.set_aspect("equal", adjustable="datalim")
    ax.autoscale_view()
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    label_axis(ax.xaxis, "$x$", units.length, size)
    label_axis(ax.yaxis, "$y$", units.length, size)


def _forces(ax: Axes, state: GraspState, scale: float, colours: Colours, what: str, **look: object) -> None:
    used = state.in_use
    for name, r, f in zip(state.grasp.names, state.grasp.positions, state.forces, strict=True):
        if name in used:
            arrow(
                ax,
                r,
                r + scale * f,
                gid=f"{what} {name}",
                **({"facecolor": colours[name], "edgecolor": colours[name], "zorder": 3} | look),
            )


def _scale_key(ax: Axes, scale: float, size: float, units: Units) -> None:
    """A bar above the axes, at the right, as long as a round force."""
    force = round_below(0.3 * size / scale)
    ax.add_artist(
        AnchoredSizeBar(
            ax.transData,
            scale * force,
            quantity(force, units.force),
            "lower right",
            pad=0,
            borderpad=0.2,
            sep=2,
            label_top=True,
            frameon=False,
            color=INK,
            bbox_to_anchor=(1, 1),
            bbox_transform=ax.transAxes,
            fontproperties=FontProperties(size=SMALL),
        )
    )
