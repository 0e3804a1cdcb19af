"""The equilibrium locus of any number of contacts, in the plane or in space, as an object to ask."""

from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, finite, number, read_only, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import DEFAULT_BACKEND, choose_forces, choose_state
from regrasp.planning.states.criteria import PEAK_RATIO, ChosenState, Criteria
from regrasp.planning.states.escape import infeasible, loose_twist
from regrasp.planning.states.objectives import Objective
from regrasp.planning.surveys.squeeze_basis import SqueezeBasis, squeeze_basis

_MOST = 10_000_000  # states of a sample


@dataclass(frozen=True, eq=False, repr=False)
class SqueezeLocus(ArrayValue):
    """All forces of two contacts or more that balance a load inside the friction cones and force limits.

    They are f = f0 + sum x_k b_k: f0 the equilibrium with the least sum of squares, b_k one newton of each
    of ``dimension`` independent internal forces, x the coordinates, the **squeezes** [N]. Three contacts not
    on a line have one along each side of their triangle, positive where two fingers push towards each other.
    More contacts have the first pairs, in the order of the contacts, that are clearly independent; they are
    named in ``coordinates``.
    Contacts too many for one plane or line that holds them all also have forces across it, which no squeeze
    makes: one newton at a further contact, borne by the first ones.

    Args:
        grasp: two contacts or more, planar or in space.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        max_force: a limit on every force besides the contacts' own [N], or None. Friction is used in full;
            ``best`` keeps a reserve back. The locus is convex: a straight path between two of its states
            stays in it.

    Raises:
        InvalidInput: For fewer than two contacts and for soft fingers.
    """

    grasp: Grasp
    load: Wrench
    max_force: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.grasp, Grasp) or len(self.grasp) < 2:
            raise InvalidInput(
                f"a squeeze locus needs a Grasp of two contacts or more, got {shown(self.grasp)}"
            )
        if self.grasp.is_soft:
            raise InvalidInput(
                "a squeeze locus is of point contacts, got soft fingers; leave their torsion out, or ask "
                "choose_state for their states"
            )
        check_load(self.grasp, self.load)
        refuse_limits(self.grasp, "a squeeze locus")
        if self.max_force is not None:
            number(self.max_force, "max_force", above=0)

    # -- coordinates ----------------------------------------------------------------------------------

    @property
    def dimension(self) -> int:
        """Numbers that equilibrium leaves free: 2n - 3 in the plane, 3n - 6 in space (3n - 5 on a line)."""
        return len(self._basis.forces)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the squeezes: ``P1-P2`` along a pair; ``across at P4`` for a force across the plane."""
        return self._basis.names

    @property
    def internal(self) -> Array:
        """(k, n, d) the internal forces, G b = 0, of one newton of each squeeze."""
        return self._basis.forces

    @cached_property
    def _basis(self) -> SqueezeBasis:
        return squeeze_basis(self.grasp)

    @cached_property
    def _readings(self) -> Array:
        """(k, n, d): x = readings . f for f in equilibrium; f0 reads zero."""
        n, d = self.grasp.positions.shape
        inverse = np.linalg.pinv(self.internal.reshape(-1, n * d))
        return np.asarray(inverse.T.reshape(-1, n, d), dtype=float)

    @cached_property
    def least(self) -> Array:
        """(n, d) f0, the forces of the least sum of squares that balance the load, whatever the cones [N].

        Raises ``Infeasible`` where contacts on a line leave a turn free about which the load has a torque.
        """
        g, w = self.grasp.matrix.copy(), self.load.vector.copy()
        g[self.grasp.dimension :] /= self.grasp.size or 1.0
        w[self.grasp.dimension :] /= self.grasp.size or 1.0
        if loose_twist(self.grasp, self.load) is not None:
            raise infeasible(self.grasp, self.load, self._criteria("effort"))
        inverse = np.linalg.pinv(g, rcond=1e-12)
        f = -inverse @ w
        f = f - inverse @ (g @ f + w)
        return read_only(f.reshape(len(self.grasp), -1))

    def forces(self, squeezes: ArrayLike) -> Array:
        """Forces (..., n, d) at squeezes (..., k) [N]; in equilibrium for any squeezes.

        Args:
            squeezes: (..., k) coordinates [N].
        """
        x = finite(squeezes, "squeezes")
        if x.ndim == 0 or x.shape[-1] != self.dimension:
            raise InvalidInput(
                f"squeezes must have {self.dimension} numbers ({', '.join(self.coordinates)}), got {x.shape}"
            )
        result: Array = self.least + np.tensordot(x, self.internal, 1)
        return result

    def squeezes(self, forces: ArrayLike | GraspState) -> Array:
        """Squeezes (..., k) of forces (..., n, d) in equilibrium, or of a state of this grasp [N].

        Of other forces, those of the nearest ones in equilibrium.

        Args:
            forces: (..., n, d) object frame [N], or a state of this grasp.
        """
        f = forces.forces if isinstance(forces, GraspState) else finite(forces, "forces")
        if f.shape[-2:] != self.grasp.positions.shape:
            raise InvalidInput(f"forces must have shape (..., {len(self.grasp)}, {self.grasp.dimension})")
        result: Array = np.tensordot(f, self._readings, axes=((-2, -1), (1, 2)))
        return result

    # -- the locus ------------------------------------------------------------------------------------

    @cached_property
    def _some(self) -> Array | Infeasible:
        """A state's forces (n, d), or why there are none."""
        try:
            chosen = choose_forces(self.grasp, self.load, self._criteria("effort"))
        except Infeasible as reason:
            return reason.with_traceback(None)
        return np.array(chosen.forces)

    @property
    def why(self) -> Infeasible | None:
        """Why the locus is empty, with the escape twist as its certificate; None where it is not."""
        return self._some if isinstance(self._some, Infeasible) else None

    @property
    def is_empty(self) -> bool:
        """Whether no forces inside the cones and limits balance the load."""
        return self.why is not None

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """(lo, hi), (k,) each: how far every squeeze goes over the whole locus [N]; (inf, -inf) if empty.

        Infinite where internal forces inside the cones can grow for ever. Conic programs, audited: raises
        ``SolverFailed`` where an end is neither found nor proven to be infinite.
        """
        from regrasp.planning.surveys.squeeze_bounds import least

        if self.is_empty:
            return read_only(np.full(self.dimension, inf)), read_only(np.full(self.dimension, -inf))
        limits = self._criteria("effort").limits(self.grasp)
        ends = [
            [sign * least(self.grasp, self.load, limits, sign * c, DEFAULT_BACKEND) for sign in (1, -1)]
            for c in self._readings
        ]
        lo, hi = np.array(ends).reshape(-1, 2).T
        return read_only(lo.copy()), read_only(hi.copy())

    def contains(self, point: ArrayLike | GraspState) -> bool:
        """Whether squeezes (k,), forces (n, d) or a state of this grasp belong to the locus.

        Judged to rounding: equilibrium to 1e-13 of the largest force, cones to 2^-50 of each.

        Args:
            point: squeezes (k,) [N], forces (n, d) [N] or a state of this grasp.
        """
        given = point.forces if isinstance(point, GraspState) else finite(point, "point")
        if given.ndim == 1 and self.why is not None and loose_twist(self.grasp, self.load) is not None:
            return False
        forces = self.forces(given) if given.ndim == 1 else given
        state = GraspState(self.grasp, self.load, forces)
        limits = np.array(self._criteria("effort").limits(self.grasp))
        return state.is_balanced(reserve=0.0) and bool((state.magnitudes <= limits).all())

    def state(self, squeezes: ArrayLike) -> GraspState:
        """The state at squeezes (k,) on the locus; ``InvalidInput`` outside it.

        Args:
            squeezes: (k,) on the locus [N].
        """
        x = array(squeezes, "squeezes", (self.dimension,))
        if not self.contains(x):
            why = "" if self.why is None else f": {self.why}"
            raise InvalidInput(f"squeezes {x.tolist()} are not on the locus{why}")
        return GraspState(self.grasp, self.load, self.forces(x))

    def margins(self, squeezes: ArrayLike) -> Margins:
        """Margins (..., n) of every contact at squeezes (..., k).

        Args:
            squeezes: (..., k) coordinates [N].
        """
        return margins(self.forces(squeezes), self.grasp.normals, self.grasp.frictions)

    def best(
        self,
        objective: str | Objective = "angle",
        *,
        peak_ratio: float = PEAK_RATIO,
        reserve: float = RESERVE,
    ) -> ChosenState:
        """The best state on the locus for an objective; see ``choose_state``.

        Args:
            objective: a word, or an objective of one's own.
            peak_ratio: where a contact has no limit, this multiple of the least peak force limits every force
                [-].
            reserve: fraction of every friction coefficient that is kept back [-].
        """
        return choose_state(
            self.grasp,
            self.load,
            objective,
            max_force=self.max_force,
            peak_ratio=peak_ratio,
            reserve=reserve,
        )

    def sample(self, count: int, seed: int = 0, *, peak_ratio: float = PEAK_RATIO) -> Array:
        """(count, n, d) forces of random states spread evenly over the locus, each by a walk of its own [N].

        Where a contact has no limit, all forces are kept below ``peak_ratio`` times the least peak force that
        holds the load, as in ``choose_state``. ``squeezes`` of the result are points to draw.

        Args:
            count: how many states.
            seed: of the random choice; the same seed, the same choice.
            peak_ratio: where a contact has no limit, this multiple of the least peak force limits every force
                [-].

        Raises:
            Infeasible: For an empty locus.
            InvalidInput: For one without volume.
        """
        from regrasp.planning.surveys.hit_and_run import walked

        whole(count, "count", least=1, most=_MOST)
        whole(seed, "seed", least=0)
        if isinstance(self._some, Infeasible):
            raise self._some
        criteria = self._criteria("force", peak_ratio)
        criteria.demand_limit(self.grasp, self.load)
        limits = criteria.limits(self.grasp)
        if inf in limits:
            peak = self.best("peak", reserve=0.0)
            limits = [min(limit, peak_ratio * peak.value) for limit in limits]
            held = peak.forces
        else:
            held = self._some
        return walked(self.grasp, held, limits, count, np.random.default_rng(seed), DEFAULT_BACKEND)

    def _criteria(self, objective: str | Objective, peak_ratio: float = PEAK_RATIO) -> Criteria:
        return Criteria(objective, self.max_force, peak_ratio, reserve=0.0)

    def __repr__(self) -> str:
        what = "empty" if self.is_empty else f"squeezes {', '.join(self.coordinates)}"
        return f"SqueezeLocus of {', '.join(self.grasp.names)} under {self.load!r}: {what}"
