"""The boundary of an outline as straight sides on which fingers may be."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.value import ArrayValue

_AT_END = 1e-12  # of an edge, which no sum of lengths tells from its end


@dataclass(frozen=True, eq=False)
class Sides(ArrayValue):
    """Stretches of the edges of a polygon, or of cubics (``CurvedSides``).

    A place is u: the number of its edge plus the fraction of it passed.

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

    def control_points(self) -> Array:
        """(k, 2) vertices, or (k, 3, 2) the first control points of cubic edges, about the centre of mass."""
        return self.vertices

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

    def u_at(self, s: float) -> float:
        """The place at an arc length from 0 to the length of the outline [m]."""
        edge = min(int(np.searchsorted(self.starts, s, "right")), len(self.starts)) - 1
        return edge + min(float((s - self.starts[edge]) / self.lengths[edge]), 1.0)

    def on(self, u: Array) -> np.ndarray:
        """(k,) the sides that places are on; the nearest before one that is on none."""
        found: np.ndarray = np.maximum(np.searchsorted(self.ends[:, 0], u, "right") - 1, 0)
        return found

    def on_edge(self, arc: tuple[float, float], edge: int, length: float) -> list[tuple[float, float]]:
        """The stretches u of an edge that an arc covers, which may run past the first vertex."""
        lo, hi, around = self.u_at(arc[0] % length), self.u_at(arc[1] % length), float(len(self.vertices))
        if hi < lo or (arc[0] != arc[1] and hi == lo):  # past the first vertex, or once around
            hi += around
        spans = [(max(lo + turn, edge), min(hi + turn, edge + 1.0)) for turn in (0.0, -around)]
        return [(a, b) for a, b in spans if a < b]

    def spread(self, count: int) -> tuple[np.ndarray, Array]:
        """The sides and u of places evenly spread over all sides."""
        widths = np.diff(self.ends, axis=1)[:, 0]
        lengths = widths * self.lengths[self.edges]
        until = np.cumsum(lengths)
        along = (np.arange(count) + 0.5) / count * until[-1]
        on = np.searchsorted(until, along)
        return on, self.ends[on, 1] - (until[on] - along) / lengths[on] * widths[on]

    def moved(self, place: int, u: float, way: float) -> tuple[int, float]:
        """A place some way along its side, a fraction of the edge, or at the end of the side."""
        least, most = self.ends[place].tolist()
        return place, min(max(u + way, least), most)

    def part(self, side: int, lo: float, hi: float) -> tuple[Array, Array]:
        """(h, 2) points whose hull contains a part, and (t, 2) unit tangents between which its own are."""
        edge = int(self.edges[side])
        ends = self.points(np.array([side, side]), np.array([lo, hi]))
        return ends if lo < hi else ends[:1], self.vectors[edge : edge + 1] / self.lengths[edge]

    def points(self, places: np.ndarray, u: Array) -> Array:
        """(k, 2) of places on sides [m]."""
        edges = self.edges[places]
        result: Array = self.vertices[edges] + (u - edges)[:, None] * self.vectors[edges]
        return result

    def contact(self, side: int, u: float, friction: float, name: str) -> Contact:
        """A finger on a side; at a corner it has that side's normal."""
        edge = int(self.edges[side])
        tangent = self.vectors[edge] / self.lengths[edge]
        point = self.vertices[edge] + (u - edge) * self.vectors[edge]
        return Contact(point, [-tangent[1] + 0.0, tangent[0]], friction, name=name)


def moved(contact: Contact, to: Contact) -> Contact:
    """A contact at the place of another."""
    return Contact(
        to.position, to.normal, contact.friction, max_force=contact.max_force, torsion=contact.torsion,
        name=contact.name,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class RingSides(Sides):
    """Stretches of the edges of a polygon and of its holes, the material on the left of each.

    Args:
        rings: (r,) the first vertex of each ring, the outline's first.
    """

    rings: np.ndarray

    @cached_property
    def vectors(self) -> Array:
        """(k, 2) of the edges [m]."""
        parts = np.split(self.vertices, self.rings[1:])
        return np.concatenate([np.roll(part, -1, axis=0) - part for part in parts])

    def arc_length(self, side: int, u: float) -> float:
        """Along the rings [m]; the end of one is said as its beginning, for there the next one begins."""
        edge = int(self.edges[side])
        first = self.rings[self.rings <= edge][-1]
        is_last = edge + 1 in (*self.rings, len(self.vertices))
        at_end = is_last and u - edge > 1 - _AT_END
        return float(self.starts[first]) if at_end else super().arc_length(side, u)
