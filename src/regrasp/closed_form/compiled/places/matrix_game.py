"""Mixtures of rows whose least entry is the largest: the value of a matrix game, by the simplex method.

With all entries raised by c the value is v + c = 1 / max {sum w: (G + c) w <= 1, w >= 0}, and the shares of
rows are the multipliers. Nothing is 0 at first, so steps go from there, each to a lower bound on v.

Source: Dantzig, G. B. (1951). A proof of the equivalence of the programming problem and the game problem.
"""

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS

_SHIFT = 2.0  # of gains of at most 1, which makes all of them positive
_EXACT = 1e-12
_PIVOTS = 20  # for each column


@njit(**VIEWS)
def play(gains, rows, least, table, names, shares, corners):  # type: ignore[no-untyped-def]
    """The value of the game: shares of ``rows`` rows of gains and of corners, their columns.

    gains: (rows or more, n) of at most 1. least: a value that ends it once no mixture is above. table: one
    row and one column more than gains. names: of its columns, then of its rows.
    """
    n = gains.shape[1]
    for j in range(rows):
        for c in range(n):
            table[j, c] = gains[j, c] + _SHIFT
        table[j, n], names[n + j] = 1.0, n + j
    for c in range(n):
        table[rows, c], names[c] = -1.0, c
    table[rows, n] = 0.0
    for _ in range(_PIVOTS * n):
        s, low = -1, -_EXACT
        for c in range(n):
            if table[rows, c] < low:
                s, low = c, table[rows, c]
        if s < 0:
            break
        r, ratio = -1, np.inf
        for j in range(rows):
            if table[j, s] > _EXACT and table[j, n] < ratio * table[j, s]:
                r, ratio = j, table[j, n] / table[j, s]
        if r < 0:
            break
        per = 1.0 / table[r, s]
        for j in range(rows + 1):
            part = table[j, s] * per
            if j != r and part != 0.0:
                for c in range(n + 1):
                    if c != s:
                        table[j, c] -= part * table[r, c]
                table[j, s] = -part
        for c in range(n + 1):
            table[r, c] *= per
        table[r, s] = per
        names[s], names[n + r] = names[n + r], names[s]
        if table[rows, n] * (_SHIFT + least) >= 1.0 - _EXACT:
            return least
    for j in range(rows):
        shares[j] = 0.0
    for c in range(n):
        corners[c] = 0.0
    total = table[rows, n]
    for c in range(n):
        if names[c] >= n:
            shares[names[c] - n] = max(table[rows, c], 0.0) / total
    for j in range(rows):
        if names[n + j] < n:
            corners[names[n + j]] = max(table[j, n], 0.0) / total
    return 1.0 / total - _SHIFT
