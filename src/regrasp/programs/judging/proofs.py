"""What a certificate proves, whatever its scale and that of any row or unknown.

A dual z in K* with A'z = 0 and b'z < 0 proves that no x has b - A x in K: x would give
0 <= z'(b - A x) = b'z. Where A'z misses zero, what it leaves must be paid for by x:

    -b'z <= sum_j |A'z|_j |x_j| <= miss * sum_ij |z_i a_ij x_j|,   miss = max_j |A'z|_j / sum_i |z_i a_ij|

and the residual is miss / (-b'z / sum_i |z_i b_i|): in a feasible point the terms of x, weighted by z, would
be 1 / residual times those of b. Rows of which b has none, and that cancel, hide by their terms what others
leave. So the residual is at least a hundredth of sum_j |A'z|_j X_j / -b'z, with X the units of the unknowns:
a feasible point would have one that is so many times its unit. Likewise a direction d with P d = 0, -A d in K
and q'd < 0 along which the objective falls for ever from any feasible point, if there is one. Where
``Program.size`` says that all unknowns are in one unit, that is X, columns are in one, too, and each is
measured by the largest.
"""

from math import inf

import numpy as np

from regrasp.programs.blocks import Array
from regrasp.programs.judging.terms import largest
from regrasp.programs.judging.units import units_of_unknowns
from regrasp.programs.program import Program

_ROUNDING = 2.0**-45
"""A sum this small beside its terms has no sign."""
_GROWN = 1e-2
"""Part of the growth of unknowns in their own units that counts."""


def infeasibility_residual(program: Program, z: Array) -> float:
    """The residual of z (m,), put inside K*; infinite where b'z is not negative."""
    terms, b = program.terms, program.b
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        inside = program.cones.dual(z)
        of_columns = terms.abs_A.T @ np.abs(inside)
        if program.size > 0:
            of_columns = np.full(of_columns.size, of_columns.max(initial=0.0))
        left = np.abs(terms.A.T @ inside)
        value, size = float(b @ inside), float(np.abs(b) @ np.abs(inside))
        residual = _per(largest(left, of_columns), value, size)
        if not residual < inf:
            return residual
        grown = float(left @ units_of_unknowns(program)[0]) / -value
        return float(np.maximum(residual, _GROWN * grown))


def unboundedness_residual(program: Program, d: Array) -> float:
    """The residual of a direction d (n,); infinite where q'd is not negative."""
    terms, cones, q = program.terms, program.cones, program.q
    sizes = np.abs(d)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        of_columns, of_rows = terms.abs_P @ sizes, terms.abs_A @ sizes
        if program.size > 0:
            of_columns = np.full(of_columns.size, of_columns.max(initial=0.0))
            of_rows = terms.in_rows(np.full(sizes.size, sizes.max(initial=0.0)))
        bent = largest(np.abs(terms.P @ d), of_columns)
        outside = largest(cones.excess(-(terms.A @ d)), cones.units(of_rows))
        return _per(float(np.maximum(bent, outside)), float(q @ d), float(np.abs(q) @ sizes))


def _per(miss: float, value: float, size: float) -> float:
    """The miss for each unit of descent; NaN descends nowhere."""
    return miss / (-value / size) if -value > _ROUNDING * size else inf
