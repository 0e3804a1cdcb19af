# mypy: allow-untyped-calls
"""The least of a convex cost of forces to the last digits.

    minimise   sum_i a_i |f_i|^2 + c_i . f_i + s t
    subject to G f + w = 0,   |f_i across n_i| + k_i t <= mu_i f_i.n_i,   |f_i| <= limit_i,
               |f_i| <= t (a peak) or f_i.n_i <= t (of normal forces)

From forces that are nearly the best, constraints that are nearly touched are taken as equations, c_j(x) = 0,
and Newton's method solves the conditions of Karush, Kuhn and Tucker,

    [H + e 1   R'  ] [dx]     [g + R' z]
    [R        -e 1 ] [dz] = - [c       ],      R = dc/dx,  H = diag(2 a) + sum_j z_j d2c_j/dx2

Where many forces are best, e leads to those nearby; it spoils no solution, as every step starts from what
is still missing. What pulls is dropped and what is overstepped added, until multipliers and forces have the
right signs (``faces``). Loops over plain numbers, so that they may be compiled (``compiled.least_forces``).
"""

import numpy as np

from regrasp.closed_form.least.faces import (
    MARGIN,
    NONE,
    PEAK_NORMAL,
    corrected,
    equations,
    guess,
    measure,
    shared,
)

# The e of forces and that of multipliers: their ratio to the rounding of what is eliminated matters.
_OF_FORCES, _OF_MULTIPLIERS = 1e-6, 1e-8
_STEPS, _ROUNDS = 8, 8
# Steps that move more than this lead somewhere else; after the last one no digit moves.
_FAR, _LAST = 1e-2, 1e-10
# Cones and limits are touched from so far inside that rounding stays within; forces may cost so much more.
INSIDE, _DONE = 1 - 2e-12, 1e-10
# Equilibrium counts as reached at this residual, relative to the largest force or load.
BALANCED = 5e-14
# Less than this fraction of the largest force is nothing.
_NOTHING = 1e-14


def _refine(x, sizes, matrix, load, normals, frictions, limits, squares, linear, kind):  # type: ignore[no-untyped-def]
    n, w = normals.shape
    r = load.size
    touched = np.zeros((n, 4), dtype=np.bool_)  # idle, on the cone, at the limit, at t
    guess(x[-1], sizes, frictions, limits, kind, touched)
    first, last, still = x.copy(), x.copy(), 0
    for turn in range(_ROUNDS):
        rows = equations(touched, frictions, r, w)
        z, good = _newton(x, touched, rows, matrix, load, normals, frictions, limits, squares, linear, kind)
        if not good:
            break
        measure(x, normals, sizes)
        if turn == 0:
            first[:] = x
        still += np.abs(x - last).max() < _LAST
        last[:] = x
        if not corrected(x, z, touched, sizes, matrix, normals, frictions, limits, squares, linear, kind):
            return
        if still > 1:
            break
    x[:] = first  # multipliers of equations that depend on one another have any sign


def _cost(x, squares, linear, kind):  # type: ignore[no-untyped-def]
    if kind != NONE:
        return -x[-1] if kind == MARGIN else x[-1]
    cost, (n, w) = 0.0, linear.shape
    for i in range(n):
        for k in range(w):
            cost += (squares[i] * x[w * i + k] + linear[i, k]) * x[w * i + k]
    return cost


def _newton(x, touched, rows, matrix, load, normals, frictions, limits, squares, linear, kind):  # type: ignore[no-untyped-def]
    """``x`` becomes the solution; its multipliers (rows,), and whether steps came to an end."""
    unknowns = x.size
    K, missing, z = np.zeros((unknowns + rows, unknowns + rows)), np.zeros(unknowns + rows), np.zeros(rows)
    for step in range(_STEPS + 1):
        # The first time only multipliers are looked for: those that leave least of the gradient.
        _system(
            x,
            z,
            touched,
            matrix,
            load,
            normals,
            frictions,
            limits,
            squares,
            linear,
            kind,
            step == 0,
            K,
            missing,
        )
        eliminated(K, unknowns, missing)
        moved = 0.0
        if step > 0:
            for j in range(unknowns):
                if not abs(missing[j]) < np.inf:
                    return z, False
                x[j] += missing[j]
                moved = max(moved, abs(missing[j]))
        for j in range(rows):
            z[j] += missing[unknowns + j]
        if not moved < _FAR:
            return z, False
        if step > 0 and moved < _LAST:
            return z, True
    return z, False


