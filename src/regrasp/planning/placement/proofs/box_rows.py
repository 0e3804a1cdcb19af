"""The rows of a proof, from the boxes that a search made."""

from collections.abc import Sequence

import numpy as np

from regrasp.mechanics.checks import Array


def rows_of(
    boxes: Sequence[np.ndarray],
    loads: Array,
    size: float,
    tied: dict[int, int],
    moving: dict[int, tuple[np.ndarray, Array]],
) -> dict[str, Array]:
    """The fields of ``PlacementProof`` that say something of boxes, by their names.

    boxes: as of the compiled search, lengths in units of ``size``. tied: rows of duals of all loads
    that exclude some. moving: twists of some loads that move with the fingers.
    """
    arcs, ends, _, twists, _, kinds, children, _, seconds, other = boxes
    work = -(twists / [1, 1, size]) @ loads.T
    number = np.where(kinds == 3, -1, work.argmax(axis=1))
    split = kinds == 2
    given = {"loads": loads, "arcs": arcs, "ends": ends, "children": np.where(split[:, None], children, 0)}
    number[list(tied)] = [-2 - row for row in tied.values()]
    given["number"] = np.where(split, 0, number)
    given["twists"] = np.where(split[:, None], 0.0, twists / [1, 1, size])
    joined = np.flatnonzero((other >= 0) & ~split & (number >= 0))
    if len(joined):
        second = seconds[joined] / [1, 1, size]
        given["pairs"] = np.column_stack([joined, (-second @ loads.T).argmax(axis=1)])
        given["seconds"] = second
    if moving:
        given["number"][list(moving)], given["twists"][list(moving)] = 0, 0.0
        given["movers"] = np.array([(box, n) for box, (some, _) in moving.items() for n in some.tolist()])
        given["motions"] = np.concatenate([twists for _, twists in moving.values()])
    return given
