"""The proof that no regrasp exists on an outline: its places in two parts, and boxes that no hold is in."""

from itertools import combinations

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.hold_map import TIE, HoldMap, Place
from regrasp.planning.anywhere.limited_twists import excluded

MOST_BOXES = 20_000
"""Boxes that a proof may take; beyond, the answer is open."""
_THINNEST = 2.0**-30

Arc = tuple[int, float, float]
"""A side and two fractions of it."""
Box = tuple[int, int, float, float, float, float]
"""Two sides, then the ends on the one and on the other."""


def reached_arcs(holds: HoldMap, start: set[int]) -> tuple[list[Arc], set[int]]:
    """Arcs around all that regions reach, wherever they touch, half way to all others; and these regions."""
    neighbours = holds.neighbours(-TIE)
    inside = set(start)
    queue = list(start)
    for region in queue:
        queue += neighbours[region] - inside
        inside |= neighbours[region]
    arcs: list[list[float]] = []
    before: tuple[int, float, bool] = (-1, 0.0, False)  # the side, how far it is taken, and by which part
    for side, lo, hi, region, _ in holds.spans():
        ours = region in inside
        if side != before[0]:
            before = (side, 0.0, ours)
            if ours:
                arcs.append([side, 0.0, 1.0])
        elif ours != before[2]:
            middle = 0.5 * (before[1] + lo)
            if ours:
                arcs.append([side, middle, 1.0])
            else:
                arcs[-1][2] = middle
            before = (side, before[1], ours)
        before = (side, max(before[1], hi), ours)
    return [(int(side), lo, hi) for side, lo, hi in arcs], inside


def is_in(place: Place, arcs: list[Arc]) -> bool:
    """Whether a place is in one of some arcs."""
    return any(side == place[0] and lo <= place[1] <= hi for side, lo, hi in arcs)


def excluded_boxes(
    holds: HoldMap, arcs: list[Arc], start: tuple[Place, ...], goal: tuple[Place, ...]
) -> tuple[list[Box], list[list[float]]] | None:
    """Boxes that tile all pairs across the cut, pairs of the ends on the wrong side besides, with twists.

    None where not all are found to be excluded.
    """
    todo = [(one[0], other[0], *one[1:], *other[1:]) for one in arcs for other in _rest(holds, arcs)]
    points = [pair for pair in combinations(start, 2) if not any(is_in(p, arcs) for p in pair)]
    points += [pair for pair in combinations(goal, 2) if all(is_in(p, arcs) for p in pair)]
    todo += [(p[0], q[0], p[1], p[1], q[1], q[1]) for p, q in points]
    lengths = np.hypot(*(np.roll(holds.vertices, -1, axis=0) - holds.vertices).T)
    boxes: list[Box] = []
    twists: list[list[float]] = []
    while todo:
        if len(boxes) + len(todo) > MOST_BOXES:
            return None
        table = np.array(todo)
        sides = table[:, :2].astype(np.intp)
        sure, found = excluded(holds, sides, table[:, 2:])
        boxes += [box for box, known in zip(todo, sure, strict=True) if known]
        twists += found[sure].tolist()
        todo = [
            half for box, known in zip(todo, sure, strict=True) if not known for half in _halves(box, lengths)
        ]
        if any(max(b[3] - b[2], b[5] - b[4]) < _THINNEST for b in todo):
            return None
    return boxes, twists


def _rest(holds: HoldMap, arcs: list[Arc]) -> list[Arc]:
    """What the arcs, in rising order, leave of every side that fingers may touch."""
    rest = []
    for side in np.flatnonzero(holds.free).tolist():
        at = 0.0
        for _, lo, hi in (arc for arc in arcs if arc[0] == side):
            if lo > at:
                rest.append((side, at, lo))
            at = hi
        if at < 1.0:
            rest.append((side, at, 1.0))
    return rest


def _halves(box: Box, lengths: Array) -> tuple[Box, Box]:
    """A box cut in two across its longer side."""
    i, j, a, b, c, d = box
    if (b - a) * lengths[i] >= (d - c) * lengths[j]:
        middle = 0.5 * (a + b)
        return (i, j, a, middle, c, d), (i, j, middle, b, c, d)
    middle = 0.5 * (c + d)
    return (i, j, a, b, c, middle), (i, j, a, b, middle, d)
