"""Volume and centre of mass of a polyhedron, by the divergence theorem."""

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike
from regrasp.mechanics.value import numbers
from regrasp.mesh.arrays import Indices, checked_faces, checked_vertices, merged
from regrasp.mesh.topology import one_body
from regrasp.outline.region import checked_size

# A face this flat, height over longest side, has no direction that rounding leaves; a body this thin, volume
# over area times size, has no inside.
_FLAT, _THIN = 1e-9, 1e-12


def checked_body(vertices: ArrayLike, faces: ArrayLike) -> tuple[Array, Indices]:
    """Vertices, each once, and faces wound the right way; raises ``InvalidInput`` for what is no body."""
    points = checked_vertices(vertices)
    if len(points):
        checked_size(points, "the mesh")
    points, triangles = merged(points, checked_faces(faces, len(points)))
    if not triangles.size:
        raise InvalidInput("the mesh is empty: every face has two corners in one place")
    return points, solid(points, triangles)


def solid(vertices: Array, faces: Indices) -> Indices:
    """The faces wound counter-clockwise seen from outside, of one body with a volume.

    Raises ``InvalidInput`` for faces without area and for what bounds no body.
    """
    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    flat = np.flatnonzero(doubled_areas(corners) <= _FLAT * longest**2)
    if flat.size:
        a, b, c = (numbers(v) for v in corners[flat[0]])
        raise InvalidInput(
            f"faces must have an area; {flat.size} of {len(faces)} have none, "
            f"face {flat[0]} is {a}, {b}, {c}; mend the mesh where it was made"
        )
    faces = one_body(vertices, faces)
    volume, _ = moments(vertices, faces)
    area, size = float(doubled_areas(corners).sum()) / 2, float(np.ptp(vertices, axis=0).max())
    if abs(volume) <= _THIN * area * size:
        raise InvalidInput(f"the mesh encloses no volume: {volume:.3g}, with an area of {area:.6g}")
    return faces if volume > 0 else faces[:, [0, 2, 1]]


def moments(vertices: Array, faces: Indices) -> tuple[float, Array]:
    """Volume [m^3] and centroid (3,) [m]: tetrahedra from a point amid the vertices, where little cancels."""
    base = vertices.mean(axis=0)
    a, b, c = (vertices - base)[faces].transpose(1, 0, 2)
    six = (a * np.cross(b, c)).sum(axis=1)  # six times the volume of each tetrahedron, signed
    total = float(six.sum())
    if total == 0:
        return 0.0, base
    return total / 6, base + (six[:, None] * (a + b + c)).sum(axis=0) / (4 * total)


def inertia(vertices: Array, faces: Indices) -> Array:
    """(3, 3) inertia about the centroid for a density of 1 [m^5], by the same tetrahedra.

    With corners a, b, c and the centroid as the fourth, the integral of x x^T over one is
    det / 120 (s s^T + a a^T + b b^T + c c^T), s = a + b + c, det = six times its volume.
    """
    corners = (vertices - moments(vertices, faces)[1])[faces]  # (m, 3, 3)
    a, b, c = corners.transpose(1, 0, 2)
    det = (a * np.cross(b, c)).sum(axis=1)
    s = corners.sum(axis=1)
    second = np.einsum("m,mi,mj->ij", det, s, s) + np.einsum("m,mki,mkj->ij", det, corners, corners)
    result: Array = (np.trace(second) * np.eye(3) - second) / 120
    return (result + result.T) / 2


def doubled_areas(corners: Array) -> Array:
    """(m,) twice the areas of triangles (m, 3, 3) [m^2]."""
    a, b, c = corners.transpose(1, 0, 2)
    result: Array = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return result
