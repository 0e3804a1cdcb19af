"""Unit quaternions (w, x, y, z) of rotations, which controllers take: cos(angle / 2), sin(angle / 2) axis."""

import numpy as np

from regrasp.mechanics.checks import Array, ArrayLike


def quaternion(matrix: Array) -> Array:
    """(4,) of a rotation matrix (3, 3), with w >= 0.

    K = q q' has 4 w^2 = 1 + tr R, 4 w x = R_zy - R_yz, 4 x y = R_xy + R_yx, ...; its largest column, scaled,
    is q without loss (Shepperd, J. Guidance and Control 1, 1978).
    """
    a = matrix
    w, (x, y, z) = 1 + np.trace(a), 1 - np.trace(a) + 2 * np.diag(a)
    wx, wy, wz = a[2, 1] - a[1, 2], a[0, 2] - a[2, 0], a[1, 0] - a[0, 1]
    xy, yz, zx = a[0, 1] + a[1, 0], a[1, 2] + a[2, 1], a[2, 0] + a[0, 2]
    products = np.array([[w, wx, wy, wz], [wx, x, xy, zx], [wy, xy, y, yz], [wz, zx, yz, z]])
    column: Array = products[np.argmax(np.diag(products))]
    column = column / np.linalg.norm(column)
    return -column if column[0] < 0 else column


def about(axis: Array, angles: ArrayLike) -> Array:
    """(..., 4) of right-handed turns by ``angles`` [rad] about a unit ``axis`` (3,).

    Its sign is that of a turn that grows from 0 without a jump; a whole turn is (-1, 0, 0, 0).
    """
    half = np.asarray(angles, dtype=float)[..., None] / 2
    return np.concatenate([np.cos(half), np.sin(half) * axis], axis=-1)


def product(p: Array, q: Array) -> Array:
    """(..., 4) of R(p) R(q), first the turn of ``q``."""
    pw, qw, pv, qv = p[..., :1], q[..., :1], p[..., 1:], q[..., 1:]
    w = pw * qw - (pv * qv).sum(axis=-1, keepdims=True)
    result: Array = np.concatenate([w, pw * qv + qw * pv + np.cross(pv, qv)], axis=-1)
    return result


def conjugate(q: Array) -> Array:
    """(..., 4) of the turn back."""
    result: Array = q * np.array([1.0, -1.0, -1.0, -1.0])
    return result
