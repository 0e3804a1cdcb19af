"""The time function T(t) of a transition, falling smoothly from 1 to 0 (Fig. 8)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from regrasp.closed_form.straight_path import fastest_duration
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import (
    Array,
    ArrayLike,
    array,
    instance,
    items,
    limits,
    number,
    numbers_in,
    whole,
)
from regrasp.mechanics.plain import entries
from regrasp.mechanics.splines.clamped import ClampedSpline
from regrasp.mechanics.value import ArrayValue, numbers

# Three tenths of a second added up are 0.30000000000000004 s.
_ROUNDING = 2.0**-50

_DEGREES = 20  # of splines whose steepest slope is found to rounding

_LARGEST = float(np.finfo(float).max)

PAPER_CONTROL = (1.0, 1.0, 0.5, 0.0, 0.0)
"""Five control values with zero slope at both ends, as in Section V (values reconstructed)."""


@dataclass(frozen=True, eq=False, repr=False)
class TimeScaling(ArrayValue):
    """A clamped B-spline on [0, duration] given by its control values.

    The first control value is 1, the last 0 and none rises. A B-spline stays within its control values and
    falls where they fall, so 0 <= T <= 1 and T' <= 0 hold at every t, not only at samples.

    Args:
        duration: [s], greater than 0.
        control: (k,) control values.
        degree: of the polynomial pieces, at most k - 1 and at most 20.

    Raises:
        InvalidInput: For control values that rise or do not fall from 1 to 0, and another degree or duration.
    """

    duration: float
    control: tuple[float, ...]
    degree: int

    def __post_init__(self) -> None:
        duration = number(self.duration, "duration", above=0)
        values = tuple(number(c, "control value") for c in items(self.control, "control"))
        falls = all(a >= b for a, b in pairwise(values))
        if len(values) < 2 or values[0] != 1 or values[-1] != 0 or not falls:
            raise InvalidInput(f"control values must fall from 1 to 0, got {values}")
        highest = min(len(values) - 1, _DEGREES)
        if not 1 <= whole(self.degree, "degree", least=0) <= highest:
            raise InvalidInput(f"degree must be from 1 to {highest}, got {shown(self.degree)}")
        if duration * _LARGEST < len(values) ** 2:  # a bound on duration |T'|
            raise InvalidInput(f"duration is {shown(duration)} s, in which T falls faster than any number")
        object.__setattr__(self, "degree", int(self.degree))
        object.__setattr__(self, "duration", duration)
        object.__setattr__(self, "control", values)

    @classmethod
    def spline(cls, duration: float, control: Sequence[float] = PAPER_CONTROL) -> "TimeScaling":
        """Cubic B-spline (of lower degree for fewer than four values); the paper's five by default.

        Args:
            duration: [s], greater than 0.
            control: values of T, falling from 1 to 0 [-].
        """
        values = items(control, "control")
        return cls(duration, values, min(3, len(values) - 1))

    @classmethod
    def minimum_jerk(cls, duration: float) -> "TimeScaling":
        """1 - 10 s^3 + 15 s^4 - 6 s^5 with s = t / duration: zero velocity and acceleration at both ends.

        Args:
            duration: [s], greater than 0.
        """
        return cls(duration, (1.0, 1.0, 1.0, 0.0, 0.0, 0.0), 5)

    @classmethod
    def linear(cls, duration: float) -> "TimeScaling":
        """1 - t / duration: the fastest shape under rate limits, with a jump of rate at both ends.

        Args:
            duration: [s], greater than 0.
        """
        return cls(duration, (1.0, 0.0), 1)

    @classmethod
    def fastest(
        cls, change: ArrayLike, rate_limit: ArrayLike, shape: "TimeScaling | None" = None
    ) -> "TimeScaling":
        """The shortest scaling of a shape under force-rate limits (docs/facts.md, 4).

        Args:
            change: (n, d) forces at one end less those at the other [N].
            rate_limit: |f_i'(t)| allowed [N/s], one number or (n,), infinite for no limit.
            shape: whose control values to use; the paper's spline by default.

        Raises:
            InvalidInput: Where nothing changes or nothing is limited: no duration follows.
        """
        shape = cls.spline(1.0) if shape is None else shape
        instance(shape, "shape", TimeScaling)
        moved = np.linalg.norm(array(change, "change", (None, None)), axis=1)
        rates = limits(rate_limit, "rate_limit", moved.size)
        duration = fastest_duration(moved.tolist(), rates.tolist(), shape.steepest * shape.duration)
        if duration == 0:
            raise InvalidInput("no force that changes has a rate limit, so no shortest duration follows")
        return shape.lasting(duration)

    def to_dict(self) -> dict[str, Any]:
        """The scaling as plain data, which JSON can hold; ``from_dict`` gives back the equal scaling."""
        return {"duration": self.duration, "control": list(self.control), "degree": self.degree}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "TimeScaling":
        """The scaling of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``TimeScaling`` does.
        """
        return cls(**entries(data, "a time scaling", ("duration", "control", "degree")))

    def lasting(self, duration: float) -> "TimeScaling":
        """The same shape over another duration.

        Args:
            duration: [s], greater than 0.
        """
        return TimeScaling(duration, self.control, self.degree)

    def reversed(self) -> "TimeScaling":
        """1 - T(duration - t): the scaling of the motion run backwards."""
        return TimeScaling(self.duration, tuple(1 - c for c in reversed(self.control)), self.degree)

    def __call__(self, t: ArrayLike) -> Array:
        """T(t), of the shape of t; ``InvalidInput`` for times outside [0, duration]."""
        return self._evaluate(0, t)

    def velocity(self, t: ArrayLike) -> Array:
        """T'(t) [1/s].

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        return self._evaluate(1, t)

    def acceleration(self, t: ArrayLike) -> Array:
        """T''(t) [1/s^2]; zero everywhere for a linear scaling, whose jumps at the ends it does not see.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        return self._evaluate(2, t)

    @property
    def abscissae(self) -> Array:
        """(k,) times [s] at which the control values stand: means of ``degree`` knots (Greville)."""
        means = [self._knots[i + 1 : i + self.degree + 1].mean() for i in range(len(self.control))]
        return self.duration * np.array(means)

    @cached_property
    def steepest(self) -> float:
        """Max |T'(t)| [1/s], exact to rounding: at a knot or where T'' = 0."""
        slope = self._splines[1]
        candidates = knots = np.unique(slope.knots)
        if self.degree == 3:  # T'' is straight between knots
            a, b = self._splines[2](knots[:-1]), self._splines[2](knots[1:])
            turns = np.flatnonzero(a * b < 0)
            share = a[turns] / (a[turns] - b[turns])
            candidates = np.concatenate([knots, knots[turns] + share * np.diff(knots)[turns]])
        elif self.degree > 3:
            candidates = np.concatenate([knots, self._splines[2].roots()])
        inside = candidates[(candidates >= 0) & (candidates <= 1)]
        return float(abs(slope(inside)).max()) / self.duration

    @property
    def _knots(self) -> Array:
        """Clamped, uniform, over s = t / duration in [0, 1]."""
        k = self.degree
        inner = np.linspace(0, 1, len(self.control) - k + 1)
        return np.concatenate([np.zeros(k), inner, np.ones(k)])

    @cached_property
    def _splines(self) -> tuple[ClampedSpline, ...]:
        """T and its first two derivatives over s = t / duration in [0, 1]."""
        spline = ClampedSpline(self._knots, np.array(self.control), self.degree)
        first = spline.derivative()
        return spline, first, first.derivative()

    def _evaluate(self, derivative: int, t: ArrayLike) -> Array:
        times = numbers_in(t, "t must be numbers")
        if not ((times >= 0) & (times <= self.duration * (1 + _ROUNDING))).all():
            raise InvalidInput(f"t must lie in [0, {self.duration:.15g}] s, got {shown(t)}")
        times = np.minimum(times, self.duration)
        values: Array = self._splines[derivative](times / self.duration)
        return values / self.duration**derivative if derivative else values

    def __repr__(self) -> str:
        return f"TimeScaling({self.duration:g} s, control={numbers(self.control)}, degree {self.degree})"
