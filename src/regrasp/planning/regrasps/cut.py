"""The proof that no regrasp exists at any orientation, where there is one."""

from itertools import combinations

import numpy as np

from regrasp.planning.holds.turning.arcs import Arcs
from regrasp.planning.holds.turning.margins import Candidates
from regrasp.planning.holds.turning.search import apart_from_each_other
from regrasp.planning.regrasps.asked import Asked
from regrasp.plans.regrasp_cut import RegraspCut

# What holds by less than this fraction, or by so much less margin [rad], is not told from what holds.
_SURE = 1e-9


def cut_of(problem: Asked) -> RegraspCut | None:
    """The cut between start and goal that no pair of contacts crosses, or None where none is found.

    Neither forces nor the direction of the load count, nor arcs of fingers, and friction counts in full: more
    may hold than the planner says.
    """
    start, goal, _ = problem.places
    if set(start) == set(goal):
        return None
    least, distance = problem.least_margin, problem.min_distance
    candidates = Candidates(problem.contacts, problem.load, 1.0, one_finger=True)
    may = apart_from_each_other(candidates.points, distance * (1 - _SURE))
    may &= Arcs(candidates).bounds() >= max(least - _SURE, 0.0) - _SURE
    np.fill_diagonal(may, val=False)
    reached = np.zeros(len(may), dtype=np.bool_)
    for i, j in combinations(start, 2):
        reached[[i, j]] |= may[i, j]
    while True:
        further = reached | may[reached].any(axis=0)
        if (further == reached).all():
            break
        reached = further
    if any(may[i, j] and (reached[i] or reached[j]) for i, j in combinations(goal, 2)):
        return None
    return RegraspCut(problem.contacts, start, goal, tuple(np.flatnonzero(reached).tolist()), least, distance)
