"""States on the way of a turning object."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench


@dataclass(frozen=True, eq=False)
class Turn(ArrayValue):
    """States on the way of a turn.

    angles: (K,) of the object [rad], counter-clockwise, from 0 to the whole turn, each step below pi.
    forces: (K, n, 2) in equilibrium at these angles, in the object frame [N].
    """

    angles: Array
    forces: Array

    def __init__(self, angles: ArrayLike, forces: ArrayLike) -> None:
        turned = array(angles, "angles of a turn", (None,))
        steps = np.diff(turned)
        one_way = bool((steps > 0).all() or (steps < 0).all())
        if turned.size < 2 or turned[0] != 0 or not one_way or abs(steps).max() >= pi:
            raise InvalidInput(f"angles of a turn must go one way from 0 in steps below pi, got {angles!r}")
        object.__setattr__(self, "angles", turned)
        object.__setattr__(self, "forces", array(forces, "forces of a turn", (turned.size, None, 2)))

    @property
    def angle(self) -> float:
        """The whole turn [rad]."""
        return float(self.angles[-1])

    def reversed(self) -> "Turn":
        """The same, run backwards, counted from its own start."""
        return Turn(self.angles[::-1] - self.angles[-1], self.forces[::-1])


def turned_load(load: Wrench, angle: float) -> Wrench:
    """The load seen from an object that turned by ``angle`` [rad]: it turns the other way."""
    return load.rotated(-angle)
