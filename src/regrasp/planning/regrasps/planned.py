"""From a problem to its plans: the best sequences, and what to do where force limits leave no room."""

from typing import Any

import numpy as np

from regrasp.errors import Infeasible
from regrasp.planning.holds.barred import Barred
from regrasp.planning.holds.sequences import Hold, Sequence
from regrasp.planning.holds.stances import REACH
from regrasp.planning.holds.turning.search import TurningSequence
from regrasp.planning.regrasps.asked import Asked
from regrasp.planning.regrasps.remedies import possible_on
from regrasp.planning.regrasps.sampled import sampled_sequences
from regrasp.planning.regrasps.steps import Refused, chosen_states, spread_states
from regrasp.planning.regrasps.turning import turning_sequences
from regrasp.planning.regrasps.why_not import unheld_end, why_not
from regrasp.plans.regrasp_notes import LEAST_SHARE, hardly_pushes
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.timing import TimeScaling

Plans = list[RegraspPlan]

_MOST_REFUSED = 100  # states that do not exist beside holds that do, after which smaller turns are tried


class _NoSequence(Infeasible):
    """There is none; why is a matter of its own, and takes longer."""

    def __init__(self) -> None:
        super().__init__("no sequence of holds leads from the start to the goal")


def planned(problem: Asked, extra: int, barred: Barred | None = None) -> Plans:
    """The plan of the best sequence, and of those of up to ``extra`` more moves; or ``Infeasible``.

    Where no least normal force is asked for, and none is ruled out, that of a share of the load is, if it
    takes no more moves and leaves half of the margin. With ``barred`` moves sampled orientations are looked
    at, and nothing ``extra``.
    """
    try:
        found = _planned(problem, extra, barred)
    except _NoSequence:
        if barred is not None:
            raise
        raise why_not(problem) from None
    usual = problem.min_normal is None and not problem.one_finger
    if usual and any(hardly_pushes(plan.steps) for plan in found):
        return _pushing(problem, extra, barred, found[0]) or found
    return found


def _pushing(problem: Asked, extra: int, barred: Barred | None, free: RegraspPlan) -> Plans:
    """Plans in which all fingers push with a share of the load; none where that takes more moves than free.

    Nor where it leaves less than half of the margin: a finger at the edge of its cone is no safer.
    """
    share = LEAST_SHARE * float(np.linalg.norm(problem.load.force))
    try:
        found = _planned(problem.asking(share), extra, barred)
    except Infeasible:
        return []
    if problem.weights is not None:
        return found
    first = found[0]
    return found if len(first.moves) <= len(free.moves) and first.margin >= 0.5 * free.margin else []


def _planned(problem: Asked, extra: int, barred: Barred | None) -> Plans:
    if problem.is_exact and barred is None:
        exact = turning_sequences(problem, extra, problem.least_margin)
        if not exact or not (problem.judges_holds or any(c.max_force for c in problem.contacts)):
            return _turning_plans(problem, exact)
        if problem.judges_holds:  # fewest moves without limits and deviations; it may keep them
            try:
                return _turning_plans(problem, exact)
            except Infeasible:
                return _sampled_plans(problem, extra)
        sampled = sampled_sequences(problem, extra, problem.largest_turn, problem.setting.reach)
        if not sampled or _order(exact[0].sequence) <= _order(sampled[0]):
            try:
                return _turning_plans(problem, exact)
            except Infeasible:
                pass  # forces grow while the object turns: shorter turns may leave them the room
    return _sampled_plans(problem, extra, barred)


def _turning_plans(problem: Asked, found: list[TurningSequence]) -> Plans:
    if not found:
        raise _NoSequence
    try:
        return [plan_of(problem, each.sequence.holds, problem.largest_turn, each.angles) for each in found]
    except Infeasible:
        raise _NoSequence from None


def _sampled_plans(problem: Asked, extra: int, barred: Barred | None = None) -> Plans:
    turn, reach = problem.largest_turn, problem.setting.reach
    known: dict[Hold, float] = {}
    found = sampled_sequences(problem, extra, turn, reach, known, barred)
    if not found:
        there_is_one = barred is None and problem.judges_holds and possible_on(problem, problem.graph)
        raise _unjudged(problem) if there_is_one else _NoSequence()
    more = _MOST_REFUSED if problem.judges_holds else 0
    while True:
        sequence = found[0]
        try:
            plans = []
            for sequence in found:
                plans.append(plan_of(problem, sequence.holds, turn))
            return plans
        except Infeasible as error:
            if more and isinstance(error, Refused):  # a state between holds that hold: another way
                more -= 1
                known[sequence.holds[error.hold(len(sequence.holds))]] = -1.0
            elif reach > REACH:
                reach = REACH  # half a turn holds nothing where a hold has no margin, or forces no room
            else:
                turn = turn / 2 if reach == turn else turn
                reach = turn
            found = sampled_sequences(problem, extra, turn, reach, known, barred)
            if not found:
                raise unheld_end(problem) or _no_room(problem, error) from None


def _unjudged(problem: Asked) -> Infeasible:
    """Why no sequence is left of the holds that hold a load without more."""
    return unheld_end(problem) or Infeasible(
        f"no sequence of holds that {_asked_besides(problem)} was found at the orientations tried, though "
        f"there is one without; it is not proven that there is none"
    )


def _no_room(problem: Asked, error: Infeasible) -> Infeasible:
    if problem.judges_holds:
        return Infeasible(
            f"no sequence was found whose states all {_asked_besides(problem)}: {error}", error.certificate
        )
    return Infeasible(
        f"the force limits leave no room for forces to grow while the object turns: {error}; "
        f"allow more force, or more orientations for smaller turns",
        error.certificate,
    )


def _asked_besides(problem: Asked) -> str:
    kept = ["keep the linear limits"] if any(c.limits is not None for c in problem.contacts) else []
    kept += ["withstand the disturbance"] if problem.criteria.withstands else []
    return " and ".join(kept) or "push with the least normal force"


def plan_of(problem: Asked, holds: tuple[Hold, ...], max_turn: float, angles: Any = None) -> RegraspPlan:
    """The plan of a sequence of holds, or ``Infeasible``.

    angles: orientations of the holds by their places; those of the problem if not given.
    """
    start, goal, _ = problem.places
    setting, each = problem.setting, problem.setting.orientations if angles is None else angles
    way = setting.along([each[hold[-1]] for hold in holds])
    contacts = [start, *(tuple(hold[:-1]) for hold in holds), goal]
    states, orientations = chosen_states(
        list(zip(contacts, way, strict=True)),
        problem.contacts,
        setting,
        problem.criteria,
        problem.one_finger,
        problem.least_margin,
        max_turn,
    )
    if problem.states == "joint":
        states = spread_states(states, problem.criteria, problem.least_margin)
    return setting.plan(states, orientations, TimeScaling.spline(problem.step_duration))


def _order(sequence: Sequence) -> tuple[float, ...]:
    return sequence.moves, -sequence.margin
