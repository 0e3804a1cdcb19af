"""Smooth closed curves by arc length: periodic splines and ellipses."""

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from regrasp.mechanics.checks import Array

# Gauss-Legendre points in a panel: exact for the areas of cubic splines, and far below rounding for lengths.
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_PANELS = 8
_NEWTON = 20

Function = Callable[[Array], Array]


class CurveBoundary:
    """A smooth closed curve x(u), counter-clockwise, given with its first two derivatives.

    breaks: (k,) rising values of u, the first and last the same point; x(u) is smooth between them.
    """

    def __init__(self, position: Function, velocity: Function, acceleration: Function, breaks: Array) -> None:
        self._x, self._dx, self._ddx = position, velocity, acceleration
        self._u = np.concatenate(
            [np.linspace(a, b, _PANELS, endpoint=False) for a, b in pairwise(breaks)] + [breaks[-1:]]
        )
        self._s = np.concatenate([[0.0], np.cumsum(self._integral(lambda u: np.hypot(*self._dx(u).T)))])

    @classmethod
    def spline(cls, points: Array) -> "CurveBoundary":
        """The periodic cubic spline through points (k, 2), by chord length."""
        from scipy.interpolate import CubicSpline

        closed = np.vstack([points, points[:1]])
        chords = np.hypot(*np.diff(closed, axis=0).T)
        u = np.concatenate([[0.0], np.cumsum(chords)])
        x = CubicSpline(u, closed, bc_type="periodic")
        return cls(x, x.derivative(), x.derivative(2), u)

    @classmethod
    def ellipse(cls, a: float, b: float) -> "CurveBoundary":
        """The ellipse of half axes a along x and b along y about the origin."""
        axes = np.array([a, b])

        def circle(u: Array) -> Array:
            return np.stack([np.cos(u), np.sin(u)], axis=-1)

        return cls(
            lambda u: axes * circle(u),
            lambda u: axes * circle(u + np.pi / 2),
            lambda u: -axes * circle(u),
            np.linspace(0, 2 * np.pi, 17),
        )

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
        """Area [m^2] and first moments (2,) [m^3], by Green's theorem."""

        def density(u: Array) -> Array:
            x, dx = self._x(u), self._dx(u)
            cross = x[:, 0] * dx[:, 1] - x[:, 1] * dx[:, 0]
            return np.stack([cross / 2, x[:, 0] * cross / 3, x[:, 1] * cross / 3], axis=-1)

        total = self._integral(density).sum(axis=0)
        return float(total[0]), total[1:]

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths."""
        return self._x(self._parameter(s))

    def tangents(self, s: ArrayLike) -> Array:
        """(..., 2) unit tangents."""
        velocity = self._dx(self._parameter(s))
        result: Array = velocity / np.linalg.norm(velocity, axis=-1, keepdims=True)
        return result

    def nearest(self, point: Array) -> float:
        """The arc length of the point nearest to ``point`` (2,): the best panel end, made exact by Newton."""
        k = int(np.argmin(((self._x(self._u) - point) ** 2).sum(axis=1)))
        u, step = float(self._u[k]), float(np.diff(self._u).max())
        lo, hi = u - step, u + step
        period = self._u[-1] - self._u[0]
        for _ in range(_NEWTON):
            at = np.array([self._u[0] + (u - self._u[0]) % period])
            away, dx, ddx = self._x(at)[0] - point, self._dx(at)[0], self._ddx(at)[0]
            slope, curvature = float(away @ dx), float(dx @ dx + away @ ddx)
            newton = u - slope / curvature if curvature > 0 else u - np.sign(slope) * step / 4
            u = min(max(newton, lo), hi)
        wrapped = self._u[0] + (u - self._u[0]) % period
        return float(self._length_to(np.array([wrapped]))[0]) % self.length

    def polygon(self, tolerance: float) -> Array:
        """(k, 2) points on the curve with chords within ``tolerance`` of it: sagitta h^2 |x''| / 8."""
        bend = np.linalg.norm(self._ddx(self._u), axis=-1)
        worst = np.maximum(bend[:-1], bend[1:]) * np.diff(self._u) ** 2 / 8
        parts = np.maximum(1, np.ceil(np.sqrt(2 * worst / tolerance))).astype(int)
        u = np.concatenate(
            [
                np.linspace(a, b, n, endpoint=False)
                for a, b, n in zip(self._u[:-1], self._u[1:], parts, strict=True)
            ]
        )
        return self._x(u)

    def _integral(self, f: Function) -> Array:
        """The integral of f over each panel."""
        return self._quadrature(f, self._u[:-1], self._u[1:])

    def _quadrature(self, f: Function, a: Array, b: Array) -> Array:
        half = (b - a) / 2
        u = (a + b)[:, None] / 2 + half[:, None] * _GAUSS
        values = f(u.ravel())
        values = values.reshape(*u.shape, *values.shape[1:])
        scale = half.reshape(-1, *[1] * (values.ndim - 2))
        result: Array = scale * np.tensordot(values, _WEIGHTS, axes=([1], [0]))
        return result

    def _length_to(self, u: Array) -> Array:
        """Arc length from the start to u."""
        k = np.clip(np.searchsorted(self._u, u, side="right") - 1, 0, self._u.size - 2)
        rest: Array = self._quadrature(lambda v: np.hypot(*self._dx(v).T), self._u[k], u)
        result: Array = self._s[k] + rest
        return result

    def _parameter(self, s: ArrayLike) -> Array:
        """The u of arc lengths, by Newton's method from linear interpolation."""
        wrapped = np.asarray(s, dtype=float) % self.length
        flat = wrapped.ravel()
        u = np.interp(flat, self._s, self._u)
        for _ in range(_NEWTON):
            off = self._length_to(u) - flat
            if abs(off).max(initial=0.0) <= 1e-14 * self.length:
                break
            u = np.clip(u - off / np.hypot(*self._dx(u).T), self._u[0], self._u[-1])
        result: Array = u.reshape(wrapped.shape)
        return result
