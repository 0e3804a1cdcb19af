"""Holds by the million: margins of every pair of points under every load direction.

Pairs are shared out to the threads, a block at a time; ``pairs`` does all loads of a pair together.
"""

from typing import Any

import numpy as np

from regrasp.closed_form.compiled import pairs
from regrasp.closed_form.compiled.compiling import digest
from regrasp.closed_form.compiled.pairs import held_loads, workspace_for
from regrasp.closed_form.compiled.sharing import shared
from regrasp.closed_form.turning_margin import NO_HOLD as NO_HOLD

_BLOCK = 16  # pairs whose margins share a cache line
STRETCH = 4096
"""Pairs that a thread takes at a time where only the widest margin of each is kept."""


def _loops(sources: str) -> tuple[Any, Any]:
    @shared("the holds of two fingers", error_model="numpy")
    def margins(start, stop, first, second, loads, candidates, result):  # type: ignore[no-untyped-def]
        """Writes the margin of each pair under each load to ``result`` (loads, pairs)."""
        _ = sources
        turned = loads.T.copy()
        for block in range(start, stop):
            begin, end = block * _BLOCK, min((block + 1) * _BLOCK, first.size)
            for o in range(len(loads)):
                for p in range(begin, end):
                    result[o, p] = NO_HOLD
            pair, load, margin = workspace_for(_BLOCK, len(loads))
            for k in range(held_loads(candidates, first, second, begin, end, turned, pair, load, margin)):
                result[load[k], pair[k]] = margin[k]

    @shared("the widest holds of two fingers", error_model="numpy")
    def widest(  # type: ignore[no-untyped-def]
        start, stop, first, second, loads, candidates, allowed, place, best, where, counts
    ):
        _ = sources
        turned = loads.T.copy()
        each = 1 if len(allowed) > 1 else 0
        for stretch in range(start, stop):
            pair, load, margin = workspace_for(_BLOCK, len(loads))
            for begin in range(stretch * STRETCH, min((stretch + 1) * STRETCH, first.size), _BLOCK):
                end = min(begin + _BLOCK, first.size)
                for k in range(held_loads(candidates, first, second, begin, end, turned, pair, load, margin)):
                    p, o, m = pair[k], load[k], np.float32(margin[k])
                    if m >= 0.0 and allowed[each * o, p]:
                        counts[stretch, o] += 1
                        if m > best[p]:
                            best[p], where[p] = m, place + o

    return margins, widest


_margins, _widest = _loops(digest((*pairs.FORMULAS, pairs)))


def hold_margins(
    first: np.ndarray, second: np.ndarray, loads: np.ndarray, candidates: tuple[Any, ...], result: np.ndarray
) -> None:
    """Writes the margin of each pair under each load to ``result`` (loads, pairs)."""
    _margins(-(-first.size // _BLOCK), first, second, loads, candidates, result)


def widest_margins(
    first: np.ndarray,
    second: np.ndarray,
    loads: np.ndarray,
    candidates: tuple[Any, ...],
    allowed: np.ndarray,
    place: int,
    best: np.ndarray,
    where: np.ndarray,
    counts: np.ndarray,
) -> None:
    """Widens the best margins of allowed pairs by these loads, the first of them number ``place``.

    allowed: (pairs,) under all loads, or (loads, pairs). A pair is prepared once for all loads of a call, so
    many loads at a time are faster. counts (stretches, loads): how many pairs of a stretch hold, to be summed
    over the stretches.
    """
    _widest(len(counts), first, second, loads, candidates, np.atleast_2d(allowed), place, best, where, counts)


def pairs_of(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Every pair i < j of ``count`` points, (count (count - 1) / 2,) each, by i and then by j."""
    first, second = np.triu_indices(count, 1)
    return first.astype(np.int32), second.astype(np.int32)
