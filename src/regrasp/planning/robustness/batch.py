"""What forces withstand, for planar grasps by the hundred thousand: the closed forms of ``tolerances``."""

from dataclasses import dataclass
from math import inf, pi
from typing import NamedTuple

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.arrays.planar import PlanarGrasps
from regrasp.mechanics.checks import Array, ArrayLike, Flags, finite, read_only
from regrasp.mechanics.value import ArrayValue

_NOTHING = 1e-14
_SINGULAR = 1e-12
_SYMMETRIC = 1e-9
_REACH = 2.0  # positions count within so many sizes of the grasp


@dataclass(frozen=True, eq=False)
class BatchTolerances(ArrayValue):
    """Arrays (...), as in ``Tolerated``; where forces are outside, friction is above 1 and wrench below 0.

    Args:
        friction: least factor on all coefficients [-].
        load: largest factor of the load [-].
        tilt: how far the load's force may turn [rad].
        centre: how far the centre of mass may be off, across the load [m].
        wrench: radius of the ball of deviations withstood, torques divided by the grasp's size [N].
        position: (..., n) how far each contact alone may be off along its tangent, either way, on flat
            surfaces [m]; infinite where it does not matter within twice the grasp's size.
        stiffness: the least factor of the stiffness given with which the object stays in its fingers [-].
    """

    friction: Array
    load: Array
    tilt: Array
    centre: Array
    wrench: Array
    position: Array
    stiffness: Array


def batch_tolerances(
    positions: ArrayLike,
    normals: ArrayLike,
    frictions: ArrayLike,
    forces: ArrayLike,
    *,
    stiffness: ArrayLike = 1.0,
) -> BatchTolerances:
    """What the forces of many planar grasps withstand, in arrays; ``tolerances`` of one says who fails, too.

    The load is what the forces balance. Force limits do not count. Leading shapes broadcast, positions and
    normals of each grasp included; NaN where forces are zero, or contacts coincide. Runs on all cores.

    Args:
        positions: (..., n, 2) relative to the centre of mass, n from 2 to 8 [m].
        normals: (..., n, 2) into the object, of any length but zero.
        frictions: (..., n), or one number.
        forces: (..., n, 2) of the fingers on the object, each finger at work [N].
        stiffness: of the fingers [N/m]: one number for all; (..., n) the same in all directions;
            (..., n, 2, 2) symmetric positive definite matrices, object frame.

    Raises:
        InvalidInput: For bad input.
    """
    grasps = PlanarGrasps.of(positions, normals, frictions)
    shape = (*grasps.shape, grasps.positions.shape[1])
    given, springs = finite(forces, "forces"), finite(stiffness, "stiffness")
    try:
        f = np.broadcast_to(given, (*shape, 2)).reshape(-1, *shape[-1:], 2)
        k = _matrices(springs, shape).reshape(-1, shape[-1], 2, 2)
    except InvalidInput:
        raise
    except ValueError:
        raise InvalidInput(
            f"forces must have shape {(*shape, 2)} and stiffness {shape} or {(*shape, 2, 2)}, or what "
            f"broadcasts to them; got {given.shape} and {springs.shape}"
        ) from None
    found = np.empty((6, len(f)))
    off = np.empty((len(f), shape[-1]))

    def work(rows: slice) -> None:
        planar = _Planar(grasps, rows, f[rows], k[rows])
        found[:, rows], off[rows] = planar.of_loads(), planar.of_positions()

    grasps.each_block(work)
    friction, load, tilt, centre, wrench, kept = (read_only(v.reshape(grasps.shape)) for v in found)
    return BatchTolerances(friction, load, tilt, centre, wrench, read_only(off.reshape(shape)), kept)


def _matrices(springs: Array, shape: tuple[int, ...]) -> Array:
    """(..., n, 2, 2) positive definite."""
    if springs.ndim > 2 and springs.shape[-3:] == (shape[-1], 2, 2):
        a, b, c, d = (springs[..., i, j] for i in (0, 1) for j in (0, 1))
        if (np.abs(b - c) > _SYMMETRIC * np.abs(springs).max()).any() or not (
            (a > 0) & (a * d > b * c)
        ).all():
            raise InvalidInput("stiffness matrices must be symmetric and positive definite")
        return np.broadcast_to(springs, (*shape, 2, 2))
    if (springs <= 0).any():
        raise InvalidInput("stiffness must be greater than 0 everywhere")
    return np.asarray(np.broadcast_to(springs, shape)[..., None, None] * np.eye(2))


