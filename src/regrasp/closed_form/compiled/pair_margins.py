"""``pair_margin`` compiled by Numba for many pairs, each at an angle of its own. Imported when needed."""

from typing import Any

import numpy as np

from regrasp.closed_form.compiled import two_fingers
from regrasp.closed_form.compiled.compiling import compiled, digest
from regrasp.closed_form.compiled.sharing import shared
from regrasp.closed_form.pairs import pair_margin

_BLOCK = 1024
_MODULES = (*two_fingers.MODULES, pair_margin)
_pair_margin = compiled(_MODULES, inline=False)["pair_margin"]


def _loop(sources: str) -> Any:
    @shared("the margins of many pairs of contacts", error_model="numpy")
    def margins(begin, end, first, second, loads, fingers, ratio, least, alone, result):  # type: ignore[no-untyped-def]
        _ = sources
        for k in range(begin * _BLOCK, min(end * _BLOCK, result.size)):
            i, j = first[k], second[k]
            one = (fingers[i, 0], fingers[i, 1], fingers[i, 2], fingers[i, 3], fingers[i, 4], fingers[i, 5])
            two = (fingers[j, 0], fingers[j, 1], fingers[j, 2], fingers[j, 3], fingers[j, 4], fingers[j, 5])
            result[k] = _pair_margin(one, two, loads[k, 0], loads[k, 1], ratio, least, alone)

    return margins


_margins = _loop(digest(_MODULES))


def pair_margins(
    first: np.ndarray,
    second: np.ndarray,
    loads: np.ndarray,
    fingers: np.ndarray,
    ratio: float,
    least: float,
    alone: bool,
) -> np.ndarray:
    """(m,) margins [rad] of pairs of V contacts, fingers (V, 6), by places (m,), under loads (m, 2)."""
    result = np.empty(first.size)
    first, second = np.array(first), np.array(second)  # Numba compiles anew for arrays of other strides
    _margins(-(-first.size // _BLOCK), first, second, loads, fingers, ratio, least, alone, result)
    return result
