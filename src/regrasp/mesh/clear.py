"""The flat parts of a surface as triangles, without what lies along their sharp edges."""

from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices
from regrasp.mesh.mesh import Mesh

_FLAT = 1e-9  # neighbours that turn by less are of one flat part [rad]
_ROUND = 1 / np.cos(np.pi / 32)  # what a polygon around a round end takes to be outside of it
_SLIVER = 1e-12  # of the square of the size: a triangle of less area is none


def clear_faces(mesh: Mesh, distance: float) -> tuple[Array, Array]:
    """(m, 3, 3) triangles relative to the centre of mass [m], and their inward normals (m, 3).

    They cover what is farther than ``distance`` [m] from the sharp edges of the flat part it is on.
    """
    points, faces = mesh.surface()
    corners = points[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = -cross / np.linalg.norm(cross, axis=1)[:, None]
    if distance == 0:
        return corners, normals
    part, sharp = _parts(faces, normals, mesh.crease)
    found, inward = [], []
    for number in np.unique(part):
        members = np.flatnonzero(part == number)
        edges = [points[list(edge)] for edge in sharp.get(int(number), [])]
        kept = _cut(corners[members], normals[members[0]], edges, distance) if edges else corners[members]
        found.append(kept)
        inward.append(np.repeat(normals[members[:1]], len(kept), axis=0))
    return np.concatenate(found), np.concatenate(inward)


def _parts(faces: Indices, normals: Array, crease: float) -> tuple[Indices, dict[int, list[tuple[int, int]]]]:
    """(m,) the flat part of each face, and the sharp edges of each."""
    part = np.arange(len(faces))

    def root(face: int) -> int:
        while part[face] != face:
            part[face] = part[part[face]]
            face = int(part[face])
        return face

    beside: dict[tuple[int, int], list[int]] = {}
    for number, face in enumerate(faces.tolist()):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            beside.setdefault((min(face[a], face[b]), max(face[a], face[b])), []).append(number)
    turns = []
    for edge, pair in beside.items():
        one, other = normals[pair[0]], normals[pair[1]]
        turn = float(np.arctan2(np.linalg.norm(np.cross(one, other)), one @ other))
        turns.append((edge, pair, turn))
        if turn <= _FLAT:
            part[root(pair[0])] = root(pair[1])
    roots = np.array([root(i) for i in range(len(faces))])
    sharp: dict[int, list[tuple[int, int]]] = {}
    for edge, pair, turn in turns:
        if turn > crease:
            for face in pair:
                sharp.setdefault(int(roots[face]), []).append(edge)
    return roots, sharp


def _cut(corners: Array, normal: Array, edges: list[Array], distance: float) -> Array:
    """(m, 3, 3) triangles of a flat part that keep a distance from some of its edges (2, 3)."""
    import shapely

    origin = corners[0, 0]
    u = corners[0, 1] - origin
    u = u / np.linalg.norm(u)
    axes = np.stack([u, np.cross(normal, u)])
    unit = float(np.abs(corners - origin).max())
    flat = (corners - origin) @ axes.T / unit
    region = shapely.union_all([shapely.Polygon(triangle) for triangle in flat])
    lines = shapely.union_all([shapely.LineString((edge - origin) @ axes.T / unit) for edge in edges])
    left: Any = region.difference(lines.buffer(distance * _ROUND / unit, quad_segs=8))
    found: Any = shapely.constrained_delaunay_triangles(left) if not left.is_empty else None
    pieces = [] if found is None else [np.array(piece.exterior.coords[:3]) for piece in found.geoms]
    triangles = [piece for piece in pieces if _area(piece) > _SLIVER]
    if not triangles:
        return np.zeros((0, 3, 3))
    result: Array = origin + (np.array(triangles) * unit) @ axes
    return result


def _area(triangle: Array) -> float:
    a, b = triangle[1] - triangle[0], triangle[2] - triangle[0]
    return float(abs(a[0] * b[1] - a[1] * b[0])) / 2
