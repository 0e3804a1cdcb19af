"""A motion in space as a screw: an axis, and how far the motion goes along it while it turns (Chasles)."""

from dataclasses import dataclass
from math import hypot, inf, sqrt

import numpy as np
from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, number, read_only
from regrasp.mechanics.value import ArrayValue

# Against the speed, a turn this slow over the whole object is rounding: the motion is a translation.
_NO_TURN = 1e-9


@dataclass(frozen=True, eq=False)
class Screw(ArrayValue):
    """An axis of motion in space.

    point: (3,) of the axis nearest to the centre of mass [m]; the centre of mass for a translation.
    direction: (3,), unit: the object turns about it in the right-handed sense, or is translated along it.
    pitch: way along the axis for each radian of the turn [m/rad]; infinite for a translation.
    """

    point: Array
    direction: Array
    pitch: float

    @classmethod
    def of(cls, twist: ArrayLike, size: float) -> "Screw":
        """The screw of a twist (6,): velocity of the centre of mass, then angular velocity, not both zero.

        size: of the object [m], by which a turn is told from rounding.
        Raises ``InvalidInput`` for a twist that is no motion.
        """
        both = array(twist, "twist", (6,))
        number(size, "size", above=0)
        v, omega = both[:3], both[3:]
        speed, spin = hypot(*v), hypot(*omega)
        if speed == spin == 0:
            raise InvalidInput("a twist of zeros has no screw: the object does not move")
        if spin * size <= _NO_TURN * speed:
            return cls(read_only(np.zeros(3)), read_only(v / speed), inf)
        axis = omega / spin
        point = np.cross(axis, v) / spin  # omega x v / |omega|^2
        pitch = float(axis @ v) / spin  # omega . v / |omega|^2
        return cls(read_only(point), read_only(axis), pitch)

    @property
    def turns(self) -> bool:
        """Whether the motion turns the object; otherwise it is a translation."""
        return self.pitch != inf

    def moved(self, points: Array, amount: float) -> Array:
        """Points (m, 3) after the object turned by ``amount`` [rad], or slid by it [m]."""
        if not self.turns:
            slid: Array = points + amount * self.direction
            return slid
        arms, n = points - self.point, self.direction
        along = arms @ n
        across = arms - np.multiply.outer(along, n)
        turned = np.cos(amount) * across + np.sin(amount) * np.cross(n, across)  # Rodrigues
        result: Array = self.point + turned + np.multiply.outer(along + self.pitch * amount, n)
        return result

    def amount_for(self, points: Array, way: float) -> float:
        """The amount of motion in which the fastest of points goes ``way`` [m]; a quarter turn at most."""
        if not self.turns:
            return way
        arms = np.cross(self.direction, points - self.point)
        fastest = sqrt(float((arms**2).sum(axis=-1).max()) + self.pitch**2)
        return min(way / fastest, np.pi / 2) if fastest else np.pi / 2
