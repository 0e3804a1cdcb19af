"""The search for the best level: by fixed twists, of all loads together, that move, that turn, or by side."""

from regrasp.planning.placement.curves.curved_sides import CurvedSides
from regrasp.planning.placement.levels.climbing import run_level
from regrasp.planning.placement.levels.joined_search import MOST_LOADS, run_joined
from regrasp.planning.placement.levels.level import ForceLevel, FrictionLevel, Level
from regrasp.planning.placement.levels.moving_search import COARSE, closed_by_moving
from regrasp.planning.placement.levels.paired_search import closed_by_pairs
from regrasp.planning.placement.levels.starts import best_start
from regrasp.planning.placement.levels.turning_search import WIDE, closed_by_turning
from regrasp.planning.placement.search import Progress, Search

MANY = 300
"""Sides beyond which three fingers with little friction start where normals meet, and go on by pairs."""


def best_level(
    search: Search, level: Level, tolerance: float, most: int, progress: Progress | None
) -> tuple[Search, float | None, float]:
    """The search as it ended, the best level it found or None, and a level that no placement is beyond."""
    curved, narrow, fingers = isinstance(search.sides, CurvedSides), search.narrow, search.fingers
    friction = isinstance(level, FrictionLevel)
    if isinstance(level, FrictionLevel) and fingers == 3 and not curved and len(search.sides.edges) > MANY:
        start = best_start(search, level)
        if start is not None:
            return closed_by_pairs(search, level, start, tolerance, most, progress)
    # of three fingers with little friction boxes go down to single edges either way
    joined = isinstance(level, ForceLevel) or (friction and fingers == 2)
    joined = joined and not curved and len(search.loads) <= MOST_LOADS
    moving = friction and not joined
    if moving and not (curved and fingers == 2):  # fixed twists leave two alone little
        search.narrow = max(WIDE if curved else COARSE, narrow)
    if joined:
        best, beyond = run_joined(search, level, tolerance, most, progress)
    else:
        best, beyond = run_level(search, level, tolerance, most, progress)
    if (
        (joined or search.narrow > narrow) and best is None and not (search.closed or search.interrupted)
    ):  # few places hold
        search = search.anew()
        search.narrow, moving = narrow, curved and friction
        best, beyond = run_level(search, level, tolerance, most, progress)
    if best is None or search.interrupted or beyond <= level.beyond(best, 1.1 * tolerance):
        return search, best, beyond
    if moving and curved:
        search, beyond = closed_by_turning(search, level, best, beyond, tolerance, most, progress)
    elif moving:
        beyond = closed_by_moving(search, level, best, beyond, tolerance, most, progress)
    return search, best, beyond
