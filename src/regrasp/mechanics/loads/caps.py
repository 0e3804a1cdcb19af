"""A polytope around the hull of a cap of the unit circle or sphere."""

from math import ceil, cos, pi, sin

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.orientation.tangents import tangents_of

_STEP = {2: 0.09, 3: 0.35}
"""Largest angle between neighbours [rad]; the polytope is larger by 1 / cos of half of it, in space twice."""


def around_cap(axis: Array, angle: float) -> Array:
    """(m, d) points whose hull holds all unit vectors within ``angle`` of a unit ``axis``, and their hull.

    In the plane tangents of the arc meet in them, and the ends of the arc are two of them. In space rings of
    tangents' corners around the axis stand for the sphere.
    """
    if angle == 0:
        return axis[None]
    across = tangents_of(axis[None])[0]
    count = max(ceil(2 * angle / _STEP[axis.size]), 1)
    if axis.size == 2:
        middles = -angle + 2 * angle * (np.arange(count) + 0.5) / count
        turns = np.concatenate([[-angle, angle], middles])
        sizes = np.concatenate([[1.0, 1.0], np.full(count, 1 / cos(angle / count))])
        corners: Array = sizes[:, None] * (np.cos(turns)[:, None] * axis + np.sin(turns)[:, None] * across[0])
        return corners
    rings, points = max(ceil(angle / _STEP[3]), 1), []
    step = angle / rings
    for k in range(rings):  # the ring of directions from k to k + 1 steps, by corners of a frustum around it
        near, far = k * step, (k + 1) * step
        sides = max(ceil(2 * pi * sin(min(max(far, near), pi / 2)) / _STEP[3]), 6)
        turns = 2 * pi * np.arange(sides) / sides
        circle = np.cos(turns)[:, None] * across[0] + np.sin(turns)[:, None] * across[1]
        middle = (near + far) / 2
        bands = [(near, 1.0), (middle, 1 / cos(step / 2)), (far, 1.0)]
        for at, grown in bands:
            wide = grown * sin(at) / cos(pi / sides)
            points.append(grown * cos(at) * axis + wide * circle)
    return np.vstack(points)