class _Planar:
    """``planar.PlanarForces`` for forces (m, n, 2) that answer with springs (m, n, 2, 2)."""

    def __init__(self, grasps: PlanarGrasps, rows: slice, f: Array, springs: Array) -> None:
        self.r, self.n, self.mu = grasps.positions[rows], grasps.normals[rows], grasps.frictions[rows]
        self.f, self.sizes = f, grasps.sizes[rows]
        self.t = np.stack([-self.n[..., 1], self.n[..., 0]], axis=-1)
        self.edges = np.stack([-self.t, self.t], axis=2) + (self.mu[..., None] * self.n)[:, :, None]
        self.room = np.einsum("mnea,mna->mne", self.edges, f)
        working: Flags = np.array(f.any(axis=2))  # nobody commands the idle ones
        self.springs = np.where(working[..., None, None], springs, 0.0)
        axes = np.broadcast_to(np.eye(2), (*f.shape[:2], 2, 2))
        self.blocks = grasps.wrenches(rows, axes, self.sizes)  # (m, n, 2, 3): G', torques divided by sizes
        held = np.einsum("mnax,mnab,mnby->mxy", self.blocks, self.springs, self.blocks)
        scale = np.trace(held, axis1=1, axis2=2) / 3
        self.sound: Flags = np.array((np.linalg.det(held) > _SINGULAR * scale**3) & f.any(axis=(1, 2)))
        self.held = np.where(self.sound[:, None, None], held, np.eye(3))

    @np.errstate(divide="ignore", invalid="ignore")
    def of_loads(self) -> Array:
        """(6, m) friction, load, tilt, centre, wrench and stiffness."""
        f, sizes, room = self.f, self.sizes, self.room
        load = -np.einsum("mnax,mna->mx", self.blocks, f)
        # the work along -R'g of a deviation w is g . K_i blocks_i held^-1 w
        pushed = np.einsum("mnea,mnab,mnbx->mnex", self.edges, self.springs, self.blocks)
        twists = np.einsum("mnex,mxy->mney", pushed, np.linalg.inv(self.held))
        normal, across = (f * self.n).sum(axis=-1), np.abs((f * self.t).sum(axis=-1))
        friction = np.where(across > 0, across / (self.mu * np.maximum(normal, 0.0)), 0.0)

        def least(work: Array) -> Array:
            none = work <= _NOTHING * np.abs(twists).max(axis=-1) * np.abs(load).max(axis=1)[:, None, None]
            ratio: Array = np.where(none, inf, room / work).min(axis=(1, 2))
            return ratio

        force = load[:, :2]
        size = np.sqrt((force * force).sum(axis=1))[:, None, None]
        q = np.sqrt((twists[..., :2] ** 2).sum(axis=-1)) * size
        ahead = np.einsum("mney,my->mne", twists[..., :2], force)
        needed = (room + ahead) / q
        turned = np.arccos(np.clip(ahead / q, -1, 1)) - np.arccos(np.clip(needed, -1, 1))
        tilt = np.where((q > 0) & (needed < 1), turned, pi).min(axis=(1, 2))
        length = np.sqrt((twists * twists).sum(axis=-1))
        away = np.where(length > 0, room / length, inf).min(axis=(1, 2))
        squeeze = (self.r * f).sum(axis=(1, 2))
        result = np.stack(
            [
                friction.max(axis=1),
                1 + least(np.einsum("mney,my->mne", twists, load)),
                np.minimum(tilt, pi),
                least(np.abs(twists[..., 2]) * size / sizes[:, None, None]),
                away,
                np.maximum(-squeeze / self._turning().against, 0.0),
            ]
        )
        result[:, ~self.sound] = np.nan
        return result

    def _turning(self) -> "_Turning":
        """How the springs answer a torque; see ``planar``."""
        q = np.stack([-self.r[..., 1], self.r[..., 0]], axis=-1)
        a = self.springs.sum(axis=1)
        a[~self.sound] = np.eye(2)
        inverse = np.linalg.inv(a)
        kq = np.einsum("mnab,mnb->mna", self.springs, q)
        b = kq.sum(axis=1)
        off = np.einsum("mab,mb->ma", inverse, b)
        return _Turning(q, inverse, off, (q * kq).sum(axis=(1, 2)) - (b * off).sum(axis=1))

    @np.errstate(divide="ignore", invalid="ignore", over="ignore")
    def of_positions(self) -> Array:
        """(m, n) offsets of one contact after the other, at the first roots of quadratics."""
        f, t, turning = self.f, self.t, self._turning()
        q, against = turning.q, turning.against[:, None, None]
        h = np.einsum("mnab,mneb->mnea", self.springs, self.edges)
        turn = np.einsum("mnea,mna->mne", h, q - turning.off[:, None])
        result = np.empty(f.shape[:2])
        for i in range(f.shape[1]):
            torque = (t[:, i, 0] * f[:, i, 1] - t[:, i, 1] * f[:, i, 0])[:, None, None]
            p = np.stack([-t[:, i, 1], t[:, i, 0]], axis=-1)
            kp = np.einsum("mab,mb->ma", self.springs[:, i], p)
            moved = np.einsum("mab,mb->ma", turning.inverse, kp)
            s1 = 2 * ((q[:, i] - turning.off) * kp).sum(axis=1)[:, None, None]
            s2 = ((p - moved) * kp).sum(axis=1)[:, None, None]
            away = np.zeros_like(f) - moved[:, None]
            away[:, i] += p
            a0 = np.maximum(self.room, 0.0) * against
            a1 = self.room * s1 - torque * turn
            a2 = self.room * s2 - torque * np.einsum("mnea,mna->mne", h, away)
            square = a1 * a1 - 4 * a0 * a2
            root = -(a1 + np.copysign(np.sqrt(square), a1)) / 2
            first = np.where((square > 0) & (root != 0), np.abs(a0 / root), inf)
            at_edge = np.where((a1 != 0) | (a2 < 0), 0.0, inf)
            result[:, i] = np.where(a0 == 0, at_edge, first).min(axis=(1, 2))
        result[(result > _REACH * self.sizes[:, None]) | ~f.any(axis=2)] = inf
        result[~self.sound] = np.nan
        return result


class _Turning(NamedTuple):
    """q = (-y, x) (m, n, 2), the inverse of sum K (m, 2, 2), A^-1 b (m, 2), and s (m,) as in ``planar``."""

    q: Array
    inverse: Array
    off: Array
    against: Array
