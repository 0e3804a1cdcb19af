"""One more finger move: which holds it leads to, over all stances of the fingers, compiled by Numba.

A *stance* is where all fingers are: three at points in the plane, four in space. All but one of them
hold, the other is free. Within a stance every hold can be exchanged for every other and the object may turn,
by less than a largest turn at a time, without any finger moving. A move takes the free finger to another
point, and so to another stance that shares the hold.

A table (holds, orientations) says what is known of each hold at each orientation: the widest least margin of
a way there (-1: none), or its least cost (inf: none). ``near`` (orientations, k): from where the object may
turn there in one step, itself included. What numbers holds have is a matter of ``others``, a function of the
opaque ``holds``, a hold and a point: the other holds of the stance of both, -1 where that is not allowed.
"""

from math import inf
from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange

from regrasp.closed_form.compiled.sharing import shared

_NONE = -1.0


@njit(error_model="numpy")
def widen(stance, known, margins, rows, near, floor, result):  # type: ignore[no-untyped-def]
    """Widest least margins (n, O) of ways to the n holds of a stance, within it; -1 up to ``floor``."""
    count = known.shape[1]
    best, top = np.full(count, _NONE), np.full(count, _NONE)
    for h in stance:
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
        for q in range(len(stance)):
            h = stance[q]
            value = min(margins[rows[h], o], max(reach, known[h, o]))
            result[q, o] = value if value > floor else _NONE


@njit(error_model="numpy")
def cheapen(stance, known, move, worth, rows, near, turning, step, bound, result):  # type: ignore[no-untyped-def]
    """Least costs (n, O) of ways to the n holds of a stance that go on within it, after a ``move``.

    worth (rows, O): the cost of a hold itself, inf where it is not allowed. turning (O, k): of a turn from
    ``near``. step: of every exchange or turn. bound (O,): no cost above it is of use.
    """
    count = known.shape[1]
    best = np.full(count, inf)
    for q in range(len(stance)):
        for o in range(count):
            value = known[stance[q], o] + move
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
                for q in range(len(stance)):
                    value = reach + worth[rows[stance[q]], o]
                    if value < result[q, o] and value <= bound[o]:
                        result[q, o] = value
                        best[o] = min(best[o], value)
                        changed = True


class Moves(NamedTuple):
    """One finger move over all stances of fresh holds; every thread has a table of its own.

    others: (holds, hold, point) -> the other holds of the stance of both; -1 where not allowed.
    widest: widens ``known`` by one move from the ``fresh`` holds, the ``frontier``; returns which are wider.
    cheapest: ``known`` after one move, and which became cheaper. rows: (H,) the row of margins of each hold.
    """

    others: Any
    widest: Any
    cheapest: Any


def others_of(holds, hold, point):  # type: ignore[no-untyped-def]
    """The other holds of a stance. Numba takes the function for this kind of ``holds``.

    Were it an argument or in a closure, the loops would be compiled anew in every process.
    """
    raise NotImplementedError("compiled code only: see stances")


@njit(error_model="numpy")
def is_mine(fresh, hold, rest):  # type: ignore[no-untyped-def]
    """Whether a stance is allowed, and no other fresh hold stands for it."""
    for other in rest:  # noqa: SIM110 - Numba unrolls a loop over a tuple, and no generator
        if other < 0 or (fresh[other] and other < hold):
            return False
    return True


@shared(error_model="numpy")
def widest(  # type: ignore[no-untyped-def]
    frontier, fresh, known, margins, rows, holds, points, near, floor, threads
):
    """Widen ``known`` by one move from the frontier; which holds are wider."""
    count = known.shape[1]
    tables = np.empty((threads, *known.shape), dtype=known.dtype)
    touched = np.zeros((threads, known.shape[0]), dtype=np.bool_)
    for thread in prange(threads):
        reached = np.empty((4, count))
        for n in range(thread, frontier.size, threads):
            for point in range(points):
                rest = others_of(holds, frontier[n], point)  # type: ignore[no-untyped-call]
                if is_mine(fresh, frontier[n], rest):
                    stance = (frontier[n], *rest)
                    widen(stance, known, margins, rows, near, floor, reached)
                    for q in range(len(stance)):
                        h = stance[q]
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


@shared(error_model="numpy")
def cheapest(  # type: ignore[no-untyped-def]
    frontier, fresh, known, move, worth, rows, holds, points, near, turning, step, bound, threads
):
    """``known`` after one move from the frontier, and which holds became cheaper."""
    count = known.shape[1]
    tables = np.empty((threads, *known.shape))
    touched = np.zeros((threads, known.shape[0]), dtype=np.bool_)
    for thread in prange(threads):
        reached = np.empty((4, count))
        for n in range(thread, frontier.size, threads):
            for point in range(points):
                rest = others_of(holds, frontier[n], point)  # type: ignore[no-untyped-call]
                if is_mine(fresh, frontier[n], rest):
                    stance = (frontier[n], *rest)
                    cheapen(stance, known, move, worth, rows, near, turning, step, bound, reached)
                    for q in range(len(stance)):
                        h = stance[q]
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
