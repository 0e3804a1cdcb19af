"""The fewest exchanges from hold to hold, by the places that can be reached with so many.

A place is reached with k exchanges if a hold joins it to one that is reached with k - 1, for that finger may
stay while the other moves. Of a convex region and an interval of one finger the other's places are an
interval, so all that is reached are intervals on sides, layer after layer. Regions grown by a tie give a
bound from below, regions made smaller by it ways that can be walked.
"""

from itertools import combinations

from regrasp.planning.anywhere.hold_map import HoldMap, Place, Region
from regrasp.planning.anywhere.walk import Hold

MOST_LAYERS = 500
Layer = dict[int, list[tuple[float, float]]]
"""Rising intervals of sides."""


def fewest_layers(
    holds: HoldMap, start: tuple[Place, ...], goal: tuple[Place, ...], room: float
) -> list[Layer] | None:
    """What is reached with 0, 1, ... exchanges, up to a place of a hold of the goal.

    Empty where no exchange is needed, None where the goal is not reached. room: by which regions are smaller,
    or grown where it is negative.
    """
    ends = _held(holds, goal, room)
    first = _held(holds, start, room)
    if {frozenset(pair) for pair in first} & {frozenset(pair) for pair in ends}:
        return []
    layers = [_merged([(side, f, f) for pair in first for side, f in pair])]
    while not any(_has(layers[-1], place, room) for pair in ends for place in pair):
        after = _after(holds, layers[-1], room)
        if not after or len(layers) > MOST_LAYERS or (len(layers) > 1 and after == layers[-2]):
            return None
        layers.append(after)
    return layers


def fewest_walk(
    holds: HoldMap, start: tuple[Place, ...], goal: tuple[Place, ...], layers: list[Layer], room: float
) -> list[Hold] | None:
    """A walk through such layers: a hold of the start, one through each layer, a hold of the goal."""
    if not layers:
        every = {frozenset(pair): pair for pair in _held(holds, start, room)}
        both = next(every[key] for pair in _held(holds, goal, room) if (key := frozenset(pair)) in every)
        return [(*both, _turn(holds, both, room))]
    last = next(
        (pair for pair in _held(holds, goal, room) if any(_has(layers[-1], p, room) for p in pair)), None
    )
    if last is None:
        return None
    place = next(p for p in last if _has(layers[-1], p, room))
    walk = [(*last, _turn(holds, last, room))]
    for layer in reversed(layers[:-1]):
        found = _before(holds, layer, place, room)
        if found is None:
            return None
        before, turn = found
        walk.append((before, place, turn))
        place = before
    begin = next((pair for pair in _held(holds, start, room) if place in pair), None)
    if begin is None:
        return None
    walk.append((*begin, _turn(holds, begin, room)))
    return walk[::-1]


def _held(holds: HoldMap, end: tuple[Place, ...], room: float) -> list[tuple[Place, Place]]:
    return [(p, q) for p, q in combinations(end, 2) if holds.at(p, q, room)]


def _turn(holds: HoldMap, pair: tuple[Place, Place], room: float) -> int:
    """In which of the orientations a pair holds."""
    return holds.regions[holds.at(*pair, room)[0][0]].turn


def _has(layer: Layer, place: Place, room: float) -> bool:
    grown = max(-room, 0.0)
    return any(lo - grown <= place[1] <= hi + grown for lo, hi in layer.get(place[0], []))


def _after(holds: HoldMap, layer: Layer, room: float) -> Layer:
    """The places that holds join to those of a layer."""
    found = []
    for region in holds.regions:
        for axis in (0, 1):
            for lo, hi in layer.get(region.sides[axis], []):
                image = _image(region, axis, lo, hi, room)
                if image is not None:
                    found.append((region.sides[1 - axis], *image))
    return _merged(found)


def _image(region: Region, axis: int, lo: float, hi: float, room: float) -> tuple[float, float] | None:
    """The other finger's interval where one finger is within ``lo`` to ``hi``."""
    least, most = region.span(axis)
    if hi < least + room or lo > most - room:
        return None
    lo, hi = min(max(lo, least), most), max(min(hi, most), least)
    ends = [*region.chord(axis, lo), *region.chord(axis, hi)]
    ends += [p[1 - axis] for p in region.polygon if lo <= p[axis] <= hi]
    low, high = min(ends) + room, max(ends) - room
    return (low, high) if low <= high else None


def _before(holds: HoldMap, layer: Layer, place: Place, room: float) -> tuple[Place, int] | None:
    """A place of a layer that a hold joins to a place, well inside, and the hold's orientation."""
    found: list[tuple[float, Place, int]] = []
    for region in holds.regions:
        for axis in (0, 1):
            least, most = region.span(axis)
            if region.sides[axis] != place[0] or not least + room <= place[1] <= most - room:
                continue
            a, b = region.chord(axis, place[1])
            for lo, hi in layer.get(region.sides[1 - axis], []):
                low, high = max(lo, a), min(hi, b)
                if low <= high:
                    at = min(max(0.5 * (a + b), low), high)
                    found.append((min(at - a, b - at), (region.sides[1 - axis], at), region.turn))
    if not found:
        return None
    _, before, turn = max(found)
    return before, turn


def _merged(spans: list[tuple[int, float, float]]) -> Layer:
    result: Layer = {}
    for side, lo, hi in sorted(spans):
        kept = result.setdefault(side, [])
        if kept and lo <= kept[-1][1]:
            kept[-1] = kept[-1][0], max(hi, kept[-1][1])
        else:
            kept.append((lo, hi))
    return result
