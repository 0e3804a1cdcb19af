"""Certificates that are nearly right, made right: a solver's noise becomes zero, the rest moves least.

Noise is the solver's, and is guessed by the size of its numbers; what comes of a guess is measured like any
other certificate. With the noise at zero, the rest takes steps of least length, each entry by its own size,
towards

    A'z = 0 and z on the boundary of the cones it is near  (a proof that a program is infeasible)
    P d = 0 and A d = 0 in the rows that it crosses        (a direction of descent)

each equation in the unit of its own terms. A dual is put back inside its cones after each step.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import sparse

from regrasp.programs.blocks import Array
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.judging.terms import reciprocal
from regrasp.programs.program import Program

# Entries below this fraction of the largest are guessed to be noise, one guess after the other.
_NOISE = (0.0, 1e-9, 1e-6, 1e-4, 1e-2)
STEPS = 3
# A cone's boundary that is nearer than this, by its size, is touched.
_TOUCHED = 1e-3


def cleaned_duals(program: Program, z: Array, enough: float, steps: int = STEPS) -> Array:
    """The dual (m,) in K* with the least ``infeasibility_residual`` that was found; ``enough`` ends it.

    It never has a larger one than z put inside K*, and is that where this has enough. Without ``steps`` its
    noise becomes zero, and the rest stays.
    """
    A, cones = sparse.csr_matrix(program.A), program.cones

    def moved(y: Array) -> Array:
        equations: list[Any] = [A.T]
        for part in cones.round:
            length = float(np.linalg.norm(y[part][1:]))
            if length > (1 - _TOUCHED) * y[part.start]:
                face = np.zeros(y.size)
                face[part] = np.r_[-1.0, y[part][1:] / length]
                equations.append(face)
        return cones.dual(_nearest(sparse.vstack(equations), y, cones.units(np.abs(y))))

    with np.errstate(all="ignore"):
        inside = cones.dual(z)
    return _best(inside, moved, lambda y: infeasibility_residual(program, y), enough, steps)


def cleaned_direction(program: Program, d: Array, enough: float, steps: int = STEPS) -> Array:
    """The direction (n,) with the least ``unboundedness_residual``, likewise; d where it has enough."""
    A, P, cones = sparse.csr_matrix(program.A), sparse.csr_matrix(program.P), program.cones

    def moved(y: Array) -> Array:
        is_crossed = cones.zero | (cones.nonnegative & (A @ y > 0))
        return _nearest(sparse.vstack([P, A[is_crossed]]), y, np.abs(y))

    return _best(d, moved, lambda y: unboundedness_residual(program, y), enough, steps)


def _best(
    start: Array,
    moved: Callable[[Array], Array],
    measure: Callable[[Array], float],
    enough: float,
    steps: int,
) -> Array:
    """Of all guesses and steps the one that measures least."""
    best, least = start, measure(start)
    with np.errstate(all="ignore"):
        for noise in _NOISE:
            y = np.where(np.abs(start) > noise * np.abs(start).max(initial=0.0), start, 0.0)
            for step in range(steps + 1):
                if least <= enough:
                    return best
                y = y if step == 0 else moved(y)
                there = measure(y)
                if there < least:
                    best, least = y, there
    return best


def _nearest(M: sparse.csr_matrix, y: Array, weights: Array) -> Array:
    """The y with M y = 0, or nearest to it by the terms of its rows, that is nearest in units of weights."""
    from scipy.sparse.linalg import lsmr

    scale = reciprocal(abs(M) @ np.abs(y))
    matrix: Any = sparse.diags(scale) @ M @ sparse.diags(weights)
    step: Array = weights * lsmr(matrix, -scale * (M @ y), atol=0.0, btol=0.0, conlim=0.0)[0]
    return y + step
