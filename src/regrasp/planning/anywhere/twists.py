"""Twists that exclude boxes: fingers anywhere on two stretches of sides hold no load.

A finger anywhere on a stretch makes only sums of four wrenches w, both edges of its cone at both ends. A
twist y with y . w >= 0 for all eight of two fingers and y . w_ext > 0 leaves nothing that could balance the
load. Such y form a cone, whose edges are cross products of two w: y is an edge plus the middle of all of
them, so that it is not undone by rounding. Where the object turns, y has to be one for the loads at both ends
of the turn, and is one for all between: an edge, or of two edges the sum that does as much work with either.
"""

from itertools import combinations

import numpy as np

from regrasp.mechanics.checks import Array

_FIRST, _SECOND = (np.array(k) for k in zip(*combinations(range(8), 2), strict=True))
# Products of unit wrenches with a unit twist that count as not negative, and room that a proof must have.
_ROUNDING, _ROOM = 1e-13, 1e-11
_AT_ONCE = 2000


def excluding_twists(
    vertices: Array, friction: float, forces: Array, sides: np.ndarray, boxes: Array
) -> tuple[np.ndarray, Array]:
    """Which boxes (m, 4) of fractions on sides (m, 2) are excluded, (m,), and their twists (m, 3).

    forces: (2, 2) at both ends of the turn, the same twice without one.
    """
    parts = range(0, len(boxes), _AT_ONCE)
    found = [
        _excluding(vertices, friction, forces, sides[k : k + _AT_ONCE], boxes[k : k + _AT_ONCE])
        for k in parts
    ]
    if not found:
        return np.zeros(0, dtype=np.bool_), np.zeros((0, 3))
    sure, twists = zip(*found, strict=True)
    return np.concatenate(sure), np.concatenate(twists)


def _excluding(
    vertices: Array, friction: float, forces: Array, sides: np.ndarray, boxes: Array
) -> tuple[np.ndarray, Array]:
    size = float(np.hypot(*vertices.T).max())
    w = _wrenches(vertices / size, friction, sides, boxes)
    loads = np.pad(forces / np.hypot(*forces.T)[:, None], ((0, 0), (0, 1))).T  # (3, 2)
    rays = np.cross(w[:, _FIRST], w[:, _SECOND])
    length = np.linalg.norm(rays, axis=2, keepdims=True)
    rays = np.divide(rays, length, out=np.zeros_like(rays), where=length > _ROUNDING)
    rays = np.concatenate([rays, -rays], axis=1)  # (m, 56, 3)
    inside = ((rays @ w.transpose(0, 2, 1)).min(axis=2) >= -_ROUNDING) & (abs(rays).max(axis=2) > 0)
    twists = _hardest(rays, inside, rays @ loads)
    most = np.maximum((twists @ loads).min(axis=1), 0.0)
    middle = (rays * inside[..., None]).sum(axis=1) / np.maximum(inside.sum(axis=1), 1)[:, None]
    lost = np.maximum(-(middle @ loads).min(axis=1), most)  # the middle may take half of the work away
    share = np.divide(0.5 * most, lost, out=np.zeros_like(most), where=lost > 0)
    twists = twists + share[:, None] * middle
    room = np.minimum(
        (twists[:, None] @ w.transpose(0, 2, 1))[:, 0].min(axis=1), (twists @ loads).min(axis=1)
    )
    result: Array = twists / [1.0, 1.0, size]
    return inside.any(axis=1) & (room > _ROOM), result


def _hardest(rays: Array, inside: np.ndarray, work: Array) -> Array:
    """(m, 3) twists within cones of edges along which both loads do work, where there are any.

    The works of an edge with both loads are a point of the plane, and a sum does positive work with both
    where the two edges that are nearest to it from either side have it between them.
    """
    at = np.arange(len(rays))
    one, other = (np.where(inside, work[..., k], -np.inf) for k in (0, 1))
    best = rays[at, np.minimum(one, other).argmax(axis=1)]
    pair = []
    for mine, its in ((one, other), (other, one)):
        ratio = np.divide(its, mine, out=np.full(its.shape, -np.inf), where=(mine > 0) & (its > -np.inf))
        pair.append(ratio.argmax(axis=1))
    (a, b), (c, d) = ((one[at, k], other[at, k]) for k in pair)
    some = (a > 0) & (b <= 0) & (d > 0) & (c <= 0)
    with np.errstate(invalid="ignore"):
        some &= a * d > c * b
        total = (d - c)[:, None] * rays[at, pair[0]] + (a - b)[:, None] * rays[at, pair[1]]
        total = total / np.linalg.norm(total, axis=1, keepdims=True)
    result: Array = np.where(some[:, None], total, best)
    return result


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
