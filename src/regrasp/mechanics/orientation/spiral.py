"""Directions spread evenly over the sphere."""

from math import pi, sqrt

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array


def even_directions(count: int) -> Array:
    """(count, 3) unit vectors on a spiral from pole to pole, a Fibonacci lattice; the same at every call.

    Equal steps of z, each turned from the last by pi (1 + sqrt 5), the golden angle but for whole turns.
    """
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise InvalidInput(f"count must be a whole number of at least 1, got {shown(count)}")
    place = np.arange(count) + 0.5
    z, turn = 1 - 2 * place / count, pi * (1 + sqrt(5)) * place
    across = np.sqrt(1 - z * z)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), z])
