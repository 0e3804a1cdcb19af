"""Why a grasp cannot hold: the motion along which the object escapes (a Farkas certificate)."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import hypot, inf

import numpy as np

from regrasp.display import Pictured
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, array, instance, limits, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.opposition import dot, exact, oppositions, surely_wins
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.mechanics.wrench import Wrench

# Forces this many times the load hold nothing: they follow from rounding in somebody's coordinates.
NEVER = 1e9


@dataclass(frozen=True, eq=False, repr=False)
class EscapeTwist(ArrayValue, Pictured):
    """A small motion of the object on which the load does more work than the contacts can oppose.

    Were G f = -w_ext, then twist . G f = -twist . w_ext < 0; but finger i moves with v_i = v + omega x r_i
    and forces in its cone cannot do work below -limit_i * opposition_i. ``is_proof`` decides this in exact
    rational arithmetic on the numbers stored here.

    Args:
        grasp: the contacts that cannot hold.
        load: the load they cannot hold, object frame [N, N m].
        twist: (3,) in the plane, (6,) in space: velocity of the centre of mass, then angular velocity; of any
            length but zero, so work along it is best read per radian or per metre, as ``amount`` measures it.
        frictions: (n,) friction coefficients it was found for [-].
        limits: (n,) force limits it was found for [N].
        row_duals: (m,) what each of the contacts' linear limits a . f <= b (``Grasp.limit_rows``) counts in
            the proof, not negative; none if they are not counted. Forces then do no work below -b . l less
            what the contacts oppose of v + sum l a.
    """

    grasp: Grasp
    load: Wrench
    twist: Array
    frictions: tuple[float, ...]
    limits: tuple[float, ...]
    row_duals: tuple[float, ...] = ()

    _drawn_by = "regrasp.plots.escapes.escape:escape_png"

    def __post_init__(self) -> None:
        instance(self.grasp, "grasp", Grasp)
        instance(self.load, "load", Wrench)
        if self.load.dimension != self.grasp.dimension:
            raise InvalidInput(f"load must have the grasp's dimension {self.grasp.dimension}")
        count = len(self.grasp)
        frictions = array(self.frictions, "frictions", (count,))
        if (frictions < 0).any():
            raise InvalidInput(f"frictions must be at least 0, got {shown(self.frictions)}")
        object.__setattr__(self, "frictions", tuple(frictions.tolist()))
        object.__setattr__(self, "limits", tuple(limits(self.limits, "limits", count).tolist()))
        object.__setattr__(self, "twist", array(self.twist, "twist", self.load.vector.shape))
        rows = self.grasp.limit_rows
        counted = array(self.row_duals, "row_duals", (None,))
        if counted.size not in (0, 0 if rows is None else len(rows.bounds)) or (counted < 0).any():
            raise InvalidInput(
                f"row_duals must be none, or one for each linear limit, at least 0, got "
                f"{shown(self.row_duals)}"
            )
        object.__setattr__(self, "row_duals", tuple(counted.tolist()))
        if not self.twist.any():
            raise InvalidInput("an escape twist must not be zero: the object does not move")

    @cached_property
    def velocities(self) -> Array:
        """(n, d) velocity of the object at each contact, v + omega x r_i."""
        moved: Array = self.grasp.matrix.T @ self.twist
        return read_only(moved.reshape(len(self.grasp), self.grasp.width)[:, : self.grasp.dimension])

    @cached_property
    def load_power(self) -> float:
        """Work of the load along the motion, twist . w_ext."""
        return float(dot(exact(self.twist), exact(self.load.vector)))

    @cached_property
    def oppositions(self) -> tuple[float, ...]:
        """For each contact the most work against the motion that one newton in its cone can do; 0: none."""
        return tuple(float(o) for o in self._oppositions)

    @cached_property
    def least_force(self) -> float:
        """Forces that hold the load would have to sum to at least this [N]; infinite when none can hold."""
        power = dot(exact(self.twist), exact(self.load.vector)) - sum(self._rows_work, start=Fraction(0))
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
        if inf not in self.limits and not self.row_duals:
            given = self.grasp, self.load.vector, self.twist, self.frictions, self.limits
            if surely_wins(*given):
                return True
        return self.least_force > self._never

    @cached_property
    def helpless(self) -> tuple[bool, ...]:
        """For each contact whether no force in its cone opposes the motion, but for rounding.

        An opposition is rounding where even 1e9 times the load would do less work than the load does.
        """
        return tuple(o == 0 or o * self._never < self.load_power for o in self.oppositions)

    @property
    def turns(self) -> bool:
        """Whether the motion turns the object; otherwise it is a translation."""
        d = self.grasp.dimension
        velocity, spin = hypot(*self.twist[:d]), hypot(*self.twist[d:])
        return spin > 0 and spin * self.grasp.size >= 1e-9 * velocity

    @property
    def amount(self) -> float:
        """How far the motion goes: the angle where it turns [rad], else the distance [m]."""
        d = self.grasp.dimension
        return hypot(*(self.twist[d:] if self.turns else self.twist[:d]))

    @property
    def drive(self) -> float:
        """Work of the load per ``amount``: its torque about the centre [N m], or its force along [N]."""
        return self.load_power / self.amount

    @cached_property
    def resistances(self) -> tuple[float, ...]:
        """For each contact the most work per ``amount`` it can do against the motion: limit times opposition.

        0 for a helpless contact, infinite for another one without force limit; [N m] or [N] as ``drive``.
        """
        each = zip(self.helpless, self.limits, self.oppositions, self._rows_work, strict=True)
        return tuple(
            (float(rows) + (0.0 if none else limit * opposition)) / self.amount
            for none, limit, opposition, rows in each
        )

    @property
    def centre(self) -> Array | None:
        """Centre of rotation (2,) [m] in the plane; None where the motion is a translation, or in space."""
        if self.grasp.dimension == 3:
            return None
        if not self.turns:
            return None
        vx, vy, omega = self.twist
        return np.array([-vy / omega, vx / omega]) + 0.0  # -0 reads as 0

    @property
    def axis(self) -> tuple[Array, Array] | None:
        """In space, the screw axis: its point (3,) nearest to the centre of mass [m] and its direction (3,).

        None where the motion is a translation, and in the plane.
        """
        if self.grasp.dimension == 2 or not self.turns:
            return None
        velocity, spin = self.twist[:3], self.twist[3:]
        length = hypot(*spin)
        direction = spin / length
        return np.cross(direction, velocity / length) + 0.0, direction + 0.0

    @property
    def pitch(self) -> float:
        """In space, how far the object moves along the screw axis per radian [m]; infinite if it slides."""
        if self.grasp.dimension == 2:
            return 0.0 if self.turns else inf
        velocity, spin = self.twist[:3], self.twist[3:]
        return float(velocity @ spin) / hypot(*spin) ** 2 if self.turns else inf

    def __str__(self) -> str:
        d, centre = self.grasp.dimension, self.centre
        velocity, spin = self.twist[:d], self.twist[d:]
        if centre is not None:
            turn = "clockwise" if spin[0] < 0 else "counter-clockwise"
            return f"turning {turn} about {numbers(_without_noise(centre, self.grasp.size))}"
        if self.axis is not None:
            point, direction = self.axis
            pitch = float(_without_noise(np.array([self.pitch]), self.grasp.size)[0])
            advance = f", moving {pitch:.6g} along it per radian" if pitch else ""
            return (
                f"turning about the axis through {numbers(_without_noise(point, self.grasp.size))} along "
                f"{numbers(_without_noise(direction, 1.0))}{advance}"
            )
        return f"sliding along {numbers(_without_noise(velocity / hypot(*velocity), 1.0))}"

    @property
    def explanation(self) -> str:
        """Why the load wins, in a sentence: its work along the motion beside what each contact can oppose.

        Work is per radian where the motion turns the object [N m], per metre where it does not [N], so the
        sentence does not depend on the length of the twist. N and m stand for the units of the input.
        """
        per, unit, arm = ("radian", "N m", " m") if self.turns else ("metre", "N", "")
        parts = [f"per {per} the load does {self.drive:.4g} {unit} of work"]
        for name, limit, most in zip(self.grasp.names, self.limits, self.resistances, strict=True):
            if most == 0:
                parts.append(f"{name} cannot oppose it")
            elif most == inf:
                parts.append(f"{name} can oppose it without limit")
            elif any(self.row_duals):
                parts.append(f"{name} can oppose at most {most:.4g} {unit} within its limits")
            else:
                lever = f"{limit:.4g} N times {most / limit:.4g}{arm}"
                parts.append(f"{name} can oppose at most {most:.4g} {unit} ({lever})")
        if not self.is_proof:
            parts.append("that is enough against this motion, which proves nothing")
        elif any(self.resistances):
            parts.append(f"together at most {sum(self.resistances):.4g} {unit}, too little")
        return f"{replace(self, twist=self.twist / self.amount)}: {'; '.join(parts)}"

    def __repr__(self) -> str:
        return f"EscapeTwist({self})"

    @property
    def _never(self) -> float:
        """A force [N] so large beside the load that it comes from rounding only."""
        load = hypot(*self.load.force) + hypot(*self.load.torque) / (self.grasp.size or 1.0)
        return NEVER * load

    @cached_property
    def _oppositions(self) -> tuple[Fraction, ...]:
        return oppositions(self.grasp, self.frictions, self.twist, self.row_duals)

    @cached_property
    def _rows_work(self) -> tuple[Fraction, ...]:
        """For each contact the work against the motion that its linear limits allow, as they are counted."""
        work, rows = [Fraction(0)] * len(self.grasp), self.grasp.limit_rows
        if rows is not None and self.row_duals:
            for i, bound, dual in zip(
                rows.contacts.tolist(), rows.bounds.tolist(), self.row_duals, strict=True
            ):
                work[i] += Fraction(bound) * Fraction(dual)
        return tuple(work)


def _without_noise(values: Array, scale: float) -> Array:
    """For printing: zero where a value is rounding beside ``scale``."""
    return np.where(abs(values) < 1e-9 * scale, 0.0, values)
