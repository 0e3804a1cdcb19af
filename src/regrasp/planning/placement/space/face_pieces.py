"""Convex pieces of flat faces around points: a polygon around a disc, cut where the face ends."""

from dataclasses import dataclass
from math import cos, pi

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mesh.mesh import Mesh

_FLAT = 1e-9  # of normals, and of the reach: faces of one plane
_ON_FACE = 1e-6  # of the reach: farther from every face a contact is on none
_AT_EDGE = 1e-9  # of the reach: a contact on an edge, which has two normals


@dataclass(frozen=True)
class FacePlace:
    """A point of a flat face, and where the face ends.

    Args:
        point: relative to the centre of mass [m].
        axes: (2, 3) along the face; the first points to the nearest end.
        ends: (s, 2, 2) edges at which the face ends, along ``axes`` from the point [m].
    """

    point: Array
    axes: Array
    ends: Array

    def piece(self, radius: float, sides: int) -> Array:
        """(m, 3) corners of a convex polygon on the face.

        It holds the disc of ``radius`` [m] but for what is behind lines through the nearest points of edges.
        """
        turns = (2 * np.arange(sides) + 1) * pi / sides
        polygon = radius / cos(pi / sides) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        nearest = _nearest(self.ends)
        away = np.hypot(*nearest.T)
        for k in np.argsort(away, kind="stable"):
            if away[k] >= np.hypot(*polygon.T).max():
                break
            if _meet(polygon, self.ends[k]):
                polygon = _cut(polygon, nearest[k] / away[k], float(away[k]))
        result: Array = self.point + polygon @ self.axes
        return result


def place_on(mesh: Mesh, contact: Contact) -> FacePlace:
    """Where a contact is on a face, by point and normal. ``InvalidInput`` for one on none, or on an edge."""
    points, faces = mesh.surface()
    corners = points[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = -cross / np.linalg.norm(cross, axis=1)[:, None]
    reach = float(np.linalg.norm(points, axis=1).max())
    height = ((corners[:, 0] - contact.position) * normals).sum(axis=1)
    facing = np.linalg.norm(normals - contact.normal, axis=1) <= _ON_FACE
    members = np.flatnonzero(facing & (np.abs(height) <= _ON_FACE * reach))
    inside = [k for k in members if _inside(corners[k], normals[k], contact.position, reach)]
    if not inside:
        raise InvalidInput(f"contact {contact.name} is on no flat face of the mesh, with its inward normal")
    on = inside[0]
    n = normals[on]
    flat = members[np.linalg.norm(normals[members] - n, axis=1) <= _FLAT]
    point = contact.position + height[on] * n
    edges = np.concatenate([faces[flat][:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    ends = points[edges[first[count == 1]]] - point
    u = np.cross(n, np.eye(3)[np.argmin(abs(n))])
    axes = np.stack([u / np.linalg.norm(u), np.cross(n, u / np.linalg.norm(u))])
    nearest = _nearest(ends @ axes.T)
    away = np.hypot(*nearest.T)
    if away.min() <= _AT_EDGE * reach:
        raise InvalidInput(f"contact {contact.name} is on an edge of its face; give one away from edges")
    towards = nearest[away.argmin()] / away.min()
    axes = np.stack([towards, [-towards[1], towards[0]]]) @ axes
    return FacePlace(point, axes, ends @ axes.T)


def _inside(corners: Array, normal: Array, point: Array, reach: float) -> bool:
    sides = np.roll(corners, -1, axis=0) - corners
    turns = -(np.cross(sides, point - corners) @ normal)
    return bool((turns >= -_ON_FACE * reach * np.linalg.norm(sides, axis=1)).all())


def _nearest(ends: Array) -> Array:
    """(s, 2) the points of segments (s, 2, 2) that are nearest to the origin."""
    way = ends[:, 1] - ends[:, 0]
    share = np.clip(-(ends[:, 0] * way).sum(axis=1) / (way**2).sum(axis=1), 0.0, 1.0)
    result: Array = ends[:, 0] + share[:, None] * way
    return result


def _meet(polygon: Array, segment: Array) -> bool:
    """Whether a segment has points within a convex polygon, whose corners run counter-clockwise."""
    sides = np.roll(polygon, -1, axis=0) - polygon
    out = np.stack([sides[:, 1], -sides[:, 0]], axis=1)
    a = ((segment[0] - polygon) * out).sum(axis=1)
    b = ((segment[1] - polygon) * out).sum(axis=1)
    enters, leaves = 0.0, 1.0
    for before, after in zip(a, b, strict=True):
        if before >= 0 and after >= 0:
            return False
        if before > 0:
            enters = max(enters, before / (before - after))
        elif after > 0:
            leaves = min(leaves, before / (before - after))
    return bool(enters < leaves)


def _cut(polygon: Array, towards: Array, height: float) -> Array:
    """What of a convex polygon is not farther than ``height`` along a unit vector."""
    beyond = polygon @ towards - height
    kept = []
    for p, q, a, b in zip(polygon, np.roll(polygon, -1, axis=0), beyond, np.roll(beyond, -1), strict=True):
        if a <= 0:
            kept.append(p)
        if a * b < 0:
            kept.append(p + a / (a - b) * (q - p))
    return np.array(kept)
