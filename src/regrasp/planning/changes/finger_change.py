"""Planning the removal and the addition of a finger."""

from collections.abc import Callable
from typing import Literal, NamedTuple, cast

from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import instance, number
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.given_ends import (
    BALANCE_TOLERANCE,
    balanced_start,
    grasp_and_load,
    limited,
    scaling_of,
)
from regrasp.planning.changes.joining import Demands, joined
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import PEAK_RATIO, ChosenForces, Criteria, criteria_of
from regrasp.plans.loads import LoadSeries
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Choice, Record, Transition

LoadFunction = Callable[[float], Wrench]


def plan_removal(
    start: GraspState | Grasp,
    contact: str | int,
    *,
    load: Wrench | LoadSeries | LoadFunction | None = None,
    end: GraspState | None = None,
    objective: str = "angle",
    whole_objective: str = "force",
    method: str = "auto",
    duration: float | None = None,
    scaling: TimeScaling | None = None,
    rate_limit: ArrayLike | None = None,
    min_normal: float | None = None,
    path_objective: str | None = None,
    idle_from: float | None = None,
    instants: int = 101,
    facets: int | None = None,
    max_force: float | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
    balance_tolerance: float = BALANCE_TOLERANCE,
) -> Transition:
    """Forces over time that take one finger away while the object stays in equilibrium (Eq. 1-3).

    start: the state to leave from; or a grasp, whose state is then chosen under ``load``.
    contact: the finger that leaves, by name or index.
    load: constant, a ``LoadSeries``, or a function of time [s] that returns a ``Wrench``; it is sampled at
    ``instants`` and taken as linear between them (``verify(plan, load=...)`` bounds the difference).
    end: the state without it, of the whole grasp or of the remaining contacts; chosen if not given.
    objective, whole_objective: what the state without the finger, and the state with it, are chosen for.
    The widest force margin, ``force``, gives every finger work; the others may leave one idle.
    method, max_force, peak_ratio, reserve, facets: as for ``choose_state``.
    duration: [s], 1 if not given, or that of the load series; or ``scaling``, a whole time function.
    rate_limit: |f_i'(t)| allowed, a number or one for each contact [N/s]. Without a duration the straight
    path takes the least time (under a load in time, which has a clock, the duration is 1); with one, the path
    bends where the straight path is too fast.
    min_normal: least normal force of every finger that stays [N].
    path_objective: what the path between the ends is planned for: ``change``, the least total change (by the
    time function, so that Eq. 1-3 is the answer where nothing bends it); ``effort``, the least sum of squares
    over time; ``peak``, the least largest force; ``force``, the widest least force margin of the fingers that
    stay, then the least change.
    idle_from: time from which the leaving finger carries no force [s]; the end if not given.
    balance_tolerance: given forces may change by this fraction of the largest one to reach exact
    equilibrium inside the cones less the reserve; the change is recorded in ``record.balancing``.

    The path is the straight one of Eq. 1-3 where the load is constant and it keeps every demand; else it is a
    ``SampledTransition`` by a convex program. ``record.path`` says which.
    Raises ``Infeasible`` with the escape twist where the fingers cannot hold the load, or with the limit that
    no path keeps, and ``InvalidInput`` for given states that are no equilibrium inside the cones.
    """
    criteria = criteria_of(objective, max_force, peak_ratio, reserve)
    whole_criteria = criteria_of(whole_objective, max_force, peak_ratio, reserve)
    number(balance_tolerance, "balance_tolerance", least=0)
    demands = Demands.of(rate_limit, min_normal, path_objective, idle_from, instants, method, facets)
    series, clock = _series_and_clock(load, duration, scaling, demands)
    first = series(0.0) if series is not None else cast(Wrench | None, load)
    grasp, first = grasp_and_load(start, first)
    last = series(series.duration) if series is not None else first
    gone = grasp.index(contact)
    given_start = start if isinstance(start, GraspState) else None
    given_end = None if end is None else _remaining(end, grasp, last, gone)
    whole, rest, record = _ends(
        limited(grasp, max_force),
        gone,
        _Side("start", first, given_start, whole_criteria, method, facets, balance_tolerance),
        _Side("end", last, given_end, criteria, method, facets, balance_tolerance),
    )
    return joined("removal", gone, whole, rest, clock, series, record, criteria, demands)


