"""Measures of an answer from the data of its program, each row and column by its own unit.

    rows       s = b - A x in K        T_i = |b_i| + min_j |a_ij| X_j + w sum_j |a_ij x_j|
    columns    P x + q + A'z = 0       V_j = |q_j| + sum_k |p_jk| X_k + min_i |a_ij| Z_i
                                             + w (sum_k |p_jk x_k| + sum_i |a_ij z_i|)
    both       s_i z_i = 0             T_i times the least z_i with |a_ij| z_i = V_j for some j, w = 1
    objective  x'P x + q'x + b'z = 0   the same sum with every term positive

X and Z are the ``units`` of unknowns and duals: sizes that matter where these are themselves near zero. The
weight w leaves little of the terms: an answer far away, where 1e9 - 1e9 is to be 1, is
not right because the miss is small beside 1e9. A second-order cone is one row: its unit is the length of
those of its rows, and s_i z_i its s'z. So each measure is the same whatever the units of rows, unknowns and
objective, and no number elsewhere makes a miss look small. z is taken where it is put inside K*: what that
moves shows in the columns.
"""

from itertools import count
from typing import NamedTuple

import numpy as np

from regrasp.programs.judging.terms import largest, reciprocal, total
from regrasp.programs.judging.units import units_of_columns, units_of_unknowns, weight_of_terms
from regrasp.programs.program import Array, Program


class Audit(NamedTuple):
    """Measures of an answer (x, z), NaN where it is not finite.

    primal, dual, complementarity, gap: relative, as above. objective: 1/2 x'P x + q'x. slack_violation:
    the largest distance of a row or cone of b - A x to K. dual_violation: how far z is moved into K*.
    stationarity: largest entry of P x + q + A'z. absolute_gap: |x'P x + q'x + b'z|.
    """

    primal: float
    dual: float
    complementarity: float
    gap: float
    objective: float
    slack_violation: float
    dual_violation: float
    stationarity: float
    absolute_gap: float


_COLD = 200
"""Answers measured before the compiled measures are loaded, or compiled: fewer take longer that way."""
_measured = count()


def audited(program: Program, x: Array, z: Array) -> Audit:
    """The measures of an answer x (n,), z (m,)."""
    if next(_measured) < _COLD:
        return measured(program, x, z)
    from regrasp.programs.judging.compiled_audit import measures

    P, A = program.P, program.A
    data = P.indptr, P.indices, P.data, program.q, A.indptr, A.indices, A.data, program.b
    return Audit(*measures(*data, program.codes, program.size, x, z))


def measured(program: Program, x: Array, z: Array) -> Audit:
    """The same by NumPy alone, which needs nothing compiled; objective and gap to the last bit."""
    terms, cones, b, q = program.terms, program.cones, program.b, program.q
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        weight = weight_of_terms(program)
        unknowns, floors = units_of_unknowns(program)
        sizes = np.maximum(np.abs(x), unknowns)
        own_rows = terms.abs_A @ np.abs(x)
        of_rows = cones.units(np.abs(b) + floors + weight * own_rows)
        whole_rows = cones.units(np.abs(b) + floors + own_rows)
        s = b - terms.A @ x
        excess = cones.excess(s)
        inside = cones.dual(z)
        px, abs_px = program.P @ x, terms.abs_P @ np.abs(x)
        pulls = terms.abs_P @ unknowns + np.abs(q)
        gradient = np.abs(px + q + terms.A.T @ inside)
        own = abs_px + terms.abs_A.T @ np.abs(inside)
        of_columns = pulls + units_of_columns(program, pulls)
        per_dual = cones.units(terms.in_rows(reciprocal(of_columns + own)))
        both = np.abs(cones.products(s, inside)) * per_dual
        quadratic, linear = total(x * px), total(q * x)
        gap = abs(quadratic + linear + total(b * inside))
        of_gap = float(sizes @ (terms.abs_P @ sizes + np.abs(q)) + np.abs(b) @ np.abs(inside))
        return Audit(
            largest(excess, of_rows),
            largest(gradient, of_columns + weight * own),
            largest(both, whole_rows),
            gap / of_gap if gap else 0.0,
            quadratic / 2 + linear,
            float(excess.max(initial=0.0)),
            float(np.abs(z - inside).max(initial=0.0)),
            float(gradient.max(initial=0.0)),
            gap,
        )
