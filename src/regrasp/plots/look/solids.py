"""Triangles to draw: meshes as they come, and cones."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, array

Triangles = tuple[Array, NDArray[np.intp]]
"""Vertices (v, 3) [m], object frame, and faces (f, 3), rows of vertices."""

# Faces that meet at a larger angle have an edge between them to see, cos 30 deg.
_CREASE = np.cos(np.pi / 6)


def triangles_of(mesh: Any) -> Triangles | None:
    """The surface of ``mesh``: of an object with ``surface()``, or (vertices, faces) itself; None for None.

    Raises ``InvalidInput`` for anything else.
    """
    if mesh is None:
        return None
    given = mesh.surface() if hasattr(mesh, "surface") else mesh
    try:
        vertices, faces = given
    except (TypeError, ValueError):
        raise InvalidInput(
            f"mesh must have a surface() or be (vertices, faces), got {type(mesh).__name__}"
        ) from None
    vertices, rows = array(vertices, "mesh vertices", (None, 3)), array(faces, "mesh faces", (None, 3))
    if not rows.size or (rows != np.floor(rows)).any() or rows.min() < 0 or rows.max() >= len(vertices):
        raise InvalidInput(
            f"mesh faces must be whole numbers from 0 to {len(vertices) - 1}, one face or more"
        )
    return vertices, rows.astype(np.intp)


def face_normals(triangles: Triangles) -> Array:
    """(f, 3) unit normals by the order of the corners; zero for a face without area."""
    a, b, c = np.moveaxis(triangles[0][triangles[1]], 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    result: Array = normals / np.where(lengths > 0, lengths, 1.0)
    return result


def creases(triangles: Triangles) -> Array:
    """(k, 2, 3) edges worth a line: those of one face only, and those where the surface bends sharply.

    Corners at one place count as one vertex, as files that list every face by itself need.
    """
    vertices, faces = triangles
    _, same = np.unique(vertices, axis=0, return_inverse=True)
    ends = same.reshape(-1)[faces]
    sides = np.sort(np.concatenate([ends[:, [0, 1]], ends[:, [1, 2]], ends[:, [2, 0]]]), axis=1)
    corners = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    face = np.tile(np.arange(len(faces)), 3)
    _, first, count = np.unique(sides, axis=0, return_index=True, return_counts=True)
    order = np.lexsort(sides.T[::-1])  # sides in the order of the unique ones, equal ones together
    starts = np.cumsum(count) - count
    normals = face_normals(triangles)
    one, other = face[order[starts]], face[order[starts + count - 1]]
    shown = (count == 1) | ((normals[one] * normals[other]).sum(axis=1) < _CREASE)
    result: Array = vertices[corners[first[shown]]]
    return result


def cone(apex: ArrayLike, axis: ArrayLike, height: float, radius: float, sides: int = 32) -> Triangles:
    """The side of a circular cone that opens along the unit vector ``axis``; its apex is the first vertex."""
    rim = circle(np.asarray(apex, dtype=float) + height * np.asarray(axis, dtype=float), axis, radius, sides)
    k = np.arange(sides)
    faces = np.column_stack([np.zeros_like(k), 1 + k, 1 + (k + 1) % sides])
    return np.vstack([np.asarray(apex, dtype=float), rim]), faces


def circle(centre: Array, axis: ArrayLike, radius: float, sides: int = 32, turn: float = 2 * np.pi) -> Array:
    """(sides, 3) points around ``axis``, right-handed, from any start; for a whole turn none comes twice."""
    n = np.asarray(axis, dtype=float)
    u = np.cross(n, np.eye(3)[np.argmin(abs(n))])
    u /= np.linalg.norm(u)
    angles = np.linspace(0, turn, sides, endpoint=turn < 2 * np.pi)[:, None]
    result: Array = centre + radius * (np.cos(angles) * u + np.sin(angles) * np.cross(n, u))
    return result
