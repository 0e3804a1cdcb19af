"""Planning the removal and the addition of a finger."""

from functools import lru_cache
from typing import Literal, NamedTuple

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import number
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.choice import choose_forces
from regrasp.planning.criteria import PEAK_RATIO, ChosenForces, Criteria
from regrasp.planning.escape import infeasible
from regrasp.planning.timing import TimeScaling
from regrasp.planning.transition import Choice, Record, Transition

BALANCE_TOLERANCE = 1e-3
"""Default largest change of a typed-in force, as a fraction of the largest force, to reach equilibrium."""


def plan_removal(
    start: GraspState | Grasp,
    contact: str | int,
    *,
    load: Wrench | None = None,
    end: GraspState | None = None,
    objective: str = "angle",
    whole_objective: str = "force",
    method: str = "auto",
    duration: float | None = None,
    scaling: TimeScaling | None = None,
    max_force: float | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
    balance_tolerance: float = BALANCE_TOLERANCE,
) -> Transition:
    """Forces over time that take one finger away while the object stays in equilibrium (Eq. 1-3).

    start: the state to leave from; or a grasp, whose state is then chosen under ``load``.
    contact: the finger that leaves, by name or index.
    end: the state without it, of the whole grasp or of the remaining contacts; chosen if not given.
    objective, whole_objective: what the state without the finger, and the state with it, are chosen for.
    The widest force margin, ``force``, gives every finger work; the others may leave one idle.
    method, max_force, peak_ratio, reserve: as for ``choose_state``.
    duration: [s], 1 if not given; or ``scaling``, a whole time function.
    balance_tolerance: given forces may change by this fraction of the largest one to reach exact
    equilibrium inside the cones less the reserve; the change is recorded in ``record.balancing``.

    Raises ``Infeasible`` with the escape twist where the remaining fingers cannot hold the load, and
    ``InvalidInput`` for given states that are no equilibrium inside the cones.
    """
    criteria = Criteria(objective, max_force, peak_ratio, reserve)
    whole_criteria = Criteria(whole_objective, max_force, peak_ratio, reserve)
    number(balance_tolerance, "balance_tolerance", least=0)
    scaling = _scaling(duration, scaling)
    grasp, load = _grasp_and_load(start, load)
    gone = grasp.index(contact)
    given_start = start if isinstance(start, GraspState) else None
    given_end = None if end is None else _remaining(end, grasp, load, gone)
    whole, rest, record = _ends(
        _limited(grasp, max_force),
        load,
        gone,
        _Side("start", given_start, whole_criteria, method, balance_tolerance),
        _Side("end", given_end, criteria, method, balance_tolerance),
    )
    return Transition("removal", grasp.names[gone], whole, rest, scaling, record)


def plan_addition(
    start: GraspState | Grasp,
    contact: Contact,
    *,
    load: Wrench | None = None,
    end: GraspState | None = None,
    objective: str = "angle",
    whole_objective: str = "force",
    method: str = "auto",
    duration: float | None = None,
    scaling: TimeScaling | None = None,
    max_force: float | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
    balance_tolerance: float = BALANCE_TOLERANCE,
) -> Transition:
    """Forces over time that bring one finger in: the removal of that finger, run backwards.

    start: the state of the fingers that hold the object; or their grasp, whose state is then chosen.
    contact: where the new finger touches.
    end: the state of all contacts, the new one last; chosen by ``whole_objective`` if not given.
    Everything else, and what is raised, is as for ``plan_removal``.
    """
    if not isinstance(contact, Contact):
        raise InvalidInput(f"contact must be the Contact that arrives, got {contact!r}")
    criteria = Criteria(objective, max_force, peak_ratio, reserve)
    whole_criteria = Criteria(whole_objective, max_force, peak_ratio, reserve)
    number(balance_tolerance, "balance_tolerance", least=0)
    scaling = _scaling(duration, scaling)
    before, load = _grasp_and_load(start, load)
    grasp = before.with_contact(contact)
    if end is not None and (end.grasp != grasp or end.load != load):
        raise InvalidInput(
            f"end must be a state of the start's contacts and the new one, in that order "
            f"({', '.join(grasp.names)}), under the same load; got {end!r}"
        )
    given_start = start if isinstance(start, GraspState) else None
    whole, rest, record = _ends(
        _limited(grasp, max_force),
        load,
        len(before),
        _Side("end", end, whole_criteria, method, balance_tolerance),
        _Side("start", given_start, criteria, method, balance_tolerance),
    )
    return Transition("addition", grasp.names[-1], rest, whole, scaling, record)


