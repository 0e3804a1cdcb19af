"""The search on maps of holds for a walk from the start to the goal, or for the proof that there is none."""

from dataclasses import replace
from itertools import combinations
from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.anywhere.cut import excluded_boxes, reached_arcs
from regrasp.planning.anywhere.fewest import fewest_layers, fewest_walk
from regrasp.planning.anywhere.hold_map import TIE, HoldMap, Place, TooLarge, flooded
from regrasp.planning.anywhere.limits import PARTS, Limits, limited_intervals
from regrasp.planning.anywhere.polygons import width
from regrasp.planning.anywhere.walk import Hold, least_turning, walk_through
from regrasp.planning.states.choosing import choose_state
from regrasp.plans.outline_cut import OutlineCut

ORIENTATIONS = 3, 9, 33
"""That are looked at between the ends of a turn, one after the other until there is a walk or a proof."""
_ROOMS = 3e-2, 3e-3, 1e-4, 1e-6, TIE

# Regions that a walk prefers are wider than the first of these fractions, then than the next: narrow ones
# take many holds.
_WIDTHS = (1e-2, 1e-3, 0.0)

Places = tuple[Place, ...]


class End(NamedTuple):
    """A grasp at the start or in the end, its places, and the object's angle there [rad]."""

    grasp: Grasp
    places: Places
    angle: float

    def unheld(self, load: Wrench, max_force: float, min_normal: float) -> Infeasible | None:
        """Why all three fingers do not hold the load [N], seen at angle 0; None where they do."""
        most, seen = max_force if max_force < inf else None, load.rotated(-self.angle)
        try:
            choose_state(self.grasp, seen, "peak", max_force=most, min_normal=min_normal)
        except Infeasible as reason:
            return reason
        return None


class Asked(NamedTuple):
    """An outline, what fingers keep on it, and the object's least and largest angle."""

    vertices: Array
    free: np.ndarray
    friction: float
    load: Wrench
    limits: Limits
    turns: tuple[float, float]

    def angles(self, count: int, goal: float) -> Array:
        """(k,) that are looked at, those of the ends among them [rad]."""
        lo, hi = self.turns
        return np.unique([*np.linspace(lo, hi, count), 0.0, goal])

    def holds(self, angles: Array, limits: Limits, parts: int) -> HoldMap:
        """The map of holds at some angles."""
        forces = np.array([self.load.rotated(-a).force for a in angles.tolist()])
        return HoldMap.of(self.vertices, self.friction, forces, self.free, limits, parts)


class Decided(NamedTuple):
    """What was found: holds, which of them are neighbours, a walk or a proof, and bounds of exchanges."""

    holds: HoldMap | None
    neighbours: list[set[int]]
    angles: Array
    walk: list[Hold] | None = None
    certificate: OutlineCut | None = None
    exchanges: tuple[int, int] | None = None


def decided(asked: Asked, start: End, goal: End) -> Decided:
    """Finer and finer in angles, and in tangents of a force limit, until there is a walk or a proof."""
    limited, turning = asked.limits.max_force < inf, asked.turns[0] < asked.turns[1]
    if limited and turning and start.angle == goal.angle:  # with limits walks turn by no more than they must
        still = decided(asked._replace(turns=(start.angle, start.angle)), start, goal)
        if still.exchanges is not None:
            return still._replace(exchanges=(_least_turning(asked, start, goal), still.exchanges[1]))
    found = Decided(None, [], np.empty(0))
    for count in ORIENTATIONS if turning else (1,):
        angles = asked.angles(count, goal.angle)
        for parts in PARTS if limited else (0,):
            try:
                around = asked.holds(angles, asked.limits, parts)
                found = _at(asked, around, angles, parts, start, goal)
            except TooLarge:
                return Decided(None, [], angles)
            if found.walk is not None or found.certificate is not None:
                return found
    return found


def _at(asked: Asked, around: HoldMap, angles: Array, parts: int, start: End, goal: End) -> Decided:
    """What one choice of angles and tangents says; ``around`` has all holds, and with a force limit more."""
    lo, hi = asked.turns
    ends = start.places, goal.places
    result = Decided(around, [], angles)
    # With a force limit a walk turns by what its holds leave room for: in one go, or step by step.
    ways: list[tuple[float, int | None]] = [(hi - lo, None)]
    if parts and lo < hi:
        ways.append((float(np.diff(angles).max()), 1))
    for turn, steps in ways if parts else [(0.0, None)]:
        limits = asked.limits.turning(turn)
        holds = asked.holds(angles, limits.chords(asked.friction, parts), parts) if parts else around
        holds = replace(holds, limits=limits)
        neighbours = holds.neighbours(TIE, steps)
        result = Decided(holds, neighbours, angles)
        if parts and lo < hi and any(end.unheld(asked.load, *limits[::-1]) for end in (start, goal)):
            continue
        turns = [None if steps is None else int(np.argmin(abs(angles - e.angle))) for e in (start, goal)]
        walk = _walk(holds, neighbours, *ends, turns)
        if walk is not None:
            if steps is None:
                walk, few = _fewest(holds, around, walk, *ends)
                walk = least_turning(holds, walk, angles, start.angle, goal.angle)
            else:
                few = _least(around, *ends), max(len(walk) - 1, 0)
            return result._replace(walk=walk, exchanges=few)
    return result._replace(certificate=_certificate(around, *ends))


