"""The map of holds as polygons: where on two sides two fingers hold a force through the centre of mass.

Axes are across the load (x) and against it (y), u = -F / |F|, d = P_2 - P_1 with d_x > 0. With h = f_1x the
balance of forces and torques gives

    f_1 d_x = (h d_x, x_2 + h d_y),     f_2 d_x = (-h d_x, -x_1 - h d_y).

A force is limited by half planes, a . f_1 >= a_0 and b . f_2 >= b_0: the edges of its cone (a_0 = 0), a least
normal force, tangents around a force limit. These are, with A = a . d and B = b . d affine in both places,

    finger 1:  a_y x_2 - a_0 d_x + h A >= 0,      finger 2:  -b_y x_1 - b_0 d_x - h B >= 0.

Once the signs of A and B are given each of them bounds h from one side, and an h exists where every lower
bound is below every upper one. Cleared of denominators and of d_x > 0, these are affine again:

    A_1 > 0 > A_2:  a_10 A_2 - a_20 A_1 + x_2 (a_1 x a_2) >= 0,
    B_1 < 0 < B_2:  b_20 B_1 - b_10 B_2 + x_1 (b_1 x b_2) >= 0,
    A, B > 0:  a_y b_y d_y + a_y b_x x_2 - b_y a_x x_1 - b_0 A - a_0 B >= 0,      A, B < 0:  the same <= 0.

So every sign pattern is a convex polygon, and no two of them overlap. Half planes join one after the other,
and whatever is empty by then is left.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from regrasp.mechanics.checks import Array

Number = float  # or a Fraction: nothing below but the axes takes a root
Point = tuple[Number, Number]
Polygon = list[Point]
Affine = tuple[Number, Number, Number]
"""c, and its rates by the first and the second place, fractions of the sides."""
Row = tuple[Point, Number]
"""A half plane a . f >= a_0 of forces, by a and a_0."""
Side = tuple[Point, Point, tuple[Row, ...]]
"""Where a side begins, the vector along it, and half planes of a finger's force, in the axes above."""

WHOLE: Polygon = [(0, 0), (1, 0), (1, 1), (0, 1)]


def hold_polygons(one: Side, other: Side, least_width: Number) -> list[Polygon]:
    """Convex polygons in the fractions (f, g) of two sides, those less wide left out."""
    found = _right_of(one, other)
    if one is not other:  # of one side with itself the other half is the mirror image
        found += [[(g, f) for f, g in reversed(polygon)] for polygon in _right_of(other, one)]
    return [polygon for polygon in found if width(polygon) > least_width]


def sides_across(
    vertices: Array,
    friction: Number,
    force: Sequence[Number],
    more: Callable[[Point], Sequence[Row]] = lambda along: (),
) -> list[Side]:
    """All sides of a polygon in the axes of a force, whose length only scales them.

    more: half planes besides the cone, for the vector along a side, with forces in units of the load's.
    """
    fx, fy = force

    def turned(p: Point) -> Point:
        return p[1] * fx - p[0] * fy, -p[0] * fx - p[1] * fy

    points = [turned((x, y)) for x, y in vertices.tolist()]
    result = []
    for (px, py), (qx, qy) in zip(points, [*points[1:], points[0]], strict=True):
        along = qx - px, qy - py
        nx, ny = -along[1], along[0]  # into the object
        edges = [((friction * nx + s * along[0], friction * ny + s * along[1]), 0) for s in (1, -1)]
        result.append(((px, py), along, (*edges, *more(along))))
    return result


def _right_of(one: Side, other: Side) -> list[Polygon]:
    """Where the second finger is to the right of the first, d_x > 0."""
    (px, py), (ax, ay), a = one
    (qx, qy), (bx, by), b = other
    at = _At((px, ax, 0), (qx, 0, bx), (qx - px, -ax, bx), (qy - py, -ay, by))
    right = clipped(WHOLE, at.dx)
    parts: list[tuple[Polygon, list[_Bound]]] = [(right, [])] if right else []
    for finger, row in [
        (k, rows[m]) for m in range(max(len(a), len(b))) for k, rows in ((1, a), (2, b)) if m < len(rows)
    ]:
        lever = at.lever(row)
        parts = [
            (polygon, [*before, bound])
            for part, before in parts
            for bound in (_Bound(finger, 1, row, lever), _Bound(finger, -1, row, lever))
            if (polygon := at.within(part, before, bound))
        ]
    return [polygon for polygon, _ in parts]


