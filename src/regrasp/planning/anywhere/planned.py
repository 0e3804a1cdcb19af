"""A walk of holds on a whole outline as a regrasp: states chosen at its places, joined by steps."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.outline.outline import Outline
from regrasp.planning.regrasps.planned import plan_of
from regrasp.planning.regrasps.problem import RegraspProblem
from regrasp.plans.regrasp_plan import RegraspPlan


def plan_along(
    problem: RegraspProblem, outline: Outline, walk: Array, angles: Array, max_turn: float
) -> RegraspPlan:
    """The plan whose holds are those of a walk, at its angles.

    problem: with the walk's places among its candidates. walk: (h, 2) arc lengths. angles: (h,) [rad].
    max_turn: in one step [rad].
    """
    points = np.array([c.position for c in problem.contacts])
    at = outline.points(walk.ravel()).reshape(-1, 1, 2)
    places = np.argmin(np.hypot(*(at - points).transpose(2, 0, 1)), axis=1).reshape(-1, 2).tolist()
    holds = tuple((*pair, k) for k, pair in enumerate(places))
    return plan_of(problem, holds, max_turn, angles.tolist())
