"""The rows of a proof, from the boxes that a search made."""

from collections.abc import Sequence

import numpy as np

from regrasp.mechanics.checks import Array

_AT_ONCE = 1_000_000  # works


def rows_of(
    boxes: Sequence[np.ndarray],
    loads: Array,
    size: float,
    tied: dict[int, int],
    moving: dict[int, tuple[np.ndarray, Array]],
    by_side: dict[int, tuple[np.ndarray, Array]],
) -> dict[str, Array]:
    """The fields of ``PlacementProof`` that say something of boxes, by their names: arrays of their own.

    boxes: as of the compiled search, lengths in units of ``size``. tied: rows of duals of all loads
    that exclude some. moving: twists of some loads that move with the fingers. by_side: of which
    one excludes each side.
    """
    arcs, ends, _, twists, _, kinds, children, _, seconds, other = boxes
    split, twists = kinds == 2, twists / [1, 1, size]
    number = np.where(kinds == 3, -1, strongest(twists, loads))
    twists[split] = 0.0
    given = {"loads": loads.copy(), "arcs": arcs.copy(), "ends": ends.copy(), "twists": twists}
    given["children"] = np.where(split[:, None], children, 0)
    number[list(tied)] = [-2 - row for row in tied.values()]
    given["number"] = np.where(split, 0, number)
    joined = np.flatnonzero((other >= 0) & ~split & (number >= 0))
    if len(joined):
        second = seconds[joined] / [1, 1, size]
        given["pairs"] = np.column_stack([joined, strongest(second, loads)])
        given["seconds"] = second
    for several, names in (moving, ("movers", "motions")), (by_side, ("by_side", "side_twists")):
        if several:
            given["number"][list(several)], given["twists"][list(several)] = 0, 0.0
            each = [(box, n) for box, (some, _) in several.items() for n in some.tolist()]
            given |= zip(
                names, (np.array(each), np.concatenate([t for _, t in several.values()])), strict=True
            )
    return given


def strongest(twists: Array, loads: Array) -> np.ndarray:
    """(n,) numbers of the loads that do the most work along twists, some at a time for little memory."""
    parts = np.array_split(twists, 1 + len(twists) * len(loads) // _AT_ONCE)
    return np.concatenate([(-some @ loads.T).argmax(axis=1) for some in parts])
