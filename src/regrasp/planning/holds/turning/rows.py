"""The widest least margin of a row of so many holds, each of which may have any orientation.

Holds of one stance are exchanged at whatever orientations they hold, for three fingers turn the object in
between (docs/facts.md, 7). So a way of k moves is a row of k holds, the first among the start's contacts and
the last among the goal's, each with one finger of the one before it and one that was free: the margin of a
hold is its widest over all orientations. With B_k(f at u, g at v) the widest least margin of k holds that
begin with this one and end at the goal, w that of a pair and e the third finger,

    B_k+1(f at u, g at v) = min( w(u, v), max over x of B_k(f at u, e at x), B_k(g at v, e at x) ),

x neither u nor v. Of B_k only its two widest over x are kept, by finger and place: a line of it, one finger
at one place, follows from these of B_k-1. Fingers that may touch everything are alike, and their tables one.
"""

from itertools import permutations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds.stances import Places
from regrasp.planning.holds.turning.least_turning import Node

SLOTS = ((0, 1), (0, 2), (1, 2))
"""The two fingers of a hold."""

_NONE = -1.0  # in the place of a margin
_Key = tuple[int, int]  # the finger that stays and the other one


class _Tops(NamedTuple):
    """Of a finger at each place (V,): its widest row, where the other finger then is, and the widest else."""

    top: Array
    other: NDArray[np.int64]
    rest: Array


class Rows:
    """Rows of holds from some contacts to others.

    widest: (V, V) margins of pairs [rad], -1 for none. allowed: (3, V) which finger may touch which contact;
    None where all may touch all. Lines that were worked out are kept: make it anew when margins changed.
    """

    def __init__(self, widest: Array, allowed: NDArray[np.bool_] | None, start: Places, goal: Places) -> None:
        self.widest, self.allowed = widest, allowed
        self._first = [(slot, start[f], start[g]) for slot, (f, g) in enumerate(SLOTS)]
        self._keys = list(permutations(range(3), 2)) if allowed is not None else [(0, 1)]
        self._pairs: dict[_Key, Array] = {}
        self._lines: dict[tuple[int, _Key, int], Array] = {}
        self._tables: list[dict[_Key, _Tops]] = []
        ways = [goal] if allowed is None else []
        if allowed is not None:
            ways = [w for w in permutations(goal) if all(allowed[f, v] for f, v in enumerate(w))]
        self._goals: dict[tuple[_Key, int], list[int]] = {}
        for way in ways:
            for f, g in permutations(range(3), 2):
                self._goals.setdefault((self._key(f, g), way[f]), []).append(way[g])

    def first(self, count: int, level: float) -> list[Node]:
        """The start's holds that begin rows of ``count`` holds of a margin of ``level`` or more [rad]."""
        return [node for node in self._first if self._margin(node, count) >= level]

    def margin(self, count: int) -> float:
        """The widest least margin of rows of ``count`` holds [rad], -1 where there is none."""
        return max(self._margin(node, count) for node in self._first)

    def row(self, count: int) -> list[Node]:
        """One of that margin."""
        row = [max(self._first, key=lambda node: self._margin(node, count))]
        for left in range(count - 1, 0, -1):
            row.append(max(self._next(row[-1], left))[1])
        return row

    def passed(self, count: int, level: float, most: int) -> list[Node]:
        """The first holds, ``most`` of them, of rows of ``count`` holds of a margin of at least ``level``."""
        found: dict[Node, None] = {}
        layer = self.first(count, level)
        for left in range(count - 1, -1, -1):
            found.update(dict.fromkeys(layer))
            if not left or len(found) >= most:
                break
            layer = list(dict.fromkeys(n for node in layer for n in self.onward(node, left, level)))
        return list(found)[:most]

    def onward(self, node: Node, count: int, level: float) -> list[Node]:
        """The holds after one that begin rows of ``count`` holds of a margin of ``level`` or more [rad]."""
        nodes: list[Node] = []
        for finger, e, at, away in _around(node):
            places = np.flatnonzero(self._line(count, finger, e, at) >= level).tolist()
            nodes += [_hold(finger, at, e, x) for x in places if x != away]
        return nodes

    def leads(self, floor: float) -> bool:
        """Whether rows of any length have a margin above ``floor`` [rad]."""
        count = 1
        while self.margin(count) <= floor:
            if count > 3 and self._as_before(count - 1):
                return False
            count += 1
        return True

    def _margin(self, node: Node, count: int) -> float:
        """That of the rows of ``count`` holds that begin with a hold."""
        slot, u, v = node
        if count == 1:
            at_goal = v in self._goals.get((self._key(*SLOTS[slot]), u), ())
            return float(self.widest[u, v]) if at_goal else _NONE
        return min(float(self.widest[u, v]), max(self._next(node, count - 1))[0])

    def _next(self, node: Node, count: int) -> list[tuple[float, Node]]:
        """Of either finger that stays the widest margin of rows of ``count`` holds, and their first hold."""
        result = []
        for finger, e, at, away in _around(node):
            line = self._line(count, finger, e, at)
            x = int(line.argmax())
            if x == away:
                line = line.copy()
                line[away] = _NONE
                x = int(line.argmax())
            result.append((float(line[x]), _hold(finger, at, e, x)))
        return result

    def _line(self, count: int, f: int, g: int, u: int) -> Array:
        """(V,) B_count(f at u, g at each place)."""
        key = (count, self._key(f, g), u)
        if key not in self._lines:
            pairs = self._pairs_of(f, g)[u]
            if count == 1:
                line = np.full(len(pairs), _NONE)
                places = self._goals.get(key[1:], [])
                line[places] = pairs[places]
            else:
                (e,) = {0, 1, 2} - {f, g}
                last = self._tops(count - 1)
                near, far = last[self._key(f, e)], last[self._key(g, e)]
                line = _blocks(near, far, np.array([u]), pairs[None])[0]
            self._lines[key] = line
        return self._lines[key]

    def _tops(self, count: int) -> dict[_Key, _Tops]:
        """Of B_count."""
        while len(self._tables) < count:
            tables = {}
            for f, g in self._keys:
                if self._tables:
                    (e,) = {0, 1, 2} - {f, g}
                    near, far = (self._tables[-1][self._key(finger, e)] for finger in (f, g))
                    tables[f, g] = _one_more(near, far, self._pairs_of(f, g))
                else:
                    tables[f, g] = self._goal_tops(f, g)
            self._tables.append(tables)
        return self._tables[count - 1]

    def _goal_tops(self, f: int, g: int) -> _Tops:
        """Of B_1, which is of the goal's holds alone."""
        tops = _nothing(len(self.widest))
        for key, u in self._goals:
            if key == (f, g):
                _put(tops, np.array([u]), self._line(1, f, g, u)[None].copy())
        return tops

    def _as_before(self, count: int) -> bool:
        """Whether B_count is B_count-2, and so all that comes after them known."""
        now, before = self._tops(count), self._tops(count - 2)
        return all(np.array_equal(a, b) for key in now for a, b in zip(now[key], before[key], strict=True))

    def _key(self, f: int, g: int) -> _Key:
        """Of the table of two fingers, one for all where these are alike."""
        return (0, 1) if self.allowed is None else (f, g)

    def _pairs_of(self, f: int, g: int) -> Array:
        """(V, V) margins of pairs that two fingers may touch."""
        if self.allowed is None:
            return self.widest
        if (f, g) not in self._pairs:
            may = np.outer(self.allowed[f], self.allowed[g])
            self._pairs[f, g] = np.where(may, self.widest, _NONE)
        return self._pairs[f, g]


