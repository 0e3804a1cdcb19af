"""Clip paths of SVG as far as they hide something whole or nothing."""

from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import Piece
from regrasp.outline.flatten import flattened

_NEAR = 1e-3  # of a size
_MOST = 200


def region_of(pieces: list[Piece]) -> Any:
    """The union of the insides of pieces (shapely), a little larger than it is; None for too many."""
    import shapely

    if len(pieces) > _MOST:
        return None
    rings = [_points(piece) for piece in pieces]
    whole = shapely.union_all([shapely.Polygon(ring).buffer(0) for ring in rings if len(ring) > 2])
    size = max((float(np.ptp(ring, axis=0).max()) for ring in rings), default=0.0)
    region = whole.buffer(_NEAR * size)
    shapely.prepare(region)
    return region


def share_within(piece: Piece, region: Any) -> float:
    """1 where a piece is within a region, 0 where it is outside, between where it is cut."""
    import shapely

    line = shapely.LineString(_points(piece))
    if region.covers(line):
        return 1.0
    return 0.5 if region.intersects(line) else 0.0


def _points(piece: Piece) -> Array:
    rough = np.concatenate([curve.rough() for curve in piece.curves])
    tolerance = _NEAR * max(float(np.ptp(rough, axis=0).max()), 1e-60)
    return np.concatenate([flattened(curve, tolerance) for curve in piece.curves])