def plan_addition(
    start: GraspState | Grasp,
    contact: Contact,
    *,
    load: Wrench | LoadSeries | LoadFunction | None = None,
    end: GraspState | None = None,
    objective: str = "angle",
    whole_objective: str = "force",
    method: str = "auto",
    duration: float | None = None,
    scaling: TimeScaling | None = None,
    rate_limit: ArrayLike | None = None,
    min_normal: float | None = None,
    path_objective: str | None = None,
    idle_until: float | None = None,
    instants: int = 101,
    facets: int | None = None,
    max_force: float | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
    balance_tolerance: float = BALANCE_TOLERANCE,
) -> Transition:
    """Forces over time that bring one finger in: the removal of that finger, run backwards.

    start: the state of the fingers that hold the object; or their grasp, whose state is then chosen.
    contact: where the new finger touches.
    end: the state of all contacts, the new one last; chosen by ``whole_objective`` if not given.
    idle_until: time up to which the new finger carries no force [s]; the start if not given.
    Everything else, and what is raised, is as for ``plan_removal``.
    """
    if not isinstance(contact, Contact):
        raise InvalidInput(f"contact must be the Contact that arrives, got {contact!r}")
    criteria = criteria_of(objective, max_force, peak_ratio, reserve)
    whole_criteria = criteria_of(whole_objective, max_force, peak_ratio, reserve)
    number(balance_tolerance, "balance_tolerance", least=0)
    demands = Demands.of(rate_limit, min_normal, path_objective, idle_until, instants, method, facets)
    series, clock = _series_and_clock(load, duration, scaling, demands)
    first = series(0.0) if series is not None else cast(Wrench | None, load)
    before, first = grasp_and_load(start, first)
    last = series(series.duration) if series is not None else first
    grasp = before.with_contact(contact)
    if end is not None:
        instance(end, "end", GraspState)
    if end is not None and (end.grasp != grasp or end.load != last):
        raise InvalidInput(
            f"end must be a state of the start's contacts and the new one, in that order "
            f"({', '.join(grasp.names)}), under the same load; got {end!r}"
        )
    given_start = start if isinstance(start, GraspState) else None
    whole, rest, record = _ends(
        limited(grasp, max_force),
        len(before),
        _Side("end", last, end, whole_criteria, method, facets, balance_tolerance),
        _Side("start", first, given_start, criteria, method, facets, balance_tolerance),
    )
    return joined("addition", len(before), rest, whole, clock, series, record, criteria, demands)


class _Side(NamedTuple):
    """One end of a transition: its name, the state given for it, and what to choose it for if none is."""

    label: Literal["start", "end"]
    load: Wrench
    given: GraspState | None
    criteria: Criteria
    method: str
    facets: int | None
    balance_tolerance: float

    def found(self, grasp: Grasp) -> tuple[GraspState | ChosenForces, Choice | None, float]:
        """The forces of ``grasp``, the record of their choice and the change of given ones [N]."""
        if self.given is None:
            best = choose_forces(grasp, self.load, self.criteria, self.method, self.facets)
            choice = Choice(self.label, self.criteria.objective, best.method, best.force_limits)
            return best, choice, 0.0
        given = self.given if self.given.grasp is grasp else GraspState(grasp, self.load, self.given.forces)
        state = balanced_start(given, self.criteria, self.balance_tolerance, self.label)
        return state, None, 0.0 if state is given else float(abs(state.forces - given.forces).max())


def _ends(grasp: Grasp, gone: int, whole: _Side, rest: _Side) -> tuple[GraspState, GraspState, Record]:
    """The states with and without finger ``gone``, both of ``grasp``."""
    # The state of fewer fingers first: it is the one that may not exist.
    fewer, choice, change = rest.found(grasp.without(gone))
    more, other_choice, other_change = whole.found(grasp)
    width = grasp.width
    fewer_forces = [
        list(force) + [0.0] * (width - len(force)) for force in fewer.forces
    ]  # no soft one is left
    idle = [0.0] * width
    return (
        more if isinstance(more, GraspState) else GraspState(grasp, whole.load, more.forces),
        GraspState(grasp, rest.load, [*fewer_forces[:gone], idle, *fewer_forces[gone:]]),
        Record(
            reserve=rest.criteria.reserve,
            choices=tuple(c for c in (choice, other_choice) if c is not None),
            balancing=max(change, other_change),
        ),
    )


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


def _series_and_clock(
    load: Wrench | LoadSeries | LoadFunction | None,
    duration: float | None,
    scaling: TimeScaling | None,
    demands: Demands,
) -> tuple[LoadSeries | None, TimeScaling | None]:
    """The load in time, None if it is constant, and T(t); None where the rate limit sets the duration."""
    if isinstance(load, LoadSeries):
        if duration is None and scaling is None:
            duration = load.duration
        clock = scaling_of(duration, scaling)
        if clock.duration != load.duration:
            raise InvalidInput(
                f"the load series lasts {load.duration:g} s, the plan {clock.duration:g} s; make them equal"
            )
        return load, clock
    if demands.rate_limit is not None and duration is None and scaling is None and not callable(load):
        return None, None
    clock = scaling_of(duration, scaling)
    if callable(load):
        return LoadSeries.sampled(load, clock.duration, demands.instants), clock
    return None, clock
