"""Arrays of planar grasps, checked: positions, normals and frictions of n fingers, many grasps at once."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, finite
from regrasp.threads import threads

BLOCK = 4096
"""Grasps that are worked on at a time: more would leave the processor's cache."""
MOST_FINGERS = 8


class PlanarGrasps(NamedTuple):
    """positions, normals: (m, n, 2) [m], unit. frictions: (m, n). shape: in which the m grasps were given."""

    positions: Array
    normals: Array
    frictions: Array
    shape: tuple[int, ...]

    @classmethod
    def of(cls, positions: ArrayLike, normals: ArrayLike, frictions: ArrayLike) -> "PlanarGrasps":
        """Checked arrays (..., n, 2), (..., n, 2) and (..., n), whose leading shapes broadcast.

        Raises:
            InvalidInput: For other shapes, numbers that are not finite, zero normals and negative frictions.
        """
        r, n = finite(positions, "positions"), finite(normals, "normals")
        mu = finite(frictions, "frictions")
        if r.ndim < 2 or r.shape[-1] != 2 or n.shape[-2:] != r.shape[-2:]:
            raise InvalidInput(
                f"positions and normals must have shape (..., n, 2), got {r.shape} and {n.shape}"
            )
        if not 2 <= r.shape[-2] <= MOST_FINGERS:
            raise InvalidInput(f"a batch is of grasps with 2 to {MOST_FINGERS} fingers, got {r.shape[-2]}")
        if mu.shape != () and mu.shape[-1] not in (1, r.shape[-2]):
            raise InvalidInput(f"frictions must be a number or (..., {r.shape[-2]}), got {mu.shape}")
        try:
            shape = np.broadcast_shapes(r.shape[:-1], n.shape[:-1], mu.shape)
        except ValueError:
            raise InvalidInput(
                f"leading shapes must broadcast, got positions {r.shape}, normals {n.shape}, frictions "
                f"{mu.shape}"
            ) from None
        lengths = np.hypot(n[..., 0], n[..., 1])
        if (lengths == 0).any():
            raise InvalidInput("normals must not be zero; give the direction that points into the object")
        if (mu < 0).any():
            raise InvalidInput("frictions must be at least 0 everywhere")
        wide = (*shape, 2)
        return cls(
            np.broadcast_to(r, wide).reshape(-1, *wide[-2:]),
            np.broadcast_to(n / lengths[..., None], wide).reshape(-1, *wide[-2:]),
            np.broadcast_to(mu, shape).reshape(-1, shape[-1]),
            shape[:-1],
        )

    @property
    def sizes(self) -> Array:
        """(m,) the largest distance of a contact from the centre of mass; 1 where it is 0 [m]."""
        far = np.sqrt((self.positions**2).sum(axis=-1)).max(axis=1)
        return np.where(far > 0, far, 1.0)

    def each_block(self, work: Callable[[slice], None]) -> None:
        """Call ``work`` for ``BLOCK`` grasps at a time, on all cores: NumPy lets go of Python's lock."""
        blocks = [slice(first, first + BLOCK) for first in range(0, len(self.positions), BLOCK)]
        if len(blocks) < 2:
            for rows in blocks:
                work(rows)
            return
        with ThreadPoolExecutor(min(len(blocks), threads())) as pool:
            list(pool.map(work, blocks))

    def wrenches(self, rows: slice, directions: Array, lengths: Array) -> Array:
        """(k, n, ..., 3) of forces along ``directions`` (k, n, ..., 2), torques over lengths (k,)."""
        r = self.positions[rows].reshape(*directions.shape[:2], *[1] * (directions.ndim - 3), 2)
        torques = r[..., 0] * directions[..., 1] - r[..., 1] * directions[..., 0]
        torques = torques / lengths.reshape(-1, *[1] * (torques.ndim - 1))
        return np.concatenate([directions, torques[..., None]], axis=-1)
