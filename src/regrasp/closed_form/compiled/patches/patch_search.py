"""Branch and bound over where fingers are on a surface, best bound first.

A box gives each finger a patch: faces, or a part of one; a point is a face of no size. Fingers are alike, so
a box is a row of patches, and fingers on the same patch are split together: j of them go to its one half, the
others to the other. The lower bound of a box is the largest of its loads' (``patch_gauge``). The finger is
split whose forces press in places that are farthest apart, and their means are a placement to try.
"""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS, digest
from regrasp.closed_form.compiled.patches import patch_gauge, patch_joint, patch_support
from regrasp.closed_form.compiled.patches.patch_gauge import bound_by, gauge, reached, workspace
from regrasp.closed_form.compiled.patches.patch_joint import LOADS, ROWS, bound_together
from regrasp.closed_form.compiled.places import placement_search
from regrasp.closed_form.compiled.places.placement_search import (
    CLOSED,
    EXCLUDED,
    FULL,
    NEAR,
    OPEN,
    PAUSED,
    SPLIT,
    pop,
    push,
)
from regrasp.closed_form.compiled.places.wrench_gauge import LARGEST
from regrasp.compilation import kept

_CORNERS = 3  # rows of a triangle
_MANY = 1000  # rows of a patch that take time
_OFTEN = 16  # boxes of which one at least is excluded by all loads together
_DOUBT = 1e-12  # of the size of a mesh, by which distances may be off
_AGREE = 1e-6  # of a norm, by which what forces reach and a bound agree


