"""Certificates that are nearly right, made right: a solver's noise becomes zero, the rest moves least.

What is noise is only guessed: what comes of a guess is measured like any other certificate. With the noise at
zero, the rest takes Gauss-Newton steps of least length, each entry by its own size, towards

    A'z = 0 and z on the boundary of the cones it lies on             (a proof that a program is infeasible)
    P d = 0 and -A d = 0 in the rows and faces that it touches        (a direction of descent)
"""

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from regrasp.programs.blocks import Array
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.judging.terms import reciprocal
from regrasp.programs.program import Program

# Entries below this fraction of the largest are guessed to be noise, one guess after the other.
_NOISE = (0.0, 1e-9, 1e-6, 1e-4, 1e-2)
STEPS = 4
# Entries up to which least squares are solved by a dense factorisation.
_DENSE = 1_000_000
# A cone whose boundary is nearer than this, by its size, is touched.
_TOUCHED = 1e-3


def cleaned_duals(program: Program, z: Array, enough: float, steps: int = STEPS) -> Array:
    """The dual (m,) with the least ``infeasibility_residual`` that was found, ``enough`` ends the search.

    Without ``steps`` its noise becomes zero, and the rest stays.
    """
    A, cones = sparse.csr_matrix(program.A), program.cones
    sizes = _largest_entries(A) * np.abs(z)

    def moved(y: Array) -> Array:
        units = cones.units(np.abs(y))
        columns = reciprocal(abs(A).T @ np.abs(y))
        rows: list[Any] = [sparse.diags(columns) @ A.T]
        wanted = [-columns * (A.T @ y)]
        for part in cones.round:
            t, length = y[part.start], float(np.linalg.norm(y[part][1:]))
            if length > 0 and length >= (1 - _TOUCHED) * t:  # stay on the boundary
                rows.append(_row(np.r_[-1.0, y[part][1:] / length] / units[part.start], part, y.size))
                wanted.append(np.array([t - length]) / units[part.start])
        return cones.dual(y + _least(rows, wanted, units))

    def kept(noise: float) -> NDArray[np.bool_]:
        loud: NDArray[np.bool_] = cones.units(sizes) > noise * sizes.max(initial=0.0)
        return loud

    start = cones.dual(z)
    return _best(start, kept, moved, lambda y: infeasibility_residual(program, y), enough, steps)


def cleaned_direction(program: Program, d: Array, enough: float, steps: int = STEPS) -> Array:
    """The direction (n,) with the least ``unboundedness_residual``, likewise."""
    A, P, cones = sparse.csr_matrix(program.A), sparse.csr_matrix(program.P), program.cones

    def moved(y: Array) -> Array:
        units = cones.units(abs(A) @ np.abs(y))
        s = -(A @ y)
        touched = cones.zero | (cones.nonnegative & (s <= _TOUCHED * units))
        rows: list[Any] = []
        wanted: list[Array] = []
        for part in cones.round:
            t, v = s[part.start], s[part][1:]
            length = float(np.linalg.norm(v))
            if np.hypot(t, length) <= _TOUCHED * units[part.start]:
                touched[part] = True
            elif length > 0 and length >= (1 - _TOUCHED) * t:
                face = np.r_[1.0, -v / length] / units[part.start]
                rows.append(sparse.csr_matrix(face @ A[part]))
                wanted.append(np.array([t - length]) / units[part.start])
        for M, some in ((P, np.ones(y.size, dtype=bool)), (A, touched)):
            scale = reciprocal(abs(M[some]) @ np.abs(y))
            rows.append(sparse.diags(scale) @ M[some])
            wanted.append(-scale * (M[some] @ y))
        return y + _least(rows, wanted, np.abs(y))

    def kept(noise: float) -> NDArray[np.bool_]:
        loud: NDArray[np.bool_] = np.abs(d) > noise * np.abs(d).max(initial=0.0)
        return loud

    return _best(d, kept, moved, lambda y: unboundedness_residual(program, y), enough, steps)


def _best(
    start: Array,
    kept: Callable[[float], NDArray[np.bool_]],
    moved: Callable[[Array], Array],
    measure: Callable[[Array], float],
    enough: float,
    steps: int,
) -> Array:
    """Of all guesses and steps the one that measures least."""
    best, least = start, measure(start)
    with np.errstate(all="ignore"):
        for noise in _NOISE:
            y = np.where(kept(noise), start, 0.0)
            before = inf
            for step in range(steps + 1):
                if least <= enough:
                    return best
                y = y if step == 0 else moved(y)
                there = measure(y)
                if there < least:
                    best, least = y, there
                if not there < before / 2 and step > 0:
                    break  # it leads nowhere
                before = there
    return best


def _least(rows: list[Any], wanted: list[Array], weights: Array) -> Array:
    """The step of least length in units of ``weights`` with rows @ step nearest to what is wanted."""
    matrix = sparse.csr_matrix(sparse.vstack(rows)) @ sparse.diags(weights)
    target = np.concatenate(wanted)
    if not (np.isfinite(matrix.data).all() and np.isfinite(target).all()):
        return np.zeros(weights.size)
    if matrix.shape[0] * matrix.shape[1] <= _DENSE:
        step = np.linalg.lstsq(matrix.toarray(), target, rcond=1e-13)[0]
    else:
        from scipy.sparse.linalg import lsmr

        step = lsmr(matrix, target, atol=1e-15, btol=1e-15, conlim=1e15)[0]
    result: Array = weights * step
    return result


def _row(entries: Array, columns: slice, width: int) -> sparse.csr_matrix:
    return sparse.csr_matrix(
        (entries, (np.zeros(entries.size, dtype=int), np.arange(columns.start, columns.stop))), (1, width)
    )


def _largest_entries(A: sparse.csr_matrix) -> Array:
    """(m,) the largest entry of each row, in size."""
    largest: Array = abs(A).max(axis=1).toarray().ravel() if A.shape[1] else np.zeros(A.shape[0])
    return largest
