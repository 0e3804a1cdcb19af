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

from regrasp.closed_form.compiled.sharing import shared
from regrasp.compilation import kept
from regrasp.threads import threads

_NONE = -1.0


@kept("widest margins within a stance", error_model="numpy")
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


@kept("least costs within a stance", error_model="numpy")
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


PLAIN_OTHERS: dict[int, Any] = {}
"""``others_of`` by the length of ``holds``, as ``stances`` enters them."""


def others_of(holds, hold, point):  # type: ignore[no-untyped-def]
    """The other holds of a stance. Numba takes the function for this kind of ``holds``.

    Were it an argument or in a closure, the loops would be compiled anew in every process. This is what runs
    where nothing is compiled.
    """
    return PLAIN_OTHERS[len(holds)](holds, hold, point)


@kept("stances of holds", error_model="numpy")
def is_mine(fresh, hold, rest):  # type: ignore[no-untyped-def]
    """Whether a stance is allowed, and no other fresh hold stands for it."""
    for other in rest:  # noqa: SIM110 - Numba unrolls a loop over a tuple, and no generator
        if other < 0 or (fresh[other] and other < hold):
            return False
    return True


@kept("stances of wanted holds", error_model="numpy")
def is_any(wanted, stance):  # type: ignore[no-untyped-def]
    """Whether a hold of the stance is wanted."""
    for hold in stance:  # noqa: SIM110 - as above
        if wanted[hold]:
            return True
    return False


@shared("finger moves of widest margins", error_model="numpy")
def _widened(  # type: ignore[no-untyped-def]
    begin, end, frontier, fresh, wanted, known, margins, rows, holds, points, near, floor, tables, touched
):
    """What moves of a thread's part of the frontier widen, in its own table."""
    count = known.shape[1]
    reached, threads = np.empty((4, count)), len(tables)
    for thread in range(begin, end):
        for n in range(thread, frontier.size, threads):
            for point in range(points):
                rest = others_of(holds, frontier[n], point)  # type: ignore[no-untyped-call]
                stance = (frontier[n], *rest)
                if is_mine(fresh, frontier[n], rest) and is_any(wanted, stance):
                    widen(stance, known, margins, rows, near, floor, reached)
                    for q in range(len(stance)):
                        h = stance[q]
                        for o in range(count):
                            before = tables[thread, h, o] if touched[thread, h] else known[h, o]
                            tables[thread, h, o] = max(before, reached[q, o])
                        touched[thread, h] = True


def widest(
    frontier: np.ndarray,
    fresh: np.ndarray,
    wanted: np.ndarray,
    known: np.ndarray,
    margins: np.ndarray,
    rows: np.ndarray,
    holds: Any,
    points: int,
    near: np.ndarray,
    floor: float,
) -> np.ndarray:
    """Widen ``known`` by one move from the frontier to stances of wanted holds; which holds are wider."""
    tables, touched = _tables(known)
    _widened(
        len(tables), frontier, fresh, wanted, known, margins, rows, holds, points, near, floor, tables,
        touched,
    )  # fmt: skip
    wider = np.zeros(len(known), dtype=np.bool_)
    for table, mine in zip(tables, touched, strict=True):
        wider[mine] |= (table[mine] > known[mine]).any(axis=1)
        known[mine] = np.maximum(known[mine], table[mine])
    return wider


@shared("finger moves of least costs", error_model="numpy")
def _cheapened(  # type: ignore[no-untyped-def]
    begin, end, frontier, fresh, known, move, worth, rows, holds, points, near, turning, step, bound,
    tables, touched,
):  # fmt: skip
    """What moves of a thread's part of the frontier make cheaper, in its own table."""
    count = known.shape[1]
    reached, threads = np.empty((4, count)), len(tables)
    for thread in range(begin, end):
        for n in range(thread, frontier.size, threads):
            for point in range(points):
                rest = others_of(holds, frontier[n], point)  # type: ignore[no-untyped-call]
                if is_mine(fresh, frontier[n], rest):
                    stance = (frontier[n], *rest)
                    cheapen(stance, known, move, worth, rows, near, turning, step, bound, reached)
                    for q in range(len(stance)):
                        h = stance[q]
                        for o in range(count):
                            before = tables[thread, h, o] if touched[thread, h] else known[h, o]
                            tables[thread, h, o] = min(before, reached[q, o])
                        touched[thread, h] = True


def cheapest(
    frontier: np.ndarray, fresh: np.ndarray, known: np.ndarray, *arguments: Any
) -> tuple[np.ndarray, np.ndarray]:
    """``known`` after one move from the frontier, and which holds became cheaper.

    arguments: move, worth, rows, holds, points, near, turning, step, bound, as ``cheapen`` takes them.
    """
    tables, touched = _tables(known)
    _cheapened(len(tables), frontier, fresh, known, *arguments, tables, touched)
    result, cheaper = known.copy(), np.zeros(len(known), dtype=np.bool_)
    for table, mine in zip(tables, touched, strict=True):
        cheaper[mine] |= (table[mine] < result[mine]).any(axis=1)
        result[mine] = np.minimum(result[mine], table[mine])
    return result, cheaper


def _tables(known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each thread a table like ``known``, and which of its rows are written."""
    count = threads()
    return np.empty((count, *known.shape), known.dtype), np.zeros((count, len(known)), dtype=np.bool_)
