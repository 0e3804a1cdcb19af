"""Boxes of where fingers may be: how they are tried and split. An arc of sides for each finger is a box."""

from math import sqrt

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.places.cubic_arcs import CONTROL, bend, farthest, polar

TOGETHER = 64
"""Ways to choose a side for each finger up to which boxes stay whole where no arc is wide enough to split."""
_TURN = 0.25  # of the size, that a turn by one radian on an arc of sides counts for


@njit(**VIEWS)
def point(sides, j, u):  # type: ignore[no-untyped-def]
    """The point of side j at u."""
    along = u - sides[j, 8]
    if sides.shape[1] > CONTROL:
        return polar(sides, j, 0, along, along, along), polar(sides, j, 1, along, along, along)
    return sides[j, 0] + along * sides[j, 2], sides[j, 1] + along * sides[j, 3]


@njit(**VIEWS)
def distance(sides, j, u, k, v):  # type: ignore[no-untyped-def]
    """Between the points of two sides."""
    px, py = point(sides, j, u)
    qx, qy = point(sides, k, v)
    return sqrt((px - qx) ** 2 + (py - qy) ** 2)


@njit(**VIEWS)
def far_apart(sides, i, one, j, other):  # type: ignore[no-untyped-def]
    """No two points on parts of two sides are farther apart."""
    if sides.shape[1] > CONTROL:
        e, f = sides[i, 8], sides[j, 8]
        return farthest(sides, i, one[0] - e, one[1] - e, j, other[0] - f, other[1] - f)
    far = 0.0
    for a in range(2):
        for b in range(2):
            far = max(far, distance(sides, i, one[a], j, other[b]))
    return far


@njit(**VIEWS)
def too_near(sides, arcs, ends, least):  # type: ignore[no-untyped-def]
    """Two fingers on one side each that are nearer than ``least`` wherever they are; else -1."""
    for i in range(len(arcs)):
        for j in range(i):
            single = arcs[i, 0] == arcs[i, 1] and arcs[j, 0] == arcs[j, 1]
            if single and far_apart(sides, arcs[i, 0], ends[i], arcs[j, 0], ends[j]) < least:
                return True
    return False


@njit(**VIEWS)
def to_try(arcs, ends, seen, places):  # type: ignore[no-untyped-def]
    """A side and u for each finger: the middle of its centres of pressure."""
    for i in range(len(arcs)):
        if seen[i, 0] > seen[i, 1]:  # it does nothing
            places[i, 0], places[i, 1] = (
                arcs[i, 0],
                ends[i, 0] + 0.5 * (min(ends[i, 1], ends[i, 0] + 1.0) - ends[i, 0]),
            )
            if arcs[i, 0] < arcs[i, 1]:
                places[i, 1] = ends[i, 0]
        elif arcs[i, 0] == arcs[i, 1]:
            # by rounding a centre may be past an end, where the next side begins
            middle = min(max(0.5 * (seen[i, 0] + seen[i, 1]), ends[i, 0]), ends[i, 1])
            places[i, 0], places[i, 1] = arcs[i, 0], middle
        else:
            places[i, 0], places[i, 1] = seen[i, 6], seen[i, 7]


@njit(**VIEWS)
def put(sides, places, least, arcs, ends):  # type: ignore[no-untyped-def]
    """Writes places as a box of no width; whether two of them are nearer than ``least``."""
    nearest = np.inf
    for i in range(len(arcs)):
        for c in range(2):
            arcs[i, c], ends[i, c] = int(places[i, 0]), places[i, 1]
        for j in range(i):
            nearest = min(nearest, distance(sides, arcs[i, 0], places[i, 1], arcs[j, 0], places[j, 1]))
    return nearest < least


@njit(**VIEWS)
def spread(sides, arcs, ends, places):  # type: ignore[no-untyped-def]
    """Puts fingers on one side each at those ends of their arcs where the nearest two are farthest apart."""
    k, most, best = len(arcs), -1.0, 0
    for i in range(k):
        if arcs[i, 0] < arcs[i, 1]:
            return
    for corner in range(1 << k):
        nearest = np.inf
        for i in range(k):
            for j in range(i):
                u, v = ends[i, (corner >> i) & 1], ends[j, (corner >> j) & 1]
                nearest = min(nearest, distance(sides, arcs[i, 0], u, arcs[j, 0], v))
        if nearest > most:
            most, best = nearest, corner
    for i in range(k):
        places[i, 0], places[i, 1] = arcs[i, 0], ends[i, (best >> i) & 1]


@njit(**VIEWS)
def turn(sides, first, last):  # type: ignore[no-untyped-def]
    """The largest chord between the normal of a side and those of the sides after it up to ``last``."""
    most = 0.0
    for j in range(first + 1, last + 1):
        most = max(most, (sides[j, 4] - sides[first, 4]) ** 2 + (sides[j, 5] - sides[first, 5]) ** 2)
    return sqrt(most)


