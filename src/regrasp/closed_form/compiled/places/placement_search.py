"""Branch and bound over where fingers are on a boundary, best bound first.

A box gives each finger an arc; fingers are alike, so a box is a set of arcs, and fingers on the same arc
are split together: j of them go left, the others right. The lower bound of a box is the largest of its loads'
(``wrench_gauge``). Its forces press each finger somewhere on the arc, for each load elsewhere: the finger
whose centres of pressure disagree most is split, at their middle, and the middles are a placement to try.
"""

from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS, digest
from regrasp.closed_form.compiled.places import (
    cubic_arcs,
    eroded,
    least_norm,
    limited,
    placement_boxes,
    two_twists,
    wrench_gauge,
)
from regrasp.closed_form.compiled.places.cubic_arcs import CONTROL
from regrasp.closed_form.compiled.places.least_norm import (
    bound_within,
    gauge_within,
    is_limited,
    room_for_limits,
)
from regrasp.closed_form.compiled.places.placement_boxes import (
    alike,
    cut,
    pop,
    push,
    put,
    spread,
    to_split,
    to_try,
    too_near,
    write_child,
)
from regrasp.closed_form.compiled.places.two_twists import bound_by_two, room_for_two
from regrasp.closed_form.compiled.places.wrench_gauge import LARGEST, bound_by, gauge, workspace
from regrasp.compilation import kept

OPEN, EXCLUDED, SPLIT, NEAR = 0, 1, 2, 3
"""A box not looked into; without a better placement; halved; without fingers as far apart as they must be."""
_APART = 1e-6  # of a value, by which what forces reach and a bound agree
COARSE = 32.0
"""Of the narrowest arcs, those of boxes where no corner has fingers as far apart as they must be."""
CLOSED, IMPROVED, PAUSED, FULL = 0, 1, 2, 3
"""Why a search returns: no box is left; a placement within a fixed level; after so many boxes; no memory."""


@njit(**VIEWS)
def _judge(sides, arcs, ends, loads, law, precision, level, first, twist, work, seen, placed):  # type: ignore[no-untyped-def]
    """The bound of a box and the load behind it, from load ``first`` on; until one reaches ``level``.

    placed: the box is a placement, whose value is asked for: what forces reach, where the bound is less.

    seen: (k, 8) of each finger: least and largest centre of pressure; the sides and u of the extreme forces;
    side and u of the largest force under the worst load, or under another where it has none there.
    """
    k = len(arcs)
    worst, critical = -1.0, first
    x, forces, best, every = work[1], work[2], work[8], work[11]
    for i in range(k):
        seen[i, 0], seen[i, 1] = np.inf, -np.inf
        seen[i, 2], seen[i, 4] = np.inf, -np.inf
        seen[i, 6] = -1.0
    for number in range(len(loads)):
        load = number if number > first else (number - 1 if number > 0 else first)
        if is_limited(law):
            value, reached = gauge_within(
                sides, arcs, ends, law, loads[load], level, precision, best, work[:11], work[19]
            )
        else:
            value, reached = gauge(sides, arcs, ends, law, loads[load], level, precision, best, work[:11])
        if placed and value < level and value < reached * (1.0 - max(precision, _APART)):
            value = reached
        for c in range(3):
            every[load, c] = best[c]
        worse = value > worst
        if worse:
            worst, critical = value, load
            twist[0], twist[1], twist[2] = best[0], best[1], best[2]
        if value >= level:
            break
        for i in range(k):
            total, moment, most = 0.0, 0.0, 0.0
            wanted = worse or seen[i, 6] < 0.0
            for j in range(4):
                weight = x[j] * forces[j, i, 0]
                total += max(weight, 0.0)
            for j in range(4):
                weight = x[j] * forces[j, i, 0]
                if weight <= 1e-9 * total or weight <= 0.0:
                    continue
                side, u = forces[j, i, 1], forces[j, i, 2]
                moment += weight * u / total
                if u < seen[i, 2]:
                    seen[i, 2], seen[i, 3] = u, side
                if u > seen[i, 4]:
                    seen[i, 4], seen[i, 5] = u, side
                if wanted and weight > most:
                    most = weight
                    seen[i, 6], seen[i, 7] = side, u
            if total > 0.0:
                seen[i, 0], seen[i, 1] = min(seen[i, 0], moment), max(seen[i, 1], moment)
    return worst, critical


@njit(**VIEWS)
def _join(sides, loads, bounding, boxes, node, work):  # type: ignore[no-untyped-def]
    """Raises the bound of a box to what two of the last twists prove together."""
    arcs, ends, bounds, twists, critical, _, _, _, seconds, other, _ = boxes
    best = work[12]
    found, load, second = bound_by_two(
        sides, arcs[node], ends[node], bounding, loads, work[11], best, work[13:19]
    )
    if found > bounds[node]:
        bounds[node], critical[node], other[node] = found, load, second
        for c in range(3):
            twists[node, c], seconds[node, c] = best[0, c], best[1, c]


