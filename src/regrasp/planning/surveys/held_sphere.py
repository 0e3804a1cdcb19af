"""The directions of a load that a grasp in space holds, sampled on a sphere.

In the plane they are an arc, known exactly (``held_directions``). In space, without force limits, they are a
convex cone too, but bounded by surfaces: so directions are sampled, and between them two proofs are at hand.
A direction that is a non-negative combination of held ones is held, by the same combination of their forces;
one along which a known escape twist does work is not.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import nan, pi, sqrt
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, number, read_only, whole
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.orientation.spiral import even_directions
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import ChosenState, Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import LimitOptions, criteria_of, takes

_MOST = 1_000_000  # directions
COUNT = 400
"""Default number of directions."""


@dataclass(frozen=True, eq=False, repr=False)
class HeldSphere(ArrayValue):
    """What a grasp in space reaches under a force through the centre of mass, direction by direction.

    Sampled: between the directions nothing is said but by ``holds``, which decides for any one.

    Args:
        grasp: the n contacts.
        magnitude: of the load [N].
        criteria: objective and limits of the states.
        directions: (m, 3), unit, of the load in the object frame.
        values: (m,) the objective reached, units as for ``choose_state``; NaN where the load is not held.
        forces: (m, n, 3) of those states [N], NaN where not held; (m, n, 4) with soft fingers, as in
            ``GraspState``.
    """

    grasp: Grasp
    magnitude: float
    criteria: Criteria
    directions: Array
    values: Array
    forces: Array = field(compare=False)
    twists: tuple[EscapeTwist, ...] = field(compare=False)
    """Escape twists that prove the directions that are not held, each for some of them."""

    @property
    def held(self) -> NDArray[np.bool_]:
        """(m,) whether each direction is held."""
        return ~np.isnan(self.values)

    @property
    def share(self) -> float:
        """The fraction of the directions that are held: an estimate of the solid angle over 4 pi."""
        return float(self.held.mean())

    @property
    def spacing(self) -> float:
        """The angle between neighbouring directions, sqrt(4 pi / m) [rad]: details below it are not seen."""
        return sqrt(4 * pi / len(self.directions))

    @property
    def shown(self) -> Array:
        """(m,) values to draw, angles in degrees: ``plot_load_sphere(directions, shown, label=label)``."""
        return np.degrees(self.values) if self.criteria.objective.unit == "rad" else self.values

    @property
    def label(self) -> str:
        """What ``shown`` is, with its unit."""
        objective = self.criteria.objective
        unit = {"rad": "deg", "-": ""}.get(objective.unit, objective.unit)
        return objective.words + (f" [{unit}]" if unit else "")

    def state(self, direction: ArrayLike) -> GraspState:
        """A state that holds the load in a direction (3,), of any length but zero.

        The combination of the nearest sampled states where that is a state, else one that is chosen.

        Args:
            direction: (3,) of the load, object frame, of any length but zero.

        Raises:
            Infeasible: Where the grasp holds no load in that direction.
        """
        load = self._load(direction)
        state = self._combined(load)
        if state is not None:
            return state
        for known in self.twists:
            if (twist := _escapes(known, load)) is not None:
                raise Infeasible(f"no forces balance {shown(load)}: the object escapes by {twist}", twist)
        chosen = choose_forces(self.grasp, load, self._plain)
        return ChosenState(self.grasp, load, self._plain, chosen)

    def holds(self, direction: ArrayLike) -> bool:
        """Whether the load in a direction (3,) is held: proven from the samples, or decided by solving.

        Friction less the reserve, and the force limits, count as they did for the samples.

        Args:
            direction: (3,) of the load, object frame, of any length but zero.
        """
        try:
            self.state(direction)
        except Infeasible:
            return False
        return True

    @cached_property
    def _plain(self) -> Criteria:
        c = self.criteria
        return Criteria("effort", c.max_force, c.peak_ratio, c.reserve)

    def _load(self, direction: ArrayLike) -> Wrench:
        u = array(direction, "direction", (3,))
        largest = float(abs(u).max())
        if largest == 0:
            raise InvalidInput("direction must not be zero")
        u = u / largest
        return Wrench(self.magnitude * u / np.linalg.norm(u))

    def _combined(self, load: Wrench) -> GraspState | None:
        """The state at a non-negative combination of held directions, if it is one to rounding."""
        from scipy.optimize import nnls

        if not self.held.any():
            return None
        shares, miss = nnls(self.directions[self.held].T, load.force / self.magnitude)
        if miss > 1e-9:
            return None
        used = shares > 0
        forces = np.tensordot(shares[used], self.forces[self.held][used], 1)
        state = GraspState(self.grasp, load, forces)
        limits = np.array(self._plain.limits(self.grasp))
        inside = state.is_balanced(reserve=self.criteria.reserve) and (state.magnitudes <= limits).all()
        return state if inside else None

    def __repr__(self) -> str:
        reached = self.shown[self.held]
        what = f"; {self.label} {reached.min():.4g} to {reached.max():.4g}" if reached.size else ""
        return (
            f"HeldSphere of {', '.join(self.grasp.names)}: {int(self.held.sum())} of {len(self.directions)} "
            f"sampled directions of a load of {self.magnitude:g} N are held{what}"
        )


@takes(LimitOptions)
def held_sphere(
    grasp: Grasp,
    magnitude: float = 1.0,
    *,
    objective: str | Objective | Criteria = "force",
    count: int = COUNT,
    **options: Unpack[LimitOptions],
) -> HeldSphere:
    """What ``choose_state`` reaches for loads of one magnitude [N] in ``count`` directions, evenly spread.

    The load is a force through the centre of mass.

    Args:
        grasp: contacts in space.
        magnitude: of the load's force [N].
        objective: as for ``choose_state``; ``angle`` and ``friction_use`` take tens of programs for each
            direction.
        count: how many directions.
        options

    Raises:
        InvalidInput: For a planar grasp, whose held directions are known exactly, and bad numbers.
    """
    if not isinstance(grasp, Grasp) or grasp.dimension != 3:
        raise InvalidInput(
            f"a held sphere is of a Grasp in space; in the plane use held_directions; got {shown(grasp)}"
        )
    number(magnitude, "magnitude", above=0)
    whole(count, "count", least=1, most=_MOST)
    criteria = criteria_of(objective, options)
    directions = even_directions(count)
    values, forces = np.full(count, nan), np.full((count, len(grasp), grasp.width), nan)
    twists: list[EscapeTwist] = []
    for k, direction in enumerate(directions):
        load = Wrench(magnitude * direction)
        if any(_escapes(known, load) for known in twists):
            continue
        try:
            state = ChosenState(grasp, load, criteria, choose_forces(grasp, load, criteria))
        except Infeasible as reason:
            if reason.certificate is not None:
                twists.insert(0, reason.certificate)
            continue
        values[k], forces[k] = state.value, state.forces
    return HeldSphere(
        grasp,
        float(magnitude),
        criteria,
        read_only(directions),
        read_only(values),
        read_only(forces),
        tuple(twists),
    )


def _escapes(known: EscapeTwist, load: Wrench) -> EscapeTwist | None:
    """The proof that a known escape twist is for another load, if it is one; decided in exact arithmetic."""
    if float(known.twist @ load.vector) <= 0:
        return None
    twist = EscapeTwist(known.grasp, load, known.twist, known.frictions, known.limits)
    return twist if twist.is_proof else None