def _system(  # type: ignore[no-untyped-def]
    x, z, touched, matrix, load, normals, frictions, limits, squares, linear, kind, first, K, missing
):
    """The lower triangle of the system above into ``K``, its right side into ``missing``."""
    n, w = normals.shape
    r, unknowns = load.size, x.size
    K[:] = 0.0
    missing[:] = 0.0
    missing[unknowns - 1] = 0.0 if kind == NONE else (1.0 if kind == MARGIN else -1.0)
    K[unknowns - 1, unknowns - 1] = 1.0 if kind == NONE else 0.0
    for i in range(n):
        for k in range(w):
            j = w * i + k
            missing[j] = -2 * squares[i] * x[j] - linear[i, k]
            K[j, j] = 2 * squares[i]
    K[unknowns : unknowns + r, : n * w] = matrix
    missing[unknowns : unknowns + r] = -load - (matrix * x[: n * w]).sum(axis=1)
    row = unknowns + r
    direction = np.zeros(w)
    for i in range(n):
        o = w * i
        along = 0.0
        square = 0.0
        for k in range(w):
            along += x[o + k] * normals[i, k]
            square += x[o + k] ** 2
        length = np.sqrt(square)
        if touched[i, 0]:
            for k in range(w):
                K[row, o + k] = 1.0
                missing[row] = -x[o + k]
                row += 1
            continue
        if frictions[i] == 0:
            for k in range(w):
                for m in range(w):
                    K[row, o + m] = (1.0 if k == m else 0.0) - normals[i, k] * normals[i, m]
                missing[row] = -(x[o + k] - along * normals[i, k])
                row += 1
        if touched[i, 1]:
            across = 0.0
            for k in range(w):
                direction[k] = x[o + k] - along * normals[i, k]
                across += direction[k] ** 2
            across = np.sqrt(across)
            mu = frictions[i]
            weight = np.sqrt(1 + mu * mu) if kind == MARGIN else 0.0
            curved = max(z[row - unknowns], 0.0) / across
            for k in range(w):
                direction[k] /= across
            for k in range(w):
                K[row, o + k] = direction[k] - mu * normals[i, k]
                for m in range(k + 1):
                    around = (
                        (1.0 if k == m else 0.0) - normals[i, k] * normals[i, m] - direction[k] * direction[m]
                    )
                    K[o + k, o + m] += curved * around
            K[row, unknowns - 1] = weight
            missing[row] = -(across - mu * along + weight * x[unknowns - 1])
            row += 1
        for part in range(2, 4):
            if not touched[i, part]:
                continue
            bound = x[unknowns - 1] if part == 3 else limits[i]
            if part == 3 and kind == PEAK_NORMAL:
                for k in range(w):
                    K[row, o + k] = normals[i, k]
                missing[row] = -(along - bound)
            else:
                curved = max(z[row - unknowns], 0.0) / length
                for k in range(w):
                    K[row, o + k] = x[o + k] / length
                    for m in range(k + 1):
                        K[o + k, o + m] += curved * ((1.0 if k == m else 0.0) - x[o + k] * x[o + m] / square)
                missing[row] = -(length - bound)
            if part == 3:
                K[row, unknowns - 1] = -1.0
            row += 1
    if first:
        missing[unknowns:] = 0.0
        K[:unknowns, :unknowns] = 0.0
        for j in range(unknowns):
            K[j, j] = 1.0
    else:
        missing[:unknowns] -= (K[unknowns:, :unknowns] * z.reshape(-1, 1)).sum(axis=0)
    for j in range(unknowns + z.size):
        K[j, j] += _OF_FORCES if j < unknowns else -_OF_MULTIPLIERS


def eliminated(K, unknowns, v):  # type: ignore[no-untyped-def]
    """``v`` becomes K^-1 v, of K (N, N) the lower triangle is given. Compiled: ``elimination``."""
    whole = np.tril(K)
    whole += np.tril(K, -1).T
    try:
        v[:] = np.linalg.solve(whole, v)
    except np.linalg.LinAlgError:
        v[:] = np.nan


def refined(  # type: ignore[no-untyped-def]
    forces, unit, matrix, load, normals, frictions, negligible, limits, squares, linear, kind
):
    """The best forces (n, w) near ``forces``, or near them, whether they cost no more, and whether they fit.

    unit: the size of forces; squares and linear are factors of them. matrix, load: (r, n w), (r,)
    of comparable rows. normals: (n, w). frictions, limits, squares: (n,); frictions up to
    ``negligible`` are none. linear: (n, w). kind: one of the words above.
    """
    n, w = forces.shape
    mu, bounds = INSIDE * frictions, INSIDE / unit * limits
    for i in range(n):
        if not frictions[i] > negligible:
            mu[i] = 0.0
    cost = max(np.abs(squares).max(), np.abs(linear).max())
    if not 0 < cost < np.inf:
        cost = 1.0
    a, c = squares / cost, linear / cost
    x = np.zeros(n * w + 1)
    x[:-1] = forces.ravel() / unit
    sizes = np.zeros((n, 3))  # along the normal, across it, in all
    measure(x, normals, sizes)
    x[-1] = shared(sizes, mu, kind)
    before = _cost(x, a, c, kind)
    _refine(x, sizes, matrix, load / unit, normals, mu, bounds, a, c, kind)
    measure(x, normals, sizes)
    x[-1] = shared(sizes, mu, kind)
    after = _cost(x, a, c, kind)
    best = unit * x[:-1].copy().reshape(n, w)
    for i in range(n):
        if sizes[i, 2] < _NOTHING:
            best[i] = 0.0
    fits = _fits(best, matrix, load, normals, frictions, limits)
    return best, after <= before + _DONE * abs(before), fits


def _fits(forces, matrix, load, normals, frictions, limits):  # type: ignore[no-untyped-def]
    """Whether forces are in equilibrium to rounding, inside their cones and limits."""
    n, w = forces.shape
    largest = max(np.abs(forces).max(), np.abs(load).max())
    for s in range(load.size):
        off = load[s]
        for i in range(n):
            for k in range(w):
                off += matrix[s, w * i + k] * forces[i, k]
        if not abs(off) <= BALANCED * largest:
            return False
    sizes = np.zeros((n, 3))
    measure(forces.ravel(), normals, sizes)
    for i in range(n):
        along, across, size = sizes[i]
        if not (along >= 0 and across <= frictions[i] * along and size <= limits[i]):
            return False
    return True
