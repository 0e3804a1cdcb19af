"""From a sequence of holds to the steps of a regrasp: states chosen, and joined by transitions."""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan, cos, pi, tan
from typing import Literal

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.rotated_loads import turned_load
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.given_ends import eased
from regrasp.planning.holds.sequences import Sequence
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import ANGLE, FORCE, recorded
from regrasp.plans.record import Choice, Record
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.straight import STRAIGHT
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition
from regrasp.plans.turning import TurningPath


@dataclass(frozen=True)
class Chosen:
    """A state of a regrasp and how it was chosen.

    places: (n,) of its contacts among all. forces: (n, d) [N]; limits: (n,) [N]. angle: of the object [rad],
    in the plane.
    """

    places: tuple[int, ...]
    load: Wrench
    grasp: Grasp
    forces: Array
    limits: tuple[float, ...]
    objective: str
    method: str
    angle: float = 0.0

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


def chosen_states(
    sequence: Sequence,
    contacts: tuple[Contact, ...],
    start: tuple[int, ...],
    goal: tuple[int, ...],
    load: Wrench,
    angles: Array,
    criteria: Criteria,
    one_finger: bool,
    least: float = 0.0,
) -> list[Chosen]:
    """The first grasp's state, that of every hold, and the last grasp's, each chosen by itself.

    Holds are chosen for the objective, whole grasps for the widest force margin: every finger works. So are
    holds of which the objective would leave one finger idle, unless ``one_finger`` may hold. least: angle
    margin [rad] that every hold keeps, whatever it is chosen for.
    """
    turned = _unwrapped([float(angles[o]) for _, _, o in sequence.holds])
    whole = replace(criteria, objective=FORCE)
    states = [chosen_state(start, contacts, load, whole)]
    for k, ((i, j, _), angle) in enumerate(zip(sequence.holds, turned, strict=True)):
        beside = [abs(b - a) for a, b in pairwise(turned[max(k - 1, 0) : k + 2])]
        ease = cos(max(beside, default=0.0) / 2) * (1 - 1e-9)  # forces grow while the object turns
        seen = turned_load(load, angle)
        state = chosen_state((i, j), contacts, seen, criteria, ease)
        if not one_finger and not state.all_work:
            state = chosen_state((i, j), contacts, seen, whole, ease)
        states.append(replace(kept(state, contacts, criteria, ease, least), angle=angle))
    last = chosen_state(goal, contacts, turned_load(load, turned[-1]), whole)
    return [*states, replace(last, angle=turned[-1])]


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
                s.grasp,
                s.load,
                s.places,
                frictions(s, 0 < k < len(states) - 1),
                list(s.limits),
                _in_use(s.forces),
            )
            for k, s in enumerate(states)
        ],
        unit,
    )
    return [
        replace(state, forces=forces, objective="joint force", method="clarabel")
        for state, forces in zip(states, together, strict=True)
    ]


def regrasp_of(
    states: list[Chosen], contacts: tuple[Contact, ...], scaling: TimeScaling, reserve: float
) -> RegraspPlan:
    """The steps between states that follow one another."""
    steps = [step_between(a, b, contacts, scaling, reserve, b.angle - a.angle) for a, b in pairwise(states)]
    margin = min(state.margin for state in states[1:-1])
    return RegraspPlan(tuple(steps), tuple(s.angle for s in states), margin)


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
    )


def step_between(
    before: Chosen,
    after: Chosen,
    contacts: tuple[Contact, ...],
    scaling: TimeScaling,
    reserve: float,
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
    record = Record(reserve, (_choice("start", before), _choice("end", after)))
    path = STRAIGHT if turn == 0 else TurningPath([0.0, turn], [start.forces, end.forces], axis)
    return Transition(start, end, scaling, record, leaving, arriving, path)


def _in_use(forces: Array) -> tuple[bool, ...]:
    sizes = np.linalg.norm(forces, axis=1)
    return tuple((sizes > 1e-9 * sizes.max()).tolist())


def _choice(label: Literal["start", "end"], state: Chosen) -> Choice:
    return Choice(label, state.objective, state.method, state.limits)


def _unwrapped(angles: list[float]) -> list[float]:
    """The same angles, each at most half a turn from the one before it, the first from 0."""
    result: list[float] = []
    for angle in angles:
        last = result[-1] if result else 0.0
        result.append(last + (angle - last + pi) % (2 * pi) - pi)
    return result
