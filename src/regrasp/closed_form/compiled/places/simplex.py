"""The simplex method on a condensed table: unknowns that are 0 are columns, the others rows.

Source: Dantzig, G. B. (1951). A proof of the equivalence of the programming problem and the game problem.
"""

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS

_SHIFT = 2.0  # of gains of at most 1, which makes all of them positive
_EXACT = 1e-12
_PIVOTS = 20  # for each column


@njit(**VIEWS, forceinline=True)
def step(table, names, rows, columns, exact):  # type: ignore[no-untyped-def]
    """Whether a column and a row changed places, the column of the least price and the row that allows least.

    table: (rows + 1, columns + 1) or more, with prices in row ``rows`` and right sides in column ``columns``.
    names: of the unknowns of columns, then of rows. exact: what is nearer to 0 is 0.
    """
    s, r, least, ratio = -1, -1, -exact, np.inf
    for c in range(columns):
        if table[rows, c] < least:
            s, least = c, table[rows, c]
    if s < 0:
        return False
    for j in range(rows):
        if table[j, s] > exact and table[j, columns] < ratio * table[j, s]:
            r, ratio = j, table[j, columns] / table[j, s]
    if r < 0:
        return False
    per = 1.0 / table[r, s]
    for j in range(rows + 1):
        part = table[j, s] * per
        if j != r and part != 0.0:
            for c in range(columns + 1):
                if c != s:
                    table[j, c] -= part * table[r, c]
            table[j, s] = -part
    for c in range(columns + 1):
        table[r, c] *= per
    table[r, s] = per
    names[s], names[columns + r] = names[columns + r], names[s]
    return True


@njit(**VIEWS)
def play(gains, rows, least, table, names, shares, corners):  # type: ignore[no-untyped-def]
    """The value of a matrix game: shares of ``rows`` rows of gains and of corners, their columns.

    With all entries raised by c the value is v + c = 1 / max {sum w: (G + c) w <= 1, w >= 0}, and shares of
    rows are the multipliers. Nothing is 0 at first, so steps go from there, each to a lower bound on v.

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
        if not step(table, names, rows, n, _EXACT):
            break
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
