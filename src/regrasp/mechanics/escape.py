"""Why a grasp cannot hold: the motion along which the object escapes (a Farkas certificate)."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import hypot, inf, isqrt

import numpy as np

from regrasp.mechanics.checks import Array, array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.mechanics.wrench import Wrench

# Forces this many times the load hold nothing: they follow from rounding in somebody's coordinates.
NEVER = 1e9


@dataclass(frozen=True, eq=False, repr=False)
class EscapeTwist(ArrayValue):
    """A small motion of the object on which the load does more work than the contacts can oppose.

    twist: (3,) in the plane, (6,) in space: velocity of the centre of mass, then angular velocity.
    frictions, limits: (n,) friction coefficients and force limits [N] it was found for.

    Were G f = -w_ext, then twist . G f = -twist . w_ext < 0; but finger i moves with v_i = v + omega x r_i
    and forces in its cone cannot do work below -limit_i * opposition_i. ``is_proof`` decides this in exact
    rational arithmetic on the numbers stored here.
    """

    grasp: Grasp
    load: Wrench
    twist: Array
    frictions: tuple[float, ...]
    limits: tuple[float, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "twist", array(self.twist, "twist", self.load.vector.shape))

    @cached_property
    def velocities(self) -> Array:
        """(n, d) velocity of the object at each contact, v + omega x r_i."""
        moved: Array = self.grasp.matrix.T @ self.twist
        return moved.reshape(len(self.grasp), self.grasp.dimension)

    @cached_property
    def load_power(self) -> float:
        """Work of the load along the motion, twist . w_ext."""
        return float(_dot(_exact(self.twist), _exact(self.load.vector)))

    @cached_property
    def oppositions(self) -> tuple[float, ...]:
        """For each contact the most work against the motion that one newton in its cone can do; 0: none."""
        return tuple(float(o) for o in self._oppositions)

    @cached_property
    def least_force(self) -> float:
        """Forces that hold the load would have to sum to at least this [N]; infinite when none can hold."""
        power = _dot(_exact(self.twist), _exact(self.load.vector))
        free = Fraction(0)
        for opposition, limit in zip(self._oppositions, self.limits, strict=True):
            if limit == inf:
                free = max(free, opposition)
            else:
                power -= Fraction(limit) * opposition
        if power <= 0:
            return 0.0
        return inf if free == 0 else float(power / free)

    @property
    def is_proof(self) -> bool:
        """Whether no forces within cones and limits, and below 1e9 times the load, balance the load."""
        load = hypot(*self.load.force) + hypot(*self.load.torque) / (self.grasp.size or 1.0)
        return self.least_force > NEVER * load

    @property
    def centre(self) -> Array | None:
        """Centre of rotation (2,) [m] in the plane; None where the motion is a translation, or in space."""
        if self.grasp.dimension == 3:
            return None
        vx, vy, omega = self.twist
        if omega == 0 or abs(omega) * self.grasp.size < 1e-9 * hypot(vx, vy):
            return None
        return np.array([-vy / omega, vx / omega]) + 0.0  # -0 reads as 0

    def __str__(self) -> str:
        d = self.grasp.dimension
        velocity, spin = self.twist[:d], self.twist[d:]
        if d == 3:
            return f"moving with velocity {numbers(velocity)} and angular velocity {numbers(spin)}"
        if self.centre is None:
            return f"sliding along {numbers(_without_noise(velocity / hypot(*velocity), 1.0))}"
        turn = "clockwise" if spin[0] < 0 else "counter-clockwise"
        return f"turning {turn} about {numbers(_without_noise(self.centre, self.grasp.size))}"

    def __repr__(self) -> str:
        return f"EscapeTwist({self})"

    @cached_property
    def _oppositions(self) -> tuple[Fraction, ...]:
        """Upper bounds, exact rationals, zero exactly where a contact cannot oppose at all.

        Pushing with 1 N against v = v_n n + v_t t does the work (mu |v_t| - v_n) / sqrt(1 + mu^2) on the
        nearer edge of the cone, or |v| where -v lies inside the cone. At most |v_n| + |v_t| mu, scaled by n.
        """
        d, twist = self.grasp.dimension, _exact(self.twist)
        columns = [_exact(column) for column in self.grasp.matrix.T]
        result = []
        for i, (normal, mu_float) in enumerate(zip(self.grasp.normals, self.frictions, strict=True)):
            v = [_dot(twist, column) for column in columns[i * d : i * d + d]]
            n, mu = _exact(normal), Fraction(mu_float)
            nn, vn, vv = _dot(n, n), _dot(v, n), _dot(v, v)
            tangential = vv * nn - vn * vn  # |v_t|^2 |n|^2
            if vn <= 0 and tangential <= mu * mu * vn * vn:
                result.append(_sqrt_above(vv))
            elif vn >= 0 and mu * mu * tangential <= vn * vn:
                result.append(Fraction(0))
            else:
                result.append((mu * _sqrt_above(tangential) - vn) * _sqrt_above(1 / (nn * (1 + mu * mu))))
        return tuple(result)


def _without_noise(values: Array, scale: float) -> Array:
    """For printing: zero where a value is rounding beside ``scale``."""
    return np.where(abs(values) < 1e-9 * scale, 0.0, values)


def _exact(values: Array) -> list[Fraction]:
    return [Fraction(value) for value in values.tolist()]


def _dot(a: list[Fraction], b: list[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def _sqrt_above(value: Fraction) -> Fraction:
    """An upper bound of the square root, tight to 2^-100 of it; exactly 0 for 0."""
    if value == 0:
        return Fraction(0)
    shift = max(0, 200 - (value.numerator.bit_length() - value.denominator.bit_length()))
    shift += shift % 2
    return Fraction(isqrt((value.numerator << shift) // value.denominator) + 1, 1 << (shift // 2))
