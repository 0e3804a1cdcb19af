"""Clip paths of SVG: what they hide whole, leave whole, or cut off the inside of a filled shape."""

from typing import Any, NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import Piece
from regrasp.outline.flatten import flattened, polyline

_NEAR = 1e-3  # of a size: lines this near to the edge of a clip are not cut by it
_FINE = 1e-5  # of a size: chords of what is cut
_SAME = 1e-9  # of an area
_MOST = 200


class Clip(NamedTuple):
    """What a clip path shows.

    wide: the union of the insides of its shapes (shapely), a little larger than it is. exact: the same as it
    is; None where shapes of it overlap, so that fill rules decide.
    """

    wide: Any
    exact: Any


def clip_of(pieces: list[Piece]) -> Clip | None:
    """The clip of the shapes of a clip path; None for too many."""
    import shapely

    if len(pieces) > _MOST:
        return None
    rings = [shapely.Polygon(ring) for ring in (_points(piece, _FINE) for piece in pieces) if len(ring) > 2]
    whole = shapely.union_all([ring.buffer(0) for ring in rings])
    size = max(
        (max(ring.bounds[2] - ring.bounds[0], ring.bounds[3] - ring.bounds[1]) for ring in rings), default=0
    )
    wide = whole.buffer(_NEAR * size)
    shapely.prepare(wide)
    apart = all(ring.is_valid for ring in rings)
    apart &= abs(sum(ring.area for ring in rings) - whole.area) <= _SAME * whole.area
    return Clip(wide, whole if apart else None)


def share_within(piece: Piece, clip: Clip) -> float:
    """1 where a piece is within a clip, 0 where it is outside, between where it is cut."""
    import shapely

    line = shapely.LineString(_points(piece, _NEAR))
    if clip.wide.covers(line):
        return 1.0
    return 0.5 if clip.wide.intersects(line) else 0.0


def cut(piece: Piece, clips: list[Clip]) -> list[Piece] | None:
    """What clips leave of a filled piece, as polygons; None where that is not sure."""
    import shapely

    points = _points(piece, _FINE)
    if not piece.filled or len(points) < 3 or any(clip.exact is None for clip in clips):
        return None
    left: Any = shapely.Polygon(points)
    if not left.is_valid:
        return None
    for clip in clips:
        left = left.intersection(clip.exact)
    polygons = [
        part for part in getattr(left, "geoms", [left]) if part.geom_type == "Polygon" and part.area > 0
    ]
    rings = [ring for part in polygons for ring in (part.exterior, *part.interiors)]
    return [Piece((polyline(np.array(ring.coords)),), closed=True, filled=True) for ring in rings]


def _points(piece: Piece, near: float) -> Array:
    rough = np.concatenate([curve.rough() for curve in piece.curves])
    tolerance = near * max(float(np.ptp(rough, axis=0).max()), 1e-60)
    return np.concatenate([flattened(curve, tolerance) for curve in piece.curves])
