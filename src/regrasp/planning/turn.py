"""States on the way of a turning object."""

from dataclasses import dataclass
from math import cos, hypot, pi, sin

import numpy as np
from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, read_only
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench

# A part of the load that does not turn below this fraction of it is rounding of the axis.
_STILL = 2.0**-44
_UNIT = 2.0**-51


@dataclass(frozen=True, eq=False)
class Turn(ArrayValue):
    """States on the way of a turn.

    angles: (K,) of the object [rad], from 0 to the whole turn, each step below pi; counter-clockwise in the
    plane, right-handed about ``axis`` in space.
    forces: (K, n, d) in equilibrium at these angles, in the object frame [N].
    axis: (3,) unit, through the centre of mass, in space; None in the plane.
    middles: (K - 1, n, d) [N] under the load where the tangents of its arc at two angles meet; None where all
    of the load turns and the states at the angles are enough (docs/facts.md, 6).
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
            raise InvalidInput(f"angles of a turn must go one way from 0 in steps below pi, got {angles!r}")
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

    def reversed(self) -> "Turn":
        """The same, run backwards, counted from its own start."""
        middles = None if self.middles is None else self.middles[::-1]
        return Turn(self.angles[::-1] - self.angles[-1], self.forces[::-1], self.axis, middles)


def unit_axis(axis: ArrayLike) -> Array:
    """A direction (3,) of any length, as a unit vector."""
    direction = array(axis, "axis", (3,))
    largest = float(abs(direction).max())
    if largest == 0:
        raise InvalidInput("axis must not be zero; give the direction about which the object turns")
    if abs(hypot(*direction) - 1) <= _UNIT:  # one made a unit vector before keeps its every bit
        return direction
    direction = direction / largest
    return read_only(direction / hypot(*direction))


def rotation_matrix(axis: ArrayLike, angle: float) -> Array:
    """(3, 3) right-handed rotation by ``angle`` [rad] about a unit ``axis`` (Rodrigues)."""
    x, y, z = np.asarray(axis, dtype=float)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix: Array = np.eye(3) + sin(angle) * cross + 2 * sin(angle / 2) ** 2 * (cross @ cross)
    return matrix


def turned_load(load: Wrench, angle: float, axis: Array | None = None) -> Wrench:
    """The load seen from an object that turned by ``angle`` [rad]: it turns the other way.

    axis: (3,) unit, in space; None in the plane.
    """
    return load.rotated(-angle if axis is None else rotation_matrix(axis, -angle))


def still_part(load: Wrench, axis: Array | None = None) -> Wrench | None:
    """What of the load does not turn: its torque in the plane, what lies along the axis in space; or None."""
    if axis is None:
        return Wrench([0.0, 0.0], float(load.torque[0])) if load.torque.any() else None
    force, torque = (axis @ load.force) * axis, (axis @ load.torque) * axis
    still = [
        abs(part).max() > _STILL * abs(whole).max()
        for part, whole in ((force, load.force), (torque, load.torque))
    ]
    return Wrench(force, torque) if any(still) else None


def load_between(load: Wrench, first: float, second: float, axis: Array | None = None) -> Wrench:
    """The load where the tangents of its arc at two angles [rad] meet: its turning part grown by 1 / cos."""
    middle = turned_load(load, (first + second) / 2, axis)
    still, stretch = still_part(load, axis), cos((second - first) / 2)
    return middle / stretch if still is None else still + (middle - still) / stretch
