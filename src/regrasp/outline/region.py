"""Checks of polygons, by shapely."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, read_only


def checked_polygon(vertices: ArrayLike, what: str) -> Array:
    """(k, 2) vertices, counter-clockwise, without repeated neighbours or a last one that closes the ring."""
    given = array(vertices, what, (None, 2))
    apart = (given != np.roll(given, 1, axis=0)).any(axis=1)
    polygon = given[apart] if given.size else given
    if len(polygon) < 3:
        raise InvalidInput(f"{what} needs three different points or more, got {len(polygon)}")
    x, y = (polygon - polygon[0]).T
    area = float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)
    size = float(np.ptp(polygon, axis=0).max())
    if abs(area) <= 1e-12 * size**2:
        raise InvalidInput(f"{what} encloses no area: its points lie on one line, or it crosses itself")
    if area < 0:
        polygon = polygon[::-1]
    return read_only(polygon.copy())


def refuse_crossing(outer: Array, holes: tuple[Array, ...]) -> None:
    """Raise ``InvalidInput`` where a boundary crosses itself or a hole is not inside."""
    import shapely

    region: Any = shapely.Polygon(outer, holes)
    if not region.is_valid:
        reason = shapely.is_valid_reason(region)
        raise InvalidInput(f"the outline is not the boundary of one region: {reason}")
