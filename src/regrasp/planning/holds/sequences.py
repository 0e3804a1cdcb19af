"""Sequences of holds from a start to a goal, in the order in which they are preferred.

While two fingers hold, the third moves to another point; then the hold is exchanged for another one of the
three points, or the object turns, by half a turn at most, for two holds under loads less far apart hold
everything between them (docs/facts.md, 6; of half a turn see ``HALF_TURN``). A *step* is an exchange, while
the object may turn, or a turn in one hold, or with all three: a larger turn than one step may make is made in
several, all three holding in between. So it is before the first finger leaves and after the last one arrives.
A *finger move* takes the free finger to another point: exchanges among the three points where the fingers
already stand need none, nor do turns.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from regrasp.planning.holds.cost_search import Cheapest, Costs, cheapest
from regrasp.planning.holds.margin_search import ALIKE, Widest, widest_by_moves
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.planar_stances import HALF_TURN, Fingering
from regrasp.planning.holds.stances import Places, Stances

Hold = tuple[int, ...]
"""The contacts and the orientation of a hold, by their places in the graph."""

MAX_TURN = 2 * pi / 3
"""Default largest turn during one step [rad]: forces grow by 1 / cos(turn / 2) = 2 at most on the way."""

# What counts after moves and margin: a step, then a radian of turning, then a radian of margin given away.
_STEP, _TURNING, _MARGIN = 1.0, 1e-4, 1e-8


@dataclass(frozen=True)
class Sequence:
    """Holds one after the other, the least of their margins [rad], and how often a finger moves."""

    holds: tuple[Hold, ...]
    margin: float
    moves: int

    @property
    def exchanges(self) -> int:
        """How often the hold is exchanged for another; a turn in one hold is none."""
        return sum(a[:-1] != b[:-1] for a, b in pairwise(self.holds))


def sequences(
    graph: HoldGraph,
    start: Places,
    goal: Places,
    goal_orientation: int = 0,
    *,
    max_turn: float = MAX_TURN,
    least_margin: float = 0.0,
    allowed: NDArray[np.bool_] | None = None,
    extra: int = 0,
    reach: float = HALF_TURN,
) -> list[Sequence]:
    """The sequence of fewest finger moves from three contacts to three, and of these of the widest margin.

    Among those as wide, to 1e-6 rad, that of fewest steps, then of least turning. With ``extra`` moves
    allowed, also one for each higher number of moves with a wider margin. Empty where none is.
    start, goal: places in the graph, of fingers 1, 2, 3 at the start. least_margin: [rad] that every hold
    must have. allowed: (3, V) which finger may touch which contact; by default all may touch all. max_turn:
    in one step; reach: of turns that take several, with all three fingers in between, at most pi [rad].
    """
    fingers = Fingering(graph, max_turn, least_margin, allowed, reach)
    return preferred(fingers, start, goal, goal_orientation, extra)


def preferred(fingers: Stances, start: Places, goal: Places, o: int, extra: int = 0) -> list[Sequence]:
    """The same for any stances: the goal is held at the orientation of place ``o``."""
    found = widest_by_moves(fingers, start, goal, o, extra)
    return [_shortest(fingers, start, goal, o, wide) for wide in found]


def as_sequence(fingers: Stances, found: Cheapest) -> Sequence:
    """Holds by their contacts in place of their numbers."""
    holds = tuple((*fingers.points(h), o) for h, o in found.way)
    margin = min(float(fingers.margins[fingers.rows[h], o]) for h, o in found.way)
    return Sequence(holds, margin, found.moves)


def _shortest(fingers: Stances, start: Places, goal: Places, o: int, wide: Widest) -> Sequence:
    """The sequence of fewest steps with so many moves and no less margin."""
    few = fingers.only(wide.useful)
    costs = preference(few.margins, wide.margin)
    found = cheapest(few, costs, start, goal, o, (wide.forward, wide.backward))
    assert found is not None
    return as_sequence(few, found)


def preference(margins: NDArray[np.float32], margin: float) -> Costs:
    """The costs of steps and turning among holds of no less than a margin [rad]."""
    worth = np.where(margins >= margin - ALIKE, _MARGIN * (pi / 2 - margins), inf)
    return Costs(worth.astype(np.float64), 0.0, _TURNING, _STEP)
