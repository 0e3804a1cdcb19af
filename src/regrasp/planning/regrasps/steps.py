"""From a sequence of holds to the steps of a regrasp: states chosen, and joined by transitions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan, ceil, cos, tan
from typing import Any, Literal, Protocol, cast

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.robust.stiffness import Stiffness
from regrasp.mechanics.robust.withstood import Withstood
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.given_ends import eased
from regrasp.planning.changes.lost_loads import refuse_lost_load
from regrasp.planning.holds.stances import Places
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import ANGLE, FORCE, recorded
from regrasp.planning.states.objectives.known import JOINT
from regrasp.plans.record import Choice, Record
from regrasp.plans.straight import STRAIGHT
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition
from regrasp.plans.turning import TurningPath


@dataclass(frozen=True)
class Chosen:
    """A state of a regrasp and how it was chosen.

    places: (n,) of its contacts among all. forces: (n, d) [N]; limits: (n,) [N]. criteria: by which it was
    chosen, within a fraction ``ease`` of the contacts' limits.
    """

    places: tuple[int, ...]
    load: Wrench
    grasp: Grasp
    forces: Array
    limits: tuple[float, ...]
    objective: str
    method: str
    criteria: Criteria
    ease: float

    def among(self, places: tuple[int, ...]) -> Array:
        """(m, d) forces of other contacts, zero for those that this state does not have."""
        known = dict(zip(self.places, self.forces, strict=True))
        idle = np.zeros(self.forces.shape[1])
        return np.array([known.get(place, idle) for place in places])

    @property
    def margin(self) -> float:
        """The least angle margin of the fingers in use [rad]."""
        return GraspState(self.grasp, self.load, self.forces).margins.least_angle

    @property
    def all_work(self) -> bool:
        """Whether every finger carries force."""
        return all(_in_use(self.forces))


class Refused(Infeasible):
    """The state of a node of a sequence, by its place, or one on the way to it, does not exist."""

    def __init__(self, node: int, between: bool, reason: Infeasible) -> None:
        super().__init__(str(reason), reason.certificate)
        self._node, self._between = node, between

    def hold(self, count: int) -> int:
        """Which of the holds to do without: between two the later, but the last: few are at the goal."""
        hold = min(max(self._node - 1, 0), count - 1)
        return hold - 1 if self._between and hold == count - 1 > 1 else hold


def chosen_states(
    nodes: Sequence[tuple[Places, Any]],
    contacts: tuple[Contact, ...],
    way: "Way",
    criteria: Criteria,
    one_finger: bool,
    least: float,
    max_turn: float,
) -> tuple[list[Chosen], list[Any]]:
    """The first grasp's state, that of every hold, and the last grasp's, with the orientation of each.

    nodes: contacts and orientation of each. Where the object turns by more than ``max_turn`` [rad] from one
    to the next, states of the contacts of both are between.

    Holds are chosen for the objective, whole grasps for the widest force margin: every finger works. So are
    holds of which the objective would leave one finger idle, unless ``one_finger`` may hold. least: angle
    margin [rad] that every hold keeps, whatever it is chosen for.

    Where a set is withstood, holds are exchanged through a state of the contacts of both, too: one finger
    arrives before another leaves, so that enough of them stay to answer (docs/robustness.md).
    """
    fingers = len(nodes[0][0])
    turns = [way.turn(a, b) for (_, a), (_, b) in pairwise(nodes)]
    pieces = [pieces_of(turn, max_turn) for turn in turns]
    if criteria.demands:
        pieces = [
            n if set(a) <= set(b) or set(b) <= set(a) else max(n, 2)
            for n, ((a, _), (b, _)) in zip(pieces, pairwise(nodes), strict=True)
        ]
    sizes = [0.0, *(turn / n for turn, n in zip(turns, pieces, strict=True)), 0.0]
    knots: list[tuple[int, Places, Any, float]] = []
    for k, (places, at) in enumerate(nodes):
        if k:
            before, last = nodes[k - 1]
            every = tuple(dict.fromkeys((*before, *places)))
            for q in range(1, pieces[k - 1]):
                share = q / pieces[k - 1]
                knots.append((k, every, way.between(last, at, share), eased_by(sizes[k])))
        knots.append((k, places, at, eased_by(max(sizes[k : k + 2]))))
    asked = of_states(criteria, [places for _, places, *_ in knots])

    def chosen(places: Places, at: Any, criteria: Criteria, ease: float) -> Chosen:
        whole = replace(criteria, objective=FORCE)
        if len(places) == fingers:
            return chosen_state(places, contacts, way.seen(at), whole, ease)
        state = chosen_state(places, contacts, way.seen(at), criteria, ease)
        if not one_finger and not state.all_work:
            state = chosen_state(places, contacts, way.seen(at), whole, ease)
        return kept(state, contacts, criteria, ease, least)

    states = []
    for (k, places, at, ease), each in zip(knots, asked, strict=True):
        try:
            states.append(chosen(places, at, each, ease))
        except Infeasible as reason:
            raise Refused(k, places != nodes[k][0], reason) from None
    return states, [at for _, _, at, _ in knots]


def of_states(criteria: Criteria, stood: Sequence[Places]) -> list[Criteria]:
    """The criteria of states that follow one another, on contacts by their places.

    Fingers that are in the air before or after are force-controlled. Stiffness has a row for each finger, in
    the order of the first contacts; who is in the air goes to what is new.
    """
    if not criteria.demands:
        return [criteria] * len(stood)
    fingers = {place: finger for finger, place in enumerate(stood[0])}
    result = []
    for k, places in enumerate(stood):
        free = [f for p, f in fingers.items() if p not in places] if k else []
        for place in places:
            if place not in fingers:
                gone = next(p for p, f in fingers.items() if f == free[0])
                fingers[place] = fingers.pop(gone)
                free.pop(0)
        beside = [set(stood[j]) for j in (k - 1, k + 1) if 0 <= j < len(stood)]
        groups = [tuple(i for i, p in enumerate(places) if p not in other) for other in beside]
        stiffness = criteria.stiffness
        if isinstance(stiffness, tuple):
            if len(stiffness) != len(stood[0]):
                raise InvalidInput(
                    f"stiffness must be one number or have a row for each of {len(stood[0])} fingers, in the "
                    f"order of the start, got {len(stiffness)}"
                )
            stiffness = tuple(stiffness[fingers[place]] for place in places)
        result.append(replace(criteria, stiffness=stiffness, controlled=tuple(groups)))
    return result


class Way(Protocol):
    """How an object turns, as ``Setting`` says."""

    def seen(self, orientation: Any) -> Wrench:
        """The load, seen from the object."""

    def turn(self, before: Any, after: Any) -> float:
        """How far it turns [rad]."""

    def between(self, before: Any, after: Any, share: float) -> Any:
        """The orientation a share of the way from one to another."""


def pieces_of(turn: float, max_turn: float) -> int:
    """Into how many steps a turn [rad] of steps of ``max_turn`` at most falls."""
    return max(ceil(abs(turn) / max_turn - 1e-9), 1)


def eased_by(turn: float) -> float:
    """Fraction of the force limits that leaves room for forces to grow in a turn [rad]; 1 without any."""
    return cos(turn / 2) * (1 - 1e-9) if turn else 1.0


def kept(
    state: Chosen, contacts: tuple[Contact, ...], criteria: Criteria, ease: float, least: float
) -> Chosen:
    """The state, or the one of the widest angle margin where it does not keep the ``least`` [rad]."""
    if least == 0 or state.margin >= least:
        return state
    widest = chosen_state(state.places, contacts, state.load, replace(criteria, objective=ANGLE), ease)
    return widest if widest.margin > state.margin else state


def spread_states(states: list[Chosen], criteria: Criteria, least: float = 0.0) -> list[Chosen]:
    """The same sequence with the forces of all states chosen together, under the limits of each.

    Each withstands what it does by itself.

    Holds keep an angle margin of ``least`` [rad], or theirs if that is less by rounding, in narrowed cones.
    """
    from regrasp.planning.regrasps.joint_states import SequenceState, spread_forces

    def frictions(state: Chosen, is_hold: bool) -> list[float]:
        whole = criteria.frictions(state.grasp)
        narrowed = min(least, state.margin) * (1 - 1e-9) if is_hold else 0.0
        return [tan(max(atan(mu) - narrowed, 0.0)) for mu in whole] if narrowed > 0 else whole

    unit = float(abs(states[0].load.force).max())
    together = spread_forces(
        [
            SequenceState(
                eased(s.grasp, s.ease),
                s.load,
                s.places,
                frictions(s, len(s.places) < len(states[0].places)),
                list(s.limits),
                _in_use(s.forces),
                criteria.least_normal,
                s.criteria,
            )
            for s in states
        ],
        unit,
    )
    return [
        replace(state, forces=forces, objective=JOINT, method="clarabel")
        for state, forces in zip(states, together, strict=True)
    ]


def least_margin(states: Sequence[Chosen]) -> float:
    """The least angle margin [rad] of the holds, in which a finger is free; without any, of all states."""
    holds = [state for state in states if len(state.places) < len(states[0].places)]
    return min(state.margin for state in holds or states)


def chosen_state(
    places: tuple[int, ...],
    contacts: tuple[Contact, ...],
    load: Wrench,
    criteria: Criteria,
    ease: float = 1.0,
) -> Chosen:
    """The best forces of some contacts under a load, within a fraction ``ease`` of their limits."""
    grasp = Grasp(contacts[i] for i in places)
    best = choose_forces(eased(grasp, ease), load, replace(criteria, max_force=None))
    return Chosen(
        places,
        load,
        grasp,
        np.array(best.forces),
        best.force_limits,
        recorded(criteria.objective),
        best.method,
        criteria,
        ease,
    )


def step_between(
    before: Chosen,
    after: Chosen,
    contacts: tuple[Contact, ...],
    scaling: TimeScaling,
    criteria: Criteria,
    turn: float,
    axis: Array | None = None,
) -> Transition:
    """From one state to the next: a finger leaves, arrives or is exchanged, or only the object turns.

    turn: of the object [rad], about ``axis`` in space, where all of the load turns.
    """
    places = max(before.places, after.places, key=len)
    if len(before.places) == len(after.places):
        places = tuple(dict.fromkeys((*before.places, *after.places)))
    grasp = Grasp(contacts[i] for i in places)
    start = GraspState(grasp, before.load, before.among(places))
    end = GraspState(grasp, after.load, after.among(places))
    leaving = tuple(str(contacts[i].name) for i in places if i not in after.places)
    arriving = tuple(str(contacts[i].name) for i in places if i not in before.places)
    stay = [i in before.places and i in after.places for i in places]
    least = [criteria.least_normal * stays for stays in stay] if criteria.presses else []
    choices = (_choice("start", before), _choice("end", after))
    promised = _withstood(before, after, places) if criteria.withstands else None
    record = Record(criteria.reserve, choices, least_normals=tuple(least), withstands=promised)
    path = STRAIGHT if turn == 0 else TurningPath([0.0, turn], [start.forces, end.forces], axis)
    return refuse_lost_load(Transition(start, end, scaling, record, leaving, arriving, path))


def _withstood(before: Chosen, after: Chosen, places: tuple[int, ...]) -> Withstood | None:
    """What a step withstands, stiffness by its contacts."""
    said = before.criteria.withstood
    if said is None or not isinstance(said.stiffness, tuple):
        return said
    rows: dict[int, Stiffness] = {}
    for state in (after, before):
        rows |= zip(state.places, cast(tuple[Stiffness, ...], state.criteria.stiffness), strict=True)
    return replace(said, stiffness=tuple(rows[place] for place in places))


def _in_use(forces: Array) -> tuple[bool, ...]:
    sizes = np.linalg.norm(forces, axis=1)
    return tuple((sizes > 1e-9 * sizes.max()).tolist())


def _choice(label: Literal["start", "end"], state: Chosen) -> Choice:
    return Choice(label, state.objective, state.method, state.limits)
