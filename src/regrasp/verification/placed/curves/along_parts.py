"""The most that a finger does along a twist on a part of a cubic, where places and normals go together.

Let T be the tangent of the part, of degree 2, N = J T its normal, J a quarter of a turn, and v the velocity
of its points, of degree 3. For a vector m with T . m > 0 a force on an edge of its cone, of n . f = 1, does

    v . (N -+ mu T) / |T|  <=  |m| times the largest ratio of coefficients of v . (N -+ mu T) and T . m,

coefficients being those of degree 5 in Bernstein's basis, in which T . m has none that is not above 0, or 0
if that is more; m is the middle coefficient of T. Let T turn by an angle d, and c and e be the edges of what
all cones have in common. Every force of |f| = 1 in a cone of edges a and b is from a to c, from c to e or
from e to b: in the hull of 0, the edges times 1 / cos(d / 2) and the forces from c to e; or, where cones have
nothing in common, in that of 0 and of a and b times sqrt(1 + mu^2). From c to e all places have the same
forces, and v . f, affine in the place, is largest at a control point.
"""

from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.forces.eroded import cone_edges
from regrasp.verification.placed.protocol import Point, velocity
from regrasp.verification.placed.roots import root_above, root_below

_BINOMIALS = [
    (r, k, r - k, (1, 3, 3, 1)[k] * (1, 2, 1)[r - k]) for r in range(6) for k in range(4) if 0 <= r - k < 3
]
"""Coefficient of degree 5, those of degrees 3 and 2 in it, and how often, but for what is common to all."""


def most_on_part(
    hull: list[Point],
    tangents: list[Point],
    ends: tuple[Point, Point],
    mu: Fraction,
    force: bool,
    y: list[Fraction],
) -> Fraction | None:
    """An upper bound of sigma on a part; None where its tangent turns by a quarter or is 0.

    hull: control points. tangents: coefficients. ends: the outermost of these, the clockwise one first.
    """
    m = tangents[1]
    if not all(_dot(t, m) > 0 for t in tangents) or _dot(*ends) <= 0:
        return None
    along, terms = [velocity(y, p) for p in hull], [[Fraction(0)] * 6 for _ in range(3)]
    for r, k, i, often in _BINOMIALS:
        (vx, vy), (tx, ty) = along[k], tangents[i]
        for term, value in zip(
            terms, (vy * tx - vx * ty, vx * tx + vy * ty, _dot(tangents[i], m)), strict=True
        ):
            term[r] += often * value
    edges = max((ahead + mu * abs(aside)) / speed for ahead, aside, speed in zip(*terms, strict=True))
    edges = Fraction(max(edges, Fraction(0)) * root_above(_dot(m, m)))
    c, e = cone_edges(ends[1], mu)[0], cone_edges(ends[0], mu)[1]
    if not force or _cross(c, e) <= 0:
        return edges
    cosine = _dot(*ends) / root_above(_dot(ends[0], ends[0]) * _dot(ends[1], ends[1]))
    wide = root_above(2 / (1 + cosine))
    found = [edges / root_below(Fraction(1 + mu**2)) * wide]
    for v in along:
        found += [_dot(d, v) / root_below(_dot(d, d)) * wide for d in (c, e) if _dot(d, v) > 0]
        if _cross(c, v) > 0 and _cross(v, e) > 0:
            found.append(root_above(_dot(v, v)))
    return max(found)


def roughly_on_part(
    hull: list[Array], tangents: list[Array], ends: tuple[Array, Array], mu: float, force: bool, y: Array
) -> Array:
    """(m,) the same of points (m, 2), unit ``ends`` and twists (m, 3), in doubles.

    Infinite for none, and where a tangent is more than 60 degrees from m, as rounding matters more there.
    """
    size = np.hypot(*tangents[1].T)[:, None]  # by which all are divided, so that no product is too small
    tangents = [t / size for t in tangents]
    m = tangents[1]
    fine = np.all([2 * _dots(t, m) >= np.hypot(*t.T) for t in tangents], axis=0)
    along = [np.stack([y[:, 0] - y[:, 2] * p[:, 1], y[:, 1] + y[:, 2] * p[:, 0]], axis=1) for p in hull]
    ahead, aside, speed = np.zeros((3, 6, len(y)))
    for r, k, i, often in _BINOMIALS:
        ahead[r] += often * _crosses(tangents[i], along[k])
        aside[r] += often * _dots(tangents[i], along[k])
        speed[r] += often * _dots(tangents[i], m)
    most = np.maximum(((ahead + mu * np.abs(aside)) / speed).max(axis=0), 0.0)
    if force:
        slant = np.hypot(1, mu)
        first, last = ends
        c = np.stack([mu * last[:, 0] - last[:, 1], mu * last[:, 1] + last[:, 0]], axis=1) / slant
        e = np.stack([-mu * first[:, 0] - first[:, 1], first[:, 0] - mu * first[:, 1]], axis=1) / slant
        wide = np.sqrt(2 / (1 + _dots(first, last)))
        common = wide * most / slant
        for v in along:
            inside = (_crosses(c, v) > 0) & (_crosses(v, e) > 0)
            both = wide * np.maximum(_dots(c, v), _dots(e, v))
            common = np.max([common, both, np.where(inside, np.hypot(*v.T), 0.0)], axis=0)
        most = np.where(_crosses(c, e) > 0, common, most)
    return np.asarray(np.where(fine, most, np.inf))


def _dot(a: Point, b: Point) -> Fraction:
    return a[0] * b[0] + a[1] * b[1]


def _cross(a: Point, b: Point) -> Fraction:
    return a[0] * b[1] - a[1] * b[0]


def _dots(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1])


def _crosses(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