def _least_turning(asked: Asked, start: End, goal: End) -> int:
    """Exchanges that every walk has that may turn; 0 where the map is too large to say."""
    try:
        around = asked.holds(asked.angles(ORIENTATIONS[0], goal.angle), asked.limits, PARTS[-1])
        return _least(around, start.places, goal.places)
    except TooLarge:
        return 0


def _least(holds: HoldMap, start: Places, goal: Places) -> int:
    """Exchanges that every walk has."""
    low = fewest_layers(holds, start, goal, -TIE)
    return len(low) if low is not None else 0


def _fewest(
    holds: HoldMap, around: HoldMap, walk: list[Hold], start: Places, goal: Places
) -> tuple[list[Hold], tuple[int, int]]:
    """The walk of fewest exchanges that is sure, and between what bounds their number is."""
    least = _least(around, start, goal)
    for room in _ROOMS:  # well inside regions, if that takes no more
        layers = fewest_layers(holds, start, goal, room)
        few = None if layers is None else fewest_walk(holds, start, goal, layers, room)
        if few is not None and len(few) < len(walk) and held(holds, few):
            walk = few
        if len(walk) - 1 <= least:
            break
    return walk, (least, max(len(walk) - 1, 0))


def _walk(
    holds: HoldMap, neighbours: list[set[int]], start: Places, goal: Places, turns: list[int | None]
) -> list[Hold] | None:
    """Holds from the start to the goal, through fewest wide regions; None where none is sure.

    turns: the forces of the first and of the last hold are next to these, unless None.
    """
    if sorted(start) == sorted(goal):
        return []
    leave, arrive = (
        {
            k: at
            for p, q in combinations(end, 2)
            for k, at in holds.at(p, q, TIE)
            if turn is None or abs(holds.regions[k].turn - turn) <= 1
        }
        for end, turn in zip((start, goal), turns, strict=True)
    )
    for least in _WIDTHS:
        wide = {k for k, region in enumerate(holds.regions) if width(region.polygon) > least}
        wide |= leave.keys() | arrive.keys()
        before = flooded([near & wide for near in neighbours], set(leave))
        last = next((k for k in before if k in arrive), None)
        if last is None:
            continue
        path = [last]
        while (previous := before[path[-1]]) is not None:
            path.append(previous)
        path.reverse()
        walk = walk_through(holds, path, leave[path[0]], arrive[last])
        if walk is not None and held(holds, walk):
            return walk
    return None


def held(holds: HoldMap, walk: list[Hold]) -> bool:
    """Whether the closed form of two contacts says so, too, hold by hold."""
    vertices = holds.vertices
    along = np.roll(vertices, -1, axis=0) - vertices
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    sides = np.array([[p[0], q[0]] for p, q, _ in walk])
    fractions = np.array([[p[1], q[1]] for p, q, _ in walk])
    forces = holds.forces[[turn for _, _, turn in walk]]
    points, n = vertices[sides] + fractions[..., None] * along[sides], normals[sides]
    lo, hi = limited_intervals(points, n, holds.friction, forces, holds.limits)
    return bool((lo < hi).all())


def _certificate(holds: HoldMap, start: Places, goal: Places) -> OutlineCut | None:
    """The proof that none exists, where there is one, nearly touching regions taken to be joined."""
    leave = {k for p, q in combinations(start, 2) for k, _ in holds.at(p, q, -TIE)}
    arrive = {k for p, q in combinations(goal, 2) for k, _ in holds.at(p, q, -TIE)}
    arcs, inside = reached_arcs(holds, leave)
    if inside & arrive:
        return None
    if not arrive:  # the goal cannot be held by two: the start may reach everything
        arcs = [(side, 0.0, 1.0) for side in np.flatnonzero(holds.free).tolist()]
    found = excluded_boxes(holds, arcs, start, goal)
    if found is None:
        return None
    return OutlineCut(
        holds.vertices,
        holds.friction,
        holds.forces[0],
        np.array(start),
        np.array(goal),
        np.array(arcs),
        np.array(found[0]),
        np.array(found[1]),
        holds.forces[-1],
        np.flatnonzero(~holds.free).astype(np.float64),
        holds.limits.min_normal,
        holds.limits.max_force if holds.limits.max_force < inf else None,
    )
