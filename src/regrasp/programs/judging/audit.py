"""Measures of an answer from the data of its program, each row and column by its own unit.

    rows       s = b - A x in K        T_i = |b_i| + min_j |a_ij| X_j + w sum_j |a_ij x_j|
    columns    P x + q + A'z = 0       V_j = |q_j| + sum_k |p_jk| X_k + min_i |a_ij| Z_i
                                             + w (sum_k |p_jk x_k| + sum_i |a_ij z_i|)
    both       s_i z_i = 0             T_i times the least z_i with |a_ij| z_i = V_j for some j, w = 1
    objective  x'P x + q'x + b'z = 0   the same sum with every term positive; the less of it, beside
                                       sum_j X_j (sum_k |p_jk| X_k + |q_j|), the more of it cancels

X and Z are the ``units`` of unknowns and duals: sizes that matter where these are themselves near zero. The
weight w leaves little of the terms, and the less the more of them cancels: an answer far away, where
1e12 - 1e12 is to be 1, is not right because the miss is small beside 1e12. Where rounding of the terms is
all that is left of a unit, nothing can be said of an answer, and primal is infinite. A second-order cone is
one row: its unit is the length of those of its rows, and s_i z_i its s'z. So each measure is the same
whatever the units of rows, unknowns and objective, and no number elsewhere makes a miss look small. z is
taken where it is put inside K*: what that moves shows in the columns.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.programs.blocks import Array
from regrasp.programs.judging.terms import largest, most, reciprocal
from regrasp.programs.judging.units import own_units_of_columns, units_of_unknowns, weight_of_terms
from regrasp.programs.program import Program

MOST = 2.0**13
"""Times its unit, that terms count for at the most; beyond, where more of them cancels, for less."""
ROUNDING = 2.0**-45
"""Of a sum of terms; a unit below it says nothing."""


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


def audited(program: Program, x: Array, z: Array) -> Audit:
    """The measures of an answer x (n,), z (m,)."""
    terms, cones, b, q = program.terms, program.cones, program.b, program.q
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        unknowns, floors = units_of_unknowns(program)
        weight, lost = weight_of_terms(program), False
        size_x, size_b = np.abs(x), np.abs(b)
        sizes = np.maximum(size_x, unknowns)
        own_rows = terms.abs_A @ size_x
        of_rows = whole_rows = cones.units(size_b + floors + own_rows)
        if weight < 1:
            of_rows = cones.units(_with_terms(size_b + floors, weight * own_rows))
        s = b - terms.A @ x
        excess, inside = cones.excess(s), cones.dual(z)
        size_z = np.abs(inside)
        px = terms.P @ x
        gradient = np.abs(px + q + inside @ terms.A)
        own = terms.abs_P @ size_x + size_z @ terms.abs_A
        of_columns = own_units_of_columns(program, unknowns)
        if weight < 1:
            lost = _has_lost(size_b + floors, own_rows) or _has_lost(of_columns, own)
        per_dual = cones.units(terms.in_rows(reciprocal(of_columns + own)))
        both = np.abs(cones.products(s, inside)) * per_dual
        quadratic, linear = float(x @ px), float(q @ x)
        gap = abs(quadratic + linear + float(b @ inside))
        of_gap = float(sizes @ (terms.abs_P @ sizes + np.abs(q)) + size_b @ size_z)
        if weight < 1:
            units = np.array([unknowns @ (terms.abs_P @ unknowns + np.abs(q))])
            of_gap = float(_with_terms(units, np.array([of_gap]))[0])
        return Audit(
            inf if lost else largest(excess, of_rows),
            largest(gradient, of_columns + own if weight == 1 else _with_terms(of_columns, weight * own)),
            largest(both, whole_rows),
            gap / of_gap if gap else 0.0,
            quadratic / 2 + linear,
            most(excess),
            most(np.abs(z - inside)),
            most(gradient),
            gap,
        )


def missed(program: Program, x: Array) -> float:
    """How far a point (n,) is outside by units alone: where whether there is a point is the question."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        units = np.abs(program.b) + units_of_unknowns(program)[1]
        return largest(program.cones.excess(program.b - program.terms.A @ x), program.cones.units(units))


def _with_terms(units: Array, terms: Array) -> Array:
    """Units (k,) and what counts of terms beside them; all of it where a unit is not known."""
    most = MOST * units
    result: Array = units + np.where(units > 0, np.minimum(terms, most * (most / terms)), terms)
    return result


def _has_lost(units: Array, sizes: Array) -> bool:
    """Whether a unit that is known is less than the rounding of terms of these sizes."""
    return bool(((units > 0) & (units < ROUNDING * sizes)).any())
