"""The periodic cubic spline through points."""

import numpy as np

from regrasp.mechanics.checks import Array


class PeriodicSpline:
    """The curve of continuous second derivative through ``values`` (k, d) at knots ``breaks`` (k + 1,).

    The last knot is the first one again, a period later. With slopes m_i at the knots, steps h_i and secants
    d_i, the second derivatives meet where

        h_i m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_{i-1} m_{i+1} = 3 (h_i d_{i-1} + h_{i-1} d_i).
    """

    def __init__(self, breaks: Array, values: Array) -> None:
        step = np.diff(breaks)
        secant = (np.roll(values, -1, axis=0) - values) / step[:, None]
        before, secant_before = np.roll(step, 1), np.roll(secant, 1, axis=0)
        right = 3 * (step[:, None] * secant_before + before[:, None] * secant)
        slope = _cyclic(step, 2 * (before + step), before, right)
        after = np.roll(slope, -1, axis=0)
        h = step[:, None]
        cubic, square = (slope + after - 2 * secant) / h**2, (3 * secant - 2 * slope - after) / h
        self._breaks = breaks
        self._orders = (cubic, square, slope, values), (3 * cubic, 2 * square, slope), (6 * cubic, 2 * square)

    def __call__(self, u: Array, order: int = 0) -> Array:
        """(..., d) the derivative of an order 0, 1 or 2 at u (...), modulo the period."""
        u = np.asarray(u, dtype=float)
        first, last = self._breaks[0], self._breaks[-1]
        if u.size and not (u.min() >= first and u.max() <= last):
            u = first + (u - first) % (last - first)
        k = np.minimum(self._breaks.searchsorted(u, "right"), len(self._breaks) - 1) - 1
        x = (u - self._breaks[k])[..., None]
        highest, *others = self._orders[order]
        result: Array = highest[k]
        for lower in others:
            result = result * x + lower[k]
        return result


def _cyclic(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    """Solves a diagonally dominant cyclic tridiagonal system for right sides (k, d).

    Without its corners it is tridiagonal; they are a matrix of rank one (Sherman and Morrison).
    """
    corner, far = lower[0], upper[-1]
    gamma = -diagonal[0]
    inner = diagonal.copy()
    inner[0] -= gamma
    inner[-1] -= corner * far / gamma
    away = np.zeros(len(diagonal))
    away[0], away[-1] = gamma, far
    solved = _tridiagonal(lower, inner, upper, np.column_stack([right, away]))
    y, z = solved[:, :-1], solved[:, -1:]
    ratio = corner / gamma
    result: Array = y - z * ((y[0] + ratio * y[-1]) / (1 + z[0] + ratio * z[-1]))
    return result


def _tridiagonal(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    """Elimination without pivots: what dominance allows."""
    pivots, result = diagonal.tolist(), right.copy()
    below, above = lower.tolist(), upper.tolist()
    for i in range(1, len(pivots)):
        share = below[i] / pivots[i - 1]
        pivots[i] -= share * above[i - 1]
        result[i] -= share * result[i - 1]
    result[-1] /= pivots[-1]
    for i in range(len(pivots) - 2, -1, -1):
        result[i] = (result[i] - above[i] * result[i + 1]) / pivots[i]
    return result
