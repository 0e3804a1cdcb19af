"""Axes and rotation matrices."""

from math import hypot, sin

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, array, read_only

_UNIT = 2.0**-51


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
