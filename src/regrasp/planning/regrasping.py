"""Planning whole regrasps of a planar object: the candidates, the search, and why there is none."""

from math import pi

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import choice, number
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.mechanics.wrench import Wrench
from regrasp.outline import Outline
from regrasp.planning.balancing import with_limit
from regrasp.planning.criteria import PEAK_RATIO, Criteria
from regrasp.planning.holds import Filter, HoldGraph, evenly
from regrasp.planning.reach import MAX_TURN, MOST_STEPS, sequences
from regrasp.planning.regrasp_plan import RegraspPlan
from regrasp.planning.regrasp_steps import chosen_states, regrasp_of, spread_states
from regrasp.planning.timing import TimeScaling

# Two contacts nearer than this fraction of the object are one.
_SAME = 1e-9


def plan_regrasp(
    outline: Outline,
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    *,
    friction: float,
    orientations: int = 72,
    goal_orientation: float = 0.0,
    candidates: int = 120,
    objective: str = "angle",
    states: str = "each",
    max_turn: float = MAX_TURN,
    least_margin: float = 0.0,
    min_distance: float = 0.0,
    keep: Filter | None = None,
    max_force: float | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
    step_duration: float = 1.0,
) -> RegraspPlan:
    """The regrasp of fewest steps, and of these the one of the widest least angle margin.

    A step between the first removal and the last addition exchanges a finger, while the object may turn by up
    to ``max_turn``, or turns the object in one hold.
    outline: an ``Outline``; fingers may touch at ``candidates`` points spread over it, of ``friction``, and
    at the contacts of ``start`` and ``goal``, three each, relative to the centre of mass.
    load: a force through the centre of mass, seen from the object before it turns.
    orientations: angles of the object that are tried, over a full turn; 1 forbids turning.
    goal_orientation: the object's angle in the end [rad]; rounded to the nearest of these.
    objective: what the state of every hold is chosen for, each by itself. states: ``each``, or ``joint``: all
    states in one program, for the widest worst force margin and then the least change of force.
    max_turn: largest turn during one exchange [rad].
    least_margin: angle margin [rad] that every hold must have at the least; more steps may be needed for it.
    min_distance [m], keep: which two fingers may hold together. max_force, peak_ratio, reserve: as for
    ``choose_state``. step_duration: [s] of each step.

    What is proven: every state, every path between two, and that no regrasp on the sampled points and
    orientations has fewer steps or, with as few, a wider least margin. Points and orientations between
    the samples are not looked at.
    Raises ``Infeasible`` where no sequence of holds leads from one to the other, and says why.
    """
    return plan_regrasps(
        outline,
        start,
        goal,
        load,
        friction=friction,
        orientations=orientations,
        goal_orientation=goal_orientation,
        candidates=candidates,
        objective=objective,
        states=states,
        max_turn=max_turn,
        least_margin=least_margin,
        min_distance=min_distance,
        keep=keep,
        max_force=max_force,
        peak_ratio=peak_ratio,
        reserve=reserve,
        step_duration=step_duration,
    )[0]


