"""Moments of a plan in space, in the world frame: a solid, its fingers, and their forces."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin, sqrt
from typing import Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from regrasp.mechanics.checks import Array
from regrasp.plans.transition import Transition
from regrasp.plots.grasps.space_body import dot, draw_mesh, write
from regrasp.plots.look.arrows import arrow3d
from regrasp.plots.look.solids import Triangles, cone, creases
from regrasp.plots.look.style import INK, PALETTE, quantity, round_below
from regrasp.plots.look.units import Units
from regrasp.plots.look.view import projection
from regrasp.plots.regrasps.moments import Finger, Moment

# As fractions of the object's size.
_FINGER, _CONE, _LONGEST = 0.08, 0.13, 0.45
# With it the box's sides fill the picture, to 3 %; matplotlib enlarges every box by 25 / 24.
_WHOLE = sqrt(3) * 24 / 25


@dataclass(frozen=True, eq=False)
class Window:
    """What panels show. view: elevation and azimuth [deg]. middle: (2,) right and up [m]. side: half [m]."""

    view: tuple[float, float]
    middle: Array
    side: float

    @property
    def picture(self) -> Array:
        """(2, 3) unit vectors in space, to the right and up in the picture."""
        return projection(*self.view)

    def flat(self, point: Array) -> Array:
        """(2,) where a point is seen, from the middle [m]."""
        result: Array = self.picture @ point - self.middle
        return result

    def place(self, right: float, up: float) -> Array:
        """(3,) a point seen at fractions of the side from the middle."""
        result: Array = (self.middle + self.side * np.array([right, up])) @ self.picture
        return result

    def show(self, ax: Any) -> None:
        """Let axes without a box show the window."""
        ax.set_axis_off()
        ax.patch.set_visible(False)  # it would hide words that reach in from the next panel
        ax.view_init(*self.view)
        low, high = self.place(0, 0) - self.side, self.place(0, 0) + self.side
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        ax.set_box_aspect((1, 1, 1), zoom=_WHOLE)


class SpaceStage:
    """What every moment of a plan is drawn with: the solid, and scales that fit all of it."""

    def __init__(self, steps: Sequence[Transition], mesh: Triangles | None, heads: float = 9.0) -> None:
        points = np.concatenate([step.grasp.positions for step in steps])
        self.mesh, self.heads = _hull(points) if mesh is None else mesh, heads
        self.edges = np.empty((0, 2, 3)) if mesh is None else creases(mesh)
        if mesh is not None:
            points = np.concatenate([points, mesh[0]])
        self.radius = float(np.linalg.norm(points, axis=1).max()) or 1.0
        self.size = 2 * self.radius
        forces = [step.forces(np.linspace(0, step.duration, 33))[..., :3] for step in steps]
        loads = [float(np.linalg.norm(step.load(0.0)[:3])) for step in steps]
        self.longest = max(*loads, *(float(np.linalg.norm(f, axis=-1).max()) for f in forces))
        self.scale = _LONGEST * self.size / (self.longest or 1.0)

    def window(self, moments: Sequence[Moment], view: tuple[float, float]) -> Window:
        """The least square of the picture in which all of these moments lie."""
        solid = np.zeros((1, 3)) if self.mesh is None else self.mesh[0]
        shown = [solid @ moment.turn.T for moment in moments]
        for moment in moments:
            ends = [(f.at, self.tip(f), f.at + self.scale * f.force) for f in moment.fingers]
            shown += [np.array([self.scale * moment.load]), *map(np.array, ends)]
        flat = np.concatenate(shown) @ projection(*view).T
        low, high = flat.min(axis=0), flat.max(axis=0)
        return Window(view, (low + high) / 2, float((high - low).max()) / 2)

    def draw(self, ax: Any, moment: Moment) -> None:
        """The object, its load, the fingers with their cones, and forces with their tails at the contacts."""
        if self.mesh is not None:
            vertices, faces = self.mesh
            draw_mesh(ax, (vertices @ moment.turn.T, faces), self.edges @ moment.turn.T)
        dot(ax, np.zeros(3), gid="centre of mass", color="white", markeredgecolor=INK, markersize=4)
        if moment.load.any():
            self._arrow(ax, np.zeros(3), moment.load, "load", INK)
        for finger in moment.fingers:
            self._finger(ax, finger)

    def tip(self, finger: Finger) -> Array:
        """(3,) the outer end of a finger in the world frame [m]."""
        return finger.at if finger.normal is None else finger.at - _FINGER * self.size * finger.normal

    def _finger(self, ax: Any, finger: Finger) -> None:
        number, colour = finger.number, PALETTE[finger.number % len(PALETTE)]
        if finger.normal is None:
            dot(ax, finger.at, gid=f"idle {number}", color="white", markeredgecolor=colour, markersize=7)
            return
        if finger.half_angle:
            side, angle = _CONE * self.size, finger.half_angle
            vertices, faces = cone(finger.at, finger.normal, side * cos(angle), side * sin(angle), 20)
            surface = Poly3DCollection(
                vertices[faces], facecolor=colour, edgecolor="none", alpha=0.13, zorder=2
            )
            surface.set_gid(f"cone {number}")
            ax.add_collection3d(surface)
        stick = np.array([self.tip(finger), finger.at])
        look: dict[str, Any] = {"solid_capstyle": "round", "zorder": 4}
        ax.plot(*stick.T, gid=f"finger {number}", color=colour, linewidth=4.0, **look)
        if np.linalg.norm(finger.force) * self.scale > 1e-3 * self.size:
            self._arrow(ax, finger.at, finger.force, f"force {number}", colour)
        else:
            ax.plot(*stick.T, gid=f"light {number}", color="white", linewidth=2.0, **look)

    def _arrow(self, ax: Any, tail: Array, force: Array, gid: str, colour: str) -> None:
        head = tail + self.scale * force
        arrow3d(ax, tail, head, gid=gid, color=colour, zorder=5, mutation_scale=self.heads)


def _hull(points: Array) -> Triangles | None:
    """Of all contacts, which suggests an object that is not known; None if they lie in a plane."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return points, ConvexHull(points).simplices.astype(np.intp)
    except QhullError:
        return None


def measures(ax: Any, stage: SpaceStage, window: Window, units: Units) -> None:
    """The world's axes and a bar of a round length, in the lower corners of a panel."""
    _triad(ax, window.place(-0.8, -0.78), 0.25 * window.side, window.view)
    length = round_below(0.3 * stage.size)
    right, up = window.picture
    end = window.place(0.95, -0.93)
    ax.plot(*np.array([end - length * right, end]).T, color=INK, linewidth=1.5, gid="bar")
    middle, text = end - 0.5 * length * right, quantity(length, units.length)
    write(ax, text, middle, up, 0.03 * window.side, gid="length")


def _triad(ax: Any, at: Array, length: float, view: tuple[float, float]) -> None:
    """The axes of the world as three short arrows with their names."""
    picture = projection(*view)
    for name, axis in zip("xyz", np.eye(3), strict=True):
        arrow3d(ax, at, at + length * axis, gid=f"axis {name}", color=INK, linewidth=0.8, mutation_scale=5)
        seen = np.hypot(*(picture @ axis)) > 0.1
        away = at + 1.3 * length * axis if seen else at - 0.4 * length * picture.sum(axis=0)
        ax.text(*away, f"${name}$", fontsize=6.5, ha="center", va="center", gid=f"name {name}", zorder=6)
