"""Weights of twists that leave most beside what fingers do at the places looked at: a linear program."""

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.places.simplex import step

_EXACT, _PIVOTS = 1e-11, 400


@njit(**VIEWS)
def mix(gains, most, rows, count, lifted, weights, shares, table, names):  # type: ignore[no-untyped-def]
    """Weights of twists that leave most, shares of places against them, and how much is left.

    max sum_j w_j gains_j - sum_i t_i, where t_i >= sum_j w_j most_jip, sum w <= 1, by a simplex method from
    w = 0; with the least of each row and finger taken off, t is 0 or more.
    """
    k, m = len(count), 0
    n = rows + k
    for j in range(rows):
        lifted[j] = gains[j]
    for i in range(k):
        for j in range(rows):
            least = np.inf
            for s in range(count[i]):
                least = min(least, most[j, i, s])
            lifted[j] -= least
            for s in range(count[i]):
                table[m + s, j] = most[j, i, s] - least
        for _ in range(count[i]):
            for j in range(rows, n + 1):
                table[m, j] = 0.0
            table[m, rows + i] = -1.0
            table[m, n] = 1e-10 * (1.0 + ((m * 37) % 97) / 97.0)  # lest steps of no length go round
            m += 1
    for j in range(n + 1):
        table[m, j] = 1.0 if j < rows or j == n else 0.0
        table[m + 1, j] = -lifted[j] if j < rows else (1.0 if j < n else 0.0)
    m += 1
    for c in range(n + m):
        names[c] = c
    for _ in range(_PIVOTS):
        if not step(table, names, m, n, _EXACT):
            break
    for j in range(rows):
        weights[j] = 0.0
    for j in range(m):
        if names[n + j] < rows:
            weights[names[n + j]] = max(table[j, n], 0.0)
    for i in range(k):
        for s in range(count[i]):
            shares[i, s] = 0.0
    for c in range(n):
        s, i = names[c] - n, 0
        while s >= 0 and i < k and s >= count[i]:
            s -= count[i]
            i += 1
        if s >= 0 and i < k:
            shares[i, s] = max(table[m, c], 0.0)
    for i in range(k):
        total = 0.0
        for s in range(count[i]):
            total += shares[i, s]
        for s in range(count[i]):
            shares[i, s] = shares[i, s] / total if total > 0.0 else 1.0 / count[i]
    return table[m, n]
