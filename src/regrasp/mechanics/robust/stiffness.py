"""How forces change when the object gives way: fingers held at their set-points by springs.

A load deviation d moves the object by a small twist y with G K G' y = d, and each finger pushes back with its
stiffness, so the forces change by

    R d,   R = -K G' (G K G')^-1,   G R = -1.

A finger that leaves or arrives is force-controlled: its stiffness is zero. R does not depend on the unit of
stiffness, and leaves out that forces turn with the object: ``regrasp.least_stiffness`` says where that
matters.
"""

from collections.abc import Collection, Sequence

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, not_huge, numbers_in
from regrasp.mechanics.grasp import Grasp

Stiffness = float | tuple["Stiffness", ...]
"""One number, or nested tuples of a checked array: values that compare and hash."""

_SINGULAR = 1e-12
_SYMMETRIC = 1e-9


def checked_stiffness(given: ArrayLike | Stiffness | None) -> Stiffness:
    """A number for all fingers, or an array by contact (see ``stiffness_matrices``), as plain numbers."""
    if given is None:
        return 1.0
    values = numbers_in(given, "stiffness must be a number or an array with a row for each contact")
    if values.ndim > 3 or not values.size or not np.isfinite(values).all():
        raise InvalidInput(
            f"stiffness must be a number, (n,), (n, 2 or 3) or (n, d, d) finite numbers, got {shown(given)}"
        )
    if values.ndim < 3 and (values < 0).any():
        raise InvalidInput(f"stiffness must be at least 0, got {shown(given)}")
    not_huge(values, "stiffness")
    if not values.any():
        raise InvalidInput(f"stiffness must not be zero everywhere, got {shown(given)}")
    if values.ndim == 0:
        return float(values)
    return _nested(values.tolist())


def _nested(values: Sequence[float] | Sequence[list[float]] | list[float]) -> Stiffness:
    return tuple(_nested(v) if isinstance(v, list) else v for v in values)


def stiffness_matrices(grasp: Grasp, stiffness: Stiffness, controlled: Collection[int] = ()) -> Array:
    """(n, w, w) the stiffness of each finger, object frame [N/m], that about its normal [N m/rad].

    stiffness: one number, or (n,), the same in all directions; (n, 2) along the normal and across it;
    (n, 3) these and about the normal, of soft fingers; (n, w, w) symmetric matrices. controlled: the
    contacts whose force is controlled, of stiffness zero.
    """
    n, w, d = len(grasp), grasp.width, grasp.dimension
    values = np.array(stiffness, dtype=float)
    if values.ndim and len(values) != n:
        raise InvalidInput(
            f"stiffness must be one number or have a row for each of {n} contacts, got {len(values)}"
        )
    if values.ndim == 3:
        if values.shape[1:] != (w, w):
            raise InvalidInput(f"stiffness matrices must have shape ({n}, {w}, {w}), got {values.shape}")
        sizes = np.abs(values).max()
        if np.abs(values - values.transpose(0, 2, 1)).max() > _SYMMETRIC * sizes:
            raise InvalidInput("stiffness matrices must be symmetric")
        if np.linalg.eigvalsh(values).min() < -_SYMMETRIC * sizes:
            raise InvalidInput("stiffness matrices must be positive semidefinite")
        matrices = values.copy()
    else:
        if values.ndim < 2 and grasp.is_soft:
            raise InvalidInput(
                "soft fingers need a stiffness about their normals, too: give stiffness (n, 3), along the "
                "normal and across it [N/m] and about it [N m/rad]"
            )
        wanted = 3 if grasp.is_soft else 2
        if values.ndim == 2 and values.shape[1] != wanted:
            raise InvalidInput(
                f"stiffness must have shape ({n}, {wanted}) for these contacts, got {values.shape}"
            )
        along = values if values.ndim < 2 else values[:, 0]
        across = values if values.ndim < 2 else values[:, 1]
        along, across = (np.broadcast_to(v, n)[:, None, None] for v in (along, across))
        projections = grasp.normals[:, :, None] * grasp.normals[:, None]
        matrices = np.zeros((n, w, w))
        matrices[:, :d, :d] = across * np.eye(d) + (along - across) * projections
        if w > 3:
            matrices[:, 3, 3] = np.where(np.array(grasp.torsions) > 0, values[:, 2], 0.0)
    matrices[list(controlled)] = 0.0
    return matrices


def response(grasp: Grasp, stiffness: Stiffness = 1.0, controlled: Collection[int] = ()) -> Array:
    """R, (n w, 3) or (n w, 6): how forces (n, w) change per unit of load [N per N and per N m].

    Arguments are those of ``stiffness_matrices``.

    Raises:
        InvalidInput: Where no stiffness resists some motion of the object.
    """
    matrices = stiffness_matrices(grasp, stiffness, controlled)
    n, w = len(grasp), grasp.width
    weight = 1 / grasp.lengths
    scaled = grasp.matrix * weight[:, None]  # torques divided by the size
    pushed = np.einsum("iab,qib->iaq", matrices, scaled.reshape(-1, n, w)).reshape(n * w, -1)  # K G'
    resisted = scaled @ pushed
    values = np.linalg.eigvalsh(resisted)
    if not values[0] > _SINGULAR * values[-1]:
        working = grasp.subset(i for i in range(n) if i not in controlled) if len(controlled) < n else grasp
        motion = working.freedom or "some motion"
        raise InvalidInput(
            f"the fingers' stiffness does not resist {motion}, so forces under a disturbance are not "
            f"determined; give more fingers stiffness, or soft fingers with one about their normals"
        )
    result: Array = -np.linalg.solve(resisted, pushed.T).T * weight
    return result
