"""Clamped B-splines of numbers."""

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.polynomial.polynomial import polyroots

from regrasp.mechanics.checks import Array


@dataclass(frozen=True, eq=False)
class ClampedSpline:
    """A B-spline of control values (k,) over knots (k + degree + 1,), from the first to the last."""

    knots: Array
    control: Array
    degree: int

    def derivative(self) -> "ClampedSpline":
        """Its control values are k (c_{i+1} - c_i) / (t_{i+k+1} - t_{i+1}); zero below degree 1."""
        k, t = self.degree, self.knots
        if k == 0:
            return ClampedSpline(t, np.zeros_like(self.control), 0)
        return ClampedSpline(t[1:-1], k * np.diff(self.control) / (t[k + 1 : -1] - t[1 : -k - 1]), k - 1)

    def roots(self) -> Array:
        """Every place where it may be zero: real parts of the roots of each piece's Taylor series."""
        edges = np.unique(self.knots)
        half, middle = np.diff(edges) / 2, (edges[:-1] + edges[1:]) / 2
        series, spline = [], self
        for k in range(self.degree + 1):
            series.append(spline(middle) * half**k / factorial(k))
            spline = spline.derivative()
        found = [polyroots(c).real.clip(-1, 1) for c in np.stack(series, axis=-1)]
        return np.concatenate([m + h * x for m, h, x in zip(middle, half, found, strict=True)])

    def __call__(self, s: Array) -> Array:
        """The values at s, by de Boor's algorithm: k rounds of means of neighbours."""
        k, t = self.degree, self.knots
        span = np.clip(np.searchsorted(t, s, side="right") - 1, k, len(self.control) - 1)
        d = [self.control[span - k + j] for j in range(k + 1)]
        for r in range(1, k + 1):
            for j in range(k, r - 1, -1):
                first = t[span - k + j]
                share = (s - first) / (t[span + 1 + j - r] - first)
                d[j] = (1 - share) * d[j - 1] + share * d[j]
        return d[k]
