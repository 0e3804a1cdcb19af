"""The widest least margin of a way with so many finger moves, where every hold may have any orientation.

Holds of one stance are exchanged at whatever orientations they hold, for three fingers turn the object in
between (docs/facts.md, 7). So a way of k moves is a row of k holds, the first among the start's contacts and
the last among the goal's, each with one finger of the one before it and one that was free: the margin of a
hold is its widest over all orientations. With F_k(f at u, g at v) the widest least margin of a row that ends
in a hold,

    F_k+1(f at u, g at v) = min( w(u, v), max over x of F_k(f at u, e at x), F_k(g at v, e at x) ),

e the third finger, x neither u nor v.
"""

from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds.stances import Places

SLOTS = ((0, 1), (0, 2), (1, 2))
"""The two fingers of a hold."""
Layer = Array
"""(3, V, V) widest least margins [rad] by slot and the places of both fingers, -1 for none."""


class Layers:
    """Rows of holds from a start, or to a goal, on contacts whose pairs have widest margins.

    widest: (V, V) [rad], -1 for none. allowed: (3, V) which finger may touch which contact.
    """

    def __init__(self, widest: Array, allowed: NDArray[np.bool_]) -> None:
        self.widest, self.allowed = widest, allowed

    def start(self, contacts: Places) -> Layer:
        """The holds of fingers 1, 2, 3 on three contacts."""
        return self._of([contacts])

    def goal(self, contacts: Places) -> Layer:
        """The holds of any fingers that may take three contacts."""
        ways = [w for w in permutations(contacts) if all(self.allowed[f, v] for f, v in enumerate(w))]
        return self._of(ways)

    def after(self, layer: Layer) -> Layer:
        """One hold further."""
        result = np.full(layer.shape, -1.0)
        for slot, (f, g) in enumerate(SLOTS):
            (e,) = {0, 1, 2} - {f, g}
            near = np.maximum(_widest_but(layer, f, e), _widest_but(layer, g, e).T)
            may = np.outer(self.allowed[f], self.allowed[g])
            result[slot] = np.where(may, np.minimum(self.widest, near), -1.0)
        return result

    def _of(self, ways: list[Places]) -> Layer:
        result = np.full((3, *self.widest.shape), -1.0)
        for way in ways:
            for slot, (f, g) in enumerate(SLOTS):
                result[slot, way[f], way[g]] = self.widest[way[f], way[g]]
        return result


def _widest_but(layer: Layer, finger: int, other: int) -> Array:
    """(V, V) of each place u of a finger the widest over places x of the other, x not v."""
    slot = SLOTS.index((min(finger, other), max(finger, other)))
    table = layer[slot] if finger < other else layer[slot].T
    count = len(table)
    first = table.argmax(axis=1)
    rows = np.arange(count)
    top = table[rows, first]
    rest = table.copy()
    rest[rows, first] = -1.0
    result = np.repeat(top[:, None], count, axis=1)
    result[rows, first] = rest.max(axis=1)
    return result


def row_of(ways: list[Layer], slot: int, u: int, v: int) -> list[tuple[int, int, int]]:
    """Holds (slot, u, v) of a row that ends in one, of the margin that its layer says, first hold first."""
    row = [(slot, u, v)]
    for layer in ways[-2::-1]:
        f, g = SLOTS[slot]
        (e,) = {0, 1, 2} - {f, g}
        best, found = -2.0, (slot, u, v)
        for finger, at, away in ((f, u, v), (g, v, u)):
            near = SLOTS.index((min(finger, e), max(finger, e)))
            line = (layer[near, at] if finger < e else layer[near, :, at]).copy()
            line[away] = -1.0
            x = int(line.argmax())
            if line[x] > best:
                best, found = float(line[x]), (near, at, x) if finger < e else (near, x, at)
        slot, u, v = found
        row.append(found)
    return row[::-1]
