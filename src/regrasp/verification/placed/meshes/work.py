"""The most work of a force of size 1 at corners along twists, in doubles and from above in rationals."""

from fractions import Fraction
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.roots import root_above

ROUNDING = 1e-12
"""Of the terms: far more than the roundings of sums and of halving edges."""
SMALL = 1e-140
"""Squares of less lose digits."""


def sigmas(proof: Any, y: Array, points: Array, normals: Array) -> Array:
    """(b, c) sigma of twists (b, 6) at corners (c, 3), but for rounding."""
    v = y[:, None, :3] + np.cross(y[:, None, 3:], points)
    along = (v * normals).sum(axis=2)
    across = np.linalg.norm(v - along[..., None] * normals, axis=2)
    edge = along + proof.friction * across
    if proof.size == "force":
        inside = across <= proof.friction * along
        edge = np.where(inside, np.linalg.norm(v, axis=2), edge / np.sqrt(1 + proof.friction**2))
    result: Array = np.maximum(edge, 0.0)
    return result


def sigma_above(proof: Any, y: list[Fraction], p: list[Fraction], n: list[float]) -> Fraction:
    """At or above sigma of a twist at a corner with a normal, whose length counts as 1."""
    (px, py, pz), (nx, ny, nz), mu = p, map(Fraction, n), Fraction(proof.friction)
    v = (y[0] + y[4] * pz - y[5] * py, y[1] + y[5] * px - y[3] * pz, y[2] + y[3] * py - y[4] * px)
    along, length2 = v[0] * nx + v[1] * ny + v[2] * nz, nx * nx + ny * ny + nz * nz
    speed2 = v[0] ** 2 + v[1] ** 2 + v[2] ** 2
    across2 = speed2 * length2 - along * along
    sigma = (along + mu * root_above(across2)) * root_above(1 / length2)
    if proof.size == "force":
        if along > 0 and across2 <= (mu * along) ** 2:
            sigma = root_above(speed2)
        else:
            sigma *= root_above(1 / (1 + mu * mu))
    return max(sigma, Fraction(0))
