"""Edges of a triangle mesh: closed, of one body, wound one way."""

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import numbers
from regrasp.mesh.arrays import Indices


def twins(faces: Indices) -> Indices:
    """(3 m / 2, 2) the half-edges that are one edge of a closed mesh.

    Half-edge 3 f + k runs in face f from its corner k to the next.
    """
    return np.argsort(_edges(faces), kind="stable").reshape(-1, 2)


def one_body(vertices: Array, faces: Indices) -> Indices:
    """The faces (m, 3) of a closed surface of one body, wound the way of the first.

    Raises ``InvalidInput`` where an edge belongs to one face only or to more than two, for several bodies
    and for a surface that has one side only.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _check_closed(vertices, faces)
    first, second = twins(faces).T
    f, g, m = first // 3, second // 3, len(faces)
    start = faces.ravel()
    # Two copies of every face, as given and turned over (f and f + m); faces that agree are linked.
    against = np.where(start[first] == start[second], m, 0)
    rows, columns = np.concatenate([f, f + m]), np.concatenate([g + against, g + m - against])
    links = coo_array((np.ones(rows.size), (rows, columns)), shape=(2 * m, 2 * m))
    sheets = connected_components(links, directed=False)[1]
    if (sheets[:m] == sheets[m:]).any():
        raise InvalidInput("the surface has one side only, like a Möbius strip: it bounds no object")
    bodies = np.unique(np.minimum(sheets[:m], sheets[m:]), return_index=True)[1]
    if bodies.size > 1:
        a, b = (numbers(vertices[faces[face, 0]]) for face in bodies[:2])
        raise InvalidInput(
            f"there are {bodies.size} closed surfaces, apart from one another: two pass through {a} and {b}; "
            "a mesh is one object without cavities: keep one, or unite them"
        )
    turned = sheets[:m] != sheets[0]
    return np.where(turned[:, None], faces[:, [0, 2, 1]], faces)


def _edges(faces: Indices) -> Indices:
    """(3 m,) a number for each half-edge, the same for both directions."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    result: Indices = np.minimum(start, end) * (int(faces.max()) + 1) + np.maximum(start, end)
    return result


def _check_closed(vertices: Array, faces: Indices) -> None:
    _, first, count = np.unique(_edges(faces), return_index=True, return_counts=True)
    open_edges, crowded = first[count == 1], first[count > 2]
    if open_edges.size:
        ends = np.stack([faces.ravel(), np.roll(faces, -1, axis=1).ravel()], axis=1)[open_edges]
        a, b = (numbers(vertices[v]) for v in ends[0])
        holes = _rings(ends)
        raise InvalidInput(
            f"the mesh is not watertight: {_plural(open_edges.size, 'open edge')} around "
            f"{_plural(holes, 'hole')}, one from {a} to {b}; close it, since an open surface has no volume"
        )
    if crowded.size:
        a, b = (
            numbers(vertices[faces.ravel()[crowded[0]]]),
            numbers(vertices[np.roll(faces, -1, axis=1).ravel()[crowded[0]]]),
        )
        raise InvalidInput(
            f"{_plural(crowded.size, 'edge')} of more than two faces, one from {a} to {b}; "
            "bodies that touch there, or faces given twice?"
        )


def _rings(ends: NDArray[np.int64]) -> int:
    """How many connected pieces edges (k, 2) make."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, local = np.unique(ends, return_inverse=True)
    i, j = local.reshape(-1, 2).T
    return int(connected_components(coo_array((np.ones(i.size), (i, j)), shape=(local.max() + 1,) * 2))[0])


def _plural(count: int, what: str) -> str:
    return f"{count} {what}" + "s" * (count != 1)
