"""The best forces of many grasps under their loads, as arrays."""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.closed_form.conic.grasp_states import FAR, HELD, NONE, OPEN
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, Flags, finite, number, numbers_in, read_only
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.reserve import NEGLIGIBLE, RESERVE, reserve_fraction
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import torque as moments
from regrasp.planning.states.batch import best_squeezes
from regrasp.planning.states.criteria import PEAK_RATIO
from regrasp.planning.states.objectives import LevelObjective, Objective, objective_of

MOST_FINGERS = 8
_SMALL = 2.0**-40
_ROUNDING = 2.0**-44


@dataclass(frozen=True, eq=False)
class BatchStates(ArrayValue):
    """The best forces of many grasps; leading shapes (...) are those given.

    Args:
        held: (...) whether a grasp holds its load: by ``forces`` that were checked.
        refused: (...) whether none do, proven by ``twists``. Where neither is so, rounding leaves it open, or
            a motion that no contact resists; ``choose_state`` says more.
        values: (...) of the objective in its unit; NaN where a load is not held.
        forces: (..., n, d) [N]; NaN where it is not held.
        margins: of these forces, each (..., n).
        twists: (..., 3) or (..., 6) motions along which the load does more work than any forces within cones
            and limits oppose, or within 1e4 times the load where there are no limits; zero where none is
            needed.
    """

    held: Flags
    refused: Flags
    values: Array
    forces: Array
    margins: Margins
    twists: Array


def choose_states(
    positions: ArrayLike,
    normals: ArrayLike,
    frictions: ArrayLike,
    force: ArrayLike,
    torque: ArrayLike = 0.0,
    *,
    objective: str | Objective = "force",
    max_force: ArrayLike | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
) -> BatchStates:
    """``choose_state`` for arrays of grasps of point contacts, in the plane and in space.

    Two planar contacts by the closed form; others by small conic programs, compiled by Numba (seconds on the
    first call, then kept) and run on all cores. Every state is checked, every refusal proven.

    Args:
        positions: (..., n, d) of the contacts, object frame, n from 2 to 8 in the plane, 3 to 8 in space [m].
        normals: (..., n, d) into the object, of any length but zero.
        frictions: (..., n), or one number, greater than 0.
        force: (..., d) of the load, object frame [N].
        torque: (...) of the load about the centre of mass, (..., 3) in space; 0 for none [N m].
        objective: a word: ``force``, ``effort``, ``peak``, ``peak_normal`` or ``sum_normal``; of two planar
            contacts ``angle`` and ``friction_use``, too.
        max_force: (..., n), or one number; infinite for none [N].
        peak_ratio: as for ``choose_state`` [-].
        reserve: fraction of every friction coefficient that is kept back [-].

    Raises:
        InvalidInput: For bad input, and for an objective that needs limits under a load of zero.
    """
    sought = objective_of(objective)
    if sought.closed_form is None:
        raise InvalidInput(f"objective {shown(sought.name)} has no batch; ask choose_state")
    number(peak_ratio, "peak_ratio", least=1)
    given = _Given.of(positions, normals, frictions, force, torque, max_force)
    is_pair = given.positions.shape[1:] == (2, 2)
    if isinstance(sought, LevelObjective) and not is_pair:
        raise InvalidInput(
            f"objective {shown(sought.name)} has no batch with more than two planar contacts; "
            "take 'force', or ask choose_state"
        )
    kept = 1 - reserve_fraction(reserve)
    given.demand_limits(sought)
    if is_pair:
        forces, verdicts, twists = _pairs(given, sought, peak_ratio, kept)
    else:
        forces, verdicts, twists = _solved(given, sought, peak_ratio, kept)
    held = (verdicts == HELD) & given.holds(forces)
    refused = (verdicts == NONE) & given.is_lost(twists)
    forces[~held] = np.nan
    twists[~refused] = 0.0
    found = margins(forces, given.normals, given.frictions)
    for verdict in (held, refused):
        verdict.setflags(write=False)
    return BatchStates(
        held.reshape(given.shape),
        refused.reshape(given.shape),
        read_only(np.where(held, _values(sought.name, forces, found, given), np.nan).reshape(given.shape)),
        read_only(forces.reshape(*given.shape, *forces.shape[1:])),
        Margins(
            *(
                read_only(x.reshape(*given.shape, x.shape[1]))
                for x in (found.angle, found.force, found.friction_use)
            )
        ),
        read_only(twists.reshape(*given.shape, twists.shape[1])),
    )


