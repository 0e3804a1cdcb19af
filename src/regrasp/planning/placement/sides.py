"""The boundary of an outline as straight sides on which fingers may be."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.value import ArrayValue
from regrasp.outline.outline import Outline


@dataclass(frozen=True, eq=False)
class Sides(ArrayValue):
    """Stretches of a polygon's edges. A place is u: the number of its edge plus the fraction of it passed.

    Args:
        vertices: (k, 2) of the polygon, counter-clockwise, relative to the centre of mass [m].
        edges: (m,) the edge of each side.
        ends: (m, 2) least and largest u of each side, in rising order.
    """

    vertices: Array
    edges: np.ndarray
    ends: Array

    @cached_property
    def vectors(self) -> Array:
        """(k, 2) of the edges [m]."""
        result: Array = np.roll(self.vertices, -1, axis=0) - self.vertices
        return result

    @cached_property
    def lengths(self) -> Array:
        """(k,) of the edges [m]."""
        result: Array = np.hypot(*self.vectors.T)
        return result

    @cached_property
    def starts(self) -> Array:
        """(k,) arc lengths of the vertices [m]."""
        result: Array = np.concatenate([[0.0], np.cumsum(self.lengths)[:-1]])
        return result

    @cached_property
    def size(self) -> float:
        """The largest distance of a vertex from the centre of mass [m]."""
        return float(np.hypot(*self.vertices.T).max())

    def table(self) -> Array:
        """(m, 9) as the compiled search takes them, lengths in units of ``size``."""
        at, along = self.vertices[self.edges] / self.size, self.vectors[self.edges]
        unit = along / self.lengths[self.edges][:, None]
        normals = np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        return np.column_stack([at, along / self.size, normals, self.ends, self.edges.astype(float)])

    def arc_length(self, side: int, u: float) -> float:
        """Along the boundary, from the first vertex [m]."""
        edge = int(self.edges[side])
        return float(self.starts[edge] + (u - edge) * self.lengths[edge])

    def contact(self, side: int, u: float, friction: float, name: str) -> Contact:
        """A finger on a side; at a corner it has that side's normal."""
        edge = int(self.edges[side])
        tangent = self.vectors[edge] / self.lengths[edge]
        point = self.vertices[edge] + (u - edge) * self.vectors[edge]
        return Contact(point, [-tangent[1] + 0.0, tangent[0]], friction, name=name)


def sides_of(outline: Outline, from_corners: float) -> Sides:
    """The sides of a polygon without the stretches that are nearer to a corner than ``from_corners`` [m]."""
    vertices = outline.polygon()
    count = len(vertices)
    edges = np.arange(count)
    sides = Sides(vertices, edges, np.stack([edges, edges + 1.0], axis=1))
    if not from_corners:
        return sides
    starts = np.append(sides.starts, outline.length)
    corners = outline.boundary.corners
    if not corners.size:
        return sides
    # what is left of each edge between the last corner not after its start and the next not before its end
    before = np.append(corners[-1] - outline.length, corners)[np.searchsorted(corners, starts[:-1], "right")]
    after = np.append(corners, corners[0] + outline.length)[np.searchsorted(corners, starts[1:], "left")]
    lo = np.clip((before + from_corners - starts[:-1]) / sides.lengths, 0.0, None)
    hi = 1.0 - np.clip((starts[1:] - after + from_corners) / sides.lengths, 0.0, None)
    kept = lo < hi
    if not kept.any():
        raise InvalidInput(
            f"no place is as far from every corner as from_corners, {from_corners:.6g}; make it smaller"
        )
    return Sides(vertices, edges[kept], np.stack([edges + lo, edges + hi], axis=1)[kept])
