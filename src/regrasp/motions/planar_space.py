"""Where the centre of a fingertip may be in the plane, and shortest ways there."""

from dataclasses import dataclass
from functools import cached_property
from math import cos, pi
from typing import Any

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.outline.outline import Outline

_ARC = 6  # chords of a quarter of a circle
_ROOM = 1 / 4  # of the clearance, kept besides it for roundings of corners
_FINE = 1e-4  # the same where a tip touches
_CHORD = 1 / 20  # of the clearance: how far chords may be from a smooth outline, and few sides from these


@dataclass(frozen=True)
class PlanarSpace:
    """The plane around an object for tips of a radius that keep a clearance [m], in the object's frame.

    body: the polygon that a tip's centre keeps away from: the object's; of a capsule, from the tip's centre
    along ``capsule`` (2,) [m], zero for a disc, swept back by it. slack: how far the true boundary may be
    outside of it. fine: a polygon that stands for the same where a tip touches.
    """

    body: Any
    slack: float
    tip_radius: float
    clearance: float
    fine: Any
    capsule: Array

    @classmethod
    def around(cls, outline: Outline, tip_radius: float, clearance: float, capsule: Array) -> "PlanarSpace":
        """That of an outline, which a polygon of few sides within a tenth of the clearance stands for."""
        within = _CHORD * clearance
        chords, fine = (shapely.Polygon(outline.polygon(part * clearance)) for part in (_CHORD, _FINE))
        body = shapely.simplify(chords, within)  # moves the boundary by as much again, at most
        body, fine = _swept(body, capsule), _swept(fine, capsule)
        return cls(body, 2 * within, tip_radius, clearance, fine, capsule)

    @property
    def reach(self) -> float:
        """How far a tip's centre keeps from the polygon [m]."""
        return self.tip_radius + self.clearance + self.slack

    @property
    def apart(self) -> float:
        """How far the axes of two fingers keep [m]."""
        return 2 * self.tip_radius + self.clearance

    @cached_property
    def room(self) -> float:
        """What is kept besides [m]."""
        return _ROOM * self.clearance

    def distance(self, points: Array) -> Array:
        """(m,) of points (m, 2) from the polygon [m]."""
        result: Array = shapely.distance(shapely.points(points), self.body)
        return result

    def cuts(self, rising: Array, contact: Contact) -> bool:
        """Whether a tip that lifts off along (m, 2) is in the object by more than polygons are coarse."""
        away = shapely.distance(shapely.points(rising), self.fine)
        return bool(away.min() < self.tip_radius - 2 * _FINE * self.clearance)

    def keeps_apart(self, piece: Array, others: Array) -> bool:
        """Whether the hull of points (k, 2) is clear of fingers (j, 2, 2) that stand, their capsules too."""
        away = shapely.distance(_hull(piece), self._taken(others))
        return bool((away >= self.apart).all())

    def keeps_clear(self, piece: Array, others: Array) -> bool:
        """Whether it is clear of the object, too."""
        return shapely.distance(_hull(piece), self.body) >= self.reach and self.keeps_apart(piece, others)

    def _taken(self, others: Array) -> list[Any]:
        """What other fingers keep a tip's centre away from, their and its capsules included."""
        return [_hull(np.array([p, p + v, p - self.capsule, p + v - self.capsule])) for p, v in others]

    def way(self, start: Array, end: Array, others: Array) -> Array | None:
        """(k, 2) the shortest polygon between two points that keeps clear, room included; None without any.

        Of the object and tips with arcs in chords around them, never inside; by the graph of what sees what.
        """
        grown = 1 / cos(pi / (4 * _ARC))  # chords stay outside of the circle
        wide = (self.reach + self.room) * grown
        discs = [t.buffer((self.apart + self.room) * grown, quad_segs=_ARC) for t in self._taken(others)]
        taken = shapely.union_all([self.body.buffer(wide, quad_segs=_ARC), *discs])
        line = shapely.LineString([start, end])
        inner = shapely.buffer(taken, -1e-3 * self.room)  # ways may run along the boundary
        shapely.prepare(inner)
        if not shapely.intersects(inner, line):
            return np.array([start, end])
        if shapely.intersects_xy(inner, *start) or shapely.intersects_xy(inner, *end):
            return None
        parts = shapely.get_parts(shapely.orient_polygons(taken))
        rings = [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(parts)]
        nodes = np.vstack([start, end, *map(_convex, rings)])
        i, j = np.triu_indices(len(nodes), 1)
        lines = shapely.linestrings(np.stack([nodes[i], nodes[j]], axis=1))
        clear = ~shapely.intersects(inner, lines)
        lengths = np.linalg.norm(nodes[i[clear]] - nodes[j[clear]], axis=1)
        graph = coo_array((lengths, (i[clear], j[clear])), shape=(len(nodes), len(nodes))).tocsr()
        distances, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
        if not np.isfinite(distances[1]):
            return None
        route = [1]
        while route[-1] != 0:
            route.append(int(before[route[-1]]))
        result: Array = nodes[route[::-1]]
        return result

    def gaps(self, free: list[Array], whole: list[Array], others: Array) -> tuple[float, float]:
        """How far the finger keeps from the object on the hulls ``free``, from others on ``whole`` [m]."""
        to_object = float(shapely.distance([_hull(p) for p in free], self.body).min())
        hulls = [_hull(p) for p in whole]
        to_tips = min((float(shapely.distance(hulls, t).min()) for t in self._taken(others)), default=np.inf)
        return to_object - self.tip_radius - self.slack, to_tips - 2 * self.tip_radius


def _hull(points: Array) -> Any:
    return shapely.MultiPoint(points).convex_hull


def _swept(body: Any, capsule: Array) -> Any:
    """A polygon and all that it passes on its way back by the capsule."""
    if not capsule.any():
        return body
    rings = [shapely.get_coordinates(ring) for ring in shapely.get_rings(body)]
    pairs = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    sides = [_hull(np.concatenate([pair, pair - capsule])) for pair in pairs]
    return shapely.union_all([body, shapely.affinity.translate(body, *(-capsule)), *sides])


def _convex(ring: Array) -> Array:
    """The corners (k, 2) at which what is taken, on the left of its rings, is convex: ways bend there."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    result: Array = ring[before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0]
    return result
