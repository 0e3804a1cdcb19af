"""A transition while the object turns: closed-form pieces between states at chosen angles."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from regrasp.closed_form.turning_path import (
    arc_path,
    arc_peaks,
    arc_slope,
    turning_path,
    turning_peaks,
    turning_slope,
)
from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.mechanics.rotated_loads import still_part
from regrasp.mechanics.value import numbers
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition
from regrasp.plans.turn import Turn


@dataclass(frozen=True, eq=False, repr=False)
class TurningTransition(Transition):
    """Finger forces, in the object frame, while the object turns under a load that stays in the world.

    Between the angles of ``turn`` the forces are a f_k + b f_k+1 with a, b >= 0, or with a middle state where
    a part of the load does not turn (docs/facts.md, 6), which keeps equilibrium and cones exactly. The
    object's angle is turn.angle (1 - T(t)), about the centre of mass and in space about ``turn.axis``.
    """

    turn: Turn = field(kw_only=True)

    def _check(self) -> None:
        if self.turn.forces.shape[1:] != self.start.forces.shape:
            n, d = self.start.forces.shape
            raise InvalidInput(f"forces of a turn must have shape (K, {n}, {d})")
        still = still_part(self.start.load, self.turn.axis)
        if still is not None and self.turn.middles is None:
            raise InvalidInput(
                f"a part of the load, {still!r}, does not turn: middles are needed, states between angles"
            )

    def orientation(self, t: ArrayLike) -> Array:
        """The object's angle from the start [rad], counter-clockwise or about the axis; of the shape of t."""
        result: Array = self.turn.angle * (1 - self.scaling(t))
        return result

    def rotations(self, t: ArrayLike) -> Array:
        """(3, 3) or (m, 3, 3) matrices from the turned object's frame to its frame at the start; in space."""
        axis = self.turn.axis
        if axis is None:
            raise InvalidInput("an object in the plane turns by an angle; ask for orientation(t)")
        theta = self.orientation(t)
        matrices = [rotation_matrix(axis, angle) for angle in theta.ravel().tolist()]
        return np.reshape(matrices, (*theta.shape, 3, 3))

    def forces(self, t: ArrayLike) -> Array:
        """Finger forces in the object frame, (n, 2) at a time, (m, n, 2) at m times [N]."""
        return self._along(turning_path, arc_path, t)

    def wrenches(self, t: ArrayLike) -> Array:
        """Finger wrenches (n, 3) or (m, n, 3), object frame [N, N m]; (…, 6) in space."""
        return self.grasp.wrenches(self.forces(t))

    def load(self, t: ArrayLike) -> Array:
        """The load (3,) or (m, 3) in the object frame [N, N m]; (…, 6) in space."""
        load, axis, theta = self.start.load, self.turn.axis, self.orientation(t)
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

    def rates(self, t: ArrayLike) -> Array:
        """Force rates in the object frame, (n, 2) or (m, n, 2) [N/s]."""
        speed = -self.turn.angle * self.scaling.velocity(t)
        result: Array = speed[..., None, None] * self._along(turning_slope, arc_slope, t)
        return result

    @property
    def load_varies(self) -> bool:
        """Whether the load is not the same at every instant: it turns."""
        return True

    @property
    def peak(self) -> float:
        """The largest |f_i| on the way, exact [N]; of soft fingers |(f, mu m / torsion)|.

        At most 1 / cos(step / 2) times that of ``turn.forces``; with middles at most the largest of all.
        """
        return float(self.peaks.max())

    @property
    def peaks(self) -> Array:
        """(n,) the largest |f_i| of each finger on the way, exact [N]."""
        result: Array = self._peaks[:, :, 0].max(axis=0)
        return result

    @property
    def steepest(self) -> Array:
        """(n,) at least the fastest change of each force, max |df/dtheta| max |theta'(t)| [N/s]."""
        result: Array = self._peaks[:, :, 1].max(axis=0) * abs(self.turn.angle) * self.scaling.steepest
        return result

    @cached_property
    def _peaks(self) -> Array:
        """(K - 1, n, 2) the largest |f_i| [N] and |df_i/dtheta| [N/rad] of each piece."""
        cones, middles = self.grasp.cones, self.turn.middles
        measured = cones.measured(self.turn.forces)
        f, g = measured[:-1], measured[1:]
        if middles is not None:
            between = cones.measured(middles)
            pieces = zip(f, between, g, np.diff(self.turn.angles).tolist(), strict=True)
            return np.array(
                [[arc_peaks(*force, step) for force in zip(a, c, b, strict=True)] for a, c, b, step in pieces]
            )
        steps = np.diff(self.turn.angles).tolist()
        return np.array(
            [
                [turning_peaks(a, b, step) for a, b in zip(*piece, strict=True)]
                for *piece, step in zip(f, g, steps, strict=True)
            ]
        )

    def fastest(self, rate_limit: ArrayLike) -> Transition:
        """The same turn and shape in the least time with |f_i'(t)| <= rate_limit, to a bound [N/s].

        rate_limit: a number or (n,). The bound is that of ``steepest``.
        """
        change = (self.steepest / self.scaling.steepest)[:, None]
        return self.retimed(TimeScaling.fastest(change, rate_limit, self.scaling))

    def _along(self, path: Callable[..., Array], arc: Callable[..., Array], t: ArrayLike) -> Array:
        """The closed form of one piece, without or with a middle state, at times on all pieces."""
        theta, turn = self.orientation(t), self.turn
        flat, sign = theta.ravel(), float(np.sign(turn.angle))
        piece = np.searchsorted(sign * turn.angles, sign * flat, side="right") - 1
        piece = np.clip(piece, 0, turn.angles.size - 2)
        result = np.empty((flat.size, *self.start.forces.shape))
        for k in np.unique(piece):
            here = piece == k
            step = float(turn.angles[k + 1] - turn.angles[k])
            ends, at = (turn.forces[k], turn.forces[k + 1]), flat[here] - turn.angles[k]
            if turn.middles is None:
                result[here] = path(*ends, step, at)
            else:
                result[here] = arc(ends[0], turn.middles[k], ends[1], step, at)
        return result.reshape(*theta.shape, *self.start.forces.shape)

    def _deciding_forces(self) -> Array:
        turn = self.turn
        return turn.forces if turn.middles is None else np.concatenate([turn.forces, turn.middles])

    def _load_in_words(self) -> str:
        about = "" if self.turn.axis is None else f" about {numbers(self.turn.axis)}"
        return f"{self.start.load!r}, turning the object by {np.degrees(self.turn.angle):.6g} deg{about}"

    def _path_in_words(self) -> list[str]:
        return [f"{self.turn.angles.size - 1} pieces in closed form, largest force {self.peak:.4g}"]

    def _reversed(self, **changes: Any) -> "TurningTransition":
        return replace(self, turn=self.turn.reversed(), **changes)
