"""The boundary of an outline as straight sides on which fingers may be."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.value import ArrayValue
from regrasp.outline.outline import Outline

_TOUCHING = 1e-9  # of the radius of a tip: so much overlap is rounding
Spans = list[tuple[float, float]]
Arcs = list[tuple[float, float]] | None
"""Arc lengths from which to which, counter-clockwise [m]; None for the whole outline."""


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


def sides_of(outline: Outline, from_corners: float, arcs: Arcs = None, tip_radius: float = 0.0) -> Sides:
    """The sides of a polygon on which fingers may be.

    Left out are stretches nearer to a corner than ``from_corners`` [m], those outside ``arcs``, and those
    that a round tip cannot touch without meeting another part of the boundary.
    """
    whole = _whole(outline)
    ends, starts, lengths = whole.ends.copy(), np.append(whole.starts, outline.length), whole.lengths
    corners = outline.boundary.corners
    if from_corners and corners.size:
        # what is left of an edge between the last corner not after its start and the next not before its end
        before = np.append(corners[-1] - outline.length, corners)
        before = before[np.searchsorted(corners, starts[:-1], "right")]
        after = np.append(corners, corners[0] + outline.length)[np.searchsorted(corners, starts[1:], "left")]
        ends[:, 0] += np.clip((before + from_corners - starts[:-1]) / lengths, 0.0, None)
        ends[:, 1] -= np.clip((starts[1:] - after + from_corners) / lengths, 0.0, None)
    edges, kept = [], []
    for edge, (lo, hi) in enumerate(ends.tolist()):
        allowed = [(lo, hi)] if lo < hi else []
        if arcs is not None:
            allowed = _within(allowed, [_on_edge(arc, whole, edge, outline.length) for arc in arcs])
        if tip_radius:
            for taken in _out_of_reach(whole, edge, tip_radius):
                allowed = _without(allowed, taken)
        edges += [edge] * len(allowed)
        kept += allowed
    if not kept:
        raise InvalidInput(
            f"no place on the outline is left for fingers: from_corners {from_corners:.6g}, arcs "
            f"{shown(arcs)}, tip_radius {tip_radius:.6g}"
        )
    return Sides(whole.vertices, np.array(edges), np.array(kept))


def _whole(outline: Outline) -> Sides:
    vertices = outline.polygon()
    edges = np.arange(len(vertices))
    return Sides(vertices, edges, np.stack([edges, edges + 1.0], axis=1))


def _on_edge(arc: tuple[float, float], sides: Sides, edge: int, length: float) -> list[tuple[float, float]]:
    """The stretches u of an edge that an arc of arc lengths covers, which may run past the first vertex."""
    lo, hi = arc[0] % length, arc[0] % length + (arc[1] - arc[0]) % length
    if arc[0] != arc[1] and lo == hi:  # once around
        hi = lo + length
    start, size = sides.starts[edge], sides.lengths[edge]
    spans = [
        (edge + (lo + turn - start) / size, edge + (hi + turn - start) / size) for turn in (0.0, -length)
    ]
    return [(max(a, edge), min(b, edge + 1.0)) for a, b in spans if max(a, edge) < min(b, edge + 1.0)]


def _within(allowed: Spans, arcs: list[Spans]) -> Spans:
    """The parts of spans that any of the arcs covers, in rising order, none twice."""
    spans = sorted(span for arc in arcs for span in arc)
    joined: Spans = []
    for lo, hi in spans:
        if joined and lo <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], hi))
        else:
            joined.append((lo, hi))
    both = [(max(a, c), min(b, d)) for a, b in allowed for c, d in joined]
    return [(a, b) for a, b in both if a < b]


def _without(allowed: Spans, taken: tuple[float, float]) -> Spans:
    parts = [part for a, b in allowed for part in ((a, min(b, taken[0])), (max(a, taken[1]), b))]
    return [(a, b) for a, b in parts if a < b]


def _out_of_reach(sides: Sides, edge: int, radius: float) -> Spans:
    """Where a disc that touches an edge from outside overlaps another: within ``radius`` of a segment.

    The distance to a segment is convex along the line of centres, so each takes one stretch: the hull of
    those in which the line is within the discs around its ends and within the strip beside it.
    """
    length = sides.lengths[edge]
    t = sides.vectors[edge] / length
    c = sides.vertices[edge] + radius * np.array([t[1], -t[0]])
    near = radius * (1 - _TOUCHING)
    taken = []
    for other in range(len(sides.vertices)):
        if other == edge:
            continue
        a, d = sides.vertices[other], sides.vectors[other] / sides.lengths[other]
        found = []
        for end in (a, a + sides.vectors[other]):
            along, across = t @ (end - c), (end - c) @ np.array([-t[1], t[0]])
            if abs(across) < near:
                half = float(np.sqrt(near**2 - across**2))
                found.append((along - half, along + half))
        m = np.array([-d[1], d[0]])
        strip = [
            _between(m @ (c - a), m @ t, -near, near),
            _between(d @ (c - a), d @ t, 0.0, sides.lengths[other]),
        ]
        lo, hi = max(s[0] for s in strip), min(s[1] for s in strip)
        if lo < hi:
            found.append((lo, hi))
        if found:
            taken.append((edge + min(f[0] for f in found) / length, edge + max(f[1] for f in found) / length))
    return taken


def _between(at: float, slope: float, least: float, most: float) -> tuple[float, float]:
    """The s with least < at + s slope < most."""
    if slope == 0.0:
        return (-np.inf, np.inf) if least < at < most else (np.inf, -np.inf)
    a, b = (least - at) / slope, (most - at) / slope
    return (a, b) if a < b else (b, a)
