"""At which times a curve is drawn."""

import numpy as np

from regrasp.mechanics.checks import Array

_SAMPLES = 201


def moments(duration: float) -> Array:
    """(m,) times from 0 to the end, close enough for a smooth line."""
    return np.linspace(0, duration, _SAMPLES)
