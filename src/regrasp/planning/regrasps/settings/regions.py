"""Regions of a mesh, and which finger may touch which contact."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, function

Regions = Sequence[ArrayLike | Callable[[Array], NDArray[np.bool_]] | None]
"""For each finger the corners (2, 3) of a box, least and largest [m]; a function of points (k, 3) that
returns (k,) booleans; or None for the whole mesh. All relative to the centre of mass."""

# Points this near to the faces of a box, as a fraction of the size of all, are in it.
_IN = 1e-9


def on_regions(regions: Any, points: Array) -> NDArray[np.bool_]:
    """(4, V) whether each finger may touch points (V, 3). Raises ``InvalidInput`` for anything else."""
    if isinstance(regions, (str, bytes)) or not isinstance(regions, Sequence) or len(regions) != 4:
        raise InvalidInput(
            f"arcs must have an entry for each of four fingers on a mesh, got {shown(regions)}"
        )
    return np.array([_within(region, f, points) for f, region in enumerate(regions, 1)])


def _within(region: Any, finger: int, points: Array) -> NDArray[np.bool_]:
    what = f"arcs: finger {finger}"
    if region is None:
        return np.ones(len(points), dtype=np.bool_)
    if callable(region):
        function(region, what, "a function of points", 1)
        found = region(points)
        if np.shape(found) != (len(points),):
            raise InvalidInput(
                f"{what} must return which of {len(points)} points are in the region, shape "
                f"({len(points)},); it returned shape {np.shape(found)}"
            )
        return np.asarray(found, dtype=np.bool_)
    least, most = array(region, what, (2, 3))
    slack = _IN * float(abs(points).max())
    within: NDArray[np.bool_] = ((points >= least - slack) & (points <= most + slack)).all(axis=1)
    return within
