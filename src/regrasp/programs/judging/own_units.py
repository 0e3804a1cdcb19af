"""A program in its own units, asked where solvers fail on it as it is: their tolerances have units.

With D the units of unknowns, E one over the largest term of each row or cone, and c one over the objective's,

    P' = c D P D,   q' = c D q,   A' = E A D,   b' = E b;   x = D x',   z = E z' / c

for certificates, too. All are powers of two: nothing is rounded but what vanishes.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from regrasp.programs.blocks import Array
from regrasp.programs.judging.terms import most
from regrasp.programs.judging.units import units_of_unknowns
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution

_FAR = 500
"""Largest exponent of two."""


class InOwnUnits(NamedTuple):
    """The program in its own units, those of unknowns (n,), and of duals (m,)."""

    program: Program
    unknowns: Array
    duals: Array

    def answer(self, found: Solution, program: Program) -> Solution:
        """What was found of the program in its own units, of ``program`` in its units; to be judged."""
        with np.errstate(over="ignore"):
            value, duals = self.unknowns * found.value, self.duals * found.duals
        said = f"{found.said}, in own units"
        return replace(found, program=program, value=value, duals=duals, said=said)


@np.errstate(all="ignore")
def in_own_units(program: Program) -> InOwnUnits | None:
    """The program in its own units; None where it is in them, its units are given or out of reach."""
    if program.size > 0 or not program.q.size:
        return None
    terms, cones = program.terms, program.cones
    D = _units(units_of_unknowns(program)[0], 1 / terms.in_columns(np.ones(program.b.size)))
    E = 1 / _units(cones.largest(terms.in_rows(D)), cones.largest(np.abs(program.b)))
    c = float(1 / _units(np.array([most(D * np.maximum(terms.in_objective(D), np.abs(program.q)))]))[0])
    if (D == 1).all() and (E == 1).all() and c == 1:
        return None
    right, left = sparse.diags(D), sparse.diags(E)
    P, A = c * (right @ program.P @ right), left @ program.A @ right
    q, b = c * D * program.q, E * program.b
    if not all(np.isfinite(values).all() for values in (P.data, A.data, q, b)):
        return None
    own = Program(sparse.csc_matrix(P), q, sparse.csc_matrix(A), b, program.blocks)
    return None if own.why_not_convex else InOwnUnits(own, D, E / c)


def _units(*sizes: Array) -> Array:
    """Powers of two near the first of ``sizes`` (k,) that are more than zero, else one."""
    units: Any = np.zeros(sizes[0].size)
    for size in sizes:
        units = np.where(units > 0, units, np.where(np.isfinite(size), size, 0.0))
    exponents = np.clip(np.round(np.log2(np.where(units > 0, units, 1.0))), -_FAR, _FAR)
    return np.asarray(2.0**exponents, dtype=float)
