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
from regrasp.closed_form.compiled.patches.patch_joint import ROWS, bound_together
from regrasp.closed_form.compiled.places.placement_search import EXCLUDED, NEAR, OPEN, SPLIT
from regrasp.compilation import kept

_CORNERS = 3  # rows of a triangle
_MANY = 1000  # rows of a patch that take time
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
        new, row = state[2], state[3]
        state[2] += 1
        state[3] += _CORNERS
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
    """The norm that fingers at spots (k, 6) need, for the worst load, and this; its twist is in ``spare[7]``.

    Infinite, and no load, -1, where they are too near.
    """
    each, _, _, nowhere, twist, work, spans, halves, balls = spare[3:]
    for i in range(len(spots)):
        for j in range(i):
            if _apart(spots[i], spots[j]) < least:
                return np.inf, -1
    return _judge((spots, spans, halves, balls), each, loads, law, level, start, twist, nowhere, work, True)


def spare(k: int) -> tuple[Any, ...]:
    """Memory that a search of k fingers works in."""
    spans = np.column_stack([np.arange(k), np.ones(k, np.int64)])
    return (
        np.zeros(k, np.int64), np.zeros(k, np.int64), np.zeros(k), np.arange(k), np.zeros((k, 6)),
        np.zeros((k, 6)), np.zeros((k, 6)), np.zeros(6), (*workspace(k), np.zeros(6)), spans,
        np.full((k, 3), -1), np.zeros((1, 9)),
    )  # fmt: skip


def _looking(digest: str) -> Any:
    @kept("the search for places on surfaces", error_model="numpy", nogil=True, _nrt=False)
    def look(  # type: ignore[no-untyped-def]
        first, step, nodes, surface, loads, trials, law, usable, found, level, least, boxes, spare, room,
        joining, values, proven, twists,
    ):  # fmt: skip
        """Of every ``step``-th box of ``nodes``: the value of its placement, and what all loads prove of it.

        surface: rows (R, 6), points and inward normals; spans (K, 2), first row and rows of each patch; tree
        (K, 3), its halves, -1 for none, and the edge across which a triangle is halved; and balls (G, 9)
        around groups (``patch_support``). trials: loads, and more that placements tried must hold, too. law:
        mu, size, norm, precision; usable: mu for placements tried. found: the least value, which others
        need not say more of. boxes: patches (N, k), bounds (N,), twists (N, 6), loads' numbers (N,), kinds
        (N,), first children and their number (N, 2), placements to try (N, k, 6), fingers to split (N,), rows
        of ``together`` that bound them (N,), -1 for none. joining: whether loads are taken together, which
        writes ``proven`` (n,), 0 for what was not, by ``twists`` (n, L, 6); room: for them.
        """
        _ = digest
        patches, bounds, critical, places = boxes[0], boxes[1], boxes[3], boxes[6]
        mu, size, norm, precision = law
        rows, spans = surface[0], surface[1]
        corners, count = spare[0], spare[1]
        for n in range(first, len(nodes), step):
            box = nodes[n]
            trying = (usable, size, norm, precision)
            values[n], _ = value_of(places[box], trials, trying, found, critical[box], least, spare)
            proven[n] = 0.0
            if not joining or bounds[box] >= level:
                continue
            total = 0
            for i in range(patches.shape[1]):
                corners[i], count[i] = spans[patches[box, i], 0], spans[patches[box, i], 1]
                total += count[i]
            if total <= ROWS:
                proven[n] = bound_together(rows, corners, count, loads, mu, size, level, twists[n], room)

    return look


def _splitting(digest: str) -> Any:
    @kept("the search for places on surfaces", error_model="numpy", _nrt=False)
    def split(nodes, surface, radius, level, least, boxes, state, spare, proven, twists, together):  # type: ignore[no-untyped-def]
        """Excludes boxes that were looked at, or splits them; those too small to be split stay open.

        radius: (K,) of each patch. state: numbers of boxes, of placements tried, of patches, of rows, of what
        was looked at, of rows of ``together`` (T, L, 6), of boxes whose loads were taken together, and of
        those excluded so. There is room for all.
        """
        _ = digest
        patches, bounds, of, critical, kinds, children, _, fingers, joined = boxes
        first, count, wide = spare[0], spare[1], spare[2]
        rows, spans, tree, _ = surface
        k = patches.shape[1]
        for n in range(len(nodes)):
            box = nodes[n]
            if proven[n] > bounds[box]:
                bounds[box], joined[box] = proven[n], state[5]
                for load in range(twists.shape[1]):
                    for c in range(6):
                        together[state[5], load, c] = twists[n, load, c]
                state[5] += 1
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
                    of[child, c] = of[box, c]
                _locate(spans, radius, patches[child], first, count, wide)
                if least > 0.0 and _too_near(rows, first, count, least):
                    kinds[child] = NEAR

    return split


def _bounding(digest: str) -> Any:
    @kept("the search for places on surfaces", error_model="numpy", nogil=True, _nrt=False)
    def bound(first, step, nodes, surface, radius, loads, law, level, narrow, boxes, spare):  # type: ignore[no-untyped-def]
        """Bounds every ``step``-th box of ``nodes``, first by the twist it has, and plans what is next."""
        _ = digest
        patches, bounds, twists, critical, _, _, places, fingers, joined = boxes
        corners, count, wide, seen, twist, work = spare[0], spare[1], spare[2], spare[4], spare[7], spare[8]
        mu, size, norm, _ = law
        for n in range(first, len(nodes), step):
            box = nodes[n]
            known = bound_by(
                surface, patches[box], loads[critical[box]], twists[box], mu, size, norm, work[:16]
            )
            if known > bounds[box]:
                bounds[box], joined[box] = known, -1
            if bounds[box] >= level:
                continue
            proven, load = _judge(
                surface, patches[box], loads, law, level, critical[box], twist, seen, work, False
            )
            if proven > bounds[box]:
                bounds[box], critical[box], joined[box] = proven, load, -1
                for c in range(6):
                    twists[box, c] = twist[c]
            _locate(surface[1], radius, patches[box], corners, count, wide)
            fingers[box] = _plan(surface[0], corners, count, wide, narrow, seen, places[box])

    return bound


# Numba's cache watches this file only; the digest in the loops' closures makes it watch these, too.
_WATCHED = digest((patch_gauge, patch_joint, patch_support))
look, split, bound = _looking(_WATCHED), _splitting(_WATCHED), _bounding(_WATCHED)
