"""A path while the object turns: closed-form pieces between states at chosen angles."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi

import numpy as np

from regrasp.closed_form.arc_friction import arc_friction_angles, arc_in_waves
from regrasp.closed_form.turning_path import (
    arc_path,
    arc_peaks,
    arc_slope,
    row_crests,
    turning_path,
    turning_peaks,
    turning_slope,
)
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.rotated import still_part
from regrasp.mechanics.orientation.rotations import rotation_matrix, unit_axis
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.plans.path import Path, needed_by
from regrasp.plans.timing import TimeScaling


@dataclass(frozen=True, eq=False)
class TurningPath(ArrayValue, Path):
    """Forces, in the object frame, while the object turns under a load that stays in the world.

    Between the angles they are a f_k + b f_k+1 with a, b >= 0, or with a middle state where a part of the
    load does not turn (docs/facts.md, 6), which keeps equilibrium and cones exactly. The object's angle is
    angle (1 - T(t)), about the centre of mass and in space about ``axis``.

    Args:
        angles: (K,) of the object [rad], from 0 to the whole turn, each step below pi; counter-clockwise in
            the plane, right-handed about ``axis`` in space.
        forces: (K, n, w) in equilibrium at these angles, in the object frame [N].
        axis: (3,) unit, through the centre of mass, in space; None in the plane.
        middles: (K - 1, n, w) [N] under the load where the tangents of its arc at two angles meet; None where
            all of the load turns and the states at the angles are enough.
    """

    angles: Array
    forces: Array
    axis: Array | None = None
    middles: Array | None = None

    def __init__(
        self,
        angles: ArrayLike,
        forces: ArrayLike,
        axis: ArrayLike | None = None,
        middles: ArrayLike | None = None,
    ) -> None:
        turned = array(angles, "angles of a turn", (None,))
        steps = np.diff(turned)
        one_way = bool((steps > 0).all() or (steps < 0).all())
        if turned.size < 2 or turned[0] != 0 or not one_way or abs(steps).max() >= pi:
            raise InvalidInput(
                f"angles of a turn must go one way from 0 in steps below pi, got {shown(angles)}"
            )
        held = array(forces, "forces of a turn", (turned.size, None, None))
        between = None if middles is None else (turned.size - 1, *held.shape[1:])
        object.__setattr__(self, "angles", turned)
        object.__setattr__(self, "forces", held)
        object.__setattr__(self, "axis", None if axis is None else unit_axis(axis))
        object.__setattr__(
            self,
            "middles",
            None if between is None else array(middles, "middles of a turn", between),  # type: ignore[arg-type]
        )

    @property
    def angle(self) -> float:
        """The whole turn [rad]."""
        return float(self.angles[-1])

    def check(self, start: GraspState, end: GraspState, scaling: TimeScaling) -> None:
        """Raise ``InvalidInput`` for forces of another shape, or middles that are missing.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            scaling: the clock of the transition.
        """
        if self.forces.shape[1:] != start.forces.shape:
            n, d = start.forces.shape
            raise InvalidInput(f"forces of a turn must have shape (K, {n}, {d})")
        still = still_part(start.load, self.axis)
        if still is not None and self.middles is None:
            raise InvalidInput(
                f"a part of the load, {shown(still)}, does not turn: middles are needed, states "
                "between angles"
            )

    def forces_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """Finger forces (..., n, w), object frame [N].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        return self._along(turning_path, arc_path, u)

    def rates_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """(..., n, w) the change of the forces by u [N].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        return -self.angle * self._along(turning_slope, arc_slope, u)

    @property
    def load_varies(self) -> bool:
        """Whether the load is not the same at every instant: it turns."""
        return True

    def load_at(self, start: GraspState, u: Array) -> Array:
        """The load (..., 3) or (..., 6), object frame [N, N m].

        Args:
            start: the state at the start, of every contact in play.
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        load, axis, theta = start.load, self.axis, self.orientation_at(u)
        c, s = np.cos(theta)[..., None], np.sin(theta)[..., None]
        if axis is None:
            fx, fy = load.force
            turned = c * load.force + s * np.array([fy, -fx])
            return np.concatenate([turned, np.broadcast_to(load.torque, c.shape)], axis=-1)
        parts = []
        for vector in (load.force, load.torque):
            still = (axis @ vector) * axis
            parts.append(still + c * (vector - still) - s * np.cross(axis, vector))
        return np.concatenate(parts, axis=-1)

    def orientation_at(self, u: Array) -> Array:
        """The object's angle from the start (...) [rad], counter-clockwise or about the axis.

        Args:
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        result: Array = self.angle * (1 - u)
        return result

    def rotations_at(self, u: Array) -> Array:
        """(..., 3, 3) from the turned object's frame to its frame at the start; in space.

        Args:
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        if self.axis is None:
            raise InvalidInput("an object in the plane turns by an angle; ask for orientation(t)")
        theta = self.orientation_at(u)
        matrices = [rotation_matrix(self.axis, angle) for angle in theta.ravel().tolist()]
        return np.reshape(matrices, (*theta.shape, 3, 3))

    def steepest(self, start: GraspState, end: GraspState) -> Array:
        """(n,) at least the fastest change of each force by u [N].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        result: Array = self._extremes(start)[:, :, 1].max(axis=0) * abs(self.angle)
        return result

    def deciding(self, start: GraspState, end: GraspState) -> Array:
        """(m, n, w) the states at the angles, and those between.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        return self.forces if self.middles is None else np.concatenate([self.forces, self.middles])

    def peaks(self, start: GraspState, end: GraspState) -> Array:
        """(n,) the largest |f_i| of each finger on the way, exact [N].

        At most 1 / cos(step / 2) times that of ``forces``; with middles at most the largest of all.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        largest: Array = self._extremes(start)[:, :, 0].max(axis=0)
        return largest

    def spare(self, start: GraspState, end: GraspState) -> Array:
        """(n,) the least by which each finger keeps its linear limits on the way [N]; infinite without any.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        rows = start.grasp.limit_rows
        if rows is None:
            return np.full(len(start.grasp), inf)
        states = start.grasp.cones.measured(self.deciding(start, end))
        least: Array = rows.spare(states).min(axis=0)
        if self.middles is not None:  # the forces between are means of those
            return least
        each = np.einsum("mw,kmw->km", rows.rows, states[:, rows.contacts])
        crests = row_crests(each[:-1], each[1:], np.diff(self.angles)[:, None]).max(axis=0)
        return np.minimum(least, rows.least(rows.bounds - crests))

    def friction_needed(self, start: GraspState, end: GraspState) -> Array:
        """(n,) the least coefficient of each finger that keeps its forces on the path inside its cone [-].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        if self.middles is None:  # the forces between are sums of those at the angles
            return super().friction_needed(start, end)
        states = [self.forces]
        for k, step in enumerate(np.diff(self.angles).tolist()):
            ends = self.forces[k], self.middles[k], self.forces[k + 1]
            x = _most_friction(start.grasp, *arc_in_waves(*ends, step))
            inside = np.clip(x, -abs(step) / 2, abs(step) / 2)
            states.append(arc_path(*ends, step, inside + step / 2))
        return needed_by(start.grasp, np.concatenate(states))

    def reversed(self) -> "TurningPath":
        """The same, run backwards, counted from its own start."""
        middles = None if self.middles is None else self.middles[::-1]
        return TurningPath(self.angles[::-1] - self.angles[-1], self.forces[::-1], self.axis, middles)

    def load_in_words(self, start: GraspState, end: GraspState) -> str:
        """Under what load it leads.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        about = "" if self.axis is None else f" about {numbers(self.axis)}"
        return f"{start.load!r}, turning the object by {np.degrees(self.angle):.6g} deg{about}"

    def in_words(self, start: GraspState, end: GraspState, by: str, objective: str | None) -> list[str]:
        """How many pieces, and the largest force.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            by: who planned the path.
            objective: what it was planned for, or None.
        """
        peak = float(self.peaks(start, end).max())
        return [f"{self.angles.size - 1} pieces in closed form, largest force {peak:.4g}"]

    def _extremes(self, start: GraspState) -> Array:
        """(K - 1, n, 2) the largest |f_i| [N] and |df_i/dtheta| [N/rad] of each piece."""
        cones, middles = start.grasp.cones, self.middles
        measured = cones.measured(self.forces)
        f, g = measured[:-1], measured[1:]
        steps = np.diff(self.angles).tolist()
        if middles is not None:
            pieces = zip(f, cones.measured(middles), g, steps, strict=True)
            return np.array(
                [[arc_peaks(*force, step) for force in zip(a, c, b, strict=True)] for a, c, b, step in pieces]
            )
        return np.array(
            [
                [turning_peaks(a, b, step) for a, b in zip(*piece, strict=True)]
                for *piece, step in zip(f, g, steps, strict=True)
            ]
        )

    def _along(self, path: Callable[..., Array], arc: Callable[..., Array], u: Array) -> Array:
        """The closed form of one piece, without or with a middle state, at u on all pieces."""
        theta = self.orientation_at(u)
        flat, sign = theta.ravel(), float(np.sign(self.angle))
        piece = np.searchsorted(sign * self.angles, sign * flat, side="right") - 1
        piece = np.clip(piece, 0, self.angles.size - 2)
        shape = self.forces.shape[1:]
        result = np.empty((flat.size, *shape))
        for k in np.unique(piece):
            here = piece == k
            step = float(self.angles[k + 1] - self.angles[k])
            ends, at = (self.forces[k], self.forces[k + 1]), flat[here] - self.angles[k]
            if self.middles is None:
                result[here] = path(*ends, step, at)
            else:
                result[here] = arc(ends[0], self.middles[k], ends[1], step, at)
        return result.reshape(*theta.shape, *shape)


def _most_friction(grasp: Grasp, u: Array, v: Array, w: Array) -> Array:
    """Where on an arc any finger may need the most friction: x (m,)."""
    found = [
        arc_friction_angles(u[i], v[i], w[i], contact.normal, contact.torsion)
        for i, contact in enumerate(grasp)
    ]
    return np.concatenate(found)
