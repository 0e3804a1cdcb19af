"""Twists that exclude boxes: fingers anywhere on two stretches of sides hold no load.

A finger anywhere on a stretch makes only sums of four wrenches w, both edges of its cone at both ends. A
twist y with y . w >= 0 for all eight of two fingers and y . w_ext > 0 leaves nothing that could balance the
load. Such y form a cone, whose edges are cross products of two w: y is an edge plus the middle of all of
them, so that it is not undone by rounding.
"""

from itertools import combinations

import numpy as np

from regrasp.mechanics.checks import Array

_FIRST, _SECOND = (np.array(k) for k in zip(*combinations(range(8), 2), strict=True))
# Products of unit wrenches with a unit twist that count as not negative, and room that a proof must have.
_ROUNDING, _ROOM = 1e-13, 1e-11
_AT_ONCE = 2000


def excluding_twists(
    vertices: Array, friction: float, force: Array, sides: np.ndarray, boxes: Array
) -> tuple[np.ndarray, Array]:
    """Which boxes (m, 4) of fractions on sides (m, 2) are excluded, (m,), and their twists (m, 3)."""
    parts = range(0, len(boxes), _AT_ONCE)
    found = [
        _excluding(vertices, friction, force, sides[k : k + _AT_ONCE], boxes[k : k + _AT_ONCE]) for k in parts
    ]
    if not found:
        return np.zeros(0, dtype=np.bool_), np.zeros((0, 3))
    sure, twists = zip(*found, strict=True)
    return np.concatenate(sure), np.concatenate(twists)


def _excluding(
    vertices: Array, friction: float, force: Array, sides: np.ndarray, boxes: Array
) -> tuple[np.ndarray, Array]:
    size = float(np.hypot(*vertices.T).max())
    w = _wrenches(vertices / size, friction, sides, boxes)
    load = np.array([*force, 0.0]) / np.hypot(*force)
    rays = np.cross(w[:, _FIRST], w[:, _SECOND])
    length = np.linalg.norm(rays, axis=2, keepdims=True)
    rays = np.divide(rays, length, out=np.zeros_like(rays), where=length > _ROUNDING)
    rays = np.concatenate([rays, -rays], axis=1)  # (m, 56, 3)
    inside = ((rays @ w.transpose(0, 2, 1)).min(axis=2) >= -_ROUNDING) & (abs(rays).max(axis=2) > 0)
    work = np.where(inside, rays @ load, -np.inf)
    best = work.argmax(axis=1)
    most = np.maximum(work[np.arange(len(w)), best], 0.0)
    middle = (rays * inside[..., None]).sum(axis=1) / np.maximum(inside.sum(axis=1), 1)[:, None]
    lost = np.maximum(-(middle @ load), most)  # the middle may take half of the work away
    share = np.divide(0.5 * most, lost, out=np.zeros_like(most), where=lost > 0)
    twists = rays[np.arange(len(w)), best] + share[:, None] * middle
    room = np.minimum((twists[:, None] @ w.transpose(0, 2, 1))[:, 0].min(axis=1), twists @ load)
    result: Array = twists / [1.0, 1.0, size]
    return inside.any(axis=1) & (room > _ROOM), result


def _wrenches(vertices: Array, friction: float, sides: np.ndarray, boxes: Array) -> Array:
    """(m, 8, 3) unit wrenches of both edges at both ends of both stretches."""
    along = np.roll(vertices, -1, axis=0) - vertices
    unit = along / np.hypot(*along.T)[:, None]
    at = np.repeat(sides, 2, axis=1)  # (m, 4)
    points = vertices[at] + boxes[..., None] * along[at]
    t = unit[at]
    n = np.stack([-t[..., 1], t[..., 0]], axis=-1)
    forces = np.stack([n + friction * t, n - friction * t], axis=2)  # (m, 4, 2, 2)
    torques = points[:, :, None, 0] * forces[..., 1] - points[:, :, None, 1] * forces[..., 0]
    w = np.concatenate([forces, torques[..., None]], axis=-1).reshape(len(boxes), 8, 3)
    result: Array = w / np.linalg.norm(w, axis=2, keepdims=True)
    return result
