"""Arcs of an outline, and which finger may touch which contact."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array
from regrasp.outline import Outline
from regrasp.outline.boundary import check_arcs

Arcs = Sequence[ArrayLike | None]
"""For each finger an interval (lo, hi) of arc length [m], several of them, or None for the whole outline."""

# Points this near to an end of an arc, as a fraction of the outline's length, are on it.
_ON = 1e-9


def on_arcs(arcs: Arcs, places: Array, length: float) -> NDArray[np.bool_]:
    """(3, V) whether each finger may touch at arc lengths (V,).

    An arc runs counter-clockwise from lo to hi, modulo the length, so that it may pass the first vertex; it
    is the whole outline where hi - lo is its length or more. Raises ``InvalidInput`` for anything else.
    """
    if isinstance(arcs, (str, bytes)) or not isinstance(arcs, Sequence) or len(arcs) != 3:
        raise InvalidInput(f"arcs must have an entry for each of three fingers, got {shown(arcs)}")
    result = np.zeros((3, places.size), dtype=np.bool_)
    for finger, arc in enumerate(arcs):
        for lo, hi in _intervals(arc, finger, length):
            width = hi - lo if hi - lo >= length else (hi - lo) % length
            slack = _ON * length
            result[finger] |= (places - lo + slack) % length <= width + 2 * slack
    return result


def arc_lengths(outline: Outline, positions: Array) -> Array:
    """(V,) arc lengths [m] of points (V, 2) of an outline, relative to the centre of mass."""
    return np.array([outline.nearest(p + outline.centre_of_mass) % outline.length for p in positions])


def stretches(arcs: Arcs, length: float) -> Array | None:
    """(m, 2) the arcs of all fingers; None where one may touch everywhere."""
    on_arcs(arcs, np.zeros(0), length)
    if any(arc is None for arc in arcs):
        return None
    return np.vstack([_intervals(arc, finger, length) for finger, arc in enumerate(arcs)])


def _intervals(arc: ArrayLike | None, finger: int, length: float) -> Array:
    if arc is None:
        return np.array([[0.0, length]])
    what = f"arcs: finger {finger + 1}"
    try:
        flat = np.ndim(arc) == 1
    except ValueError:
        flat = False
    result = array(arc, what, (2,))[None] if flat else array(arc, what, (None, 2))
    if not result.size:
        raise InvalidInput(f"{what} has no arc; give (lo, hi), or None for the whole outline")
    check_arcs(result, length, what)
    return result
