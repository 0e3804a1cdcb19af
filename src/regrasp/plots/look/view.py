"""The direction to look at wrench space from."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from regrasp.mechanics.checks import Array

# Between the corners of the box, where no axis points at the reader and its numbers have room.
_ELEVATIONS = (15.0, 25.0, 35.0, 45.0)
_AZIMUTHS = tuple(
    quadrant + turn for quadrant in (0.0, 90.0, 180.0, 270.0) for turn in (25.0, 35.0, 45.0, 55.0, 65.0)
)


def best_view(shapes: Sequence[Array]) -> tuple[float, float]:
    """(elevation, azimuth) [deg] from which shapes in wrench space lie open, none of them edge-on.

    shapes: corners (k, 3) of closed polygons, three or more of each. The view maximises the geometric mean of
    the roundness of all triangles of successive corners, so that no two successive sides fall together.
    """
    points = np.vstack(shapes)
    spans = np.ptp(points, axis=0)
    spans[spans == 0] = 1.0
    triangles = np.concatenate(
        [np.stack([np.roll(s, k, axis=0) for k in (1, 0, -1)], axis=1) for s in shapes]
    )

    def openness(view: tuple[float, float]) -> float:
        return float(np.log(_roundness((triangles / spans) @ projection(*view).T) + 1e-3).mean())

    return max(product(_ELEVATIONS, _AZIMUTHS), key=openness)


def sight(elevation: float, azimuth: float) -> Array:
    """(3,) the unit vector from the picture to the reader, of angles [deg]."""
    e, a = np.radians(elevation), np.radians(azimuth)
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def projection(elevation: float, azimuth: float) -> Array:
    """(2, 3) from space to the picture, right and up."""
    e, a = np.radians(elevation), np.radians(azimuth)
    return np.array(
        [
            [-np.sin(a), np.cos(a), 0.0],
            [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)],
        ]
    )


def _roundness(triangles: Array) -> Array:
    """(m,) area over perimeter squared of triangles (m, 3, 2); 0 for a triangle without sides."""
    sides = np.roll(triangles, -1, axis=1) - triangles
    area = abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
    perimeter = np.linalg.norm(sides, axis=2).sum(axis=1)
    result: Array = area / np.where(perimeter > 0, perimeter, 1.0) ** 2
    return result


def facing_view(positions: Array, normals: Array) -> tuple[float, float]:
    """(elevation, azimuth) [deg] from which contacts in space lie apart, most of them on the near side.

    positions, normals: (n, 3); normals point into the object, away from the reader at a contact that is seen.
    """
    return shared_view([(positions, normals)])


def shared_view(grasps: Sequence[tuple[Array, Array]]) -> tuple[float, float]:
    """``facing_view`` of several grasps, (positions, normals) of each, that are seen from one direction."""
    size = max(float(np.ptp(positions, axis=0).max()) for positions, _ in grasps) or 1.0

    def clearness(view: tuple[float, float]) -> float:
        return sum(_clearness(positions / size, normals, view) for positions, normals in grasps)

    return max(product(_ELEVATIONS, _AZIMUTHS), key=clearness)


def _clearness(positions: Array, normals: Array, view: tuple[float, float]) -> float:
    """How far apart contacts look, and how many of them look at the reader."""
    pairs = np.array([(i, j) for i in range(len(positions)) for j in range(i)], dtype=np.intp).reshape(-1, 2)
    shown = positions @ projection(*view).T
    apart = np.linalg.norm(shown[pairs[:, 0]] - shown[pairs[:, 1]], axis=1)
    return float(np.log(apart + 1e-2).sum() / max(1, len(pairs)) - 0.5 * (normals @ sight(*view)).mean())