@njit(**VIEWS)
def to_split(sides, arcs, ends, seen, near, narrow):  # type: ignore[no-untyped-def]
    """The finger to split, the last side of its left part, and where, if on one side; -1 for none."""
    chosen, most = -1, -1.0
    curved = sides.shape[1] > CONTROL
    if narrow == np.inf:
        ways = 1
        for i in range(len(arcs)):
            ways *= arcs[i, 1] - arcs[i, 0] + 1
        if ways <= TOGETHER:
            return -1
    for i in range(len(arcs)):
        first, last = arcs[i]
        if first < last:
            apart = 0.0
            if seen[i, 2] <= seen[i, 4]:
                j, c = int(seen[i, 3]), int(seen[i, 5])
                apart = distance(sides, j, seen[i, 2], c, seen[i, 4])
                # where two sides meet forces differ, too
                apart += sqrt((sides[j, 4] - sides[c, 4]) ** 2 + (sides[j, 5] - sides[c, 5]) ** 2)
            matters = apart + (0.1 if curved else _TURN * turn(sides, first, last))
        else:
            j = first
            length = sqrt(sides[j, 2] ** 2 + sides[j, 3] ** 2)
            width = (ends[i, 1] - ends[i, 0]) * length
            # a short part that turns is no place yet: its normals differ
            bent = bend(sides, j, ends[i, 0], ends[i, 1]) if curved else 0.0
            if max(width, bent) < narrow:
                continue
            matters = 1e-3 * width
            if seen[i, 0] <= seen[i, 1]:
                matters = (seen[i, 1] - seen[i, 0]) * length + 1e-6 * width
            matters += 0.5 * bent
            if near:  # only a smaller box tells whether fingers can be far enough apart
                matters = width
        if matters > most:
            chosen, most = i, matters
    return chosen


@njit(**VIEWS)
def cut(sides, arcs, ends, seen, i):  # type: ignore[no-untyped-def]
    """The last side of the left part, and u where finger i is split."""
    first, last = arcs[i]
    if first < last:
        if seen[i, 2] > seen[i, 4]:
            at = (first + last - 1) // 2
        elif seen[i, 3] != seen[i, 5]:
            at = int(seen[i, 3] + seen[i, 5]) // 2
        else:
            at = int(seen[i, 3])
        at = min(max(at, first), last - 1)
        return at, sides[at, 7]
    lo, hi = ends[i, 0], ends[i, 1]
    pressed = seen[i, 0] <= seen[i, 1] and sides.shape[1] <= CONTROL
    middle = 0.5 * (seen[i, 0] + seen[i, 1]) if pressed else 0.5 * (lo + hi)
    return first, min(max(middle, lo + 0.1 * (hi - lo)), hi - 0.1 * (hi - lo))


@njit(**VIEWS)
def alike(arcs, ends, i, j):  # type: ignore[no-untyped-def]
    """Whether two fingers have one box."""
    same = arcs[i, 0] == arcs[j, 0] and arcs[i, 1] == arcs[j, 1]
    return same and ends[i, 0] == ends[j, 0] and ends[i, 1] == ends[j, 1]


@njit(**VIEWS)
def write_child(sides, arcs, ends, i, same, left, at, u, new_arcs, new_ends):  # type: ignore[no-untyped-def]
    """Of ``same`` fingers alike from i on, ``left`` on the left part of their arc, the others right."""
    for f in range(len(arcs)):
        for c in range(2):
            new_arcs[f, c], new_ends[f, c] = arcs[f, c], ends[f, c]
        if i <= f < i + left:
            new_arcs[f, 1], new_ends[f, 1] = at, u
        elif i + left <= f < i + same:
            whole = arcs[i, 0] < arcs[i, 1]
            new_arcs[f, 0], new_ends[f, 0] = (at + 1, sides[at + 1, 6]) if whole else (at, u)


@njit(**VIEWS)
def push(heap, count, bounds, node):  # type: ignore[no-untyped-def]
    """Adds a node to a heap of ``count``, the least bound on top."""
    at = count
    while at > 0 and bounds[heap[(at - 1) // 2]] > bounds[node]:
        heap[at] = heap[(at - 1) // 2]
        at = (at - 1) // 2
    heap[at] = node


@njit(**VIEWS)
def pop(heap, count, bounds):  # type: ignore[no-untyped-def]
    """The node of the least bound of ``count``; the heap is one shorter."""
    top, node, at = heap[0], heap[count - 1], 0
    while 2 * at + 1 < count - 1:
        child = 2 * at + 1
        if child + 1 < count - 1 and bounds[heap[child + 1]] < bounds[heap[child]]:
            child += 1
        if bounds[heap[child]] >= bounds[node]:
            break
        heap[at] = heap[child]
        at = child
    heap[at] = node
    return top
