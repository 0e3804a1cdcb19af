"""From a problem to its plans: the best sequences, and what to do where force limits leave no room."""

from typing import Any

import numpy as np

from regrasp.errors import Infeasible
from regrasp.planning.holds.sequences import Sequence
from regrasp.planning.holds.stances import REACH
from regrasp.planning.holds.turning.search import TurningSequence
from regrasp.planning.regrasps.asked import Asked
from regrasp.planning.regrasps.sampled import sampled_sequences
from regrasp.planning.regrasps.steps import chosen_states, spread_states
from regrasp.planning.regrasps.turning import turning_sequences
from regrasp.planning.regrasps.why_not import unheld_end, why_not
from regrasp.plans.regrasp_notes import LEAST_SHARE, hardly_pushes
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.timing import TimeScaling

Plans = list[RegraspPlan]


class _NoSequence(Infeasible):
    """There is none; why is a matter of its own, and takes longer."""

    def __init__(self) -> None:
        super().__init__("no sequence of holds leads from the start to the goal")


def planned(problem: Asked, extra: int) -> Plans:
    """The plan of the best sequence, and of those of up to ``extra`` more moves; or ``Infeasible``.

    Where no least normal force is asked for, and none is ruled out, that of a share of the load is, if it
    takes no more moves.
    """
    try:
        found = _planned(problem, extra)
    except _NoSequence:
        raise why_not(problem) from None
    usual = problem.min_normal is None and not problem.one_finger
    if usual and any(hardly_pushes(plan.steps) for plan in found):
        return _pushing(problem, extra, len(found[0].moves)) or found
    return found


def _pushing(problem: Asked, extra: int, moves: int) -> Plans:
    """Plans in which all fingers push with a share of the load; none where that takes more moves."""
    share = LEAST_SHARE * float(np.linalg.norm(problem.load.force))
    try:
        found = _planned(problem.asking(share), extra)
    except Infeasible:
        return []
    return found if len(found[0].moves) <= moves or problem.weights is not None else []


def _planned(problem: Asked, extra: int) -> Plans:
    if problem.is_exact:
        exact = turning_sequences(problem, extra, problem.least_margin)
        if not exact or not any(c.max_force for c in problem.contacts):
            return _turning_plans(problem, exact)
        sampled = sampled_sequences(problem, extra, problem.largest_turn, REACH)
        if not sampled or _order(exact[0].sequence) <= _order(sampled[0]):
            try:
                return _turning_plans(problem, exact)
            except Infeasible:
                pass  # forces grow while the object turns: shorter turns may leave them the room
    return _sampled_plans(problem, extra)


def _turning_plans(problem: Asked, found: list[TurningSequence]) -> Plans:
    if not found:
        raise _NoSequence
    try:
        return [_plan(problem, each.sequence, problem.largest_turn, each.angles) for each in found]
    except Infeasible:
        raise _NoSequence from None


def _sampled_plans(problem: Asked, extra: int) -> Plans:
    turn, reach = problem.largest_turn, REACH
    found = sampled_sequences(problem, extra, turn, reach)
    if not found:
        raise _NoSequence
    while True:
        try:
            return [_plan(problem, sequence, turn) for sequence in found]
        except Infeasible as error:
            turn = turn / 2 if reach == turn else turn
            reach = turn
            found = sampled_sequences(problem, extra, turn, reach)
            if not found:
                raise unheld_end(problem) or Infeasible(
                    f"the force limits leave no room for forces to grow while the object turns: {error}; "
                    f"allow more force, or more orientations for smaller turns",
                    error.certificate,
                ) from None


def _plan(problem: Asked, sequence: Sequence, max_turn: float, angles: Any = None) -> RegraspPlan:
    """angles: orientations of the sequence's holds by their places; those of the problem if not given."""
    start, goal, _ = problem.places
    setting, each = problem.setting, problem.setting.orientations if angles is None else angles
    way = setting.along([each[hold[-1]] for hold in sequence.holds])
    contacts = [start, *(tuple(hold[:-1]) for hold in sequence.holds), goal]
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
