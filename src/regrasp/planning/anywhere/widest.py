"""Of the walks of as few exchanges the one whose holds keep the widest margin, wherever on the outline.

Holds that keep an angle margin are those with cones narrower by it, so theirs is a map of the same kind,
within the one of all holds: halving finds the widest that a walk of so many exchanges still crosses.
"""

from math import atan, inf, tan

from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.fewest import fewest_layers, fewest_walk
from regrasp.planning.anywhere.limits import PARTS
from regrasp.planning.anywhere.search import Asked, End, held
from regrasp.planning.anywhere.walk import Hold, least_turning

_ROUNDS = 10  # of halving: to a thousandth of the cones
_ROOM = 1e-6  # of a side: fingers are off its corners


def widest_walk(asked: Asked, ends: tuple[End, End], angles: Array, exchanges: int) -> list[Hold] | None:
    """Its holds, at the places of some angles [rad]; None where none has room for any margin."""
    start, goal = ends
    low, high = 0.0, atan(asked.friction)
    parts = PARTS[0] if asked.limits.max_force < inf else 0
    best = None
    for _ in range(_ROUNDS):
        margin = 0.5 * (low + high)
        narrowed = asked._replace(friction=tan(atan(asked.friction) - margin))
        limits = asked.limits.chords(narrowed.friction, parts) if parts else asked.limits
        holds = narrowed.holds(angles, limits, parts)
        layers = fewest_layers(holds, start.places, goal.places, _ROOM)
        walk = None
        if layers is not None and len(layers) <= exchanges:
            walk = fewest_walk(holds, start.places, goal.places, layers, _ROOM)
        if walk is None or not held(holds, walk):
            high = margin
        else:
            low, best = margin, least_turning(holds, walk, angles, start.angle, goal.angle)
    return best
