"""What a state is chosen for, and under which limits."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import inf
from typing import Literal, NamedTuple

import numpy as np

from regrasp.closed_form.choice import OBJECTIVES
from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, choice, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE, kept_force, kept_friction, reserve_fraction
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench

Objective = Literal["angle", "force", "effort", "peak", "peak_normal", "friction_use"]

PEAK_RATIO = 3.0
"""Default limit on every force, as a multiple of the least peak force that holds the load."""

# Objectives whose best value may lie at infinite force.
UNBOUNDED = ("angle", "force", "friction_use")


@dataclass(frozen=True)
class Criteria:
    """Objective and limits of a choice, checked.

    objective: ``angle`` or ``force``, the widest least margin; ``effort`` (least sum of squares), ``peak``
    (least largest force), ``peak_normal`` (least largest normal force), ``friction_use`` (least largest
    fraction of the friction available).
    max_force: a limit on every force [N] besides the contacts' own, or None.
    peak_ratio: where any contact has no limit, ``angle``, ``force`` and ``friction_use`` limit all of them
    to this multiple (at least 1) of the least peak force with which the grasp holds the load, or to a
    contact's own limit if that is smaller.
    reserve: fraction of every friction coefficient kept back.
    """

    objective: str = "angle"
    max_force: float | None = None
    peak_ratio: float = PEAK_RATIO
    reserve: float = RESERVE

    def __post_init__(self) -> None:
        choice(self.objective, "objective", OBJECTIVES)
        if self.max_force is not None:
            number(self.max_force, "max_force", above=0)
        number(self.peak_ratio, "peak_ratio", least=1)
        reserve_fraction(self.reserve)

    @property
    def unbounded(self) -> bool:
        """Whether the best value may lie at infinite force, so that forces must be limited."""
        return self.objective in UNBOUNDED

    def frictions(self, grasp: Grasp) -> list[float]:
        """Friction coefficients that planning may use."""
        return [kept_friction(c.friction, self.reserve) for c in grasp]

    def limits(self, grasp: Grasp) -> list[float]:
        """Force limits that planning may use, infinite where there is none [N]."""
        general = inf if self.max_force is None else self.max_force
        return [
            kept_force(general if c.max_force is None else min(general, c.max_force), self.reserve)
            for c in grasp
        ]

    def demand_limit(self, grasp: Grasp, load: Wrench) -> None:
        """Raise ``InvalidInput`` where a multiple of the least peak force says nothing: the load is zero."""
        if self.unbounded and not any(load.plain) and inf in self.limits(grasp):
            raise InvalidInput(
                f"objective {self.objective!r} under a zero load needs max_force: any squeeze holds it, "
                f"so no force follows from the load"
            )


@lru_cache(maxsize=256, typed=True)
def _known(objective: str, max_force: float | None, peak_ratio: float, reserve: float) -> Criteria:
    return Criteria(objective, max_force, peak_ratio, reserve)


def criteria_of(objective: str, max_force: float | None, peak_ratio: float, reserve: float) -> Criteria:
    """``Criteria``, checked once for the same arguments: planning takes microseconds."""
    try:
        return _known(objective, max_force, peak_ratio, reserve)
    except TypeError:  # not hashable: the check says what is wrong
        return Criteria(objective, max_force, peak_ratio, reserve)


class ChosenForces(NamedTuple):
    """Forces (n, d) of a choice [N]; limits, method and gap as in ``ChosenState``."""

    forces: Array | list[list[float]]
    force_limits: tuple[float, ...]
    method: str
    gap: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class ChosenState(GraspState):
    """A state with the record of its choice."""

    criteria: Criteria
    force_limits: tuple[float, ...]
    """(n,) limits the choice was made under [N], those set by ``peak_ratio`` included."""
    method: str
    """``closed-form`` or the back end's name."""
    gap: float | None
    """How much better the best value can be at most, by duality; None for the closed form, which is exact.

    For ``angle`` [rad] and ``friction_use`` mostly 1e-7, and never more than 1e-5.
    """

    def __init__(
        self,
        grasp: Grasp,
        load: Wrench,
        criteria: Criteria,
        chosen: ChosenForces,
    ) -> None:
        super().__init__(grasp, load, chosen.forces)
        object.__setattr__(self, "criteria", criteria)
        object.__setattr__(self, "force_limits", chosen.force_limits)
        object.__setattr__(self, "method", chosen.method)
        object.__setattr__(self, "gap", chosen.gap)

    @cached_property
    def value(self) -> float:
        """The objective reached; units as for ``objective_value``."""
        return objective_value(self, self.criteria.objective)


def objective_value(state: GraspState, objective: str) -> float:
    """An objective at a state: ``angle`` [rad], ``effort`` [N^2], ``friction_use`` [-], others [N].

    Torques of soft fingers count as the tangential forces that use as much friction, mu m / torsion.
    """
    measured = state.grasp.cones.measured(state.forces)
    if objective == "angle":
        return state.margins.least_angle
    if objective == "force":
        return float(state.margins.force.min())
    if objective == "effort":
        return float((measured**2).sum())
    if objective == "peak":
        return float(np.sqrt((measured**2).sum(axis=1).max()))
    if objective == "friction_use":
        return state.margins.largest_friction_use
    return float(state.grasp.cones.normal(measured).max())