@dataclass(frozen=True)
class _Given:
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
    ) -> "_Given":
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

    def some(self, rows: NDArray[np.bool_]) -> "_Given":
        """Of some grasps."""
        return _Given(
            self.positions[rows],
            self.normals[rows],
            self.frictions[rows],
            self.limits[rows],
            self.loads[rows],
            (int(rows.sum()),),
        )

    @property
    def dimension(self) -> int:
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
        return np.asarray(inside.all(axis=1) & (sizes <= self.limits).all(axis=1) & (off <= _SMALL * scale))

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


Chosen = tuple[Array, NDArray[np.int64], Array]


def _pairs(given: _Given, objective: Objective, peak_ratio: float, kept: float) -> Chosen:
    """Forces, verdicts and twists of two planar contacts, by the closed form."""
    (r1, r2), (n1, n2) = given.positions.transpose(1, 0, 2), given.normals.transpose(1, 0, 2)
    mu, limits = kept * given.frictions, (1 - _SMALL) * given.limits
    load = given.loads
    x = best_squeezes(
        r1, n1, mu[:, 0], r2, n2, mu[:, 1], load[:, :2], load[:, 2],
        objective=objective, max_force=(limits[:, 0], limits[:, 1]), peak_ratio=peak_ratio,
    )  # fmt: skip
    apart = r2 - r1
    length = np.hypot(*apart.T)
    u = apart / length[:, None]
    p = np.stack([-u[:, 1], u[:, 0]], axis=1)
    phi, side = (u * load[:, :2]).sum(axis=1), (p * load[:, :2]).sum(axis=1)
    arm, before = r1[:, 0] * u[:, 1] - r1[:, 1] * u[:, 0], (r1 * u).sum(axis=1)
    b = (arm * phi - load[:, 2] + before * side) / length
    forces = np.stack(
        [x[:, None] * u - (side + b)[:, None] * p, -(x + phi)[:, None] * u + b[:, None] * p], axis=1
    )
    verdicts, twists = np.full(len(x), HELD, dtype=np.int64), np.zeros_like(load)
    lost = np.isnan(x)
    if lost.any():  # the programs prove it
        _, found, twists[lost] = _solved(given.some(lost), objective, peak_ratio, kept)
        verdicts[lost] = np.where(found == NONE, NONE, OPEN)
    return forces, verdicts, twists


def _solved(given: _Given, objective: Objective, peak_ratio: float, kept: float) -> Chosen:
    from regrasp.closed_form.compiled.grasp_states import best_states

    m, n, d = given.positions.shape
    loads = given.scaled_loads
    units = np.abs(loads).max(axis=1)
    idle = units == 0
    units = np.where(idle, np.where(np.isinf(given.limits), 1.0, given.limits).min(axis=1), units)
    forces, twists = np.zeros((m, n, d)), np.zeros((m, 3 * d - 3))
    verdicts = np.zeros(m, dtype=np.int64)
    tangents = tangents_of(given.normals.reshape(-1, d)).reshape(m, n, d - 1, d)
    parts = (
        given.matrices(), loads / units[:, None], given.normals, tangents, kept * given.frictions,
        given.limits / units[:, None],
    )  # fmt: skip
    plain = (np.array(part, order="C") for part in parts)  # of one type, so that they are compiled for once
    best_states(m, objective.closed_form, float(peak_ratio), *plain, forces, twists, verdicts)
    forces *= units[:, None, None]
    if not objective.unbounded:  # of a load of zero nothing is the best
        forces[idle], verdicts[idle] = 0.0, HELD
    return forces, verdicts, twists * given.lengths


def _values(name: str, forces: Array, found: Margins, given: _Given) -> Array:
    """(m,) what the objective comes to."""
    sizes = (forces * forces).sum(axis=-1)
    normal = np.einsum("mnd,mnd->mn", forces, given.normals)
    by_name = {
        "angle": lambda: np.where(np.isnan(found.angle), inf, found.angle).min(axis=1),
        "friction_use": lambda: np.where(np.isnan(found.friction_use), -inf, found.friction_use).max(axis=1),
        "force": lambda: found.force.min(axis=1),
        "effort": lambda: sizes.sum(axis=1),
        "peak": lambda: np.sqrt(sizes.max(axis=1)),
        "peak_normal": lambda: normal.max(axis=1),
        "sum_normal": lambda: normal.sum(axis=1),
    }
    with np.errstate(all="ignore"):
        return np.asarray(by_name[name]())
