"""What planning starts from: given states balanced, limits carried along, the clock."""

from functools import lru_cache
from typing import TypeVar

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import number
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import ChosenState, Criteria
from regrasp.planning.states.escape import infeasible
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import PlanOptions
from regrasp.plans.timing import TimeScaling

Options = TypeVar("Options", bound=PlanOptions)


def balanced_start(state: GraspState, criteria: Criteria, tolerance: float, label: str) -> GraspState:
    """A given state in exact equilibrium inside the cones less the reserve; ``label`` names it in errors."""
    try:
        balanced = state.balanced(reserve=criteria.reserve)
    except Infeasible:
        raise infeasible(state.grasp, state.load, criteria) from None
    if balanced is state:
        return state
    change, largest = float(abs(balanced.forces - state.forces).max()), float(state.magnitudes.max())
    if change > tolerance * largest:
        raise InvalidInput(
            f"{label}: the forces are no equilibrium inside the friction cones and limits; the nearest "
            f"one differs by {change:.3g}, more than {tolerance:g} of the largest force "
            f"{largest:.4g}; correct them, or allow more by balance_tolerance"
        )
    return balanced


def refuse_set_without_none(criteria: Criteria, grasp: Grasp) -> None:
    """Raise ``InvalidInput`` for a set without zero: forces of a turn grow between states."""
    none = Wrench.from_vector(np.zeros(len(grasp.matrix)))
    if criteria.disturbance is not None and not criteria.disturbance.contains(none):
        raise InvalidInput(
            f"a disturbance of a turn must hold the deviation zero, besides others; got "
            f"{criteria.disturbance}"
        )


def refuse_what_gives(state: GraspState, criteria: Criteria, label: str) -> None:
    """Raise ``InvalidInput`` for a given state that does not withstand the criteria's disturbance."""
    demand = criteria.demand(state.grasp) if criteria.withstands else None
    if demand is None:
        return
    spare = demand.spare(state.grasp.cones.measured(state.forces), np.array(criteria.limits(state.grasp)))
    if spare < 0:
        raise InvalidInput(
            f"{label}: the forces do not withstand the disturbance, some finger misses its cone or limit by "
            f"{-spare:.3g} N; give another state, or the grasp, whose state is then chosen"
        )


def grasp_and_load(start: GraspState | Grasp, load: Wrench | None) -> tuple[Grasp, Wrench]:
    """The grasp and the load of a start, which may be a state or a grasp."""
    if isinstance(start, GraspState):
        if load is not None and not (isinstance(load, Wrench) and load == start.load):
            raise InvalidInput(
                f"the start state has the load {shown(start.load)}; leave load out, got {shown(load)}"
            )
        return start.grasp, start.load
    if not isinstance(start, Grasp):
        raise InvalidInput(f"start must be a GraspState or a Grasp, got {shown(start)}")
    if load is None:
        raise InvalidInput("a plan from a grasp needs the load: load=Wrench(force=[...])")
    check_load(start, load)
    return start, load


def kept_limits(
    start: GraspState | Grasp, objective: str | Objective | Criteria, options: Options
) -> Options:
    """The options of a call, with the force limit that a start was chosen under unless one is given."""
    if "max_force" in options or isinstance(objective, Criteria) or not isinstance(start, ChosenState):
        return options
    limit = start.criteria.max_force
    if limit is None:
        return options
    return {**options, "max_force": limit}  # type: ignore[return-value]


def limited(grasp: Grasp, max_force: float | None) -> Grasp:
    """The grasp with every force limited to ``max_force``, so that a plan carries its limits with it."""
    if max_force is None:
        return grasp
    return Grasp(
        with_limit(contact, max_force if contact.max_force is None else min(contact.max_force, max_force))
        for contact in grasp
    )


def eased(grasp: Grasp, fraction: float) -> Grasp:
    """The grasp with a fraction of every force limit, which leaves room for forces to grow in a turn."""
    return Grasp(
        c.changed(
            max_force=None if c.max_force is None else fraction * c.max_force,
            limits=None if c.limits is None else c.limits.scaled(fraction),
        )
        for c in grasp
    )


def with_limit(contact: Contact, limit: float) -> Contact:
    """The same contact with another force limit [N]."""
    return contact.changed(max_force=limit)


def scaling_of(duration: float | None, scaling: TimeScaling | None) -> TimeScaling:
    """T(t) from a duration [s] or a whole time function; one second if neither is given."""
    if scaling is None:
        return _spline(1.0 if duration is None else number(duration, "duration", above=0))
    if duration is not None:
        raise InvalidInput("scaling has a duration of its own; give one of duration and scaling")
    if not isinstance(scaling, TimeScaling):
        raise InvalidInput(f"scaling must be a TimeScaling, got {shown(scaling)}")
    return scaling


@lru_cache
def _spline(duration: float) -> TimeScaling:
    """One value for one duration, so that its polynomials are worked out once."""
    return TimeScaling.spline(duration)