class _Side(NamedTuple):
    """One end of a transition: its name, the state given for it, and what to choose it for if none is."""

    label: Literal["start", "end"]
    given: GraspState | None
    criteria: Criteria
    method: str
    balance_tolerance: float

    def found(self, grasp: Grasp, load: Wrench) -> tuple[GraspState | ChosenForces, Choice | None, float]:
        """The forces of ``grasp``, the record of their choice and the change of given ones [N]."""
        if self.given is None:
            best = choose_forces(grasp, load, self.criteria, self.method)
            choice = Choice(self.label, self.criteria.objective, best.method, best.force_limits)
            return best, choice, 0.0
        given = self.given if self.given.grasp is grasp else GraspState(grasp, load, self.given.forces)
        state = _balanced(given, self)
        return state, None, 0.0 if state is given else float(abs(state.forces - given.forces).max())


def _ends(
    grasp: Grasp, load: Wrench, gone: int, whole: _Side, rest: _Side
) -> tuple[GraspState, GraspState, Record]:
    """The states with and without finger ``gone``, both of ``grasp``."""
    # The state of fewer fingers first: it is the one that may not exist.
    fewer, choice, change = rest.found(grasp.without(gone), load)
    more, other_choice, other_change = whole.found(grasp, load)
    idle = [0.0] * grasp.dimension
    return (
        more if isinstance(more, GraspState) else GraspState(grasp, load, more.forces),
        GraspState(grasp, load, [*fewer.forces[:gone], idle, *fewer.forces[gone:]]),
        Record(
            reserve=rest.criteria.reserve,
            choices=tuple(c for c in (choice, other_choice) if c is not None),
            balancing=max(change, other_change),
        ),
    )


def _balanced(state: GraspState, side: _Side) -> GraspState:
    try:
        balanced = state.balanced(reserve=side.criteria.reserve)
    except Infeasible:
        raise infeasible(state.grasp, state.load, side.criteria) from None
    if balanced is state:
        return state
    change, largest = float(abs(balanced.forces - state.forces).max()), float(state.magnitudes.max())
    if change > side.balance_tolerance * largest:
        raise InvalidInput(
            f"{side.label}: the forces are no equilibrium inside the friction cones and limits; the nearest "
            f"one differs by {change:.3g}, more than {side.balance_tolerance:g} of the largest force "
            f"{largest:.4g}; correct them, or allow more by balance_tolerance"
        )
    return balanced


def _grasp_and_load(start: GraspState | Grasp, load: Wrench | None) -> tuple[Grasp, Wrench]:
    if isinstance(start, GraspState):
        if load is not None and load != start.load:
            raise InvalidInput(f"the start state has the load {start.load!r}; leave load out, got {load!r}")
        return start.grasp, start.load
    if not isinstance(start, Grasp):
        raise InvalidInput(f"start must be a GraspState or a Grasp, got {start!r}")
    if load is None:
        raise InvalidInput("a plan from a grasp needs the load: load=Wrench(force=[...])")
    check_load(start, load)
    return start, load


def _remaining(end: GraspState, grasp: Grasp, load: Wrench, gone: int) -> GraspState:
    """The state of the fingers that stay, from one of theirs or of the whole grasp with an idle finger."""
    rest, name = grasp.without(gone), grasp.names[gone]
    if isinstance(end, GraspState) and end.load == load:
        if end.grasp == rest:
            return end
        if end.grasp == grasp:
            if end.forces[gone].any():
                raise InvalidInput(f"end: {name} must carry no force, got {end.forces[gone].tolist()}")
            return end.without(gone)
    raise InvalidInput(
        f"end must be a GraspState of {', '.join(rest.names)}, or of the whole grasp with {name} idle, "
        f"under the start's load; got {end!r}"
    )


def _limited(grasp: Grasp, max_force: float | None) -> Grasp:
    """The grasp with every force limited to ``max_force``, so that a plan carries its limits with it."""
    if max_force is None:
        return grasp
    return Grasp(
        _with_limit(contact, max_force if contact.max_force is None else min(contact.max_force, max_force))
        for contact in grasp
    )


def _with_limit(contact: Contact, limit: float) -> Contact:
    """The same contact with another force limit [N]."""
    return Contact(contact.position, contact.normal, contact.friction, max_force=limit, name=contact.name)


def _scaling(duration: float | None, scaling: TimeScaling | None) -> TimeScaling:
    if scaling is None:
        return _spline(1.0 if duration is None else number(duration, "duration", above=0))
    if duration is not None:
        raise InvalidInput("scaling has a duration of its own; give one of duration and scaling")
    if not isinstance(scaling, TimeScaling):
        raise InvalidInput(f"scaling must be a TimeScaling, got {scaling!r}")
    return scaling


@lru_cache
def _spline(duration: float) -> TimeScaling:
    """One value for one duration, so that its polynomials are worked out once."""
    return TimeScaling.spline(duration)
