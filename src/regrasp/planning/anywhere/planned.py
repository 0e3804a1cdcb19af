"""A walk of holds on a whole outline as a regrasp: states chosen at its places, joined by steps."""

from typing import Any

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.asking import arc_lengths_of, asked_of
from regrasp.planning.anywhere.search import ORIENTATIONS
from regrasp.planning.anywhere.widest import widest_walk
from regrasp.planning.regrasps.planned import plan_of
from regrasp.planning.regrasps.problem import RegraspProblem
from regrasp.plans.regrasp_plan import RegraspPlan


def planned_anywhere(found: Any, options: dict[str, Any]) -> RegraspPlan:
    """The wider of the plans along the walk and along the widest of as many exchanges.

    found: as ``OutlineRegrasps``, which is above this.
    """
    _problem(found, 1, options)  # wrong options are refused before any work
    plans: list[RegraspPlan] = []
    refused: InvalidInput | Infeasible | None = None
    for walk, angles in ((found.walk, found.angles), *_wider(found)):
        try:
            plans.append(_along(found, walk, angles, options))
        except (Infeasible, InvalidInput) as reason:
            refused = refused or reason
    if refused is not None and not plans:
        raise refused
    return max(plans, key=lambda plan: plan.margin)


def _wider(found: Any) -> list[tuple[Array, Array]]:
    """The places and angles of the widest walk; none where force limits leave only some turns."""
    still = found.turns[0] == found.turns[1]
    turns = found.turns
    if found.max_force is not None and not found.angles.any() and found.goal_orientation == 0.0:
        still, turns = True, (0.0, 0.0)  # what stands still needs no room to turn
    if not len(found.walk) or (found.max_force is not None and not still):
        return []
    asked, ends = asked_of(
        found.outline,
        found.start,
        found.goal,
        found.load,
        found.friction,
        found.goal_orientation,
        turns,
        found.forbidden,
        found.min_normal,
        found.max_force,
    )
    each = (asked.angles(count, ends[1].angle) for count in ((1,) if still else ORIENTATIONS))
    angles = next(a for a in each if abs(found.angles[:, None] - a).min(axis=1).max() < 1e-12)
    walk = widest_walk(asked, ends, angles, len(found.walk) - 1)
    if walk is None:
        return []
    return [(arc_lengths_of(asked.vertices, walk), angles[[turn for _, _, turn in walk]])]


def _along(found: Any, walk: Array, angles: Array, options: dict[str, Any]) -> RegraspPlan:
    """The plan whose holds are those of a walk (h, 2) of arc lengths, at its angles (h,)."""
    problem = _problem(found, walk.ravel() if len(walk) else 1, options)
    points = np.array([c.position for c in problem.contacts])
    at = found.outline.points(walk.ravel()).reshape(-1, 1, 2)
    places = np.argmin(np.hypot(*(at - points).transpose(2, 0, 1)), axis=1).reshape(-1, 2).tolist()
    turn = problem.largest_turn
    if options["max_turn"] is None:  # forces were left room for turns as large as that
        turn = max(turn, found.turns[1] - found.turns[0])
    return plan_of(problem, tuple((*pair, k) for k, pair in enumerate(places)), turn, angles.tolist())


def _problem(found: Any, candidates: int | Array, options: dict[str, Any]) -> RegraspProblem:
    return RegraspProblem(
        found.outline,
        found.start,
        found.goal,
        found.load,
        found.friction,
        goal_orientation=found.goal_orientation,
        candidates=candidates,
        max_force=found.max_force,
        min_normal=found.min_normal,
        **options,
    )
