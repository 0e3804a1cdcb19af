"""Where round fingertips touch an outline without meeting another part of it."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.curves.curved_sides import CurvedSides
from regrasp.planning.placement.sides import Sides

Spans = list[tuple[float, float]]
_TOUCHING = 1e-9  # of the radius of a tip: so much overlap is rounding
_CHORDS = 1e-4  # of the radius: how far chords of a curve may be from it
_POINTS, _BLOCK = 2000, 200  # of a curve, at which a tip is tried
_HALVINGS = 40


def within_reach(sides: CurvedSides, radius: float) -> Spans:
    """The stretches u of a curve where a tip touches nothing else, as seen at points spread over it.

    A tip does not fit where the curve is hollow by more than 1 / radius, nor where its centre is nearer to
    chords of the curve than the radius, less twice what these are off by.
    """
    k = len(sides.control)
    ring = sides.outline.polygon(_CHORDS * radius)
    along = np.roll(ring, -1, axis=0) - ring
    squares = (along**2).sum(axis=1)

    def clear(u: Array) -> np.ndarray:
        points, normals, bends = sides.frames(u)
        centres = points - radius * normals
        nearest = np.concatenate(
            [
                _nearest(some, ring, along, squares)
                for some in np.split(centres, range(_BLOCK, len(u), _BLOCK))
            ]
        )
        result: np.ndarray = (nearest >= radius * (1 - 2 * _CHORDS)) & (-bends * radius <= 1 + _TOUCHING)
        return result

    share = np.cumsum(sides.lengths) / sides.lengths.sum()
    u = np.interp(np.arange(_POINTS + 1) / _POINTS, np.append(0.0, share), np.arange(k + 1.0))
    fits = clear(u)
    changes = np.flatnonzero(fits[1:] != fits[:-1])
    inside = np.where(fits[changes], u[changes], u[changes + 1])
    outside = np.where(fits[changes], u[changes + 1], u[changes])
    for _ in range(_HALVINGS if len(changes) else 0):
        middle = 0.5 * (inside + outside)
        good = clear(middle)
        inside, outside = np.where(good, middle, inside), np.where(good, outside, middle)
    ends = [*([0.0] if fits[0] else []), *inside.tolist(), *([float(k)] if fits[-1] else [])]
    return list(zip(ends[::2], ends[1::2], strict=True))


def _nearest(points: Array, ring: Array, along: Array, squares: Array) -> Array:
    """(m,) distances of points from the sides of a polygon."""
    away = points[:, None] - ring
    part = np.clip((away * along).sum(axis=2) / squares, 0.0, 1.0)
    result: Array = np.sqrt(((away - part[..., None] * along) ** 2).sum(axis=2)).min(axis=1)
    return result


def out_of_reach(sides: Sides, edge: int, radius: float) -> Spans:
    """Where a disc that touches an edge from outside overlaps another: within ``radius`` of a segment.

    The distance to a segment is convex along the line of centres, so each takes one stretch: the hull of
    those in which the line is within the discs around its ends and within the strip beside it.
    """
    length = sides.lengths[edge]
    t = sides.vectors[edge] / length
    n = np.array([-t[1], t[0]])
    c = sides.vertices[edge] - radius * n
    near = radius * (1 - _TOUCHING)
    a = sides.vertices - c
    d = sides.vectors / sides.lengths[:, None]
    m = np.stack([-d[:, 1], d[:, 0]], axis=1)
    lo, hi = np.full(len(a), np.inf), np.full(len(a), -np.inf)
    for end in (a, a + sides.vectors):
        half = np.sqrt(np.maximum(near**2 - (end @ n) ** 2, 0.0))
        meets, along = np.abs(end @ n) < near, end @ t
        lo = np.where(meets, np.minimum(lo, along - half), lo)
        hi = np.where(meets, np.maximum(hi, along + half), hi)
    beside = _between(-(m * a).sum(axis=1), m @ t, -near, near)
    before = _between(-(d * a).sum(axis=1), d @ t, 0.0, sides.lengths)
    first, last = np.maximum(beside[0], before[0]), np.minimum(beside[1], before[1])
    lo, hi = (
        np.where(first < last, np.minimum(lo, first), lo),
        np.where(first < last, np.maximum(hi, last), hi),
    )
    lo[edge], hi[edge] = np.inf, -np.inf
    meets = np.flatnonzero((lo < hi) & (lo < length) & (hi > 0))
    taken: Spans = []
    for k in meets[np.argsort(lo[meets], kind="stable")].tolist():
        here = (edge + float(lo[k] / length), edge + float(hi[k] / length))
        if taken and here[0] <= taken[-1][1]:
            taken[-1] = (taken[-1][0], max(taken[-1][1], here[1]))
        else:
            taken.append(here)
    return taken


def _between(at: Array, slope: Array, least: float, most: float | Array) -> tuple[Array, Array]:
    """The s with least < at + s slope < most."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (least - at) / slope, (most - at) / slope
    flat, inside = slope == 0.0, (least < at) & (at < most)
    lo = np.where(flat, np.where(inside, -np.inf, np.inf), np.minimum(a, b))
    return lo, np.where(flat, -lo, np.maximum(a, b))
