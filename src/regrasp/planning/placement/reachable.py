"""Which sides of an outline fingers may be on: away from corners, within arcs, where their tips reach."""

from dataclasses import replace

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.outline.boundary import Boundary
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.placement.curves.curved_sides import CurvedSides, curved_sides
from regrasp.planning.placement.curves.tips import Spans, out_of_reach, within_reach
from regrasp.planning.placement.sides import RingSides, Sides

_ROUNDING = 1e-9  # of the length
Arcs = list[tuple[float, float]] | None
"""Arc lengths from which to which, counter-clockwise [m]; None for the whole outline."""


def sides_of(
    outline: Outline, from_corners: float, arcs: Arcs = None, tip_radius: float = 0.0, in_holes: bool = False
) -> Sides:
    """The sides of an outline on which fingers may be.

    Left out are stretches nearer to a corner than ``from_corners`` [m], those outside ``arcs``, and those
    that a round tip cannot touch without meeting another part of the boundary. With ``in_holes`` the sides of
    holes come after those of the outline, clockwise around each, and so do their arc lengths.
    """
    control = outline.cubics()
    if in_holes and outline.holes:
        whole: Sides = _with_holes(outline)
        rings = [outline.boundary, *(PolygonBoundary(v) for v in hole_rings(outline))]
    else:
        whole = _whole(outline) if control is None else curved_sides(outline, control)
        rings = [outline.boundary]
    ends, first = whole.ends.copy(), 0
    for ring in rings if from_corners and control is None else []:
        last = first + (len(ring.vertices) if isinstance(ring, PolygonBoundary) else len(ends))
        starts = whole.starts[first:last] - whole.starts[first]
        ends[first:last] += _trims(ring, starts, whole.lengths[first:last], from_corners)
        first = last
    reached = within_reach(whole, tip_radius) if tip_radius and isinstance(whole, CurvedSides) else None
    edges, kept = [], []
    for edge, (lo, hi) in zip(whole.edges.tolist(), ends.tolist(), strict=True):
        allowed = [(lo, hi)] if lo < hi else []
        if arcs is not None:
            allowed = _within(allowed, [whole.on_edge(arc, edge, outline.length) for arc in arcs])
        if reached is not None:
            allowed = _within(allowed, [reached])
        elif tip_radius:
            for taken in out_of_reach(whole, edge, tip_radius):
                allowed = _without(allowed, taken)
        edges += [edge] * len(allowed)
        kept += allowed
    if not kept:
        raise InvalidInput(
            f"no place on the outline is left for fingers: from_corners {from_corners:.6g}, arcs "
            f"{shown(arcs)}, tip_radius {tip_radius:.6g}"
        )
    return replace(whole, edges=np.array(edges), ends=np.array(kept))


def _whole(outline: Outline) -> Sides:
    vertices = outline.polygon()
    edges = np.arange(len(vertices))
    return Sides(vertices, edges, np.stack([edges, edges + 1.0], axis=1))


def _trims(ring: Boundary, starts: Array, lengths: Array, least: float) -> Array:
    """(m, 2) by how much the ends of edges move to be ``least`` from corners, as fractions of the edges.

    What is left of an edge is between the last corner not after its start and the next not before its end.
    """
    corners, slack = ring.corners, _ROUNDING * ring.length
    if not corners.size:
        return np.zeros((len(starts), 2))
    stops = np.append(starts[1:], ring.length)
    before = np.append(corners[-1] - ring.length, corners)
    before = before[np.searchsorted(corners, starts + slack, "right")]
    after = np.append(corners, corners[0] + ring.length)[np.searchsorted(corners, stops - slack, "left")]
    back, ahead = (before + least - starts) / lengths, (stops - after + least) / lengths
    return np.stack([np.clip(back, 0.0, None), -np.clip(ahead, 0.0, None)], axis=1)


def hole_rings(outline: Outline) -> list[Array]:
    """(k, 2) vertices of each hole that is a polygon, clockwise, in the coordinates given [m]."""
    return [hole.vertices[::-1] for hole in outline.holes if isinstance(hole, PolygonBoundary)]


def _with_holes(outline: Outline) -> RingSides:
    """The sides of a polygon and of its holes."""
    holes = hole_rings(outline)
    if outline.cubics() is not None or len(holes) < len(outline.holes):
        raise InvalidInput(
            "in_holes is for polygons with holes that are polygons; give Outline(shape.polygon(tolerance), "
            "holes=...) of smooth ones"
        )
    rings = [outline.polygon(), *(hole - outline.centre_of_mass for hole in holes)]
    edges = np.arange(sum(map(len, rings)))
    return RingSides(
        np.concatenate(rings), edges, np.stack([edges, edges + 1.0], axis=1),
        np.cumsum([0, *map(len, rings[:-1])]),
    )  # fmt: skip


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
