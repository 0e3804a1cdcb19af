"""Regrasps of which an end is left open: the best of those between sets of grasps."""

from collections.abc import Callable, Iterable
from itertools import product
from typing import Any

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.plans.regrasp_plan import RegraspPlan

End = Grasp | Iterable[Grasp] | None
"""One grasp, several of which one is taken, or None for those of least force that the outline has."""
_FINGERS = 3
MOST_ENDS = 100


def is_open(end: End) -> bool:
    """Whether an end is to be chosen."""
    return not isinstance(end, Grasp)


def best_between(
    planned: Callable[[Grasp, Grasp], Any],
    shape: Any,
    start: End,
    goal: End,
    load: Wrench,
    options: dict[str, Any],
) -> Any:
    """The regrasp of fewest moves between two sets of grasps, and of these the one of the widest margin.

    ``Infeasible`` where none of them has one.
    """
    if options.get("weights") is not None:
        raise InvalidInput(
            "weights compare sequences between two grasps; give one start and one goal with them"
        )
    turn = float(options.get("goal_orientation", 0.0))
    starts = _grasps(start, "start", shape, load, options)
    goals = _grasps(goal, "goal", shape, load if turn == 0 else load.rotated(-turn), options)
    if len(starts) * len(goals) > MOST_ENDS:
        raise InvalidInput(
            f"{len(starts)} starts and {len(goals)} goals are more than {MOST_ENDS} pairs; give fewer"
        )
    found: list[Any] = []
    refused: list[Infeasible] = []
    for one, other in product(starts, goals):
        try:
            found.append(planned(one, other))
        except Infeasible as error:
            refused.append(error)
    if found:
        return min(found, key=_rank)
    first = refused[0]
    others = len(refused) - 1
    more = f"; nor for {others} other pair{'s' * (others > 1)} of grasps" if others else ""
    raise Infeasible(f"{first}{more}", first.certificate)


def _rank(found: Any) -> tuple[int, float]:
    plan = found if isinstance(found, RegraspPlan) else found.plan
    return len(plan.moves), -plan.margin


def _grasps(end: End, what: str, shape: Any, load: Wrench, options: dict[str, Any]) -> list[Grasp]:
    if isinstance(end, Grasp):
        return [end]
    if end is None:
        return _chosen(what, shape, load, options)
    try:
        grasps = list(end)
    except TypeError:
        grasps = []
    if not grasps or not all(isinstance(grasp, Grasp) for grasp in grasps):
        raise InvalidInput(f"{what} must be a Grasp, several of them, or None for any; got {shown(end)}")
    return grasps


def _chosen(what: str, shape: Any, load: Wrench, options: dict[str, Any]) -> list[Grasp]:
    """The grasps of least largest normal force, a few that differ."""
    from regrasp.outline.outline import Outline
    from regrasp.planning.placement.choosing import choose_grasp

    if not isinstance(shape, Outline):
        raise InvalidInput(f"{what} is chosen on outlines only; give a Grasp, or several")
    if "friction" not in options:
        raise InvalidInput(f"friction is needed to choose {what}; give the coefficient of the candidates")
    limit = options.get("max_force")
    found = choose_grasp(
        shape,
        _FINGERS,
        load,
        friction=options["friction"],
        objective="peak_normal",
        max_force=limit,
        tolerance=0.01,
    )
    return [found.grasp, *(other.grasp for other in found.others)]
