"""The boxes that a search makes: memory for them, how one is split, and what excludes some."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.parts import memory, split
from regrasp.planning.placement.sides import Sides

_FIRST = 2048

Twists = tuple[np.ndarray, Array]
"""Loads, and their twists."""


class Boxes:
    """A tree of boxes, each an arc of sides for each finger; box 0 is all sides.

    Beside a twist for one load (``leave``): tied, rows of duals of all loads together; moving, twists of
    loads that move with the fingers; by_side, twists of loads of which one excludes each side of the finger
    that is on most, but for those in boxes that it is split into.
    """

    def __init__(self, sides: Sides, fingers: int) -> None:
        self.sides, self.fingers = sides, fingers
        self._boxes = memory(_FIRST, fingers)
        arcs, ends = self._boxes[:2]
        arcs[0, :, 1] = len(sides.ends) - 1
        ends[0] = sides.ends[0, 0], sides.ends[-1, 1]
        self._heap, self._state = np.zeros(_FIRST, np.int64), np.array([1, 1, 0])
        self.tied: dict[int, int] = {}
        self.moving: dict[int, Twists] = {}
        self.by_side: dict[int, Twists] = {}

    @property
    def count(self) -> int:
        """Boxes made."""
        return int(self._state[0])

    def box(self, node: int) -> tuple[np.ndarray, Array]:
        """(k, 2) first and last side of each arc of a box, and its ends."""
        return self._boxes[0][node], self._boxes[1][node]

    def halved(self, node: int, finger: int, u: float, most: int, after: int | None = None) -> range:
        """The boxes that one is split into, at ``u`` on one side or ``after`` another; none without room."""
        if len(self._heap) < self.count + self.fingers + 1 and not self._grow(most):
            return range(0)
        sides = None if after is None else (after, self.sides.ends[[after, after + 1], [1, 0]])
        made = split(self._boxes, self.count, node, finger, u, sides)
        self._state[0] = made.stop
        return made

    def parted(self, node: int, finger: int, sides: np.ndarray, twists: Twists, most: int) -> range | None:
        """The boxes of some stretches of one finger's arc, as twists exclude all its other sides.

        sides: (n, 2) first and last side of each; none where the box is excluded. None without room.
        """
        while len(self._heap) < self.count + len(sides):
            if not self._grow(most):
                return None
        self.by_side[node] = twists
        arcs, ends, _, _, _, kinds, children, _, _, other, _ = self._boxes
        made = range(self.count, self.count + len(sides))
        if not made:
            kinds[node] = 1
            return made
        self._state[0], kinds[node], children[node] = made.stop, 2, (made.start, len(made))
        arcs[made], ends[made], kinds[made], other[made] = arcs[node], ends[node], 0, -1
        arcs[made, finger] = sides
        ends[made, finger] = np.clip(self.sides.ends[sides, [0, 1]], *ends[node, finger])
        return made

    def leave(self, node: int, row: int | None, moving: Twists | None = None) -> None:
        """Take a box for excluded, by a row of ``duals`` or loads' twists; else as nearer than may be."""
        if row is not None:  # first, lest an interrupt leaves a box excluded by nothing
            self.tied[node] = row
        elif moving is not None:
            self.moving[node] = moving
        self._boxes[5][node] = 3 if row is None and moving is None else 1

    def _grow(self, most: int) -> bool:
        have, room = len(self._heap), min(2 * len(self._heap), most)
        if room <= have:
            return False
        self._boxes = memory(room, self.fingers, self._boxes)
        self._heap = np.concatenate([self._heap, np.zeros(room - have, np.int64)])
        return True
