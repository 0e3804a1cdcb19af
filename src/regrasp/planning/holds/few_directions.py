"""A margin that the best sequence in space has at the least, from few directions of the load.

The best sequence among some directions is one among all. Where no other has fewer moves, the best of all has
its margin m or a wider one, and triples need their margins only where these are m or more. The loads that
three fingers hold in cones narrowed by m form a convex set, so that what proves that they do not hold one
load, a motion along which it does work, proves it for all loads of a half space: most directions are outside
by one scalar product (``compiled.triples``), and few have a margin to be found. Of these directions, too,
some come first.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from regrasp.planning.holds.margin_search import ALIKE, widest_by_moves
from regrasp.planning.holds.sequences import Sequence
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.stances import Places

_SHARE = 6  # of the directions one in so many comes first
_FEW = 50  # directions that are looked at all together

Search = Callable[[Quads, NDArray[np.int64]], list[Sequence]]
"""The best sequence among stances, and the places of their directions among all; or none."""


def few_directions_first(
    fingers: Quads, start: Places, goal: Places, o: int, search: Search, places: NDArray[np.int64]
) -> list[Sequence]:
    """What ``search`` finds among all directions.

    o: the place of the goal's direction, 0 or 1. places: (O,) of the directions of ``fingers`` among all.
    """
    if places.size > _FEW:
        some = np.unique([0, 1, *range(2, places.size, _SHARE)])
        few = fingers.among(some, fingers.least)
        found = few_directions_first(few, start, goal, o, search, places[some])
        if found and found[0].moves == _fewest(fingers, start, goal, o, found[0].moves):
            wide = fingers.among(np.arange(places.size), found[0].margin - 2 * ALIKE)
            again = search(wide, places)
            if again and again[0].moves == found[0].moves:
                return again
    return search(fingers, places)


def _fewest(fingers: Quads, start: Places, goal: Places, o: int, moves: int) -> int:
    """No sequence has fewer moves than these, of which there is one with so many."""
    least = len(set(goal) - set(start))
    if least < moves:
        least = next(widest_by_moves(fingers.bounded(), start, goal, o, 0)).moves
    return least
