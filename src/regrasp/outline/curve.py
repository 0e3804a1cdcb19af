"""A smooth closed curve by arc length, to rounding: Gauss-Legendre panels and Newton's method."""

from abc import abstractmethod
from collections.abc import Callable
from functools import cache, cached_property

import numpy as np

from regrasp.mechanics.checks import Array, ArrayLike
from regrasp.mechanics.value import ArrayValue

_PANELS = 4  # to begin with, in each smooth stretch
_HALVINGS, _STEPS = 30, 60

Function = Callable[[Array], Array]


class CurveBoundary(ArrayValue):
    """A smooth closed curve x(u), counter-clockwise, with its first two derivatives.

    Between the rising ``breaks`` (k,), of which the first and the last are the same point, x(u) is smooth.
    Panels of u are halved until the length of each is that of its halves to rounding.
    """

    @property
    @abstractmethod
    def breaks(self) -> Array:
        """(k,) rising values of u."""

    @abstractmethod
    def at(self, u: Array, order: int = 0) -> Array:
        """(..., 2) the derivative of x of an order 0, 1 or 2."""

    @abstractmethod
    def cubics(self) -> tuple[Array, Array]:
        """(k + 1,) values of u and (k, 4, 2) control points of cubic Bezier pieces between them.

        They are the curve but for rounding.
        """

    @cached_property
    def _u(self) -> Array:
        breaks = self.breaks
        u = np.interp(np.arange(_PANELS * (breaks.size - 1) + 1) / _PANELS, np.arange(breaks.size), breaks)
        for _ in range(_HALVINGS):
            a, b, middle = u[:-1], u[1:], (u[:-1] + u[1:]) / 2
            halves = _integrals(self._speed, a, middle) + _integrals(self._speed, middle, b)
            rough = abs(_integrals(self._speed, a, b) - halves) > 1e-14 * halves.sum()
            if not rough.any():
                break
            u = np.sort(np.concatenate([u, middle[rough]]))
        return u

    @cached_property
    def _s(self) -> Array:
        """Arc lengths at the ends of the panels."""
        return np.concatenate([[0.0], np.cumsum(_integrals(self._speed, self._u[:-1], self._u[1:]))])

    @property
    def length(self) -> float:
        """[m]."""
        return float(self._s[-1])

    @property
    def corners(self) -> Array:
        """None: (0,)."""
        return np.zeros(0)

    @cached_property
    def moments(self) -> tuple[float, Array]:
        """Area [m^2] and centroid (2,) [m], by Green's theorem about a point of the curve."""
        base = self.at(self._u[0])

        def density(u: Array) -> Array:
            x, dx = self.at(u) - base, self.at(u, 1)
            cross = x[:, 0] * dx[:, 1] - x[:, 1] * dx[:, 0]
            return np.stack([cross / 2, x[:, 0] * cross / 3, x[:, 1] * cross / 3], axis=-1)

        area, *first = _integrals(density, self._u[:-1], self._u[1:]).sum(axis=0)
        return float(area), base + np.array(first) / area

    @cached_property
    def second_moment(self) -> float:
        """Polar, about the centroid [m^4]: the flux of x |x|^2 / 4, whose divergence is |x|^2."""
        centre = self.moments[1]

        def density(u: Array) -> Array:
            x, dx = self.at(u) - centre, self.at(u, 1)
            result: Array = (x[:, 0] * dx[:, 1] - x[:, 1] * dx[:, 0]) * (x * x).sum(axis=1) / 4
            return result

        return float(_integrals(density, self._u[:-1], self._u[1:]).sum())

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths."""
        return self.at(self.parameter(s))

    def tangents(self, s: ArrayLike) -> Array:
        """(..., 2) unit tangents."""
        velocity = self.at(self.parameter(s), 1)
        result: Array = velocity / np.linalg.norm(velocity, axis=-1, keepdims=True)
        return result

    def nearest(self, point: Array) -> float:
        """The arc length of the point nearest to ``point`` (2,); one of several.

        In every panel where the distance first falls and then rises Newton's method finds its least.
        """

        def slope(u: Array) -> Array:
            result: Array = ((self.at(u) - point) * self.at(u, 1)).sum(axis=-1)
            return result

        def bend(u: Array) -> Array:
            away, dx, ddx = self.at(u) - point, self.at(u, 1), self.at(u, 2)
            result: Array = (dx**2 + away * ddx).sum(axis=-1)
            return result

        falls = slope(self._u)
        k = np.flatnonzero((falls[:-1] <= 0) & (falls[1:] >= 0))
        u = np.concatenate([self._u, _roots(slope, bend, self._u[k], self._u[k + 1])])
        best = int(np.argmin(np.hypot(*(self.at(u) - point).T)))
        return float(self._length_to(u[best : best + 1])[0]) % self.length

    def polygon(self, tolerance: float) -> Array:
        """(k, 2) points on the curve with chords within ``tolerance`` of it: sagitta h^2 |x''| / 8."""
        bend = np.linalg.norm(self.at(self._u, 2), axis=-1)
        worst = np.maximum(bend[:-1], bend[1:]) * np.diff(self._u) ** 2 / 8
        parts = np.maximum(1, np.ceil(np.sqrt(2 * worst / tolerance))).astype(int)
        panels = zip(self._u[:-1], self._u[1:], parts, strict=True)
        return self.at(np.concatenate([np.linspace(a, b, n, endpoint=False) for a, b, n in panels]))

    def _speed(self, u: Array) -> Array:
        result: Array = np.hypot(*self.at(u, 1).T)
        return result

    def _length_to(self, u: Array) -> Array:
        """Arc length from the start to u."""
        k = np.clip(np.searchsorted(self._u, u, side="right") - 1, 0, self._u.size - 2)
        result: Array = self._s[k] + _integrals(self._speed, self._u[k], u)
        return result

    def parameter(self, s: ArrayLike) -> Array:
        """(...) the u of arc lengths (...) [m], modulo the length."""
        wrapped = np.asarray(s, dtype=float) % self.length
        flat = wrapped.ravel()
        k = np.clip(np.searchsorted(self._s, flat, side="right") - 1, 0, self._u.size - 2)
        return _roots(lambda u: self._length_to(u) - flat, self._speed, self._u[k], self._u[k + 1]).reshape(
            wrapped.shape
        )


def _integrals(f: Function, a: Array, b: Array) -> Array:
    """(m, ...) the integrals of f from each a to each b."""
    half = (b - a) / 2
    gauss, weights = _gauss()
    u = (a + b)[:, None] / 2 + half[:, None] * gauss
    values = f(u.ravel())
    values = values.reshape(*u.shape, *values.shape[1:])
    scale = half.reshape(-1, *[1] * (values.ndim - 2))
    result: Array = scale * np.tensordot(values, weights, axes=([1], [0]))
    return result


def _roots(f: Function, slope: Function, lo: Array, hi: Array) -> Array:
    """(m,) where f, not positive at lo and not negative at hi, is zero: Newton, kept inside by bisection."""
    u, width = (lo + hi) / 2, hi - lo
    for _ in range(_STEPS):
        value, rate = f(u), slope(u)
        lo, hi = np.where(value < 0, u, lo), np.where(value > 0, u, hi)
        step = np.divide(value, rate, out=np.full_like(u, np.inf), where=rate > 0)
        after = np.where((u - step > lo) & (u - step < hi), u - step, (lo + hi) / 2)
        after = np.where(value == 0, u, after)
        moved, u = abs(after - u), after
        if (moved <= 1e-15 * width).all():
            break
    return u


@cache
def _gauss() -> tuple[Array, Array]:
    """Points and weights on [-1, 1]; worked out when the first curve is, not at import."""
    points, weights = np.polynomial.legendre.leggauss(12)
    return points, weights
