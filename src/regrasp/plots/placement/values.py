"""What values of placements are of: the unit is read from the objective, whoever adds one."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.states.objectives import OBJECTIVES

# Of a placement as a whole, which no state has: in terms of N.
_WHOLE = {"wrench_ball": "N", "answered": "-"}


def unit_of(word: str) -> str:
    """The unit of an objective, in terms of N and rad."""
    found = OBJECTIVES.get(word)
    return _WHOLE.get(word, "N") if found is None else found.unit


def drawn_in(word: str) -> str:
    """The unit in which it is drawn: angles in degrees."""
    return {"rad": "deg"}.get(unit_of(word), unit_of(word))


def as_drawn(word: str, values: Array) -> Array:
    """Values in ``drawn_in``."""
    return np.degrees(values) if unit_of(word) == "rad" else values
