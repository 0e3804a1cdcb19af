"""Where a triangle mesh is sharp, and the normals of the smooth surface it stands for elsewhere."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices
from regrasp.mesh.topology import twins


def face_normals(corners: Array) -> Array:
    """(m, 3) unit normals into the object of triangles (m, 3, 3) counter-clockwise from outside."""
    a, b, c = corners.transpose(1, 0, 2)
    inward = np.cross(c - a, b - a)
    result: Array = inward / np.linalg.norm(inward, axis=1, keepdims=True) + 0.0  # no -0
    return result


def turns(a: Array, b: Array) -> Array:
    """(...,) angles between vectors (..., 3) [rad], exact for small ones too."""
    result: Array = np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1))
    return result


class Shading:
    """What the angles between faces say.

    edges: (k, 2) vertices of the sharp edges, where the surface turns by more than ``crease`` [rad].
    points: (j,) vertices that are sharp without such an edge, like the tip of a cone.
    normals: (m, 3, 3) for each corner of each face the mean of the faces around that vertex, weighted by
    their angles there (Thürmer and Wüthrich, 1998), as far as no sharp edge parts them. The weights do not
    depend on how a flat face is divided.
    """

    def __init__(self, vertices: Array, faces: Indices, crease: float) -> None:
        corners = vertices[faces]
        flat = face_normals(corners)
        first, second = twins(faces).T
        sharp = turns(flat[first // 3], flat[second // 3]) > crease
        start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        self.edges = np.stack([start, end], axis=1)[first[sharp]]
        self.normals = self._corner_normals(corners, flat, first[~sharp], second[~sharp])
        off = (turns(self.normals, flat[:, None]) > crease).ravel()
        self.points = np.setdiff1d(start[off], self.edges)

    def _corner_normals(self, corners: Array, flat: Array, first: Indices, second: Indices) -> Array:
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        after = np.arange(corners.size // 3).reshape(-1, 3)[:, [1, 2, 0]].ravel()
        # Twins run against each other: one starts where the other ends.
        rows, columns = np.concatenate([first, after[first]]), np.concatenate([after[second], second])
        links = coo_array((np.ones(rows.size), (rows, columns)), shape=(after.size, after.size))
        count, group = connected_components(links, directed=False)
        ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
        weighted = (turns(ahead, behind)[..., None] * flat[:, None]).reshape(-1, 3)
        sums = np.stack([np.bincount(group, column, count) for column in weighted.T], axis=1)[group]
        length = np.linalg.norm(sums, axis=1, keepdims=True)
        own = np.repeat(flat, 3, axis=0)
        result = np.where(length > 1e-9, sums / np.maximum(length, 1e-9), own)  # none: faces that cancel
        return result.reshape(corners.shape)