def plan_regrasps(
    outline: Outline,
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    *,
    friction: float,
    orientations: int = 72,
    goal_orientation: float = 0.0,
    candidates: int = 120,
    objective: str = "angle",
    states: str = "each",
    max_turn: float = MAX_TURN,
    least_margin: float = 0.0,
    min_distance: float = 0.0,
    keep: Filter | None = None,
    max_force: float | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
    step_duration: float = 1.0,
    extra: int = 0,
) -> list[RegraspPlan]:
    """The trade-off between steps and margin, as a list of plans.

    First that of ``plan_regrasp``, then those of up to ``extra`` more steps, each with a wider least margin
    than the one before it. Arguments and errors are those of ``plan_regrasp``.
    """
    if not isinstance(outline, Outline):
        raise InvalidInput(f"outline must be an Outline, got {outline!r}")
    criteria = Criteria(objective, max_force, peak_ratio, reserve)
    number(goal_orientation, "goal_orientation")
    number(step_duration, "step_duration", above=0)
    choice(states, "states", ("each", "joint"))
    if not 0 < number(max_turn, "max_turn") < pi:
        raise InvalidInput(f"max_turn must be above 0 and below pi, got {max_turn!r}")
    angles = evenly(orientations)
    ends = _Ends(start, goal, max_force)
    sampled = [
        outline.contact_at(float(s), friction=friction, max_force=max_force)
        for s in outline.sample(candidates)
    ]
    contacts = ends.joined(sampled)
    kept = tuple(
        Contact(c.position, c.normal, kept_friction(c.friction, reserve), max_force=c.max_force, name=c.name)
        for c in contacts
    )
    graph = HoldGraph(kept, load, angles, peak_ratio, number(min_distance, "min_distance", least=0), keep)
    last = int(np.argmin(abs((angles - goal_orientation + pi) % (2 * pi) - pi)))
    least = number(least_margin, "least_margin", least=0)
    found = sequences(
        graph, ends.start, ends.goal, last, max_turn=max_turn, extra=extra if least == 0 else MOST_STEPS
    )
    if not found:
        raise Infeasible(_why_not(graph, ends, last))
    safe = [sequence for sequence in found if sequence.margin >= least]
    if not safe:
        raise Infeasible(
            f"no sequence of holds keeps angle margins of {least:.4g} rad; the widest worst margin on the "
            f"sampled points and orientations is {found[-1].margin:.4g} rad"
        )
    found = [sequence for sequence in safe if len(sequence.holds) <= len(safe[0].holds) + extra]
    scaling = TimeScaling.spline(step_duration)
    plans = []
    for sequence in found:
        chosen = chosen_states(sequence, contacts, ends.start, ends.goal, load, angles, criteria)
        if states == "joint":
            chosen = spread_states(chosen, criteria)
        plans.append(regrasp_of(chosen, contacts, scaling, reserve))
    return plans


class _Ends:
    """Contacts of both grasps among the candidates: those at one place are one."""

    def __init__(self, start: Grasp, goal: Grasp, max_force: float | None) -> None:
        for what, grasp in (("start", start), ("goal", goal)):
            if not isinstance(grasp, Grasp) or len(grasp) != 3 or grasp.dimension != 2:
                raise InvalidInput(f"{what} must be a Grasp of three planar contacts, got {grasp!r}")
        self._limit = max_force
        self.contacts: list[Contact] = []
        self.start = tuple(self._place(c, f"start {c.name}") for c in start)
        self.goal = tuple(self._place(c, f"goal {c.name}") for c in goal)

    def _place(self, contact: Contact, name: str) -> int:
        size = max(
            float(abs(contact.position).max()), *(float(abs(c.position).max()) for c in self.contacts), 0.0
        )
        for i, known in enumerate(self.contacts):
            if abs(known.position - contact.position).max() <= _SAME * size:
                return i
        if self._limit is not None:
            contact = with_limit(contact, min(self._limit, contact.max_force or self._limit))
        self.contacts.append(contact.named(name))
        return len(self.contacts) - 1

    def joined(self, sampled: list[Contact]) -> tuple[Contact, ...]:
        """The contacts of both ends, then the sampled ones that are at other places, named by their order."""
        ends = np.array([c.position for c in self.contacts])
        size = float(abs(ends).max())
        others = [
            c.named(f"c{i}")
            for i, c in enumerate(sampled, 1)
            if abs(ends - c.position).max(axis=1).min() > _SAME * size
        ]
        return (*self.contacts, *others)


def _why_not(graph: HoldGraph, ends: _Ends, last: int) -> str:
    """Which end has no hold, or that their holds are in different components."""
    for what, places, o in (("start", ends.start, 0), ("goal", ends.goal, last)):
        pairs = [(i, j) for k, i in enumerate(places) for j in places[k + 1 :]]
        if all(graph.margin(i, j, o) < 0 for i, j in pairs):
            return (
                f"no two fingers of the {what} hold the load at {np.degrees(graph.angles[o]):.4g} deg, "
                f"so none of its fingers can leave or arrive"
            )
    holding = graph.margins.max(axis=0) >= 0
    component = graph.components()
    return (
        f"no sequence of holds leads from the start to the goal: on {len(graph.contacts)} points and "
        f"{len(graph.angles)} orientations ({int(holding.sum())} pairs hold at one of them) the start's "
        f"points are in component {sorted({int(component[i]) for i in ends.start})} and the goal's in "
        f"{sorted({int(component[i]) for i in ends.goal})}; try more candidates, orientations or friction"
    )
