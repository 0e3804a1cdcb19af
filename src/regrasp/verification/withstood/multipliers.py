"""The multipliers of the S-lemma, in doubles: guesses, which a proof goes on from."""

import numpy as np

from regrasp.mechanics.checks import Array

_STEPS = 60


@np.errstate(all="ignore")
def multipliers(values: Array, b: Array, low: Array) -> Array:
    """The lambda >= low, (...), that makes -lambda - sum b_i^2 / (e_i + lambda) largest: its slope falls.

    values: e, (..., k), none less than -low. b: (..., k).
    """

    def rises(x: Array) -> Array:
        return np.asarray(np.nansum((b / (values + x[..., None])) ** 2, axis=-1) > 1)

    high = low + np.where(rises(low), np.sqrt(np.einsum("...i,...i->...", b, b)), 0.0)
    for _ in range(_STEPS):
        middle = (low + high) / 2
        up = rises(middle)
        low, high = np.where(up, middle, low), np.where(up, high, middle)
    return np.asarray(high)