class _Bound(NamedTuple):
    """A half plane of a finger's force where its lever A or B has a sign."""

    finger: int
    sign: int
    row: Row
    lever: Affine

    @property
    def is_lower(self) -> bool:
        return (self.sign > 0) == (self.finger == 1)


class _At(NamedTuple):
    """Where both fingers are, all affine in their places."""

    x1: Affine
    x2: Affine
    dx: Affine
    dy: Affine

    def lever(self, row: Row) -> Affine:
        return _mix((row[0][0], self.dx), (row[0][1], self.dy))

    def within(self, polygon: Polygon, before: list[_Bound], bound: _Bound) -> Polygon:
        """The part of a polygon where a bound holds beside those before it; empty for none."""
        (_, ny), least = bound.row
        if not any(bound.lever):  # a condition without h, once and not for either sign
            x, s = (self.x2, 1) if bound.finger == 1 else (self.x1, -1)
            return clipped(polygon, _mix((s * ny, x), (-least, self.dx))) if bound.sign > 0 else []
        polygon = clipped(polygon, _mix((bound.sign, bound.lever)))
        for known in before:
            if not polygon:
                break
            if any(known.lever) and known.is_lower != bound.is_lower:
                lower, upper = (known, bound) if known.is_lower else (bound, known)
                polygon = clipped(polygon, self.between(lower, upper))
        return polygon

    def between(self, lower: _Bound, upper: _Bound) -> Affine:
        """What is not negative where a lower bound of h is below an upper one, cleared of d_x."""
        (n, c), (w, d) = lower.row, upper.row
        if lower.finger == upper.finger == 1:
            return _mix((c, upper.lever), (-d, lower.lever), (_cross(n, w), self.x2))
        if lower.finger == upper.finger:
            return _mix((d, lower.lever), (-c, upper.lever), (_cross(n, w), self.x1))
        s = 1 if lower.finger == 1 else -1
        one, other = (lower, upper) if lower.finger == 1 else (upper, lower)
        ((nx, ny), c), ((wx, wy), d) = one.row, other.row
        return _mix(
            (s * ny * wy, self.dy),
            (s * ny * wx, self.x2),
            (-s * wy * nx, self.x1),
            (-s * d, one.lever),
            (-s * c, other.lever),
        )


def clipped(polygon: Polygon, value: Affine) -> Polygon:
    """The part of a convex polygon where an affine function is not negative; empty without one inside."""
    c, cf, cg = value
    values = [c + cf * f + cg * g for f, g in polygon]
    if all(v >= 0 for v in values):
        return polygon if any(v > 0 for v in values) else []
    if all(v <= 0 for v in values):
        return []
    result = []
    for k, (p, v) in enumerate(zip(polygon, values, strict=True)):
        q, w = polygon[k - 1], values[k - 1]
        if (v > 0 > w) or (v < 0 < w):
            t = w / (w - v)
            result.append((q[0] + t * (p[0] - q[0]), q[1] + t * (p[1] - q[1])))
        if v >= 0:
            result.append(p)
    return result


def area(polygon: Polygon) -> Number:
    """Of a polygon that runs counter-clockwise."""
    return (
        sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(polygon, [*polygon[1:], polygon[0]], strict=True)) / 2
    )


def width(polygon: Polygon) -> Number:
    """The area over both sides of the box around it, which is below the width of a strip; 0 of a point."""
    f, g = [p[0] for p in polygon], [p[1] for p in polygon]
    around = max(f) - min(f) + max(g) - min(g)
    return area(polygon) / around if around > 0 else around


def _mix(*terms: tuple[Number, Affine]) -> Affine:
    c, cf, cg = (sum(weight * value[k] for weight, value in terms) for k in range(3))
    return c, cf, cg


def _cross(a: Point, b: Point) -> Number:
    return a[0] * b[1] - a[1] * b[0]
