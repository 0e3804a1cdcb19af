"""Points of a boundary by arc length: of polygons by sums, of cubics by Gauss' quadrature and bisection.

Where a cubic nearly stops, as at a sharp turn, its speed is far from any polynomial: parts are halved until
halves say the same.
"""

from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.protocol import after_each

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_SAME, _HALVINGS = 1e-14, 50  # of the length of a cubic's legs
_BISECTIONS = 60


def points_at(arc_lengths: Array, vertices: Array, control: Array | None, rings: Any = None) -> Array:
    """(k, 2) points of a closed boundary, counted from its first vertex, modulo its length [m].

    vertices: (m, 2) of a polygon, of one ring after the other. control: (m, 4, 2) of its edges where they are
    cubics, None elsewhere. rings: the first vertex of each, None of one alone.
    """
    if control is None:
        chords = vertices[after_each(len(vertices), rings)] - vertices
        lengths = np.hypot(*chords.T)
    else:
        lengths = lengths_to(control, np.ones(len(control)))
    ends = np.cumsum(lengths)
    points = []
    for s in np.asarray(arc_lengths, dtype=float) % ends[-1]:
        k = min(int(np.searchsorted(ends, s, side="right")), len(ends) - 1)
        passed = s - (ends[k] - lengths[k])
        if control is None:
            points.append(vertices[k] + passed / lengths[k] * chords[k])
        else:
            points.append(_at_length(control[k], passed))
    return np.array(points)


def lengths_to(control: Array, ends: Array) -> Array:
    """(m,) of cubics from their beginnings to parameters.

    control: (m, 4, 2) [m]. ends: (m,) from 0 to 1.
    """
    legs = np.diff(control, axis=1)
    few = _SAME * np.hypot(legs[..., 0], legs[..., 1]).sum(axis=1)
    found, on, lo, hi = np.zeros(len(control)), np.arange(len(control)), np.zeros(len(control)), ends
    known = _quadrature(legs, lo, hi)
    for _ in range(_HALVINGS):
        middle = (lo + hi) / 2
        first, second = _quadrature(legs[on], lo, middle), _quadrature(legs[on], middle, hi)
        rest = np.abs(first + second - known) > few[on]
        found += np.bincount(on[~rest], (first + second)[~rest], len(control))
        on, known = np.tile(on[rest], 2), np.append(first[rest], second[rest])
        lo, hi = np.append(lo[rest], middle[rest]), np.append(middle[rest], hi[rest])
        if not len(on):
            break
    return found + np.bincount(on, known, len(control))


def _quadrature(legs: Array, lo: Array, hi: Array) -> Array:
    """(m,) lengths of cubics between parameters, by one rule."""
    t = lo[:, None] + (hi - lo)[:, None] * (1 + _NODES) / 2
    d = 3 * legs[:, :, :, None]
    t = t[:, None]
    x, y = np.moveaxis((1 - t) ** 2 * d[:, 0] + 2 * t * (1 - t) * d[:, 1] + t**2 * d[:, 2], 1, 0)
    result: Array = (hi - lo) / 2 * (np.hypot(x, y) @ _WEIGHTS)
    return result


def _at_length(edge: Array, passed: float) -> Array:
    lo, hi = 0.0, 1.0
    for _ in range(_BISECTIONS):
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if lengths_to(edge[None], np.array([middle])) < passed else (lo, middle)
    t, s = lo, 1 - lo
    result: Array = s**3 * edge[0] + 3 * s * s * t * edge[1] + 3 * s * t * t * edge[2] + t**3 * edge[3]
    return result
