"""Which of the closed curves of a drawing is the outline and which are holes; or why they are no object."""

from collections import Counter
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.outline.region import meeting

_SAME = 1e-6  # of an area, or of the drawing's size


def check_nested(rings: list[Array], regions: list[Any]) -> None:
    """Raise ``InvalidInput`` where rings, the largest first, are several objects or drawn twice.

    regions: shapely's polygons of them. What meets in other ways is left to ``check_holes``.
    """
    import shapely

    if len(regions) < 2:
        return
    outer, *inner = regions
    shapely.prepare(outer)
    for i, region in enumerate(inner, start=1):
        if not outer.intersects(region):
            x, y = rings[i][0]
            raise InvalidInput(
                f"there are several outlines: one at ({x:.6g}, {y:.6g}) is outside the largest; "
                "keep one object in a file"
            )
    for j, region in enumerate(inner, start=1):
        if outer.area - region.area > _SAME * outer.area:
            break
        _check_apart(rings, regions, 0, j)
    for i, j in meeting(inner):
        _check_apart(rings, regions, i + 1, j + 1)


def _check_apart(rings: list[Array], regions: list[Any], i: int, j: int) -> None:
    """Raise ``InvalidInput`` for rings i < j that are the same, or one in the other in the outline."""
    large, small = regions[i], regions[j]
    x, y = rings[j][0]
    if large.area - small.area <= _SAME * large.area and (
        large.symmetric_difference(small).area <= _SAME * large.area
    ):
        raise InvalidInput(f"a closed curve is drawn twice, at ({x:.6g}, {y:.6g}); keep one of the two")
    if i and large.contains(small):
        raise InvalidInput(
            f"there is a closed curve at ({x:.6g}, {y:.6g}) inside a hole: what is inside a hole is "
            "another object; if the outermost curve is the frame of a sheet, leave it out of the file"
        )


def check_once(pieces: list[Array], size: float) -> None:
    """Raise ``InvalidInput`` where of pieces (k, 2) some lie on one another."""
    keys = []
    for points in pieces:
        ends = sorted(tuple(np.round(end / (_SAME * size)) + 0.0) for end in (points[0], points[-1]))
        middle = np.round(points.mean(axis=0) / (_SAME * size)) + 0.0
        keys.append((*ends, tuple(middle)))
    twice = [key for key, count in Counter(keys).items() if count > 1]
    if twice:
        (x, y), (u, v) = (tuple(_SAME * size * number for number in end) for end in twice[0][:2])
        raise InvalidInput(
            f"{len(twice)} lines or curves are drawn twice, one from ({x:.6g}, {y:.6g}) "
            f"to ({u:.6g}, {v:.6g}); keep one of each"
        )
