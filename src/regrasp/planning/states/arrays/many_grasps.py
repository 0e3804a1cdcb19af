"""Many grasps and their loads as checked arrays, and what is checked of forces and refusals."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.closed_form.conic.grasp_states import FAR
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, finite, numbers_in
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.mechanics.wrench import torque as moments
from regrasp.planning.states.objectives import Objective

MOST_FINGERS = 8
SMALL = 2.0**-40
_ROUNDING = 2.0**-44


@dataclass(frozen=True)
class ManyGrasps:
    """Checked: positions, normals (m, n, d). frictions, limits (m, n). loads (m, 3 or 6). shape: leading."""

    positions: Array
    normals: Array
    frictions: Array
    limits: Array
    loads: Array
    shape: tuple[int, ...]

    @classmethod
    def of(
        cls,
        positions: ArrayLike,
        normals: ArrayLike,
        frictions: ArrayLike,
        force: ArrayLike,
        torque: ArrayLike,
        max_force: ArrayLike | None,
    ) -> "ManyGrasps":
        """The arguments of ``choose_states``, checked and made as long as one another.

        Raises:
            InvalidInput: For whatever is wrong with them.
        """
        r, n = finite(positions, "positions"), finite(normals, "normals")
        if r.ndim < 2 or r.shape[-1] not in (2, 3) or n.shape[-2:] != r.shape[-2:]:
            raise InvalidInput(
                f"positions and normals must have shape (..., n, d) with d of 2 or 3, got {r.shape} and "
                f"{n.shape}"
            )
        count, d = r.shape[-2:]
        if not d <= count <= MOST_FINGERS:
            raise InvalidInput(f"a batch is of grasps with {d} to {MOST_FINGERS} fingers, got {count}")
        mu, f = finite(frictions, "frictions"), finite(force, "force", (d,))
        tau = finite(torque, "torque")
        if d == 3 and tau.shape[-1:] != (3,) and not (tau.ndim == 0 and tau == 0):
            raise InvalidInput(f"torque must have shape (..., 3) in space, got {tau.shape}")
        tau = tau[..., None] if d == 2 else np.broadcast_to(tau, (*tau.shape[:-1], 3))
        most = numbers_in(inf if max_force is None else max_force, "max_force must be numbers")
        if np.isnan(most).any() or not (most > 0).all():
            raise InvalidInput("max_force must be greater than 0 everywhere")
        if (mu <= NEGLIGIBLE).any():
            raise InvalidInput(f"frictions must be greater than {NEGLIGIBLE:g} everywhere; ask choose_state")
        for what, values in (("frictions", mu), ("max_force", most)):
            if values.shape != () and values.shape[-1] not in (1, count):
                raise InvalidInput(f"{what} must be a number or (..., {count}), got {values.shape}")
        try:
            leads = [x.shape[:-k] for x, k in ((r, 2), (n, 2), (f, 1), (tau, 1))]
            shape = np.broadcast_shapes(*leads, mu.shape[:-1], most.shape[:-1])
        except ValueError:
            raise InvalidInput(
                f"leading shapes must broadcast, got positions {r.shape}, normals {n.shape}, frictions "
                f"{mu.shape}, force {f.shape}, torque {tau.shape[:-1]}, max_force {most.shape}"
            ) from None
        sizes = np.sqrt((n * n).sum(axis=-1))
        if (sizes == 0).any():
            raise InvalidInput("normals must not be zero; give the direction that points into the object")

        def flat(values: Array, *tail: int) -> Array:
            return np.ascontiguousarray(np.broadcast_to(values, (*shape, *tail))).reshape(-1, *tail)

        return cls(
            flat(r, count, d),
            flat(n / sizes[..., None], count, d),
            flat(mu, count),
            flat(most, count),
            np.hstack([flat(f, d), flat(tau, 2 * d - 3)]),
            shape,
        )

    def some(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> "ManyGrasps":
        """Of some grasps, by flags or by places."""
        return replace(
            self,
            positions=self.positions[rows],
            normals=self.normals[rows],
            frictions=self.frictions[rows],
            limits=self.limits[rows],
            loads=self.loads[rows],
            shape=(len(self.loads[rows]),),
        )

    def without(self, i: int) -> "ManyGrasps":
        """The grasps without one finger."""
        r, n, mu, most = (
            np.delete(part, i, axis=1) for part in (self.positions, self.normals, self.frictions, self.limits)
        )
        return ManyGrasps(r, n, mu, most, self.loads, self.shape)

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return int(self.positions.shape[2])

    @property
    def sizes(self) -> Array:
        """(m,) the largest distance of a contact from the centre of mass; 1 where it is 0 [m]."""
        far = np.sqrt((self.positions**2).sum(axis=-1)).max(axis=1)
        return np.where(far > 0, far, 1.0)

    @property
    def scaled_loads(self) -> Array:
        """(m, 3 or 6), torques over sizes [N]."""
        loads = self.loads.copy()
        loads[:, self.dimension :] /= self.sizes[:, None]
        return loads

    def demand_limits(self, objective: Objective) -> None:
        """Refuse loads of zero where forces would have no size."""
        if objective.unbounded and (~self.loads.any(axis=1) & np.isinf(self.limits).any(axis=1)).any():
            raise InvalidInput(f"objective {shown(objective.name)} under a zero load needs max_force")

    def matrices(self) -> Array:
        """(m, 3 or 6, n d) grasp matrices, torques over sizes."""
        m, n, d = self.positions.shape
        axes = np.eye(d)
        arms = moments((self.positions / self.sizes[:, None, None])[:, :, None], axes)  # (m, n, d, 1 or 3)
        result = np.empty((m, 3 * d - 3, n, d))
        result[:, :d] = axes[:, None]
        result[:, d:] = np.moveaxis(arms, -1, 1)
        return result.reshape(m, 3 * d - 3, n * d)

    def holds(self, forces: Array) -> NDArray[np.bool_]:
        """(m,) whether forces are in equilibrium, inside cones and limits."""
        d = self.dimension
        arms = self.positions / self.sizes[:, None, None]
        total = np.concatenate([forces.sum(axis=1), moments(arms, forces).sum(axis=1)], axis=1)
        sizes = np.sqrt((forces * forces).sum(axis=-1))
        loads = self.scaled_loads
        scale = np.maximum(sizes.max(axis=1), np.abs(loads).max(axis=1))
        normal = np.einsum("mnd,mnd->mn", forces, self.normals)
        across = forces - normal[..., None] * self.normals
        inside = np.sqrt((across * across).sum(axis=-1)) <= self.frictions * normal
        inside |= sizes == 0
        off: Array = np.abs(total + loads).max(axis=1)
        assert d == forces.shape[2]
        return np.asarray(inside.all(axis=1) & (sizes <= self.limits).all(axis=1) & (off <= SMALL * scale))

    def is_lost(self, twists: Array) -> NDArray[np.bool_]:
        """(m,) whether the load does more work along a motion than forces within cones and limits oppose."""
        m, n, d = self.positions.shape
        loads = self.scaled_loads
        motion = twists / self.lengths
        velocities = np.einsum("mqk,mq->mk", self.matrices(), motion).reshape(m, n, d)
        along = np.einsum("mnd,mnd->mn", velocities, self.normals)
        across = np.sqrt(((velocities - along[..., None] * self.normals) ** 2).sum(axis=-1))
        mu = self.frictions
        opposed = np.maximum(mu * across - along, 0.0) / np.sqrt(1 + mu * mu)
        opposed = np.where(across <= -mu * along, np.hypot(along, across), opposed)
        limits = np.minimum(self.limits, FAR * np.abs(loads).max(axis=1)[:, None])
        work, power = (limits * opposed).sum(axis=1), np.einsum("mq,mq->m", loads, motion)
        terms = np.abs(motion).sum(axis=1) * (limits * (1 + mu)).sum(axis=1)
        return np.asarray(power > work + _ROUNDING * terms)

    @property
    def lengths(self) -> Array:
        """(m, 3 or 6) 1 for velocities, one over the size for spins: of motions over sizes."""
        d = self.dimension
        result = np.ones(self.loads.shape)
        result[:, d:] = 1 / self.sizes[:, None]
        return result
