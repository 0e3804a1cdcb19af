"""Wrenches: a force and its torque about the centre of mass."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import cos, sin
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics import checks
from regrasp.mechanics.checks import Array, ArrayLike, array, number, point
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue, numbers


def torque(position: ArrayLike, force: ArrayLike) -> Array:
    """Tau = r x f about the origin: r_x f_y - r_y f_x, shape (..., 1), in the plane; (..., 3) in space."""
    r, f = np.asarray(position, dtype=float), np.asarray(force, dtype=float)
    if r.shape[-1] == 2:
        planar: Array = r[..., :1] * f[..., 1:] - r[..., 1:] * f[..., :1]
        return planar
    return np.cross(r, f)


@dataclass(frozen=True, eq=False, repr=False)
class Wrench(ArrayValue):
    """A force and a torque on the object, about the centre of mass.

    Wrenches add, subtract, negate and scale. As a load, equilibrium is G f + w_ext = 0.

    Args:
        force: (d,) [N], object frame.
        torque: [N m], a number in the plane, (3,) in space; zero unless given.

    Raises:
        InvalidInput: For wrong shapes and numbers that are not finite.
    """

    vector: Array
    """(3,) in the plane, (6,) in space: force, then torque."""

    def __init__(self, force: ArrayLike, torque: ArrayLike | None = None) -> None:
        f = point(force, "force")
        size = 1 if f.size == 2 else 3
        if torque is None:
            tau: Array = np.zeros(size)
        elif size == 1:
            tau = np.array([number(torque, "torque")])
        else:
            tau = array(torque, "torque", (3,))
        vector = np.concatenate([f, tau])
        vector.setflags(write=False)
        object.__setattr__(self, "vector", vector)

    @classmethod
    def from_vector(cls, vector: ArrayLike) -> "Wrench":
        """The wrench (force, torque) given as one vector, (3,) in the plane or (6,) in space.

        Args:
            vector: (3,) in the plane or (6,) in space: force [N], then torque [N m].
        """
        w = array(vector, "wrench", (None,))
        if w.size not in (3, 6):
            raise InvalidInput(f"a wrench must have 3 (plane) or 6 (space) numbers, got {w.size}")
        return cls(w[:2], float(w[2])) if w.size == 3 else cls(w[:3], w[3:])

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return 2 if self.vector.size == 3 else 3

    @property
    def force(self) -> Array:
        """(d,) [N]."""
        return self.vector[: self.dimension]

    @property
    def torque(self) -> Array:
        """(1,) in the plane, (3,) in space [N m]."""
        return self.vector[self.dimension :]

    @cached_property
    def plain(self) -> tuple[float, ...]:
        """(force, torque) as plain floats, the way the closed forms take a load."""
        return tuple(self.vector.tolist())

    def rotated(self, rotation: ArrayLike) -> "Wrench":
        """The wrench turned about the centre of mass.

        Args:
            rotation: an angle [rad], counter-clockwise, in the plane; a (3, 3) rotation matrix in space.
        """
        if self.dimension == 2:
            angle = number(rotation, "rotation")
            c, s = cos(angle), sin(angle)
            fx, fy = self.force
            return Wrench([c * fx - s * fy, s * fx + c * fy], float(self.torque[0]))
        matrix = checks.rotation(rotation, "rotation")
        return Wrench(matrix @ self.force, matrix @ self.torque)

    def _with(self, other: object, combine: Callable[[Array, Array], Array]) -> "Wrench":
        if not isinstance(other, Wrench):
            raise InvalidInput(f"a wrench combines with a wrench, got {shown(other)}")
        if other.dimension != self.dimension:
            raise InvalidInput("a planar wrench and a wrench in space cannot be combined")
        with np.errstate(over="ignore"):  # what is not finite is refused
            return Wrench.from_vector(combine(self.vector, other.vector))

    def __add__(self, other: object) -> "Wrench":
        return self._with(other, np.add)

    def __sub__(self, other: object) -> "Wrench":
        return self._with(other, np.subtract)

    def __neg__(self) -> "Wrench":
        return Wrench.from_vector(-self.vector)

    def __mul__(self, factor: float) -> "Wrench":
        with np.errstate(over="ignore"):
            return Wrench.from_vector(number(factor, "factor") * self.vector)

    __rmul__ = __mul__

    def __truediv__(self, divisor: float) -> "Wrench":
        by = number(divisor, "divisor")
        if by == 0:
            raise InvalidInput("a wrench cannot be divided by 0")
        with np.errstate(over="ignore"):
            return Wrench.from_vector(self.vector / by)

    def to_dict(self) -> dict[str, Any]:
        """The wrench as plain data, which JSON can hold; ``from_dict`` gives back the equal wrench."""
        torque = self.torque.tolist()
        return {"force": self.force.tolist(), "torque": torque if self.dimension == 3 else torque[0]}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Wrench":
        """The wrench of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``Wrench`` does.
        """
        return cls(**entries(data, "a wrench", ("force",), ("torque",)))

    def __repr__(self) -> str:
        shown = numbers(self.torque) if self.dimension == 3 else f"{self.torque[0] + 0.0:.6g}"
        return f"Wrench(force={numbers(self.force)}, torque={shown})"
