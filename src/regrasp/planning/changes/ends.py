"""The two ends of a transition: given states balanced, others chosen, in a grasp of all contacts."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal, NamedTuple

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState, state_of
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.given_ends import balanced_start, refuse_what_gives
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import ChosenForces, Criteria
from regrasp.planning.states.objectives import recorded
from regrasp.planning.states.options import BALANCE_TOLERANCE
from regrasp.plans.record import Choice, Record


class End(NamedTuple):
    """One end of a transition: the state given for its fingers, or what to choose it for.

    idle: the places of the fingers that carry no force there.
    """

    label: Literal["start", "end"]
    load: Wrench
    given: GraspState | None
    criteria: Criteria
    idle: tuple[int, ...]

    def found(
        self, grasp: Grasp, moving: set[int], method: str, facets: int | None, tolerance: float
    ) -> tuple[GraspState | ChosenForces, Choice | None, float]:
        """The forces of the fingers at work, the record of their choice and the change of given ones [N]."""
        rest = grasp
        if self.idle:
            rest = grasp.without(self.idle[0]) if len(self.idle) == 1 else _without(grasp, self.idle)
        if self.given is None:
            best = choose_forces(rest, self.load, self._asked(grasp, moving), method, facets)
            choice = Choice(self.label, recorded(self.criteria.objective), best.method, best.force_limits)
            return best, choice, 0.0
        given = self.given if self.given.grasp is rest else GraspState(rest, self.load, self.given.forces)
        state = balanced_start(given, self.criteria, tolerance, self.label)
        refuse_what_gives(state, self._asked(grasp, moving), self.label)
        return state, None, 0.0 if state is given else float(abs(state.forces - given.forces).max())

    def _asked(self, grasp: Grasp, moving: set[int]) -> Criteria:
        """The criteria: fingers that leave or arrive need not push and are force-controlled."""
        criteria = self.criteria
        if not criteria.min_normal and not criteria.demands:  # the usual case, in microseconds
            return criteria
        least = criteria.least_normal
        at_work = [i for i in range(len(grasp)) if i not in self.idle]
        if least:
            criteria = replace(criteria, min_normal=tuple(0.0 if i in moving else least for i in at_work))
        if criteria.demands:
            criteria = criteria.of_some(grasp, at_work, moving)
        return criteria

    def among(self, grasp: Grasp, found: GraspState | ChosenForces) -> GraspState:
        """The state of all contacts, the idle ones without force."""
        if not self.idle:
            return found if isinstance(found, GraspState) else GraspState(grasp, self.load, found.forces)
        width = grasp.width
        # Where no soft finger is left, forces are narrower.
        forces = found.forces if isinstance(found.forces, list) else found.forces.tolist()
        rows = [[*force, *[0.0] * (width - len(force))] for force in forces]
        for place in sorted(self.idle):
            rows.insert(place, [0.0] * width)
        return state_of(grasp, self.load, rows)


class Change(NamedTuple):
    """Two ends of one grasp, which fingers leave and arrive by place, and the record of both choices."""

    start: GraspState
    end: GraspState
    leaving: tuple[int, ...]
    arriving: tuple[int, ...]
    record: Record

    @classmethod
    def between(cls, grasp: Grasp, first: End, last: End, options: Mapping[str, Any]) -> "Change":
        """The change from one end to the other, states balanced or chosen by the options of a call."""
        tolerance = BALANCE_TOLERANCE
        if "balance_tolerance" in options:
            tolerance = number(options["balance_tolerance"], "balance_tolerance", least=0)
        how = {*first.idle, *last.idle}, options.get("method", "auto"), options.get("facets"), tolerance
        # The state of fewer fingers first: it is the one that may not exist.
        if len(first.idle) >= len(last.idle):
            forces, choice, change = first.found(grasp, *how)
            forces_then, choice_then, change_then = last.found(grasp, *how)
            choices = (choice, choice_then)
        else:
            forces_then, choice_then, change_then = last.found(grasp, *how)
            forces, choice, change = first.found(grasp, *how)
            choices = (choice_then, choice)
        record = Record(
            min(first.criteria.reserve, last.criteria.reserve),
            tuple([choice for choice in choices if choice is not None]),
            max(change, change_then),
        )
        start, end = first.among(grasp, forces), last.among(grasp, forces_then)
        return cls(start, end, last.idle, first.idle, record)


def shared(criteria: Criteria, first: End, last: End) -> Criteria:
    """The criteria of a path: the loosest limit and the least reserve of its ends, between which it lies."""
    a, b = first.criteria, last.criteria
    reserve = a.reserve if a.reserve < b.reserve else b.reserve
    loosest = None if a.max_force is None or b.max_force is None else max(a.max_force, b.max_force)
    if (loosest, reserve) == (criteria.max_force, criteria.reserve):
        return criteria
    return replace(criteria, max_force=loosest, reserve=reserve)


def state_among(
    state: GraspState, grasp: Grasp, load: Wrench, gone: tuple[int, ...], label: str
) -> GraspState:
    """The state of the fingers that stay, from one of theirs or of the whole grasp with idle fingers."""
    rest = _without(grasp, gone)
    if isinstance(state, GraspState) and state.load == load:
        if state.grasp == rest:
            return state
        if state.grasp == grasp:
            for i in gone:
                if state.forces[i].any():
                    raise InvalidInput(
                        f"{label}: {grasp.names[i]} must carry no force, got {state.forces[i].tolist()}"
                    )
            stay = [i for i in range(len(grasp)) if i not in gone]
            return GraspState(rest, load, state.forces[stay][:, : rest.width])
    names = ", ".join(grasp.names[i] for i in gone)
    raise InvalidInput(
        f"{label} must be a GraspState of {', '.join(rest.names)}, or of the whole grasp with {names} idle, "
        f"under the start's load; got {shown(state)}"
    )


def _without(grasp: Grasp, gone: tuple[int, ...]) -> Grasp:
    return grasp.subset(i for i in range(len(grasp)) if i not in gone)
