"""Mixtures of rows that are above zero in every column: the value of a matrix game, by the simplex method."""

import numpy as np

from regrasp.mechanics.checks import Array

_EXACT = 1e-12  # of the largest entry
_STEPS = 20  # for each column


def best_mixture(gains: Array) -> Array | None:
    """(n,) weights of sum one whose mixture has the largest least entry; None where it is not above zero.

    gains: (n, m). With all entries raised by c the value is v + c = 1 / max {sum w: (G + c) w <= 1, w >= 0},
    and weights are the multipliers. Nothing is 0 at first, so steps go from there, and end early once the
    bound on v is not above zero.

    Source: Dantzig, G. B. (1951). A proof of the equivalence of the programming problem and the game problem.
    """
    n, m = gains.shape
    size = float(np.abs(gains).max())
    lift = size - min(float(gains.min()), 0.0)
    if size == 0:
        return None
    table = np.ones((n + 1, m + 1))
    table[:n, :m] = gains + lift
    table[n] = -1.0
    table[n, m] = 0.0
    rows = np.arange(n)  # the unknown of each: slacks first
    columns = np.arange(n, n + m)
    for _ in range(_STEPS * m):
        c = int(table[n, :m].argmin())
        if table[n, c] >= -_EXACT / size:
            break
        column = table[:, c].copy()
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(column[:n] > _EXACT * size, table[:n, m] / column[:n], np.inf)
        r = int(room.argmin())
        row = table[r] / column[r]
        table -= column[:, None] * row
        table[r] = row
        table[:, c] = -column / column[r]
        table[r, c] = 1 / column[r]
        rows[r], columns[c] = columns[c], rows[r]
        if table[n, m] * lift >= 1 - _EXACT:
            return None
    else:
        return None
    weights = np.zeros(n)
    slack = columns < n
    weights[columns[slack]] = np.maximum(table[n, :m][slack], 0.0)
    weights /= weights.sum()
    return weights if (weights @ gains).min() > 0 else None
