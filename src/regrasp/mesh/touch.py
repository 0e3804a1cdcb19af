"""Where fingers touch a surface of triangles: the nearest place, the normal there, places spread evenly."""

from functools import cached_property

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import numbers
from regrasp.mesh.arrays import Indices
from regrasp.mesh.closest import at, touching
from regrasp.mesh.doubts import warn_of_distance, warn_of_walls
from regrasp.mesh.rays import entry, outermost
from regrasp.mesh.shading import Shading, face_normals, turns
from regrasp.mesh.solid import doubled_areas
from regrasp.mesh.spread import Surface, spread

_AMBIGUOUS = np.radians(5.0)  # normals of faces that meet may differ by this where a finger touches
_AT_EDGE = 1e-9  # of the largest side
_FAR = 0.1  # of the largest side
_OPPOSED = -0.5  # the cosine between walls that face apart


class Touch:
    """The surface of a mesh as fingers meet it, in the coordinates given.

    Args:
        vertices: (k, 3) [m].
        faces: (m, 3), wound counter-clockwise seen from outside.
        smooth: whether normals are interpolated between vertices.
        crease: largest turn between neighbours over which they are [rad].
    """

    def __init__(self, vertices: Array, faces: Indices, smooth: bool, crease: float) -> None:
        self._vertices, self._faces, self._smooth, self._crease = vertices, faces, smooth, crease
        self.corners = vertices[faces]
        self._size = np.ptp(vertices, axis=0)
        self._reach = _AT_EDGE * float(self._size.max())

    @cached_property
    def _flat(self) -> Array:
        return face_normals(self.corners)

    @cached_property
    def _shading(self) -> Shading:
        return Shading(self._vertices, self._faces, self._crease)

    def nearest(self, points: Array) -> Array:
        """(m, 3) the places of the surface nearest to points (m, 3)."""
        faces, weights = self._nearest(points)
        return at(self.corners[faces], weights)

    def normals(self, points: Array) -> Array:
        """(m, 3) unit normals into the object there."""
        return self._normals_at(*self._nearest(points))

    def place(self, point: Array, along: Array | None, outside: bool) -> tuple[Array, Array]:
        """Where a finger for ``point`` (3,) touches, and the normal there; see ``Mesh.contact_at``."""
        if along is not None:
            foot = entry(point, along, self.corners, self._flat)
        else:
            foot = outermost(point, self.corners, self._flat) if outside else self.nearest(point[None])[0]
        away, largest = float(np.linalg.norm(point - foot)), float(self._size.max())
        if away > _FAR * largest:
            raise InvalidInput(
                f"point {numbers(point)} is {away:.3g} away from the surface of an object of size "
                f"{numbers(self._size)}; is it in the mesh's coordinates and unit? nearest() answers for any"
            )
        normal = self._normal(foot)
        if along is None and not outside and away > self._reach:
            warn_of_walls(point, away, self.corners[self._flat @ normal < _OPPOSED])
            warn_of_distance(point, away, self._size)
        return foot, normal

    def _normal(self, foot: Array) -> Array:
        """The normal (3,) at a place. Raises ``InvalidInput`` where faces meet at an angle."""
        _, faces, weights = touching(foot[None], self.corners, self._reach)
        normals = self._normals_at(faces, weights)
        turn = float(turns(normals, normals[0]).max())
        bend = float(turns(normals, self._flat[faces]).max())  # the tip of a cone has one normal and no sense
        if turn > _AMBIGUOUS or bend > self._crease:
            most = np.degrees(max(turn, bend))
            soft = not self._smooth and turn <= self._crease
            advice = "; for a curved surface give the mesh smooth=True" if soft else ""
            raise InvalidInput(
                f"point {numbers(foot)} is at an edge or corner, where {len(faces)} faces meet at up to "
                f"{most:.3g} degrees and no normal is defined; move it into a face{advice}"
            )
        normal: Array = normals[0]
        return normal

    def sample(self, count: int, seed: int, clearance: float | None) -> tuple[Array, Array]:
        """(count, 3) places spread evenly, and their normals; see ``Mesh.sample``."""
        shading = self._shading
        starts, ends = (np.concatenate([shading.edges[:, k], shading.points]) for k in (0, 1))
        sharp = self._vertices[starts], self._vertices[ends]
        surface = Surface(self.corners, doubled_areas(self.corners) / 2, self._flat, sharp)
        faces, weights = spread(surface, count, seed, clearance, 2 * self._reach)
        return at(self.corners[faces], weights), self._normals_at(faces, weights)

    def _nearest(self, points: Array) -> tuple[Indices, Array]:
        i, faces, weights = touching(points, self.corners, self._reach)
        first = np.searchsorted(i, np.arange(len(points)))
        return faces[first], weights[first]

    def _normals_at(self, faces: Indices, weights: Array) -> Array:
        if not self._smooth:
            return self._flat[faces]
        mixed = at(self._shading.normals[faces], weights)
        length = np.linalg.norm(mixed, axis=1, keepdims=True)
        return np.where(length > _AT_EDGE, mixed / np.maximum(length, _AT_EDGE), self._flat[faces])
