"""That polygons are on flat faces of a mesh, around their places, and as wide as they are said to be."""

from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.verification.placed.meshes.surfaces import away

_ROUNDING = 2.0**-46  # of the reach: how uneven a polygon may be, or its corners in one line
_INSIDE = 1e-12  # of the reach: by less an edge is not within a polygon
_CLOSE = 1e-9  # of the reach: a polygon is on a face; of normals: faces are in one plane


def polygon_wrong(vertices: Array, faces: Any, contact: Contact, patch: Array, radius: float) -> list[str]:
    """What is wrong with the polygon (m, 3) of a finger that may be ``radius`` off, in words.

    Args:
        vertices: (v, 3) of the mesh [m].
        faces: (t, 3) its triangles.
        contact: in the middle of the polygon.
        patch: the corners one after the other, or one point alone [m].
        radius: how far off in all directions, but for what is behind lines through the nearest points of
            edges at which the face ends [m].
    """
    name, n, r = contact.name, contact.normal, contact.position
    reach = float(np.linalg.norm(vertices, axis=1).max())
    flat = _flat(vertices[faces], contact, reach)
    is_on = bool((away(vertices[faces[flat]], r) <= _CLOSE * reach).any())
    if len(patch) < 3:
        if radius != 0 or not np.abs(patch - r).max() <= _CLOSE * reach:
            return [f"{name} has no polygon"]
        return [] if is_on else [f"{name} is on no face with its normal"]
    sides = np.roll(patch, -1, axis=0) - patch
    lengths = np.linalg.norm(sides, axis=1)
    if (lengths == 0).any():
        return [f"the polygon of {name} is not convex"]
    out = np.cross(sides, n) / lengths[:, None]
    out *= np.sign((np.cross(patch, sides) @ n).sum())  # outwards, whichever way the corners run
    if ((patch[:, None] - patch) * out).sum(axis=2).max() > _ROUNDING * reach:
        return [f"the polygon of {name} is not convex"]
    heights = ((patch - r) * out).sum(axis=1)
    up = (patch - r) @ n
    if not heights.min() > _INSIDE * reach or np.abs(up).max() > _CLOSE * reach:
        return [f"the polygon of {name} is not around its place"]
    if np.ptp(up) > _ROUNDING * reach:
        return [f"the polygon of {name} is not flat"]
    ends = vertices[_ends(faces[flat])]
    if not is_on or _within(ends, patch, out, reach).any():
        return [f"the polygon of {name} is not on faces with its normal"]
    feet = (r + heights[:, None] * out)[heights < radius * (1 - _CLOSE)]
    far = np.linalg.norm(_nearest(ends, r) - feet[:, None], axis=2)
    if not (far <= _CLOSE * reach).any(axis=1).all():
        return [f"the polygon of {name} is narrower than its radius, and its face does not end there"]
    return []


def _flat(corners: Array, contact: Contact, reach: float) -> np.ndarray:
    """(t,) which triangles are in the plane of a contact, with its normal."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned = cross / np.linalg.norm(cross, axis=1)[:, None] + contact.normal
    height = np.abs((corners[:, 0] - contact.position) @ contact.normal)
    result: np.ndarray = (np.linalg.norm(turned, axis=1) <= _CLOSE) & (height <= _CLOSE * reach)
    return result


def _ends(faces: np.ndarray) -> np.ndarray:
    """(e, 2) edges of one triangle alone: beyond them their plane does not go on."""
    edges = np.sort(np.concatenate([faces[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]), axis=1)
    each, count = np.unique(edges, axis=0, return_counts=True)
    return np.asarray(each[count == 1])


def _within(ends: Array, patch: Array, out: Array, reach: float) -> np.ndarray:
    """(e,) which edges (e, 2, 3) pass through a convex polygon: a part of them is inside of all its sides.

    Along each way some sides are neared and some left, so that parts begin at 0 and end at 1 at the most.
    """
    a, b = np.moveaxis(((ends[:, :, None] - patch) * out).sum(axis=3) + _INSIDE * reach, 1, 0)
    fall = a - b
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a / fall
    never = (fall == 0) & (a >= 0)
    enters = np.where(never, np.inf, np.where(fall > 0, at, 0.0)).max(axis=1)
    leaves = np.where(fall < 0, at, 1.0).min(axis=1)
    return np.asarray(enters < leaves)


def _nearest(ends: Array, point: Array) -> Array:
    """(e, 3) the point of each edge (e, 2, 3) that is nearest to a point."""
    p, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    share = np.clip(((point - p) * way).sum(axis=1) / (way**2).sum(axis=1), 0.0, 1.0)
    result: Array = p + share[:, None] * way
    return result
