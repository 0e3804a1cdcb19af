"""The map of holds as polygons: where on two sides two fingers hold a force through the centre of mass.

Axes are across the load (x) and against it (y), u = -F / |F|, d = P_2 - P_1 with d_x > 0. With h = f_1x the
balance of forces and torques gives

    f_1 d_x = (h d_x, x_2 + h d_y),     f_2 d_x = (-h d_x, -x_1 - h d_y).

A cone is a . f >= 0 for its two edges' normals a, which becomes, with A = a . d affine in both places,

    finger 1:  a_y x_2 + h A >= 0,      finger 2:  -b_y x_1 - h B >= 0.

Once the signs of A and B are given each of them bounds h from one side, and an h exists where every lower
bound is below every upper one. Cleared of denominators and of d_x > 0, these are affine again:

    A_1 > 0 > A_2:  x_2 (a_1 x a_2) >= 0,      B_1 < 0 < B_2:  x_1 (b_1 x b_2) >= 0,
    A, B > 0:  a_y b_y d_y + a_y b_x x_2 - b_y a_x x_1 >= 0,      A, B < 0:  the same <= 0.

So every sign pattern is a convex polygon, and no two of them overlap.
"""

from collections.abc import Sequence
from itertools import product

from regrasp.mechanics.checks import Array

Number = float  # or a Fraction: nothing below but the axes takes a root
Point = tuple[Number, Number]
Polygon = list[Point]
Affine = tuple[Number, Number, Number]
"""c, and its rates by the first and the second place, fractions of the sides."""
Side = tuple[Point, Point, tuple[Point, Point]]
"""Where a side begins, the vector along it, and the normals of both edges of its cones, in the axes above."""

WHOLE: Polygon = [(0, 0), (1, 0), (1, 1), (0, 1)]


def hold_polygons(one: Side, other: Side, least_width: Number) -> list[Polygon]:
    """Convex polygons in the fractions (f, g) of two sides, those less wide left out."""
    found = _right_of(one, other)
    if one is not other:  # of one side with itself the other half is the mirror image
        found += [[(g, f) for f, g in reversed(polygon)] for polygon in _right_of(other, one)]
    return [polygon for polygon in found if width(polygon) > least_width]


def sides_across(vertices: Array, friction: Number, force: Sequence[Number]) -> list[Side]:
    """All sides of a polygon in the axes of a force, whose length only scales them."""
    fx, fy = force

    def turned(p: Point) -> Point:
        return p[1] * fx - p[0] * fy, -p[0] * fx - p[1] * fy

    points = [turned((x, y)) for x, y in vertices.tolist()]
    result = []
    for (px, py), (qx, qy) in zip(points, [*points[1:], points[0]], strict=True):
        along = qx - px, qy - py
        nx, ny = -along[1], along[0]  # into the object
        edges = [(friction * nx + s * along[0], friction * ny + s * along[1]) for s in (1, -1)]
        result.append(((px, py), along, (edges[0], edges[1])))
    return result


def _right_of(one: Side, other: Side) -> list[Polygon]:
    """Where the second finger is to the right of the first, d_x > 0."""
    (px, py), (ax, ay), a = one
    (qx, qy), (bx, by), b = other
    x1, x2 = (px, ax, 0), (qx, 0, bx)
    dx, dy = (qx - px, -ax, bx), (qy - py, -ay, by)
    right = clipped(WHOLE, dx)
    if not right:
        return []
    first, second = ([_mix((n[0], dx), (n[1], dy)) for n in edges] for edges in (a, b))
    parts: list[tuple[Polygon, tuple[int, ...]]] = [(right, ())]
    for value in (*first, *second):
        minus = _mix((-1, value))
        split = [(clipped(p, v), (*signs, s)) for p, signs in parts for v, s in ((value, 1), (minus, -1))]
        parts = [(p, signs) for p, signs in split if p]
    found = []
    for polygon, signs in parts:
        rows = []
        if signs[0] != signs[1]:
            rows.append(_mix((signs[0] * _cross(*a), x2)))
        if signs[2] != signs[3]:
            rows.append(_mix((-signs[2] * _cross(*b), x1)))
        for (k, n), (m, w) in product(enumerate(a), enumerate(b)):
            if signs[k] == signs[2 + m]:
                s = signs[k]
                rows.append(_mix((s * n[1] * w[1], dy), (s * n[1] * w[0], x2), (-s * w[1] * n[0], x1)))
        for row in rows:
            polygon = clipped(polygon, row)
        if polygon:
            found.append(polygon)
    return found


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
