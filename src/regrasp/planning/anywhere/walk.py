"""A sequence of holds from one place of the map to another, each an exchange of one finger."""

from itertools import pairwise
from math import inf

from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.hold_map import HoldMap, Place, Region

MOST_HOLDS = 5_000
"""Of a walk; regions so thin that they take more leave the answer open."""
_SHARE = 0.75  # of the way to a boundary that an exchange goes

Hold = tuple[Place, Place, int]
"""Two places, and the place of the load's force among those of the map."""
At = tuple[float, float]


def walk_through(holds: HoldMap, path: list[int], start: At, goal: At) -> list[Hold] | None:
    """Holds through regions, from a place in the first to one in the last; None if there are too many."""
    regions = [holds.regions[k] for k in path]
    found: list[Hold] = []
    at = start
    for here, there in pairwise(regions):
        leave, enter = _doors(here, there)
        found += _stairs(here, at, leave, MOST_HOLDS - len(found))
        at = enter
    found += _stairs(regions[-1], at, goal, MOST_HOLDS - len(found))
    return found if len(found) < MOST_HOLDS else None


def least_turning(holds: HoldMap, walk: list[Hold], angles: Array, start: float, goal: float) -> list[Hold]:
    """The same places, at those of the map's angles between which the object turns least [rad].

    A hold is only moved to an angle where it is at least half as far inside its region.
    """
    by_sides: dict[tuple[int, int], list[Region]] = {}
    for region in holds.regions:
        by_sides.setdefault(region.sides, []).append(region)
    ways: list[tuple[float, float, list[int]]] = [(0.0, start, [])]  # turned, now at, by the places of angles
    for (i, f), (j, g), turn in walk:
        rooms: dict[int, float] = {}
        for sides, at in (((i, j), (f, g)), ((j, i), (g, f))):
            for region in by_sides.get(sides, []):
                rooms[region.turn] = max(rooms.get(region.turn, -inf), region.room(at))
        ways = [
            min((turned + abs(angle - before), angle, [*way, k]) for turned, before, way in ways)
            for k, angle in enumerate(angles.tolist())
            if rooms.get(k, -inf) >= 0.5 * rooms[turn]
        ]
    _, best = min((turned + abs(goal - at), way) for turned, at, way in ways)
    return [(p, q, k) for (p, q, _), k in zip(walk, best, strict=True)]


def _doors(here: Region, there: Region) -> tuple[At, At]:
    """Holds of two regions that share a place, in the middle of what both have of a side."""
    shared = []
    for one in (0, 1):
        for other in (0, 1):
            if here.sides[one] == there.sides[other]:
                (a, b), (c, d) = here.span(one), there.span(other)
                shared.append((min(b, d) - max(a, c), one, other, 0.5 * (min(b, d) + max(a, c))))
    _, one, other, place = max(shared)
    return _middle(here, one, place), _middle(there, other, place)


def _middle(region: Region, axis: int, place: float) -> At:
    across = 0.5 * sum(region.chord(axis, place))
    return (place, across) if axis == 0 else (across, place)


def _stairs(region: Region, at: At, goal: At, most: int) -> list[Hold]:
    """Within a convex region, along the straight line to the goal: two exchanges from point to point on it.

    Distances to the boundary are concave along the line, so no step is much shorter than those at its ends.
    """
    here, found = at, [_hold(region, at)]
    while here != goal and len(found) < most:
        way = goal[0] - here[0], goal[1] - here[1]
        share, first = max((_share(region, here, way, axis), axis) for axis in (0, 1))
        after = goal if share >= 1.0 else (here[0] + share * way[0], here[1] + share * way[1])
        between = (after[0], here[1]) if first == 0 else (here[0], after[1])
        found += [_hold(region, between)] if between not in (here, after) else []
        found.append(_hold(region, after))
        here = after
    return found


def _share(region: Region, here: At, way: At, axis: int) -> float:
    """The part of the way that one finger can go by itself."""
    if way[axis] == 0.0:
        return 1.0
    lo, hi = region.chord(1 - axis, here[1 - axis])
    return _SHARE * ((hi if way[axis] > 0 else lo) - here[axis]) / way[axis]


def _hold(region: Region, at: At) -> Hold:
    return (region.sides[0], at[0]), (region.sides[1], at[1]), region.turn
