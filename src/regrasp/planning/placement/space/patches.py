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
        balls: (p, 9) the middle of each, how far its corners are from there [m], an axis, and cosine and sine
            of the widest angle of a normal to it.
        order: (m,) which triangle comes at each place.
    """

    rows: Array
    spans: np.ndarray
    tree: np.ndarray
    radius: Array
    balls: Array
    order: np.ndarray


def patches_of(corners: Array, normals: Array) -> Patches:
    """Of triangles (m, 3, 3), or points as triangles of no size, whose inward normals are (m, 3)."""
    m = len(corners)
    reach = float(np.abs(corners).max()) or 1.0
    features = np.concatenate([corners.mean(axis=1) / reach, _FACING * normals], axis=1)
    order = np.arange(m)
    spans, tree, deep, waiting = [(0, m)], [[-1, -1, -1]], [0], [0]
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
            deep.append(deep[patch] + 1)
            spans.append(half)
            tree.append([-1, -1, -1])
    rows = np.concatenate([corners[order], np.repeat(normals[order][:, None], 3, axis=1)], axis=2)
    rows, some = rows.reshape(-1, 6), 3 * (np.array(spans) @ [[1, -1], [0, 1]])
    radius, balls = _around(rows, some, np.array(deep))
    return Patches(rows, some, np.array(tree), radius, balls, order)


def _around(rows: Array, spans: np.ndarray, deep: np.ndarray) -> tuple[Array, Array]:
    """Half of the largest side of the box around each patch, and its ball."""
    radius, balls = np.zeros(len(spans)), np.zeros((len(spans), 9))
    for depth in range(int(deep.max()) + 1):  # patches of one depth have no row in common
        these = np.flatnonzero(deep == depth)
        these = these[np.argsort(spans[these, 0])]
        starts, counts = np.cumsum([0, *spans[these[:-1], 1]]), spans[these, 1]
        own = np.repeat(np.arange(len(these)), counts)
        part = rows[np.arange(len(own)) + (spans[these, 0] - starts)[own]]
        least, most = (end.reduceat(part[:, :3], starts) for end in (np.minimum, np.maximum))
        axes = np.add.reduceat(part[:, 3:], starts)
        lengths = np.linalg.norm(axes, axis=1)
        axes = np.where(lengths[:, None] > 0, axes / np.where(lengths > 0, lengths, 1)[:, None], [1.0, 0, 0])
        centres = (least + most) / 2
        away = np.linalg.norm(part[:, :3] - centres[own], axis=1)
        cosines = np.minimum.reduceat((part[:, 3:] * axes[own]).sum(axis=1), starts)
        cosines = np.where(cosines > 0, np.minimum(cosines, 1.0), -1.0)  # of no narrow cone: any normal
        radius[these] = (most - least).max(axis=1) / 2
        sines = np.sqrt(1 - cosines**2)
        balls[these] = np.column_stack([centres, np.maximum.reduceat(away, starts), axes, cosines, sines])
    return radius, balls
