"""Regrasps of which an end is left open: the best of those between sets of grasps."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import product
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import rotation
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh

End = Grasp | Iterable[Grasp] | None
"""One grasp, several of which one is taken, or None for those of least force that the shape has."""
_FINGERS = 3  # in space they hold while a fourth moves
_MORE_IN_SPACE = 1  # grasps besides the best
_FOURTHS = 40  # points where a fourth finger may be
_APART = 0.05  # of the size: no nearer to the three
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
    starts = _grasps(start, "start", shape, load, options)
    goals = _grasps(goal, "goal", shape, _seen_at_the_end(load, options), options)
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


def _seen_at_the_end(load: Wrench, options: dict[str, Any]) -> Wrench:
    """The load as the object sees it where it ends."""
    if isinstance(load, Wrench) and load.dimension == 3 and options.get("goal_rotation") is not None:
        back = rotation(options["goal_rotation"], "goal_rotation").T
        return Wrench(back @ load.force, back @ load.torque)
    turn = float(options.get("goal_orientation", 0.0))
    return load if turn == 0 else load.rotated(-turn)


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
    """The grasps of least largest normal force, in space of least largest force, a few that differ."""
    from regrasp.mesh.mesh import Mesh
    from regrasp.planning.placement.choosing import choose_grasp

    if "friction" not in options:
        raise InvalidInput(f"friction is needed to choose {what}; give the coefficient of the candidates")
    if isinstance(shape, Mesh):
        few = choose_grasp(
            shape,
            _FINGERS,
            load,
            friction=options["friction"],
            objective="peak",
            tolerance=0.01,
            min_distance=options.get("min_distance") or None,
        )
        threes = [few.grasp, *(other.grasp for other in few.others)]
        fours = [_with_a_fourth(shape, three, load, options) for three in threes]
        found_some = [four for four in fours if four is not None]
        if not found_some:
            raise Infeasible(f"no place for a fourth finger was found beside the three chosen for {what}")
        return found_some[: 1 + _MORE_IN_SPACE]
    limit = options.get("max_force")
    found = choose_grasp(
        shape,
        _FINGERS,
        load,
        friction=options["friction"],
        objective="peak_normal",
        max_force=limit,
        min_distance=options.get("min_distance") or None,
        tolerance=0.01,
    )
    return [found.grasp, *(other.grasp for other in found.others)]


def _with_a_fourth(shape: "Mesh", three: Grasp, load: Wrench, options: dict[str, Any]) -> Grasp | None:
    """Three fingers and a fourth, of some points where it makes the largest force least; None for none."""
    from regrasp.planning.states.choosing import choose_state

    apart = max(options.get("min_distance", 0.0), _APART * float(shape.size.max()))
    best, found = inf, None
    for contact in shape.contacts(_FOURTHS, friction=options["friction"]):
        if np.linalg.norm(three.positions - contact.position, axis=1).min() < apart:
            continue
        four = Grasp([*three, replace(contact, name=f"F{_FINGERS + 1}")])
        try:
            value = choose_state(four, load, "peak").value
        except Infeasible:
            continue
        if value < best * (1 - 1e-6):
            best, found = value, four
    return found
