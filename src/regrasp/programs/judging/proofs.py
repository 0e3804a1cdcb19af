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
measured by the largest. Where b'z or q'd cancels to a millionth of its terms and less, what A'z, A d and P d
leave may be what rounding of their terms hides: there sums are exact before a proof is believed.
"""

from fractions import Fraction
from math import inf
from typing import Any

import numpy as np
from scipy import sparse

from regrasp.programs.blocks import Array
from regrasp.programs.judging.terms import largest
from regrasp.programs.judging.units import units_of_unknowns
from regrasp.programs.program import Program

_ROUNDING = 2.0**-45
"""A sum this small beside its terms has no sign."""
_GROWN = 1e-2
"""Part of the growth of unknowns in their own units that counts."""
_CANCELLED, _BELIEVED = 2.0**-20, 1e-7
"""Descent, by its terms, below which rounding can hide what is left, and residuals that might be believed."""


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
        if residual <= _BELIEVED and -value < _CANCELLED * size:
            left, value = np.abs(_exact(terms.A.T, inside)), float(_exact(b[None], inside)[0])
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

        def measured(bends: Array, rows: Array, value: float) -> float:
            bent, outside = largest(np.abs(bends), of_columns), largest(cones.excess(-rows), of_cones)
            return _per(float(np.maximum(bent, outside)), value, size)

        value, size, of_cones = float(q @ d), float(np.abs(q) @ sizes), cones.units(of_rows)
        residual = measured(terms.P @ d, terms.A @ d, value)
        if residual <= _BELIEVED and -value < _CANCELLED * size:
            return measured(_exact(terms.P, d), _exact(terms.A, d), float(_exact(q[None], d)[0]))
        return residual


def _per(miss: float, value: float, size: float) -> float:
    """The miss for each unit of descent; NaN descends nowhere."""
    return miss / (-value / size) if -value > _ROUNDING * size else inf


def _exact(M: Any, x: Array) -> Array:
    """(k,) M x, each sum rounded once; M (k, n), x (n,), finite."""
    rows, y = sparse.csr_matrix(M), [Fraction(float(number)) for number in x]
    terms = [Fraction(float(a)) * y[j] for a, j in zip(rows.data, rows.indices, strict=True)]
    sums = [sum(terms[i:k], Fraction(0)) for i, k in zip(rows.indptr[:-1], rows.indptr[1:], strict=True)]
    return np.array([float(each) for each in sums])
