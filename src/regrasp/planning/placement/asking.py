"""What a placement is asked for, checked: shape, load, and the level that an objective is."""

from collections.abc import Sequence

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, array, number
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.boundary import check_arcs
from regrasp.outline.outline import Outline
from regrasp.planning.placement.laws import LEVELS
from regrasp.planning.placement.levels.ball import BallLevel
from regrasp.planning.placement.levels.level import AnsweredLevel, ForceLevel, FrictionLevel, Level
from regrasp.planning.placement.levels.withstood import WithstoodLevel
from regrasp.planning.placement.loads import check_planar, inner_and_outer
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.sides import Sides

SCALED = ("answered", "wrench")
"""Objectives that are a factor of a disturbance."""
_FARTHEST = 1e13  # times the loads, forces beside which they are not rounding


def level_of(
    goal: str,
    friction: float,
    load: Wrench | LoadSet,
    max_force: float | None,
    disturbance: LoadSet | None,
    length: float,
) -> Level | None:
    """The level that is sought, None for a norm. ``InvalidInput`` for limits that it does not go with."""
    if (disturbance is not None) != (goal in SCALED):
        raise InvalidInput(
            "disturbance and objective 'answered' or 'wrench' go together: give both, or neither"
        )
    if goal not in LEVELS:
        return None
    if max_force is None:
        raise InvalidInput(
            f"objective {goal!r} needs max_force: without a limit it is best at infinite force; got None"
        )
    limit = number(max_force, "max_force", above=0)
    if goal == "wrench_ball":
        if not isinstance(load, Wrench) or load.vector.any():
            raise InvalidInput(
                f"objective 'wrench_ball' is about loads in every direction: load must be zero, got "
                f"{shown(load)}"
            )
        return BallLevel(limit, friction, length)
    if disturbance is None:
        if friction <= NEGLIGIBLE:
            raise InvalidInput(
                f"objective {goal!r} needs friction above {NEGLIGIBLE:g}: what is less counts as none; got "
                f"{friction:g}"
            )
        loads = load.vector[None] if isinstance(load, Wrench) else load.vertices
        if loads is not None and not loads.any() and goal != "force":
            raise InvalidInput(f"objective {goal!r} needs a load other than zero: without force none is used")
        asked = inner_and_outer(load, 0.1)[0] / (
            [1, 1, length] if load.dimension == 2 else [1] * 3 + [length] * 3
        )
        size = float(np.abs(asked).max())
        if size and limit > _FARTHEST * size:
            raise InvalidInput(
                f"max_force {limit:g} is more than {_FARTHEST:g} times the loads, {size:.3g}, and rounding "
                "would decide; give the most that a finger can do"
            )
        if goal == "force":
            return ForceLevel(limit, friction)
        return FrictionLevel(limit, friction, angle=goal == "angle")
    if not isinstance(load, Wrench):
        raise InvalidInput(
            f"objective {goal!r} takes one load, a Wrench, on top of which the disturbance comes"
        )
    level = WithstoodLevel if goal == "wrench" else AnsweredLevel
    return level(limit, load.vector, _deviations(disturbance, load.dimension))


def length_of(goal: str, length: float | None, shape: Outline) -> float:
    """By which torques are divided [m]. ``InvalidInput`` for one that is not asked for."""
    if length is not None and goal != "wrench_ball":
        raise InvalidInput("length is for objective 'wrench_ball', by which it divides torques")
    reach = float(np.hypot(*shape.polygon().T).max())
    return reach if length is None else number(length, "length", above=0)


def asked_sides(
    shape: Outline,
    from_corners: float,
    arcs: Sequence[Sequence[float]] | None,
    tip_radius: float,
    in_holes: bool,
) -> Sides:
    """The sides on which fingers may be; see ``choose_grasp``."""
    if not isinstance(in_holes, bool) or (in_holes and arcs is not None):
        raise InvalidInput(
            f"in_holes must be True or False, and True goes with no arcs; got {shown(in_holes)}"
        )
    stretches = None if arcs is None else _pairs(arcs, shape.length)
    return sides_of(shape, from_corners, stretches, number(tip_radius, "tip_radius", least=0), in_holes)


def asked_distance(min_distance: float | None, points: Array) -> float | None:
    """The least distance of fingers on a shape of these points (m, 2) or (m, 3) [m]."""
    if min_distance is None:
        return None
    apart = number(min_distance, "min_distance", above=0)
    # one point after the other, for little memory
    widest = max(float(np.linalg.norm(points - point, axis=1).max()) for point in points)
    if apart > widest:
        raise InvalidInput(
            f"min_distance is {apart:g}, and no two points of the shape are further apart than {widest:g}"
        )
    return apart


def _pairs(arcs: Sequence[Sequence[float]], length: float) -> list[tuple[float, float]]:
    found = array(arcs, "arcs", (None, 2))
    if not len(found) or (found[:, 0] == found[:, 1]).any():
        raise InvalidInput("arcs must be one pair of arc lengths or more, of two different numbers each")
    check_arcs(found, length, "arcs")
    return [(float(a), float(b)) for a, b in found]


def _deviations(disturbance: LoadSet, dimension: int) -> Array:
    of = isinstance(disturbance, LoadSet) and disturbance.dimension == dimension
    if not of or disturbance.vertices is None:
        what = "a planar LoadSet.hull" if dimension == 2 else "a LoadSet.hull in space"
        raise InvalidInput(f"disturbance must be {what}, got {shown(disturbance)}")
    if not disturbance.vertices.any(axis=1).all():
        raise InvalidInput("every vertex of disturbance must be a deviation, other than zero")
    return disturbance.vertices


def check_task(shape: Outline, load: Wrench | LoadSet, expected: str = "an Outline or a Mesh") -> None:
    """``InvalidInput`` for what is no outline or no load of the plane."""
    if not isinstance(shape, Outline):
        raise InvalidInput(f"shape must be {expected}, got {shown(shape)}")
    check_planar(load)
