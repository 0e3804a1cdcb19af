"""What forces withstand, for planar grasps by the hundred thousand: the closed forms of ``tolerances``."""

from dataclasses import dataclass
from math import inf, pi

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.arrays.planar import PlanarGrasps
from regrasp.mechanics.checks import Array, ArrayLike, finite, read_only
from regrasp.mechanics.value import ArrayValue

_NOTHING = 1e-14


@dataclass(frozen=True, eq=False)
class BatchTolerances(ArrayValue):
    """Arrays (...), as in ``Tolerated``; where forces are outside, friction is above 1 and wrench below 0.

    Args:
        friction: least factor on all coefficients [-].
        load: largest factor of the load [-].
        tilt: how far the load's force may turn [rad].
        centre: how far the centre of mass may be off, across the load [m].
        wrench: radius of the ball of deviations withstood, torques divided by the grasp's size [N].
    """

    friction: Array
    load: Array
    tilt: Array
    centre: Array
    wrench: Array


def batch_tolerances(
    positions: ArrayLike,
    normals: ArrayLike,
    frictions: ArrayLike,
    forces: ArrayLike,
    *,
    stiffness: ArrayLike = 1.0,
) -> BatchTolerances:
    """What the forces of many planar grasps withstand, in arrays; ``tolerances`` of one says who fails, too.

    The load is what the forces balance. Force limits do not count, positions are left to ``tolerances``.
    Leading shapes broadcast; NaN where forces are zero, or contacts coincide.

    Args:
        positions: (..., n, 2) relative to the centre of mass, n from 2 to 8 [m].
        normals: (..., n, 2) into the object, of any length but zero.
        frictions: (..., n), or one number.
        forces: (..., n, 2) of the fingers on the object, each finger at work [N].
        stiffness: of the fingers, the same in all directions: (..., n), or one number for all [N/m].

    Raises:
        InvalidInput: For bad input.
    """
    grasps = PlanarGrasps.of(positions, normals, frictions)
    shape = (*grasps.shape, grasps.positions.shape[1])
    given, springs = finite(forces, "forces"), finite(stiffness, "stiffness")
    if (springs <= 0).any():
        raise InvalidInput("stiffness must be greater than 0 everywhere")
    try:
        f = np.broadcast_to(given, (*shape, 2)).reshape(-1, *shape[-1:], 2)
        k = np.broadcast_to(springs, shape).reshape(-1, shape[-1])
    except ValueError:
        raise InvalidInput(
            f"forces must have shape {(*shape, 2)} and stiffness {shape}, or what broadcasts to them; got "
            f"{given.shape} and {springs.shape}"
        ) from None
    found = np.empty((5, len(f)))
    for rows in grasps.blocks():
        found[:, rows] = _of(grasps, rows, f[rows], k[rows])
    return BatchTolerances(*(read_only(values.reshape(grasps.shape)) for values in found))


@np.errstate(divide="ignore", invalid="ignore")
def _of(grasps: PlanarGrasps, rows: slice, f: Array, k: Array) -> Array:
    """(5, m) the fields of ``BatchTolerances``."""
    n, mu, sizes = grasps.normals[rows], grasps.frictions[rows], grasps.sizes[rows]
    t = np.stack([-n[..., 1], n[..., 0]], axis=-1)
    axes = np.broadcast_to(np.eye(2), (*f.shape[:2], 2, 2))
    blocks = grasps.wrenches(rows, axes, sizes)  # (m, n, 2, 3): rows of G', torques divided by sizes
    held = np.einsum("mn,mnax,mnay->mxy", k, blocks, blocks)
    load = -np.einsum("mnax,mna->mx", blocks, f)
    edges = np.stack([mu[..., None] * n - t, mu[..., None] * n + t], axis=2)  # (m, n, 2, 2)
    room = np.einsum("mnea,mna->mne", edges, f)
    sound = np.linalg.det(held) > 1e-12 * np.trace(held, axis1=1, axis2=2) ** 3 / 27
    held[~sound] = np.eye(3)
    # the work along -R'g of a deviation w is k_i g . blocks_i held^-1 w
    twists = np.einsum("mn,mnea,mnax,mxy->mney", k, edges, blocks, np.linalg.inv(held))
    normal, across = (f * n).sum(axis=-1), np.abs((f * t).sum(axis=-1))
    friction = np.where(across > 0, across / (mu * np.maximum(normal, 0.0)), 0.0)

    def least(work: Array) -> Array:
        none = work <= _NOTHING * np.abs(twists).max(axis=-1) * np.abs(load).max(axis=1)[:, None, None]
        ratio: Array = np.where(none, inf, room / work).min(axis=(1, 2))
        return ratio

    force = load[:, :2]
    size = np.sqrt((force * force).sum(axis=1))[:, None, None]
    q = np.sqrt((twists[..., :2] ** 2).sum(axis=-1)) * size
    ahead = np.einsum("mney,my->mne", twists[..., :2], force)
    needed = (room + ahead) / q
    angle = np.where(needed < 1, np.arccos(np.clip(ahead / q, -1, 1)) - np.arccos(np.clip(needed, -1, 1)), pi)
    tilt = np.minimum(np.where(q > 0, angle, pi).min(axis=(1, 2)), pi)
    length = np.sqrt((twists * twists).sum(axis=-1))
    result = np.stack(
        [
            friction.max(axis=1),
            1 + least(np.einsum("mney,my->mne", twists, load)),
            tilt,
            least(np.abs(twists[..., 2]) * size / sizes[:, None, None]),
            (room / length).min(axis=(1, 2)),
        ]
    )
    result[:, ~sound | ~f.any(axis=(1, 2))] = np.nan
    return result
