"""Ways of free fingers: all of them in the object's frame, and moments of them over time."""

from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, instance
from regrasp.mesh.mesh import Mesh
from regrasp.motions.value import Motions
from regrasp.outline.outline import Outline
from regrasp.plots.grasps.space_body import draw_mesh
from regrasp.plots.look.solids import triangles_of
from regrasp.plots.look.space_axes import equal_scale, include, space_axes
from regrasp.plots.look.style import GREY, INK, PALE, PALETTE, axes_or_new, label_axis, legend
from regrasp.plots.look.units import SI, Units
from regrasp.plots.regrasps.moments import Finger, Moment, as_regrasp, moment_of

_POINTS = 200  # of a way
_DETAIL = 2e-4  # of the object's size


def plot_motions(motions: Motions, shape: Outline | Mesh, ax: Any = None, *, units: Units = SI) -> Any:
    """The ways of all fingers' tips in the object's frame, a colour for each finger.

    A full disc, in space a full dot, is where a way begins, an open one where it ends; discs are the tips'
    size.

    Args:
        motions: what ``plan_motions`` returns.
        shape: the object they go around.
        ax: the axes to draw on; new ones if not given.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For ways in the plane around a mesh, or in space around an outline.
    """
    instance(motions, "motions", Motions)
    in_plane = motions.tips.shape[2] == 2
    if not isinstance(shape, Outline if in_plane else Mesh):
        raise InvalidInput(
            f"these ways go around {'an Outline' if in_plane else 'a Mesh'}, got {type(shape).__name__}"
        )
    fingers = sorted({m.finger for m in motions.motions})
    if isinstance(shape, Outline):
        ax = _plane(motions, shape, ax, units)
    else:
        ax = space_axes(ax)
        _space(motions, shape, ax, units)
    handles = [Line2D([], [], color=PALETTE[i % len(PALETTE)], label=f"finger {i + 1}") for i in fingers]
    if handles:
        legend(ax, handles, loc="upper left", bbox_to_anchor=(0.0, 1.0))
    return ax


def _curve(motions: Motions, number: int) -> Array:
    motion = motions.motions[number]
    return motion.way.over_time(np.linspace(0, 1, _POINTS), motion.duration)[0]


def _plane(motions: Motions, shape: Outline, ax: Any, units: Units) -> Any:
    size = float(np.ptp(shape.polygon(), axis=0).max())
    ax = axes_or_new(ax, height=3.4)
    rings = [shape.polygon(_DETAIL * size), *(hole[::-1] for hole in shape.hole_polygons(_DETAIL * size))]
    paths = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in rings]
    body = PathPatch(Path.make_compound_path(*paths), facecolor=PALE, edgecolor=INK, linewidth=0.8, zorder=0)
    ax.add_patch(body)
    for number, motion in enumerate(motions.motions):
        colour, curve = PALETTE[motion.finger % len(PALETTE)], _curve(motions, number)
        ax.plot(*curve.T, color=colour, linewidth=1.2, zorder=2, gid=f"way {number}")
        capsule = motions.capsules[motion.finger]
        for at, full in ((curve[0], True), (curve[-1], False)):
            look = {"facecolor": colour if full else "white", "edgecolor": colour, "zorder": 3}
            circle = Path.circle(tuple(at), motions.tip_radius)
            ax.add_patch(PathPatch(circle, linewidth=0.8, **look))
            if capsule.any():
                ax.plot(*np.array([at, at + capsule]).T, color=colour, linewidth=2.5, alpha=0.35, zorder=1)
    ax.set_aspect("equal", adjustable="datalim")
    ax.autoscale_view()
    ax.locator_params(axis="x", nbins=5)  # numbers side by side have no room for more
    label_axis(ax.xaxis, "$x$", units.length, size / 2)
    label_axis(ax.yaxis, "$y$", units.length, size / 2)
    return ax


def _space(motions: Motions, shape: Mesh, ax: Any, units: Units) -> None:
    triangles = triangles_of(shape)
    assert triangles is not None
    draw_mesh(ax, triangles)
    for number, motion in enumerate(motions.motions):
        colour, curve = PALETTE[motion.finger % len(PALETTE)], _curve(motions, number)
        ax.plot(*curve.T, color=colour, linewidth=1.2, zorder=4, gid=f"way {number}")
        include(ax, curve)
        capsule = motions.capsules[motion.finger]
        for at, face in ((curve[0], colour), (curve[-1], "white")):
            ax.plot(*at[:, None], "o", color=face, markeredgecolor=colour, markersize=5, zorder=5)
            if capsule.any():
                ax.plot(*np.array([at, at + capsule]).T, color=GREY, linewidth=2.5, alpha=0.5, zorder=3)
    equal_scale(ax, units)


def motion_moments(motions: Motions, t: Array) -> list[Moment]:
    """What times (m,) on the motions' clock [s] show; fingers in the air are where their tips are."""
    plan = as_regrasp(motions.plan)
    k, local = motions.step_times(t)
    at, touching = motions.positions(t), motions.touching(t)
    moments = []
    for step, now, tips, on in zip(k.tolist(), local.tolist(), at, touching, strict=True):
        moment = moment_of(plan, step, now)
        held = {f.number: f for f in moment.fingers}
        fingers = [
            held[i]
            if on[i] and i in held
            else Finger(i, "", moment.turn @ tip, None, 0.0, np.zeros(tip.size))
            for i, tip in enumerate(tips)
        ]
        moments.append(Moment(moment.turn, moment.load, tuple(fingers)))
    return moments
