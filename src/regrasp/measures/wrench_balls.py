"""Ferrari and Canny's measure of planar grasps by the hundred thousand."""

from itertools import combinations

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.measures.wrench_ball import NORMS, Norm
from regrasp.mechanics.arrays.planar import PlanarGrasps
from regrasp.mechanics.checks import Array, ArrayLike, choice, finite, number

_NOISE = 1e-14


def wrench_balls(
    positions: ArrayLike,
    normals: ArrayLike,
    frictions: ArrayLike,
    *,
    limit: float = 1.0,
    norm: Norm = "Linf",
    length: ArrayLike | None = None,
) -> Array:
    """The radius of ``wrench_ball`` for many planar grasps of n fingers, (...) [N]; 0 without closure.

    Arrays of normals of all possible facets, as for one grasp: exact but for rounding. Leading shapes
    broadcast.

    Args:
        positions: (..., n, 2) relative to the centre of mass, n from 2 to 8 [m].
        normals: (..., n, 2) into the object, of any length but zero.
        frictions: (..., n), or one number.
        limit: largest normal force of each finger (``Linf``), or of their sum (``L1``) [N].
        norm: ``Linf`` or ``L1``.
        length: by which torques are divided [m], a number or (...); each grasp's size if not given.

    Raises:
        InvalidInput: For bad input.
    """
    grasps = PlanarGrasps.of(positions, normals, frictions)
    total = choice(norm, "norm", NORMS) == "L1"
    most = number(limit, "limit", above=0)
    lengths = grasps.sizes
    if length is not None:
        given = finite(length, "length")
        if (given <= 0).any():
            raise InvalidInput("length must be greater than 0 everywhere")
        try:
            lengths = np.broadcast_to(given, grasps.shape).ravel()
        except ValueError:
            raise InvalidInput(f"length must be a number or {grasps.shape}, got {given.shape}") from None
    result = np.empty(len(grasps.positions))

    def work(rows: slice) -> None:
        result[rows] = most * _radii(grasps, rows, lengths[rows], total)

    grasps.each_block(work)
    return result.reshape(grasps.shape)


def _radii(grasps: PlanarGrasps, rows: slice, lengths: Array, total: bool) -> Array:
    """(k,) radii at a limit of 1."""
    n, mu = grasps.normals[rows], grasps.frictions[rows, :, None]
    across = mu * np.stack([-n[..., 1], n[..., 0]], axis=-1)
    edges = grasps.wrenches(rows, np.stack([n - across, n + across], axis=2), lengths)  # (k, n, 2, 3)
    sides = edges.reshape(len(edges), -1, 3)
    if total:
        corners = np.concatenate([np.zeros((len(edges), 1, 3)), sides], axis=1)
        a, b, c = np.array(list(combinations(range(corners.shape[1]), 3))).T
        facets = np.cross(corners[:, b] - corners[:, a], corners[:, c] - corners[:, a])
    else:
        sides = np.concatenate([sides, edges[:, :, 1] - edges[:, :, 0]], axis=1)
        a, b = np.array(list(combinations(range(sides.shape[1]), 2))).T
        facets = np.cross(sides[:, a], sides[:, b])
    sizes = np.sqrt((facets * facets).sum(axis=-1))  # (k, f)
    first, second = (edges[:, :, e] @ facets.transpose(0, 2, 1) for e in (0, 1))  # (k, n, f)
    ahead = np.maximum(np.maximum(first, second), 0.0)
    behind = np.maximum(-np.minimum(first, second), 0.0)
    over = np.max if total else np.sum
    reach = np.minimum(over(ahead, axis=1), over(behind, axis=1))
    known = sizes > _NOISE * sizes.max(axis=1, keepdims=True)
    values = np.divide(reach, sizes, out=np.full(sizes.shape, np.inf), where=known)
    least: Array = values.min(axis=1)
    return np.where(np.isfinite(least), least, 0.0)