@njit(**VIEWS)
def _assess(sides, loads, law, level, boxes, node, work):  # type: ignore[no-untyped-def]
    """Raises the bound of a box to what its loads prove, and notes where its forces press."""
    arcs, ends, bounds, twists, critical, _, _, seen, _, other, twist = boxes
    mu, _, size, norm, precision, limit, margin = law
    bounding = (mu, size, norm, limit, margin)
    found, load = _judge(
        sides, arcs[node], ends[node], loads, bounding, precision, level, critical[node], twist[0], work,
        seen[node], False,
    )  # fmt: skip
    if found >= bounds[node]:
        bounds[node], critical[node], other[node] = found, load, -1
        for c in range(3):
            twists[node, c] = twist[0, c]
    if found < level and not is_limited(bounding):
        _join(sides, loads, bounding, boxes, node, work)


def spare(k: int, loads: int) -> tuple[Any, ...]:
    """Memory that a search of k fingers under so many loads works in."""
    return (
        (*workspace(k), *room_for_two(loads, k), room_for_limits(k)),
        np.zeros((k, 2)),
        np.zeros((k, 8)),
        np.zeros((k, 2), np.int64),
        np.zeros((k, 2)),
    )


def _loop(digest: str) -> Any:
    @kept("the search for places", error_model="numpy", nogil=True, _nrt=False)
    def search(  # type: ignore[no-untyped-def]
        sides, loads, law, fixed, tolerance, least, narrow, boxes, heap, state, found, tried, budget, spare
    ):
        """Goes on with a search; see the module. Returns why it ends.

        sides: (m, 9) or (m, 17) as of ``wrench_gauge.gauge``. loads: (L, 3) to be made. law: mu, what
        placements tried may use of it, size, norm, precision, and of ``ERODED`` the limit and the distance.
        fixed: a level, or infinite to follow the least value times 1 - tolerance. least: distance of fingers.
        narrow: arcs shorter than this are not split.
        boxes: arcs (N, k, 2), ends (N, k, 2), bounds (N,), below 0 of what is to be bounded anew, twists
        (N, 3), loads' numbers (N,), kinds (N,), first children and their number (N, 2), where forces press
        (N, k, 8), second twists (N, 3) and loads (N,), -1 for none, scratch (1, 3). state: number of
        boxes, of those in the heap, of placements tried. found: (1 + 2 k) the least value so far, sides and u
        of its fingers. tried: (T, 1 + 2 k) the last placements tried.
        """
        _ = digest
        arcs, ends, bounds, twists, critical, kinds, children, seen, seconds, other, twist = boxes
        k = arcs.shape[1]
        work, places, nowhere, at_arcs, at_ends = spare
        mu, usable, size, norm, precision, limit, margin = law
        bounding, trying = (mu, size, norm, limit, margin), (usable, size, norm, limit, margin)
        looked = 0
        if state[0] == 1 and kinds[0] == OPEN:
            _assess(sides, loads, law, np.inf, boxes, heap[0], work)
        while state[1] > 0:
            level = fixed if fixed < np.inf else found[0] * (1.0 - tolerance)
            if bounds[heap[0]] >= level:
                break
            if looked >= budget:
                return PAUSED
            if state[0] + k + 1 > len(bounds):
                return FULL
            looked += 1
            node = pop(heap, state[1], bounds)
            state[1] -= 1
            if bounds[node] < 0.0:  # of another level
                bounds[node] = 0.0
                _assess(sides, loads, law, level, boxes, node, work)
                if bounds[node] >= level:
                    kinds[node] = EXCLUDED
                else:
                    push(heap, state[1], bounds, node)
                    state[1] += 1
                continue
            most = found[0] if fixed == np.inf else fixed * (1.0 + 1e-6)
            # a placement from where its forces press
            to_try(arcs[node], ends[node], seen[node], places)
            near = put(sides, places, least, at_arcs, at_ends)
            stuck = near
            if near:
                spread(sides, arcs[node], ends[node], places)
                stuck = put(sides, places, least, at_arcs, at_ends)
            if not stuck:
                flat, single = norm == LARGEST and sides.shape[1] <= CONTROL, True
                flat = flat and not is_limited(bounding)
                for i in range(k):
                    single = single and arcs[node, i, 0] == arcs[node, i, 1]
                flat = flat and single
                for again in range(2):
                    if again:
                        # on a knife's edge: where forces press that use a little less friction
                        value, _ = _judge(
                            sides, arcs[node], ends[node], loads, trying, precision, most, critical[node],
                            twist[0], work, nowhere, False,
                        )  # fmt: skip
                        if value >= most:
                            break
                        to_try(arcs[node], ends[node], nowhere, places)
                        if put(sides, places, least, at_arcs, at_ends):
                            break
                    value, _ = _judge(
                        sides, at_arcs, at_ends, loads, trying, precision, np.inf if flat else most,
                        critical[node], twist[0], work, nowhere, True,
                    )  # fmt: skip
                    row = state[2] % len(tried)
                    state[2] += 1
                    tried[row, 0] = value
                    for i in range(k):
                        tried[row, 1 + 2 * i], tried[row, 2 + 2 * i] = places[i, 0], places[i, 1]
                    if value < found[0]:
                        for c in range(2 * k + 1):
                            found[c] = tried[row, c]
                        if fixed < np.inf and value <= fixed:
                            push(heap, state[1], bounds, node)
                            state[1] += 1
                            return IMPROVED
                        level = fixed if fixed < np.inf else found[0] * (1.0 - tolerance)
                    if value < most or not single or near:
                        break
                if flat:
                    _join(sides, loads, bounding, boxes, node, work)
            if bounds[node] >= level:
                kinds[node] = EXCLUDED
                continue
            i = to_split(
                sides, arcs[node], ends[node], seen[node], near, COARSE * narrow if stuck else narrow
            )
            if i < 0:  # too small to be split: it stays open
                continue
            at, u = cut(sides, arcs[node], ends[node], seen[node], i)
            while i > 0 and alike(arcs[node], ends[node], i - 1, i):
                i -= 1
            same = 1
            while i + same < k and alike(arcs[node], ends[node], i, i + same):
                same += 1
            kinds[node] = SPLIT
            children[node, 0], children[node, 1] = state[0], same + 1
            for left in range(same, -1, -1):
                child = state[0]
                state[0] += 1
                write_child(sides, arcs[node], ends[node], i, same, left, at, u, arcs[child], ends[child])
                bounds[child], critical[child], kinds[child] = bounds[node], critical[node], OPEN
                other[child] = other[node]
                for c in range(3):
                    twists[child, c], seconds[child, c] = twists[node, c], seconds[node, c]
                if least > 0.0 and too_near(sides, arcs[child], ends[child], least):
                    kinds[child] = NEAR
                    continue
                b = loads[critical[node]]
                if is_limited(bounding):
                    known = bound_within(
                        sides, arcs[child], ends[child], bounding, b, twists[node], level, work[:11], work[19]
                    )
                else:
                    known = bound_by(sides, arcs[child], ends[child], bounding, b, twists[node], work[:11])
                if sides.shape[1] > CONTROL:  # of a part of a curve a twist may prove a little less
                    bounds[child] = min(bounds[child], known)
                if known >= level:
                    bounds[child], other[child] = known, -1
                else:
                    _assess(sides, loads, law, level, boxes, child, work)
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


