"""A surface in patches: triangles, halved again and again into groups that lie and face alike."""

from dataclasses import dataclass

import numpy as np

from regrasp.mechanics.checks import Array

_FACING = 0.5  # what a normal's difference counts, where the surface's reach is 1


@dataclass(frozen=True)
class Patches:
    """A tree of patches of a surface. Patch 0 is all of it.

    Args:
        rows: (3 m, 6) corners in the order of the patches, and inward normals.
        spans: (p, 2) first row and number of rows of each.
        tree: (p, 3) the two halves of each, -1 for none, and -1.
        radius: (p,) half of the largest side of the box around each [m].
        order: (m,) which triangle comes at each place.
    """

    rows: Array
    spans: np.ndarray
    tree: np.ndarray
    radius: Array
    order: np.ndarray


def patches_of(corners: Array, normals: Array) -> Patches:
    """Of triangles (m, 3, 3), or points as triangles of no size, whose inward normals are (m, 3)."""
    m = len(corners)
    reach = float(np.abs(corners).max()) or 1.0
    features = np.concatenate([corners.mean(axis=1) / reach, _FACING * normals], axis=1)
    order = np.arange(m)
    spans, tree, waiting = [(0, m)], [[-1, -1, -1]], [0]
    while waiting:
        patch = waiting.pop()
        lo, hi = spans[patch]
        if hi - lo == 1:
            continue
        members = order[lo:hi]
        widest = int(np.ptp(features[members], axis=0).argmax())
        members = members[np.argsort(features[members, widest], kind="stable")]
        order[lo:hi] = members
        # at the widest gap near the middle, so that faces of one side stay together
        values = features[members, widest]
        inner = np.arange(max((hi - lo) // 4, 1), max(-(-3 * (hi - lo) // 4), 2))
        cut = lo + int(inner[np.argmax(values[inner] - values[inner - 1])])
        for half in ((lo, cut), (cut, hi)):
            tree[patch][0 if half[0] == lo else 1] = len(spans)
            waiting.append(len(spans))
            spans.append(half)
            tree.append([-1, -1, -1])
    points = corners[order]
    radius = [0.5 * float(np.ptp(points[lo:hi].reshape(-1, 3), axis=0).max()) for lo, hi in spans]
    rows = np.concatenate([points, np.repeat(normals[order][:, None], 3, axis=1)], axis=2).reshape(-1, 6)
    return Patches(rows, 3 * (np.array(spans) @ [[1, -1], [0, 1]]), np.array(tree), np.array(radius), order)
