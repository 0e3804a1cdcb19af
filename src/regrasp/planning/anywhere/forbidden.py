"""Arcs of an outline where no finger may touch: sides are parted where they begin and end."""

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, numbers_in

_NEAR = 1e-12  # of the length: ends of arcs this near to a vertex are there


def parted_outline(vertices: Array, forbidden: ArrayLike) -> tuple[Array, NDArray[np.bool_]]:
    """Vertices with those where arcs begin and end among them, and on which sides fingers may touch.

    forbidden: (k, 2) arc lengths, from the first counter-clockwise to the second. Raises ``InvalidInput``.
    """
    rows = numbers_in(forbidden, "forbidden must be arcs (lo, hi) in arc length")
    if not rows.size:
        return vertices, np.ones(len(vertices), dtype=np.bool_)
    arcs = array(rows, "forbidden", (None, 2))
    lengths = np.hypot(*(np.roll(vertices, -1, axis=0) - vertices).T)
    begins, whole = np.cumsum(lengths) - lengths, float(lengths.sum())
    widths = arcs[:, 1] - arcs[:, 0]
    if (widths <= 0).any() or (widths >= whole).any():
        raise InvalidInput(
            f"forbidden must be arcs (lo, hi) with lo below hi by less than the length {whole:g}, got "
            f"{shown(arcs.tolist())}"
        )
    points, places = [], []
    ends = np.unique(arcs % whole)
    for k, (begin, length) in enumerate(zip(begins.tolist(), lengths.tolist(), strict=True)):
        inside = [s for s in ends.tolist() if _NEAR * whole < s - begin < length - _NEAR * whole]
        along = (np.roll(vertices, -1, axis=0)[k] - vertices[k]) / length
        points += [vertices[k], *(vertices[k] + (s - begin) * along for s in inside)]
        places += [begin, *inside]
    middles = 0.5 * (np.array(places) + np.array([*places[1:], whole]))
    taken = (((middles[:, None] - arcs[:, 0]) % whole) < widths).any(axis=1)
    return np.array(points), ~taken
