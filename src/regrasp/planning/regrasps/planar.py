"""What a regrasp is to do and under which limits: the hold graph, its ends, and the plans on it."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, number, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.outline import Outline
from regrasp.planning.holds.bottleneck import Bottleneck, bottleneck
from regrasp.planning.holds.cost_search import cheapest
from regrasp.planning.holds.pairs import Filter, HoldGraph, evenly
from regrasp.planning.holds.planar_stances import Fingering
from regrasp.planning.holds.sequences import MAX_TURN, Sequence, as_sequence, sequences
from regrasp.planning.holds.stances import REACH, Places
from regrasp.planning.holds.turning.search import TurningSequence
from regrasp.planning.holds.weights import RegraspWeights
from regrasp.planning.regrasps.arcs import Arcs, arc_lengths, on_arcs
from regrasp.planning.regrasps.ends import Ends
from regrasp.planning.regrasps.options import (
    MOST_CANDIDATES,
    MOST_EXTRA,
    check_steps,
    settled,
    turn_below_pi,
)
from regrasp.planning.regrasps.remedies import allowed
from regrasp.planning.regrasps.steps import chosen_states, regrasp_of, spread_states
from regrasp.planning.regrasps.turning import turning_sequences
from regrasp.planning.regrasps.why_not import unheld_end, why_not
from regrasp.planning.states.criteria import PEAK_RATIO, Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.plans.regrasp_notes import LEAST_SHARE, hardly_pushes
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.timing import TimeScaling

SAMPLED = 72
"""Orientations that are tried where all of them are not looked at in closed form."""
# A goal nearer than this to one of the orientations is that one [rad].
_SAME_ANGLE = 1e-9


@dataclass(frozen=True, eq=False)
class RegraspProblem(ArrayValue):
    """From one grasp of three fingers to another: what is asked, its hold graph, and the plans.

    Args:
        outline: an ``Outline``; fingers may touch at ``candidates`` points spread over it, of ``friction``,
            and at the contacts of ``start`` and ``goal``, three each, relative to the centre of mass.
        start: three contacts, relative to the centre of mass [m].
        goal: three contacts at the end, relative to the centre of mass [m].
        load: a force through the centre of mass, seen from the object before it turns [N].
        friction: Coulomb coefficient of the candidates [-].
        orientations: None for all, in closed form; or how many angles of the object are tried, spread over a
            full turn, 1 to forbid turning. With ``keep`` or ``weights``, and in hold maps, bottlenecks and
            remedies, 72 are tried where none are given.
        goal_orientation: the object's angle in the end [rad]; tried besides if it is none of these.
        candidates: how many points are spread over the outline.
        objective: what the state of every hold is chosen for, each by itself.
        states: ``each``, or ``joint``: all states in one program, for the widest worst force margin and then
            the least change of force.
        max_turn: largest turn during one step [rad].
        least_margin: angle margin [rad] that every hold must have at the least; more moves may be needed for
            it.
        min_distance: least distance of two fingers that hold together [m].
        keep: which two fingers may hold together, by reach or collision: a function of points (k, 2) of the
            one and (k, 2) of the other, relative to the centre of mass [m], and the object's angle [rad],
            that returns (k,) booleans; all if not given.
        arcs: where each finger of the start may touch, an arc (lo, hi) in arc length [m], several, or None
            for everywhere; see ``arcs``. Any finger whose arc allows it may take a contact of the goal.
        one_finger: whether a pair also holds where one of its fingers carries the whole load; by default both
            must push.
        weights: look for the least cost in place of the fewest moves and the widest margin.
        max_force: limit on every force besides the contacts' own [N], as for ``choose_state``.
        min_normal: with which every finger of a state pushes at the least, those that leave and arrive during
            a step apart [N]; 0 for none. If not given, and no ``Criteria`` are, 1 % of the load's force, or
            none where that takes more moves or leaves no sequence.
        peak_ratio: as for ``choose_state`` [-].
        reserve: as for ``choose_state`` [-].
        step_duration: [s] of each step.

    Raises:
        InvalidInput: For arguments that are not what they must be.
    """

    outline: Outline
    start: Grasp
    goal: Grasp
    load: Wrench
    friction: float
    orientations: int | None = None
    goal_orientation: float = 0.0
    candidates: int = 120
    objective: str | Objective | Criteria = "angle"
    states: str = "each"
    max_turn: float = MAX_TURN
    least_margin: float = 0.0
    min_distance: float = 0.0
    keep: Filter | None = None
    arcs: Arcs | None = None
    one_finger: bool = False
    weights: RegraspWeights | None = None
    max_force: float | None = None
    peak_ratio: float = PEAK_RATIO
    reserve: float = RESERVE
    step_duration: float = 1.0
    min_normal: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.outline, Outline):
            raise InvalidInput(f"outline must be an Outline, got {shown(self.outline)}")
        _ = self.criteria
        check_steps(self.step_duration, self.states, self.max_turn, self.least_margin)
        number(self.goal_orientation, "goal_orientation")
        whole(self.candidates, "candidates", least=1, most=MOST_CANDIDATES)
        number(self.min_distance, "min_distance", least=0)
        if not isinstance(self.one_finger, bool):
            raise InvalidInput(f"one_finger must be True or False, got {shown(self.one_finger)}")
        if self.weights is not None and not isinstance(self.weights, RegraspWeights):
            raise InvalidInput(f"weights must be RegraspWeights, got {shown(self.weights)}")
        _ = self.graph, self.allowed

    @cached_property
    def criteria(self) -> Criteria:
        """Objective and limits of every choice of a state."""
        return settled(self)

    @cached_property
    def ends(self) -> Ends:
        """The contacts of both grasps, which are on the outline."""
        ends = Ends(self.start, self.goal, self.max_force)
        for contact in ends.contacts:
            where = contact.position + self.outline.centre_of_mass
            on = self.outline.points(self.outline.nearest(where))
            ends.refuse_off(contact, on, self.outline.length, "outline")
        return ends

    @cached_property
    def angles(self) -> Array:
        """(O,) angles of the object that are tried [rad], the goal's among them."""
        spread = evenly(SAMPLED if self.orientations is None else self.orientations)
        off = abs((spread - self.goal_orientation + pi) % (2 * pi) - pi)
        if off.min() <= _SAME_ANGLE:
            return spread
        if self.orientations == 1:
            raise InvalidInput(
                f"orientations=1 forbids turning, but goal_orientation is {self.goal_orientation:g} rad"
            )
        return np.append(spread, self.goal_orientation % (2 * pi))

    @cached_property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts of both ends, then the candidates; with their whole friction."""
        return self.ends.joined(
            [
                self.outline.contact_at(float(s), friction=self.friction, max_force=self.max_force)
                for s in self.outline.sample(self.candidates)
            ]
        )

    @cached_property
    def graph(self) -> HoldGraph:
        """The holds of these contacts."""
        return self.graph_on(self.contacts)

    def graph_on(self, contacts: Iterable[Contact]) -> HoldGraph:
        """The holds of contacts, with the friction that the reserve leaves.

        Args:
            contacts: planar, relative to the centre of mass [m].
        """
        kept = tuple(c.changed(friction=kept_friction(c.friction, self.reserve)) for c in contacts)
        return HoldGraph(
            kept, self.load, self.angles, self.peak_ratio, self.min_distance, self.keep,
            one_finger=self.one_finger, min_normal=self.min_normal or 0.0,
        )  # fmt: skip

    @cached_property
    def allowed(self) -> NDArray[np.bool_] | None:
        """(3, V) which finger may touch which contact; None where all may touch all."""
        if self.arcs is None:
            return None
        positions = np.array([c.position for c in self.contacts])
        allowed = on_arcs(self.arcs, arc_lengths(self.outline, positions), self.outline.length)
        self.ends.check(allowed, self.arcs)
        return allowed

    @property
    def places(self) -> tuple[Places, Places, int]:
        """The start's and the goal's contacts in the graph, and the place of the last orientation."""
        off = (self.graph.angles - self.goal_orientation + pi) % (2 * pi) - pi
        return self.ends.start, self.ends.goal, int(np.argmin(abs(off)))

    def sequences(self, extra: int = 0, max_turn: float | None = None) -> list[Sequence]:
        """The best sequence among sampled orientations, and those of more moves with wider margins.

        Args:
            extra: finger moves beyond the fewest.
            max_turn: in place of the problem's [rad].
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        return self._sampled(extra, self.max_turn if max_turn is None else turn_below_pi(max_turn), REACH)

    def _sampled(self, extra: int, turn: float, reach: float) -> list[Sequence]:
        """The same, with turns of at most ``reach`` [rad] from one hold to the next, in steps of ``turn``."""
        start, goal, last = self.places
        if self.weights is None:
            return sequences(
                self.graph, start, goal, last, max_turn=turn, least_margin=self.least_margin,
                allowed=self.allowed, extra=extra, reach=reach,
            )  # fmt: skip
        fingers = Fingering(self.graph, turn, self.least_margin, self.allowed, reach)
        costs = self.weights.costs(self.graph, fingers.margins, self.step_duration)
        found = cheapest(fingers, costs, start, goal, last)
        return [] if found is None else [as_sequence(fingers, found)]

    @property
    def is_exact(self) -> bool:
        """Whether all orientations are looked at, and not some of them."""
        return self.orientations is None and self.keep is None and self.weights is None

    def turning_sequences(self, extra: int = 0) -> list[TurningSequence]:
        """The best sequence over all orientations, and those of more moves with wider margins.

        Args:
            extra: finger moves beyond the fewest.
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        return turning_sequences(self, extra, self.least_margin)

    def plans(self, extra: int = 0) -> list[RegraspPlan]:
        """The plan of each sequence.

        Forces grow while the object turns. Where force limits leave too little room for that, sequences
        without turns in several steps are looked for, then of smaller turns, of half the size each time.

        Args:
            extra: finger moves beyond the fewest.

        Raises:
            Infeasible: Where there is none, and says why.
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        if extra and self.weights is not None:
            raise InvalidInput("extra trades moves against margin; leave it out, or weights")
        try:
            found = self._planned(extra)
        except _NoSequence:
            raise why_not(self) from None
        if (
            self.min_normal is None
            and not self.one_finger
            and any(hardly_pushes(plan.steps) for plan in found)
        ):
            return self._pushing(extra, len(found[0].moves)) or found
        return found

    def _pushing(self, extra: int, moves: int) -> list[RegraspPlan]:
        """Plans in which all fingers push with a share of the load; none where that takes more moves."""
        try:
            found = replace(self, min_normal=LEAST_SHARE * float(np.hypot(*self.load.force)))._planned(extra)
        except Infeasible:
            return []
        return found if len(found[0].moves) <= moves or self.weights is not None else []

    def _planned(self, extra: int) -> list[RegraspPlan]:
        if self.is_exact:
            exact = self.turning_sequences(extra)
            if not exact or not any(c.max_force for c in self.contacts):
                return self._turning_plans(exact)
            sampled = self.sequences(extra)
            if not sampled or _order(exact[0].sequence) <= _order(sampled[0]):
                try:
                    return self._turning_plans(exact)
                except Infeasible:
                    pass  # forces grow while the object turns: shorter turns may leave them the room
        return self._sampled_plans(extra)

    def _turning_plans(self, found: list[TurningSequence]) -> list[RegraspPlan]:
        if not found:
            raise _NoSequence
        try:
            return [self._plan(each.sequence, self.max_turn, np.array(each.angles)) for each in found]
        except Infeasible:
            raise _NoSequence from None

    def _sampled_plans(self, extra: int) -> list[RegraspPlan]:
        turn, found = self.max_turn, self.sequences(extra)
        if not found:
            raise _NoSequence
        reach = REACH
        while True:
            try:
                return [self._plan(sequence, turn) for sequence in found]
            except Infeasible as error:
                turn = turn / 2 if reach == turn else turn
                reach = turn
                found = self._sampled(extra, turn, reach)
                if not found:
                    raise unheld_end(self) or Infeasible(
                        f"the force limits leave no room for forces to grow while the object turns: {error}; "
                        f"allow more force, or more orientations for smaller turns",
                        error.certificate,
                    ) from None

    def allowing(self, force: float) -> "RegraspProblem":
        """The same problem with at least this force [N] wherever it is limited.

        Args:
            force: [N].
        """
        number(force, "force", above=0)
        start, goal = (Grasp(allowed(c, force) for c in grasp) for grasp in (self.start, self.goal))
        most = None if self.max_force is None else max(force, self.max_force)
        return replace(self, start=start, goal=goal, max_force=most)

    def bottleneck(self) -> Bottleneck | None:
        """What limits the way, however many moves it takes; None where there is none. Not with ``arcs``."""
        if self.arcs is not None:
            raise InvalidInput("a bottleneck is that of fingers that may touch everywhere; leave arcs out")
        return bottleneck(self.graph, *self.places)

    def _plan(self, sequence: Sequence, max_turn: float, angles: Array | None = None) -> RegraspPlan:
        start, goal, _ = self.places
        states = chosen_states(
            sequence,
            self.contacts,
            start,
            goal,
            self.load,
            self.graph.angles if angles is None else angles,
            self.goal_orientation,
            self.criteria,
            self.one_finger,
            self.least_margin,
            max_turn,
        )
        if self.states == "joint":
            states = spread_states(states, self.criteria, self.least_margin)
        return regrasp_of(states, self.contacts, TimeScaling.spline(self.step_duration), self.criteria)


class _NoSequence(Infeasible):
    """There is none; why is a matter of its own, and takes longer."""

    def __init__(self) -> None:
        super().__init__("no sequence of holds leads from the start to the goal")


def _order(sequence: Sequence) -> tuple[float, ...]:
    return sequence.moves, -sequence.margin