def _value(digest: str) -> Any:
    @kept("the search for places", error_model="numpy", nogil=True, _nrt=False)
    def value_of(sides, loads, law, most, arcs, ends, first, spare):  # type: ignore[no-untyped-def]
        """What the worst load needs of the worst placement at ends of arcs, one or the other of each finger.

        sides, loads, law, arcs, ends, spare: as of ``search``. first: bits of the corner to begin with.
        Returns some value beyond ``most``, if there is one, and bits of the worst corner seen.
        """
        _ = digest
        _, usable, size, norm, precision, limit, margin = law
        work, _, nowhere, at_arcs, at_ends = spare
        at_arcs, at_ends = at_arcs[: len(arcs)], at_ends[: len(arcs)]  # some may have left
        law, twist = (usable, size, norm, limit, margin), work[12][0]
        worst, corner, critical, single = -1.0, first, 0, 0
        for i in range(len(arcs)):
            if arcs[i, 0] == arcs[i, 1] and ends[i, 0] == ends[i, 1]:
                single |= 1 << i
        for number in range(1 << len(arcs)):
            if number & single:
                continue
            bits = first ^ number
            for i in range(len(arcs)):
                at_arcs[i, 0] = at_arcs[i, 1] = arcs[i, (bits >> i) & 1]
                at_ends[i, 0] = at_ends[i, 1] = ends[i, (bits >> i) & 1]
            found, critical = _judge(
                sides, at_arcs, at_ends, loads, law, precision, most, critical, twist, work, nowhere, True
            )  # fmt: skip
            if found > worst:
                worst, corner = found, bits
            if worst >= most:
                break
        return worst, corner

    return value_of


# Numba's cache watches this file only; the digest in the loop's closure makes it watch these, too.
_WATCHED = digest((cubic_arcs, eroded, least_norm, limited, placement_boxes, two_twists, wrench_gauge))
search, value_of = _loop(_WATCHED), _value(_WATCHED)
