"""States on the way of a turning object."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array
from regrasp.mechanics.orientation.rotations import unit_axis
from regrasp.mechanics.value import ArrayValue


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
