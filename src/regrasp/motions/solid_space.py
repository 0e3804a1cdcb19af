"""Where the centre of a fingertip may be in space, and short ways there."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mesh.closest import at, touching
from regrasp.mesh.mesh import Mesh
from regrasp.motions.bounds import Distance, keeps, least, segments
from regrasp.motions.geometry.apart import apart
from regrasp.motions.geometry.tightening import tightened
from regrasp.motions.roadmap import Roadmap

_ROOM = 1 / 4  # of the clearance, kept besides it for roundings of corners
_FINE = 1e-3  # of the clearance: a tip that touches may be inside the object by as much
_TOLD = 1 / 50  # of the clearance: how far below the true gaps those told are, and what is kept for that
_FINEST = 1 / 16  # of the room: pieces of ways that are no longer are not halved
_TOGETHER = 64  # points for which faces that are far from all of them are left out


@dataclass(frozen=True)
class SolidSpace:
    """The space around an object for tips of a radius that keep a clearance [m], in the object's frame.

    body: (m, 3, 3) triangles of the object. capsule: (3,) from the tip's centre to the capsule's other end,
    zero for a sphere [m]. faces: (k, 3, 3) what the tip's centre keeps away from: the object's triangles, and
    of a capsule those swept back by it; the first ``outward`` are wound counter-clockwise seen from outside.
    """

    body: Array
    faces: Array
    outward: int
    tip_radius: float
    clearance: float
    capsule: Array

    @classmethod
    def around(cls, mesh: Mesh, tip_radius: float, clearance: float, capsule: Array) -> "SolidSpace":
        """That of a mesh, taken as it is: a smooth one, too, is the polyhedron of its faces."""
        vertices, faces = mesh.surface()
        body = soup = vertices[faces]
        outward = len(body)
        if capsule.any():
            sides = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
            a, b = vertices[sides].transpose(1, 0, 2)
            swept = [np.stack([a, b, a - capsule], axis=1), np.stack([b - capsule, a - capsule, b], axis=1)]
            area = np.linalg.norm(np.cross(b - a, capsule), axis=1)
            long = area > 1e-12 * np.linalg.norm(b - a, axis=1) * np.linalg.norm(capsule)
            soup, outward = np.concatenate([body, body - capsule, *(s[long] for s in swept)]), 2 * len(body)
        return cls(body, soup, outward, tip_radius, clearance, capsule)

    @property
    def reach(self) -> float:
        """How far a tip's centre keeps from the faces [m]."""
        return self.tip_radius + self.clearance

    @property
    def apart(self) -> float:
        """How far the axes of two fingers keep [m]."""
        return 2 * self.tip_radius + self.clearance

    @property
    def room(self) -> float:
        """What is kept besides [m]."""
        return _ROOM * self.clearance

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        return self.faces.min(axis=1), self.faces.max(axis=1)

    def distance(self, points: Array) -> Array:
        """(m,) of points (m, 3) from the nearest face [m]; points next to one another are quick together."""
        result = np.empty(len(points))
        low, high = self._bounds
        slack = 1e-9 * self.reach
        for begin in range(0, len(points), _TOGETHER):
            p = points[begin : begin + _TOGETHER]
            centre = p.mean(axis=0)
            wide = float(np.linalg.norm(p - centre, axis=1).max())
            box = np.linalg.norm(np.maximum(np.maximum(low - centre, centre - high), 0.0), axis=1)
            corner = float(np.linalg.norm(self.faces[:, 0] - centre, axis=1).min())
            near = self.faces[box <= corner + 2 * wide + slack]
            i, f, w = touching(p, near, slack)
            away = np.linalg.norm(p[i] - at(near[f], w), axis=1)
            result[begin : begin + len(p)] = np.minimum.reduceat(away, np.searchsorted(i, np.arange(len(p))))
        return result

    def cuts(self, rising: Array, contact: Contact) -> bool:
        """Whether a tip that lifts off a contact along centres (m, 3) is inside the object on its way.

        Normals of a smooth mesh lean against its faces, into which a tip may reach by as much.
        """
        _, near, _ = touching(contact.position[None], self.faces, 1e-9 * self.reach)
        e, g = (self.faces[near][:, k] - self.faces[near][:, 0] for k in (1, 2))
        flat = np.cross(e, g)
        lean = np.abs(flat @ contact.normal) / np.linalg.norm(flat, axis=1)
        depth = self.tip_radius * (1 - min(1.0, float(lean.min()))) + _FINE * self.clearance
        return bool(self.distance(rising).min() < self.tip_radius - depth) or self._pierces(rising[0])

    def _pierces(self, tip: Array) -> bool:
        """Whether the axis of a capsule cuts the object's faces (Moeller and Trumbore, 1997)."""
        a, e, g = self.body[:, 0], *(self.body[:, k] - self.body[:, 0] for k in (1, 2))
        across = np.cross(self.capsule, g)
        det = (e * across).sum(axis=1)
        cut = det != 0
        det[~cut] = 1.0
        turned = np.cross(tip - a, e)
        u, v = ((tip - a) * across).sum(axis=1) / det, turned @ self.capsule / det
        t = (g * turned).sum(axis=1) / det
        return bool((cut & (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)).any())

    def keeps_apart(self, piece: Array, others: Array) -> bool:
        """Whether the hull of points (k, 3), k = 2 or 3, is clear of the fingers (j, 2, 3) that stand."""
        if not len(others):
            return True
        return keeps(
            _piece(piece), self._to(others), self.apart + _TOLD * self.clearance, _FINEST * self.room
        )

    def keeps_clear(self, piece: Array, others: Array) -> bool:
        """Whether it is clear of the object, too."""
        if not keeps(_piece(piece), self.distance, self.reach + _TOLD * self.clearance, _FINEST * self.room):
            return False
        return self.keeps_apart(piece, others)

    def _to(self, others: Array) -> Distance:
        """Distances of tips' centres from what other fingers (j, 2, 3), tips and capsules, take."""

        def distance(points: Array) -> Array:
            away = apart(points[:, None], self.capsule, others[None, :, 0], others[None, :, 1])
            return np.asarray(away.min(axis=1))

        return distance

    @cached_property
    def _roadmap(self) -> Roadmap:
        return Roadmap.over(self.faces, self.outward, self.distance, self.reach, self.room)

    def way(self, start: Array, end: Array, others: Array) -> Array | None:
        """(k, 3) a short polygon between two points that keeps clear; None where the roadmap has none."""

        def clear(a: Array, b: Array) -> bool:
            return self.keeps_clear(np.array([a, b]), others)

        if clear(start, end):
            return np.array([start, end])
        to = self._to(others) if len(others) else None
        found = self._roadmap.way(start, end, to, self.apart, self._spread(others), clear)
        return None if found is None else tightened(found, clear)

    def _spread(self, others: Array) -> Array:
        """(m, 3) points around the fingers that stand, from where ways around them lead."""
        k = np.arange(40) + 0.5
        z, turn = 1 - 2 * k / k.size, np.pi * (1 + 5**0.5) * k
        ball = np.column_stack([np.cos(turn) * np.sqrt(1 - z * z), np.sin(turn) * np.sqrt(1 - z * z), z])
        ends = [p + s * v - t * self.capsule for p, v in others for s in (0, 1) for t in (0, 1)]
        if not ends:
            return np.empty((0, 3))
        return np.concatenate(
            [p + f * self.apart * ball for p in np.unique(ends, axis=0) for f in (1.2, 1.7)]
        )

    def gaps(self, free: list[Array], whole: list[Array], others: Array) -> tuple[float, float]:
        """How far the finger keeps from the object on the hulls ``free``, from others on ``whole`` [m]."""
        within = _TOLD * self.clearance
        to_object = least(np.concatenate([_piece(p) for p in free]), self.distance, within) - self.tip_radius
        if not len(others):
            return to_object, np.inf
        to_tips = least(np.concatenate([_piece(p) for p in whole]), self._to(others), within)
        return to_object, to_tips - 2 * self.tip_radius


def _piece(points: Array) -> Array:
    """(1, 3, 3) the hull of two or three points."""
    return segments(points) if len(points) == 2 else points[None]
