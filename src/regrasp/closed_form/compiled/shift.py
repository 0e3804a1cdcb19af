"""Forces moved least into equilibrium, in loops compiled by Numba. Imported when needed.

Of all f with G f + w = 0 the nearest to f0 is f0 - G' y with (G G') y = G f0 + w. Where it lies inside the
cones and limits, it is the nearest there, too.
"""

import numpy as np

from regrasp.compilation import kept

# A direction in which G G' is less than this fraction of its largest entry is no direction of G.
_FLAT = 1e-13
# A force below this fraction of the largest is a solver's noise at a finger that carries none.
_IDLE = 1e-8


@kept()
def shifted_inside(wanted, matrix, load, normals, frictions, limits, tolerance):  # type: ignore[no-untyped-def]
    """Forces (n, w) moved into equilibrium, idle fingers left idle, and whether that is an answer.

    wanted: (n, w). matrix, load: (r, n w), (r,) of comparable rows. normals: (n, w). frictions, limits: (n,).
    tolerance: of each row of G f + w, relative to the largest force and to the load. An answer is in
    equilibrium to it, inside every cone and limit, and finite.
    """
    n, w = wanted.shape
    rows, columns = matrix.shape
    used = _used(wanted)
    f = np.where(used, wanted.ravel(), 0.0)
    factor = _factored(matrix, used)
    off = np.empty(rows)
    for _ in range(2):  # the second time takes away the rounding of the first
        _imbalance(matrix, load, f, off)
        _solved(factor, off)
        for j in range(columns):
            if used[j]:
                for r in range(rows):
                    f[j] -= matrix[r, j] * off[r]
    _imbalance(matrix, load, f, off)
    largest = 0.0
    for value in f:
        largest = max(largest, abs(value))
    for value in load:
        largest = max(largest, abs(value))
    answers = largest < np.inf
    for value in off:
        answers = answers and abs(value) <= tolerance * largest
    forces = f.reshape(n, w)
    for i in range(n):
        answers = answers and _is_inside(forces[i], normals[i], frictions[i], limits[i])
    return forces, answers


@kept()
def _used(forces):  # type: ignore[no-untyped-def]
    """(n w,) which numbers are of a finger that carries force."""
    n, w = forces.shape
    sizes = np.zeros(n)
    for i in range(n):
        for k in range(w):
            sizes[i] = max(sizes[i], abs(forces[i, k]))
    return np.repeat(sizes >= _IDLE * sizes.max(), w)


@kept()
def _imbalance(matrix, load, f, off):  # type: ignore[no-untyped-def]
    """``off`` becomes G f + w."""
    rows, columns = matrix.shape
    for r in range(rows):
        off[r] = load[r]
        for j in range(columns):
            off[r] += matrix[r, j] * f[j]


@kept()
def _factored(matrix, used):  # type: ignore[no-untyped-def]
    """L with L L' = G G' of the columns used; flat directions have a zero on the diagonal."""
    rows, columns = matrix.shape
    lower = np.zeros((rows, rows))
    for r in range(rows):
        for s in range(r + 1):
            for j in range(columns):
                if used[j]:
                    lower[r, s] += matrix[r, j] * matrix[s, j]
    largest = lower.max()
    for s in range(rows):
        for k in range(s):
            lower[s, s] -= lower[s, k] * lower[s, k]
        flat = lower[s, s] <= _FLAT * largest
        lower[s, s] = 0.0 if flat else np.sqrt(lower[s, s])
        for r in range(s + 1, rows):
            for k in range(s):
                lower[r, s] -= lower[r, k] * lower[s, k]
            lower[r, s] = 0.0 if flat else lower[r, s] / lower[s, s]
    return lower


@kept()
def _solved(lower, y):  # type: ignore[no-untyped-def]
    """``y`` becomes the solution of L L' x = y, zero in flat directions."""
    rows = y.size
    for r in range(rows):
        for k in range(r):
            y[r] -= lower[r, k] * y[k]
        y[r] = y[r] / lower[r, r] if lower[r, r] > 0 else 0.0
    for back in range(rows):
        r = rows - 1 - back
        for k in range(r + 1, rows):
            y[r] -= lower[k, r] * y[k]
        y[r] = y[r] / lower[r, r] if lower[r, r] > 0 else 0.0


@kept()
def _is_inside(f, normal, friction, limit):  # type: ignore[no-untyped-def]
    along, square = 0.0, 0.0
    for k in range(f.size):
        along += f[k] * normal[k]
        square += f[k] * f[k]
    across = 0.0
    for k in range(f.size):
        across += (f[k] - along * normal[k]) ** 2
    return along >= 0 and np.sqrt(across) <= friction * along and square <= limit**2
