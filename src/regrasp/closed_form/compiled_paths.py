"""One more finger move: which holds it leads to, over all triples of points, compiled by Numba.

Three fingers stand at a triple of points; two of them hold, the third is free. Within a triple every hold can
be exchanged for every other and the object may turn, by less than a largest turn at a time, without any
finger moving. A move takes the free finger to another point, and so to another triple that shares the hold.

A table (holds, orientations) says what is known of each hold at each orientation: the widest least margin of
a way there (-1: none), or its least cost (inf: none). ``holds`` is (ids, slots, first, second, rows): the
number of a hold by its slot and its two points (-1 where it is not allowed); of each hold its slot, points
and row of margins. ``near`` (orientations, k): from where the object may turn there in one step, itself
included.
"""

from math import inf

import numpy as np
from numba import get_num_threads, njit, prange

_NONE = -1.0


@njit(error_model="numpy")
def others(holds, hold, third):  # type: ignore[no-untyped-def]
    """The two other holds of the triple of a hold and a third point; -1 where the triple is not allowed."""
    ids, slots, first, second, _ = holds
    u, v = first[hold], second[hold]
    if slots[hold] == 0:
        return ids[1, u, third], ids[2, v, third]
    if slots[hold] == 1:
        return ids[0, u, third], ids[2, third, v]
    return ids[0, third, u], ids[1, third, v]


@njit(error_model="numpy")
def widen(triple, known, margins, rows, near, floor, result):  # type: ignore[no-untyped-def]
    """Widest least margins (3, O) of ways to the holds of a triple, within it; -1 up to ``floor``."""
    count = known.shape[1]
    best, top = np.full(count, _NONE), np.full(count, _NONE)
    for h in triple:
        for o in range(count):
            m = margins[rows[h], o]
            if m > top[o]:
                top[o] = m
            if known[h, o] > max(best[o], floor):
                best[o] = known[h, o]
    changed = True
    while changed:
        changed = False
        for o in range(count):
            if best[o] < top[o]:
                value = best[o]
                for k in near[o]:
                    value = max(value, best[k])
                value = min(value, top[o])
                if value > best[o]:
                    best[o] = value
                    changed = True
    for o in range(count):
        reach = _NONE
        for k in near[o]:
            reach = max(reach, best[k])
        for q in range(3):
            h = triple[q]
            value = min(margins[rows[h], o], max(reach, known[h, o]))
            result[q, o] = value if value > floor else _NONE


@njit(error_model="numpy")
def cheapen(triple, known, move, worth, rows, near, turning, step, bound, result):  # type: ignore[no-untyped-def]
    """Least costs (3, O) of ways to the holds of a triple that go on within it, after a ``move``.

    worth (rows, O): the cost of a hold itself, inf where it is not allowed. turning (O, k): of a turn from
    ``near``. step: of every exchange or turn. bound (O,): no cost above it is of use.
    """
    count = known.shape[1]
    best = np.full(count, inf)
    for q in range(3):
        for o in range(count):
            value = known[triple[q], o] + move
            result[q, o] = value if value <= bound[o] else inf
            best[o] = min(best[o], result[q, o])
    changed = True
    while changed:
        changed = False
        for o in range(count):
            reach = inf
            for k in range(near.shape[1]):
                reach = min(reach, best[near[o, k]] + turning[o, k])
            reach += step
            if reach < bound[o]:
                for q in range(3):
                    value = reach + worth[rows[triple[q]], o]
                    if value < result[q, o] and value <= bound[o]:
                        result[q, o] = value
                        best[o] = min(best[o], value)
                        changed = True


@njit(error_model="numpy")
def _triple(holds, fresh, hold, third):  # type: ignore[no-untyped-def]
    """The triple of a fresh hold and a third point; none where another fresh hold stands for it."""
    a, b = others(holds, hold, third)
    mine = a >= 0 and b >= 0 and not (fresh[a] and a < hold) and not (fresh[b] and b < hold)
    return mine, (hold, a, b)


@njit(error_model="numpy", parallel=True, cache=True)
def widest_after_move(  # type: ignore[no-untyped-def]
    frontier, fresh, known, margins, holds, near, floor, threads
):
    """Widens ``known`` by one move from the ``fresh`` holds, the ``frontier``; returns which became wider."""
    points, count = holds[0].shape[1], known.shape[1]
    tables = np.empty((threads, *known.shape), dtype=known.dtype)
    touched = np.zeros((threads, known.shape[0]), dtype=np.bool_)
    for thread in prange(threads):
        reached = np.empty((3, count))
        for n in range(thread, frontier.size, threads):
            for third in range(points):
                mine, triple = _triple(holds, fresh, frontier[n], third)
                if mine:
                    widen(triple, known, margins, holds[4], near, floor, reached)
                    for q in range(3):
                        h = triple[q]
                        if not touched[thread, h]:
                            touched[thread, h] = True
                            tables[thread, h] = known[h]
                        for o in range(count):
                            tables[thread, h, o] = max(tables[thread, h, o], reached[q, o])
    wider = np.zeros(known.shape[0], dtype=np.bool_)
    for h in prange(known.shape[0]):
        for thread in range(threads):
            for o in range(count if touched[thread, h] else 0):
                if tables[thread, h, o] > known[h, o]:
                    known[h, o] = tables[thread, h, o]
                    wider[h] = True
    return wider


@njit(error_model="numpy", parallel=True, cache=True)
def cheapest_after_move(  # type: ignore[no-untyped-def]
    frontier, fresh, known, move, worth, holds, near, turning, step, bound, threads
):
    """``known`` after one move from the ``fresh`` holds, the ``frontier``, and which became cheaper."""
    points, count = holds[0].shape[1], known.shape[1]
    tables = np.empty((threads, *known.shape))
    touched = np.zeros((threads, known.shape[0]), dtype=np.bool_)
    for thread in prange(threads):
        reached = np.empty((3, count))
        for n in range(thread, frontier.size, threads):
            for third in range(points):
                mine, triple = _triple(holds, fresh, frontier[n], third)
                if mine:
                    cheapen(triple, known, move, worth, holds[4], near, turning, step, bound, reached)
                    for q in range(3):
                        h = triple[q]
                        if not touched[thread, h]:
                            touched[thread, h] = True
                            tables[thread, h] = known[h]
                        for o in range(count):
                            tables[thread, h, o] = min(tables[thread, h, o], reached[q, o])
    result, cheaper = known.copy(), np.zeros(known.shape[0], dtype=np.bool_)
    for h in prange(known.shape[0]):
        for thread in range(threads):
            for o in range(count if touched[thread, h] else 0):
                if tables[thread, h, o] < result[h, o]:
                    result[h, o] = tables[thread, h, o]
                    cheaper[h] = True
    return result, cheaper


def threads() -> int:
    """How many threads share a frontier, each with a table of its own."""
    return int(get_num_threads())
