"""Checks of rings: simple, with area, holes strictly inside. By shapely."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, array, read_only
from regrasp.mechanics.value import numbers

# Neighbours nearer than this, as a fraction of the ring's size, are one vertex: a ring closed up to rounding.
_SAME = 1e-9
_AT_ONCE = 100
LARGEST = 1e60
"""Sizes up to this, and down to one over it, have areas and moments that are numbers."""


def checked_ring(points: ArrayLike, what: str) -> Array:
    """(k, 2) the points counter-clockwise from the first, without repeats and a last one that closes."""
    given = _finite(points, what)
    size = checked_size(given, what) if len(given) else 0.0
    apart = np.hypot(*(np.roll(given, -1, axis=0) - given).T) > _SAME * size
    ring = given[apart]
    if len(ring) < 3:
        raise InvalidInput(f"{what} needs three different points or more, got {len(ring)}")
    if signed_area(ring) < 0:
        ring = np.roll(ring[::-1], 1, axis=0)
    return read_only(ring.copy())


def _finite(points: ArrayLike, what: str) -> Array:
    """(k, 2) finite numbers; what is not is named by its vertex."""
    try:
        given: Array = np.array(points, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return array(points, what, (None, 2))
    if given.ndim != 2 or given.shape[1] != 2:
        shape = ", ".join(map(str, given.shape))
        raise InvalidInput(f"{what} must have shape (any, 2), got ({shape}{',' * (given.ndim == 1)})")
    bad = np.flatnonzero(~np.isfinite(given).all(axis=1))
    if bad.size:
        raise InvalidInput(f"{what} must be finite, vertex {bad[0]} is {numbers(given[bad[0]])}")
    return given


def checked_size(points: Array, what: str) -> float:
    """The larger side of points (k, d). ``InvalidInput`` where areas or moments would not be numbers."""
    size = float(np.ptp(points, axis=0).max())
    if size and not 1 / LARGEST <= size <= LARGEST:
        raise InvalidInput(
            f"{what} must be between {1 / LARGEST:g} and {LARGEST:g} in size, got {size:g}; change the unit"
        )
    return size


def signed_area(ring: Array) -> float:
    """Positive for a counter-clockwise ring [m^2]."""
    x, y = (ring - ring[0]).T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def check_spread(ring: Array, what: str) -> None:
    """Raise ``InvalidInput`` where the points of a ring (k, 2) lie on one line."""
    unit = (ring - ring[0]) / float(np.ptp(ring, axis=0).max())
    if np.linalg.svd(unit - unit.mean(axis=0), compute_uv=False)[1] <= _SAME:
        raise InvalidInput(f"{what} encloses no area: its points lie on one line")


def checked_region(ring: Array, what: str) -> Any:
    """The shapely polygon of a ring (k, 2). ``InvalidInput`` where it has no area or meets itself."""
    import shapely

    check_spread(ring, what)
    size = float(np.ptp(ring, axis=0).max())
    origin = ring[0]
    unit = (ring - origin) / size
    region = shapely.Polygon(unit)
    if not region.is_valid:
        reason = shapely.is_valid_reason(region)
        place = re.search(r"\[(\S+) (\S+)\]", reason)
        where = ""
        if place:
            x, y = origin + size * np.array([float(number) for number in place.groups()])
            where = f" near ({x:.6g}, {y:.6g})"
        raise InvalidInput(f"{what} crosses or touches itself{where}; it must be a simple closed curve")
    return shapely.Polygon(ring)


def check_holes(outer: Array, holes: list[Array]) -> None:
    """Raise ``InvalidInput`` unless rings are simple and holes strictly inside, apart from one another."""
    import shapely

    region = checked_region(outer, "outline")
    inside = [checked_region(hole, f"hole {i}") for i, hole in enumerate(holes)]
    if not inside:
        return
    shapely.prepare(region)
    for i, hole in enumerate(inside):
        if not region.contains_properly(hole):
            raise InvalidInput(f"hole {i} must lie inside the outline without touching it")
    for i, j in meeting(inside):
        raise InvalidInput(f"holes {i} and {j} overlap or touch; give their union as one hole")


def meeting(regions: list[Any]) -> Iterator[tuple[int, int]]:
    """Pairs i < j of regions that meet, found a few at a time: of many that lie on one another all would."""
    import shapely

    tree = shapely.STRtree(regions)
    for begin in range(0, len(regions), _AT_ONCE):
        first, second = tree.query(regions[begin : begin + _AT_ONCE], predicate="intersects")
        for i, j in zip(first + begin, second, strict=True):
            if i < j:
                yield int(i), int(j)