def _around(node: Node) -> list[tuple[int, int, int, int]]:
    """(finger that stays, third finger, its place, the place that is left), for either finger of a hold."""
    slot, u, v = node
    f, g = SLOTS[slot]
    (e,) = {0, 1, 2} - {f, g}
    return [(f, e, u, v), (g, e, v, u)]


def _hold(f: int, u: int, g: int, v: int) -> Node:
    """Of finger f at u and g at v."""
    return (SLOTS.index((f, g)), u, v) if f < g else (SLOTS.index((g, f)), v, u)


def _one_more(near: _Tops, far: _Tops, pairs: Array) -> _Tops:
    """The two widest of each place after one hold more, near those of the finger, far those of the other."""
    tops = _nothing(len(pairs))
    some, others = np.flatnonzero(near.top >= 0), np.flatnonzero(near.top < 0)
    if some.size:
        _put(tops, some, _blocks(near, far, some, pairs[some]))
    ends = np.flatnonzero(far.top >= 0)
    if others.size and ends.size:  # whose rows go on from the other finger alone
        _put(tops, others, np.minimum(_but(far, others, ends), pairs[np.ix_(others, ends)]), ends)
    return tops


def _blocks(near: _Tops, far: _Tops, places: NDArray[np.int64], pairs: Array) -> Array:
    """(m, V) B_k+1 of a finger at places (m,) and the other one anywhere, pairs (m, V) those between."""
    block = np.repeat(near.top[places, None], len(near.top), axis=1)
    block[np.arange(places.size), near.other[places]] = near.rest[places]
    np.maximum(block, _but(far, places, np.arange(len(far.top))), out=block)
    return np.minimum(block, pairs, out=block)


def _but(far: _Tops, places: NDArray[np.int64], ends: NDArray[np.int64]) -> Array:
    """(m, n) the widest of the other finger at its ends (n,), the third not at the finger's places (m,)."""
    block = np.repeat(far.top[None, ends], places.size, axis=0)
    row = np.full(len(far.top), -1)
    row[places] = np.arange(places.size)
    at = row[far.other[ends]]
    there = np.flatnonzero(at >= 0)
    block[at[there], there] = far.rest[ends[there]]
    return block


def _nothing(count: int) -> _Tops:
    return _Tops(np.full(count, _NONE), np.zeros(count, dtype=np.int64), np.full(count, _NONE))


def _put(
    tops: _Tops, places: NDArray[np.int64], block: Array, columns: NDArray[np.int64] | None = None
) -> None:
    """Writes the two widest of each row; overwrites the block."""
    first = block.argmax(axis=1)
    rows = np.arange(len(block))
    tops.top[places] = block[rows, first]
    tops.other[places] = first if columns is None else columns[first]
    block[rows, first] = _NONE
    tops.rest[places] = block.max(axis=1)
