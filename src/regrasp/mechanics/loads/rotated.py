"""A load as seen from an object that turns."""

from math import cos

from regrasp.mechanics.checks import Array
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.mechanics.wrench import Wrench

# A part of the load that does not turn below this fraction of it is rounding of the axis.
_STILL = 2.0**-44


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
