"""Tangents for normals: one in the plane, the normal turned left by a right angle; two in space.

Nothing that is exact depends on which two are taken: friction is the same in all directions. An inner pyramid
does, so the rule is fixed: the first tangent is n x e_z, horizontal, and n x e_x where the normal is so near
to e_z that n x e_z would be rounding.
"""

import numpy as np

from regrasp.mechanics.checks import Array

# Below this sine of the angle between a normal and e_z its horizontal direction is noise.
_STEEP = 1e-6


def tangents_of(normals: Array) -> Array:
    """(n, d - 1, d) orthonormal tangents of unit normals (n, d)."""
    if normals.shape[1] == 3:
        return tangent_pairs(normals)
    return np.stack([-normals[:, 1], normals[:, 0]], axis=-1)[:, None]


def tangent_pairs(normals: Array) -> Array:
    """(..., 2, 3) unit tangents t_1 and t_2 = n x t_1 of unit normals (..., 3)."""
    first = np.cross(normals, [0.0, 0.0, 1.0])
    steep = np.linalg.norm(first, axis=-1, keepdims=True) < _STEEP
    first = np.where(steep, np.cross(normals, [1.0, 0.0, 0.0]), first)
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    second = np.cross(normals, first)
    return np.stack([first, second / np.linalg.norm(second, axis=-1, keepdims=True)], axis=-2)
