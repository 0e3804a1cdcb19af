"""Vertices and faces as arrays: checked, duplicates merged, what is unused left out."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, numbers_in
from regrasp.mechanics.value import numbers

Indices = NDArray[np.int64]

_FARTHEST = 1e150  # whose square is a number
_MOST_DIFFERENT = 1_500_000
_FEW = 300  # vertices of which all pairs are looked at
_MOST_NEAR = 30  # vertices in the cell of one, of two tolerances a side, on average


def checked_vertices(vertices: ArrayLike) -> Array:
    """(k, 3) finite floats, a new array."""
    result = numbers_in(vertices, "vertices must be numbers of shape (any, 3)")
    if result.ndim != 2 or result.shape[1] != 3:
        raise InvalidInput(f"vertices must have shape (any, 3), got {result.shape}")
    bad = np.flatnonzero(~np.isfinite(result).all(axis=1))
    if bad.size:
        more = f" ({bad.size} are not)" if bad.size > 1 else ""
        raise InvalidInput(f"vertices must be finite, vertex {bad[0]} is {numbers(result[bad[0]])}{more}")
    return result


def checked_faces(faces: ArrayLike, count: int) -> Indices:
    """(m, 3) whole numbers that name ``count`` vertices, a new array."""
    try:
        given: NDArray[Any] = np.array(faces)
    except ValueError:  # rows of different lengths
        raise InvalidInput("faces must be triangles, three vertex numbers in each row") from None
    if given.size == 0:
        raise InvalidInput("the mesh is empty: it has no faces")
    if given.dtype.kind not in "iu" or given.ndim != 2:
        raise InvalidInput(
            f"faces must be whole numbers of shape (any, 3), got {given.dtype} of shape {given.shape}"
        )
    if given.shape[1] != 3:
        raise InvalidInput(f"faces must be triangles, shape (any, 3); got {given.shape}: divide them first")
    wrong = np.argwhere((given < 0) | (given >= count))
    if wrong.size:
        face, corner = wrong[0]
        raise InvalidInput(
            f"face {face} names vertex {given[face, corner]}; there are {count}, numbered from 0"
        )
    return given.astype(np.int64)


def merged(vertices: Array, faces: Indices, tolerance: float = 0.0) -> tuple[Array, Indices]:
    """The mesh whose vertices within ``tolerance`` [m] of one another are one, the first of them.

    Faces that lose a corner by it and vertices that no face names are left out; the order stays.
    """
    same, first = _equal(vertices)
    if tolerance:
        near = _near(vertices[first], tolerance)
        same = near[same]
        _, first = np.unique(same, return_index=True)
    faces = first[same][faces]
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    used, renumbered = np.unique(faces, return_inverse=True)
    return vertices[used], renumbered.reshape(-1, 3)


def _equal(vertices: Array) -> tuple[Indices, Indices]:
    """(k,) a number for each vertex, the same for equal ones, and of each number the first vertex."""
    order = np.lexsort(vertices.T)
    ahead = vertices[order]
    new = np.concatenate([[True], (ahead[1:] != ahead[:-1]).any(axis=1)])
    same = np.empty(len(vertices), dtype=np.int64)
    same[order] = np.cumsum(new) - 1
    return same, order[new]


def _near(vertices: Array, tolerance: float) -> Indices:
    """(k,) a number for each of different vertices, the same for chains of steps up to ``tolerance``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if len(vertices) > _MOST_DIFFERENT:
        raise InvalidInput(f"there are {len(vertices)} different vertices, more than {_MOST_DIFFERENT}")
    crowd = np.bincount(_equal(np.floor(vertices / (2 * tolerance)))[0]).astype(float)
    if (crowd**2).sum() > _MOST_NEAR * len(vertices):
        raise InvalidInput(
            f"of the vertices many are within {tolerance:.3g} of one another, a millionth of the size: "
            "is one of them far from the rest?"
        )
    i, j = _pairs_within(vertices, tolerance)
    links = coo_array((np.ones(i.size), (i, j)), shape=(len(vertices),) * 2)
    result: Indices = connected_components(links, directed=False)[1].astype(np.int64)
    return result


def _pairs_within(vertices: Array, reach: float) -> tuple[Indices, Indices]:
    """(p,), (p,) all pairs of vertices at most so far apart [m]."""
    if len(vertices) <= _FEW:  # sooner done than a tree is imported
        away = vertices[:, None] - vertices
        i, j = np.nonzero(np.triu((away * away).sum(axis=2) <= reach * reach, 1))
        return i, j
    from scipy.spatial import cKDTree

    i, j = cKDTree(vertices).query_pairs(reach, output_type="ndarray").T
    return i, j


def checked_points(points: ArrayLike) -> Array:
    """(..., 3) finite floats whose squares are numbers too."""
    result = numbers_in(points, "points must be numbers of shape (..., 3)")
    if result.ndim < 1 or result.shape[-1] != 3 or not np.isfinite(result).all():
        raise InvalidInput(
            f"points must be finite, of shape (..., 3); got shape {result.shape}: {shown(points)}"
        )
    if result.size and abs(result).max() > _FARTHEST:
        raise InvalidInput(f"points must be nearer than {_FARTHEST:g}, got {shown(points)}")
    return result
