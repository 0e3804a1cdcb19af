"""Sequences of holds among sampled orientations, in the plane and in space."""

import numpy as np

from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.holds.cost_search import cheapest
from regrasp.planning.holds.graphs import place_of
from regrasp.planning.holds.sequences import Hold, Sequence, as_sequence, preferred
from regrasp.planning.holds.stances import Stances
from regrasp.planning.holds.triples import TripleGraph
from regrasp.planning.regrasps.asked import Asked
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import ANGLE


def sampled_sequences(problem: Asked, extra: int, turn: float, reach: float) -> list[Sequence]:
    """The best, with turns of at most ``reach`` [rad] from one hold to the next, in steps of ``turn``.

    Triples in space are judged without least normal forces: where these are asked for, the margins found so
    are bounds, and those of the holds of the best sequences are found, until these have no bound left.
    """
    graph = problem.graph
    stances = problem.setting.stances(graph, turn, reach, problem.allowed, problem.least_margin)
    pressed = isinstance(graph, TripleGraph) and problem.criteria.presses
    known: set[Hold] = set()
    while True:
        found = _best(problem, stances, extra)
        new = {hold for sequence in found for hold in sequence.holds} - known if pressed else set()
        if not new:
            return found
        for *places, o in new:
            margin = _pressed_margin(problem, tuple(places), o)
            row = place_of(graph, tuple(places))
            bound = stances.margins[row, o]
            stances.margins[row, o] = -1.0 if margin < problem.least_margin else min(bound, margin)
        known |= new


def _best(problem: Asked, stances: Stances, extra: int) -> list[Sequence]:
    start, goal, last = problem.places
    if problem.weights is None:
        return preferred(stances, start, goal, last, extra)
    costs = problem.weights.costs(problem.graph, stances.margins, problem.step_duration)
    found = cheapest(stances, costs, start, goal, last)
    return [] if found is None else [as_sequence(stances, found)]


def _pressed_margin(problem: Asked, places: tuple[int, ...], o: int) -> float:
    """The widest angle margin [rad] of a hold whose fingers push with the least normal force; -1 for none."""
    asked = problem.criteria
    criteria = Criteria(ANGLE, asked.max_force, asked.peak_ratio, asked.reserve, asked.min_normal)
    grasp = Grasp(problem.contacts[i] for i in places)
    load = problem.setting.seen(problem.setting.orientations[o])
    try:
        forces = choose_forces(grasp, load, criteria).forces
    except (Infeasible, SolverFailed):
        return -1.0
    return _least_angle(grasp, np.array(forces))


def _least_angle(grasp: Grasp, forces: np.ndarray) -> float:
    normal = (forces * grasp.normals).sum(axis=1)
    across = np.linalg.norm(forces - normal[:, None] * grasp.normals, axis=1)
    return max(float((np.arctan(grasp.frictions) - np.arctan2(across, normal)).min()), 0.0)