@njit(**VIEWS)
def _apart(p, q):  # type: ignore[no-untyped-def]
    return sqrt((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2)


@njit(**VIEWS)
def _judge(surface, patches, loads, law, level, start, twist, seen, work, placed):  # type: ignore[no-untyped-def]
    """The bound of patches, the load behind it, and where forces press; until one load reaches ``level``.

    placed: patches are points, and the norm is asked for that forces reach, where the bound is less.
    seen: (k, 6) of each finger: weight, weight times place (3), times its square, row of the largest weight.
    """
    mu, size, norm, precision = law
    best, rows = work[16], surface[0]
    made, shares, x = work[10], work[11], work[7]
    k = len(patches)
    worst, critical, many = -1.0, start, False
    for i in range(k):
        many = many or surface[1][patches[i], 1] > _MANY
        for c in range(6):
            seen[i, c] = 0.0
        seen[i, 5] = -1.0
    for number in range(len(loads)):
        load = number if number > start else (number - 1 if number > 0 else start)
        enough = worst if many and not placed else -1.0  # a load that needs no more is not the worst
        w = loads[load]
        found = gauge(surface, patches, w, mu, size, norm, level, enough, precision, best, work[:16])
        if placed and found < level:
            norm_of_forces = reached(loads[load], k, work[:16])
            if found < norm_of_forces * (1.0 - max(precision, _AGREE)):
                found = norm_of_forces
        if found > worst:
            worst, critical = found, load
            for c in range(6):
                twist[c] = best[c]
        if found >= level:
            break
        for i in range(k):
            most = 0.0
            for r in range(6):
                weight = x[r] * shares[r, i]
                if weight <= 0.0:
                    continue
                p = rows[made[r, i]]
                seen[i, 0] += weight
                for c in range(3):
                    seen[i, 1 + c] += weight * p[c]
                seen[i, 4] += weight * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
                if weight > most:
                    most = weight
                    seen[i, 5] = made[r, i]
    return worst, critical


@njit(**VIEWS)
def _plan(rows, first, count, radius, narrow, seen, spots):  # type: ignore[no-untyped-def]
    """Writes a placement to try, (k, 6); returns the finger to split, -1 for none."""
    k = len(first)
    chosen, most, total = -1, -1.0, 0.0
    for i in range(k):
        total += seen[i, 0]
    for i in range(k):
        row = int(seen[i, 5]) if seen[i, 5] >= 0.0 else first[i]
        weight, square = seen[i, 0], 0.0
        for c in range(3):
            spots[i, c], spots[i, 3 + c] = rows[row, c], rows[row, 3 + c]
            mean = seen[i, 1 + c] / weight if weight > 0.0 else 0.0
            square += mean * mean
            if count[i] == _CORNERS and weight > 0.0:
                spots[i, c] = mean
            else:
                one = first[i] + (row - first[i]) // _CORNERS * _CORNERS
                spots[i, c] = 0.5 * spots[i, c] + (rows[one, c] + rows[one + 1, c] + rows[one + 2, c]) / 6.0
        if count[i] == _CORNERS and radius[i] < narrow:
            continue
        spread = sqrt(max(seen[i, 4] / weight - square, 0.0)) if weight > 0.0 else 0.0
        if count[i] > _CORNERS:
            spread += 0.5 * radius[i]
        matters = 1e-3 * radius[i]
        if total > 0.0:
            matters += spread * weight / total
        if matters > most:
            chosen, most = i, matters
    return chosen


@njit(**VIEWS)
def _halve(rows, spans, tree, radius, patch, state):  # type: ignore[no-untyped-def]
    """Makes the halves of a triangle across its longest edge, if it has none yet."""
    if tree[patch, 0] >= 0:
        return
    first, longest, edge = spans[patch, 0], -1.0, 0
    for e in range(_CORNERS):
        length = _apart(rows[first + e], rows[first + (e + 1) % _CORNERS])
        if length > longest * (1.0 + 1e-9):
            longest, edge = length, e
    a, b, o = first + edge, first + (edge + 1) % _CORNERS, first + (edge + 2) % _CORNERS
    tree[patch, 2] = edge
    for half in range(2):
        new, row = state[3], state[4]
        state[3] += 1
        state[4] += _CORNERS
        tree[patch, half] = new
        tree[new, 0] = tree[new, 1] = tree[new, 2] = -1
        spans[new, 0], spans[new, 1] = row, _CORNERS
        for c in range(6):
            middle = 0.5 * (rows[a, c] + rows[b, c])
            if c >= 3:
                middle = rows[a, c]
            rows[row, c] = rows[a, c] if half == 0 else middle
            rows[row + 1, c] = middle if half == 0 else rows[b, c]
            rows[row + 2, c] = rows[o, c]
        radius[new] = 0.0
        for e in range(_CORNERS):
            length = _apart(rows[row + e], rows[row + (e + 1) % _CORNERS])
            radius[new] = max(radius[new], 0.5 * length)


@njit(**VIEWS)
def _too_near(rows, first, count, least):  # type: ignore[no-untyped-def]
    """Whether two fingers on small patches are nearer than ``least`` wherever they are."""
    for i in range(len(first)):
        for j in range(i):
            if count[i] > _CORNERS or count[j] > _CORNERS:
                continue
            far = 0.0
            for a in range(count[i]):
                for b in range(count[j]):
                    far = max(far, _apart(rows[first[i] + a], rows[first[j] + b]))
            if far < least - _DOUBT:
                return True
    return False


@njit(**VIEWS)
def _locate(spans, radius, patches, first, count, wide):  # type: ignore[no-untyped-def]
    for i in range(len(patches)):
        first[i], count[i] = spans[patches[i], 0], spans[patches[i], 1]
        wide[i] = radius[patches[i]]


@njit(**VIEWS)
def value_of(spots, loads, law, level, start, least, spare):  # type: ignore[no-untyped-def]
    """The norm that fingers at spots (k, 6) need, for the worst load; infinite where they are too near."""
    each, _, _, nowhere, scrap, work, spans, halves, balls = spare[3:]
    for i in range(len(spots)):
        for j in range(i):
            if _apart(spots[i], spots[j]) < least:
                return np.inf
    found, _ = _judge(
        (spots, spans, halves, balls), each, loads, law, level, start, scrap, nowhere, work, True
    )
    return found


def spare(k: int) -> tuple[Any, ...]:
    """Memory that a search of k fingers works in."""
    spans = np.column_stack([np.arange(k), np.ones(k, np.int64)])
    return (
        np.zeros(k, np.int64), np.zeros(k, np.int64), np.zeros(k), np.arange(k), np.zeros((k, 6)),
        np.zeros((k, 6)), np.zeros((k, 6)), np.zeros(6), (*workspace(k), np.zeros(6)), spans,
        np.full((k, 3), -1), np.zeros((1, 9)),
    )  # fmt: skip


def _loop(digest: str) -> Any:
    @kept("the search for places on surfaces", error_model="numpy", _nrt=False)
    def search(  # type: ignore[no-untyped-def]
        surface, radius, loads, trials, law, usable, tolerance, least, narrow, boxes, heap, state,
        found, tried, budget, spare, together, room,
    ):  # fmt: skip
        """Goes on with a search; see the module. Returns why it ends.

        surface: rows (R, 6), points and inward normals; spans (K, 2), first row and rows of each patch; tree
        (K, 3), its halves, -1 for none, and the edge across which a triangle is halved; and balls (G, 9)
        around groups (``patch_support``). radius: (K,) of each patch. trials: loads, and more that placements
        tried must hold, too. law: mu, size, norm, precision; usable: mu for placements tried.
        boxes: patches (N, k), bounds (N,), twists (N, 6), loads' numbers (N,), kinds (N,), first children and
        their number (N, 2), placements to try (N, k, 6), fingers to split (N,), rows of ``together`` that
        bound them (N,), -1 for none. state: numbers of boxes, of those in the heap, of placements tried, of
        patches, of rows, of what was looked at, of rows of ``together``, of boxes whose loads were taken
        together, and of those excluded so. found: (1 + 6 k) the least value and its spots. together:
        (T, L, 6) twists of all loads; room: for them. tolerance: where below 0, what is found ends it.
        """
        _ = digest
        patches, bounds, twists, critical, kinds, children, places, fingers, joined = boxes
        first, count, wide, seen, twist, work = spare[0], spare[1], spare[2], spare[4], spare[7], spare[8]
        rows, spans, tree, _ = surface
        k, looked = patches.shape[1], 0
        mu, size, norm, precision = law
        trying = (usable, size, norm, precision)
        if state[0] == 1 and kinds[0] == OPEN and state[2] == 0 and bounds[0] == 0.0:
            _locate(spans, radius, patches[0], first, count, wide)
            bounds[0], critical[0] = _judge(
                surface, patches[0], loads, law, np.inf, 0, twists[0], seen, work, False
            )
            fingers[0] = _plan(rows, first, count, wide, narrow, seen, places[0])
        while state[1] > 0:
            level = found[0] * (1.0 - tolerance)
            if bounds[heap[0]] >= level:
                break
            if looked >= budget:
                return PAUSED
            if state[0] + k + 1 > len(bounds) or state[3] + 2 > len(spans) or state[4] + 6 > len(rows):
                return FULL
            if state[6] == len(together):
                return FULL
            looked += 1
            state[5] = work[15][0] + room[6][0]
            box = pop(heap, state[1], bounds)
            state[1] -= 1
            value = value_of(places[box], trials, trying, found[0], critical[box], least, spare)
            row = state[2] % len(tried)
            state[2] += 1
            tried[row, 0] = value
            for i in range(k):
                for c in range(6):
                    tried[row, 1 + 6 * i + c] = places[box, i, c]
            if value < found[0]:
                for c in range(6 * k + 1):
                    found[c] = tried[row, c]
                if tolerance < 0.0:
                    push(heap, state[1], bounds, box)
                    state[1] += 1
                    return PAUSED
                level = found[0] * (1.0 - tolerance)
            if bounds[box] < level and norm == LARGEST and 1 < len(loads) <= LOADS:
                _locate(spans, radius, patches[box], first, count, wide)
                # while it pays: where it seldom excludes a box, few more are tried
                if count.sum() <= ROWS and state[7] <= _OFTEN * (state[8] + _OFTEN):
                    proven = bound_together(
                        rows, first, count, loads, mu, size, level, precision, together[state[6]], room
                    )
                    state[7] += 1
                    if proven > bounds[box]:
                        bounds[box], joined[box] = proven, state[6]
                        state[6] += 1
                    state[8] += 1 if proven >= level else 0
            if bounds[box] >= level:
                kinds[box] = EXCLUDED
                continue
            i = fingers[box]
            if i < 0:  # too small to be split: it stays open
                continue
            patch = patches[box, i]
            if spans[patch, 1] == _CORNERS:
                _halve(rows, spans, tree, radius, patch, state)
            while i > 0 and patches[box, i - 1] == patch:
                i -= 1
            same = 1
            while i + same < k and patches[box, i + same] == patch:
                same += 1
            kinds[box] = SPLIT
            children[box, 0], children[box, 1] = state[0], same + 1
            for left in range(same, -1, -1):
                child = state[0]
                state[0] += 1
                for f in range(k):
                    patches[child, f] = patches[box, f]
                    if i <= f < i + same:
                        patches[child, f] = tree[patch, 0 if f < i + left else 1]
                bounds[child], critical[child], kinds[child] = bounds[box], critical[box], OPEN
                joined[child] = joined[box]
                for c in range(6):
                    twists[child, c] = twists[box, c]
                _locate(spans, radius, patches[child], first, count, wide)
                if least > 0.0 and _too_near(rows, first, count, least):
                    kinds[child] = NEAR
                    continue
                w = loads[critical[box]]
                known = bound_by(surface, patches[child], w, twists[box], mu, size, norm, work[:16])
                if known > bounds[box]:
                    bounds[child], joined[child] = known, -1
                if bounds[child] < level:
                    proven, load = _judge(
                        surface, patches[child], loads, law, level, critical[box], twist, seen, work, False
                    )
                    if proven > bounds[child]:
                        bounds[child], critical[child], joined[child] = proven, load, -1
                        for c in range(6):
                            twists[child, c] = twist[c]
                    fingers[child] = _plan(rows, first, count, wide, narrow, seen, places[child])
                if bounds[child] >= level:
                    kinds[child] = EXCLUDED
                else:
                    push(heap, state[1], bounds, child)
                    state[1] += 1
        for n in range(state[1]):
            kinds[heap[n]] = EXCLUDED
        state[1] = 0
        return CLOSED

    return search


# Numba's cache watches this file only; the digest in the loop's closure makes it watch this, too.
search = _loop(digest((patch_gauge, patch_joint, patch_support, placement_search)))
