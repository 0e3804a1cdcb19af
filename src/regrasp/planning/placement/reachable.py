"""Which sides of an outline fingers may be on: away from corners, within arcs, where their tips reach."""

from dataclasses import replace

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.outline.outline import Outline
from regrasp.planning.placement.curved_sides import curved_sides
from regrasp.planning.placement.sides import Sides

_TOUCHING = 1e-9  # of the radius of a tip: so much overlap is rounding
Spans = list[tuple[float, float]]
Arcs = list[tuple[float, float]] | None
"""Arc lengths from which to which, counter-clockwise [m]; None for the whole outline."""


def sides_of(outline: Outline, from_corners: float, arcs: Arcs = None, tip_radius: float = 0.0) -> Sides:
    """The sides of an outline on which fingers may be.

    Left out are stretches nearer to a corner than ``from_corners`` [m], those outside ``arcs``, and those
    that a round tip cannot touch without meeting another part of the boundary.
    """
    control = outline.cubics()
    if tip_radius and control is not None:
        raise InvalidInput(
            "tip_radius is for polygons; give Outline(shape.polygon(tolerance)) of a smooth outline"
        )
    whole = _whole(outline) if control is None else curved_sides(outline, control)
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
    for edge, (lo, hi) in zip(whole.edges.tolist(), ends.tolist(), strict=True):
        allowed = [(lo, hi)] if lo < hi else []
        if arcs is not None:
            allowed = _within(allowed, [whole.on_edge(arc, edge, outline.length) for arc in arcs])
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
    return replace(whole, edges=np.array(edges), ends=np.array(kept))


def _whole(outline: Outline) -> Sides:
    vertices = outline.polygon()
    edges = np.arange(len(vertices))
    return Sides(vertices, edges, np.stack([edges, edges + 1.0], axis=1))


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
