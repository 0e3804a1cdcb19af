"""Triangles of simple solids: boxes, balls, plates and bodies of revolution."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, array
from regrasp.mesh.arrays import Indices

Triangles = tuple[Array, Indices]


def box(a: float, b: float, c: float) -> Triangles:
    """Of sides a, b, c about the origin [m]; vertex 4 x + 2 y + z is at the far side where x, y, z are 1."""
    ends = np.array([-0.5, 0.5])
    vertices = np.stack(np.meshgrid(a * ends, b * ends, c * ends, indexing="ij"), axis=-1).reshape(-1, 3)
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return vertices, np.array([(p, q, r) for w, x, y, z in sides for p, q, r in ((w, x, y), (w, y, z))])


def ball(radius: float, divisions: int) -> Triangles:
    """An icosahedron whose faces are divided into ``divisions``^2 each, its vertices moved to the sphere."""
    g = (1 + np.sqrt(5)) / 2
    tips = np.array([v for s in (-1, 1) for t in (-g, g) for v in ((0, s, t), (s, t, 0), (t, 0, s))])
    near = np.linalg.norm(tips[:, None] - tips, axis=2) < 2.1  # edges are 2 long
    icosahedron = [
        (i, j, k)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    # Row by row within a face: sums of its corners with whole weights that add up to ``divisions``; equal
    # sums, on edges and corners, are equal to the bit when the corners come in one order.
    rows = [[(divisions - i, i - j, j) for j in range(i + 1)] for i in range(divisions + 1)]
    number = {weights: n for n, weights in enumerate(w for row in rows for w in row)}
    small = [[number[w] for w in (rows[i][j], rows[i + 1][j], rows[i + 1][j + 1])]
             for i in range(divisions) for j in range(i + 1)]  # fmt: skip
    small += [[number[w] for w in (rows[i][j], rows[i + 1][j + 1], rows[i][j + 1])]
              for i in range(1, divisions) for j in range(i)]  # fmt: skip
    weights = np.array(list(number), dtype=float)
    vertices = np.concatenate([(weights[..., None] * tips[list(face)]).sum(axis=1) for face in icosahedron])
    faces = np.concatenate([np.array(small) + i * len(weights) for i in range(len(icosahedron))])
    return radius * vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def plate(rings: Sequence[Array], height: float) -> Triangles:
    """Between z = 0 and ``height``: rings (k, 2) counter-clockwise, the outer one first, then holes."""
    flat, triangles = np.concatenate(rings), polygon_triangles(rings)
    n = len(flat)
    vertices = np.concatenate([np.column_stack([flat, np.full(n, z)]) for z in (0.0, height)])
    walls = strips(rings)
    return vertices, np.concatenate([triangles[:, ::-1], triangles + n, *walls])


def strips(rings: Sequence[Array]) -> list[Indices]:
    """The walls between rings numbered one after another and the same rings numbered after them all."""
    n, begin, result = sum(map(len, rings)), 0, []
    for ring in rings:
        i = begin + np.arange(len(ring))
        j = begin + (np.arange(len(ring)) + 1) % len(ring)
        walls = np.concatenate([np.stack([i, j, j + n], axis=1), np.stack([i, j + n, i + n], axis=1)])
        result.append(walls if begin == 0 else walls[:, ::-1])
        begin += len(ring)
    return result


def polygon_triangles(rings: Sequence[Array]) -> Indices:
    """(m, 3) the polygon of an outer ring and holes as triangles, counter-clockwise, of their vertices."""
    import shapely

    flat = np.concatenate(rings)
    origin, size = flat.min(axis=0), float(np.ptp(flat, axis=0).max())
    unit = [(ring - origin) / size for ring in rings]
    number = {(float(x), float(y)): i for i, (x, y) in enumerate(np.concatenate(unit))}
    found: Any = shapely.constrained_delaunay_triangles(shapely.Polygon(unit[0], unit[1:]))
    corners = [[number[x, y] for x, y in piece.exterior.coords[:3]] for piece in found.geoms]
    triangles = np.array(corners, dtype=np.int64)
    a, b, c = flat[triangles].transpose(1, 0, 2)
    e, g = b - a, c - a
    clockwise = e[:, 0] * g[:, 1] < e[:, 1] * g[:, 0]
    return np.where(clockwise[:, None], triangles[:, ::-1], triangles)


def revolution(profile: ArrayLike, segments: int) -> Triangles:
    """A profile (k, 2) of radius and z about the z axis."""
    from regrasp.outline.region import checked_region, checked_ring

    given = array(profile, "profile", (None, 2))
    if len(given) < 3 or given[0, 0] != 0 or given[-1, 0] != 0 or (given[1:-1, 0] <= 0).any():
        raise InvalidInput(
            "profile must begin and end on the axis, with radius 0, and have radii above 0 in between; "
            f"got radii {given[:, 0]}"
        )
    checked_region(checked_ring(given, "profile"), "profile")
    angle = np.arange(segments) * 2 * np.pi / segments
    (r, z), k = given[1:-1].T, len(given) - 2
    around = np.stack([np.cos(angle), np.sin(angle), np.ones(segments)], axis=1)
    rings = (np.stack([r, r, z], axis=1)[:, None] * around).reshape(-1, 3)
    vertices = np.concatenate([rings, [[0, 0, given[0, 1]], [0, 0, given[-1, 1]]]])
    i = np.arange(segments)
    j, foot, head = (i + 1) % segments, np.full(segments, k * segments), np.full(segments, k * segments + 1)
    last = (k - 1) * segments
    faces = [np.stack([foot, j, i], axis=1), np.stack([head, last + i, last + j], axis=1)]
    for ring in range(0, last, segments):
        a, b, c, d = ring + i, ring + j, ring + segments + i, ring + segments + j
        faces += [np.stack([a, b, d], axis=1), np.stack([a, d, c], axis=1)]
    return vertices, np.concatenate(faces)
