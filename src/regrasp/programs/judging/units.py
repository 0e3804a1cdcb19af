"""Sizes of unknowns and duals that matter where these are themselves near zero, from the data alone.

The unit of an unknown is the least of what alone makes up a right side, |b_i| / |a_ij|, or balances the
objective, |q_j| / p_jj, or where q_j is zero any |q_k| / |p_kj|: the least, so that no far bound counts. A
row whose right side is zero passes units on: its own is that of the smallest of its terms, |a_ij| X_j, and
X_l is at most that over |a_il|. Duals have units likewise, with rows and columns exchanged and the sizes of
P x + q in the place of b. Nothing that gives a unit leaves it at zero. Where ``Program.size`` says the unit
of all unknowns, rows have that of their largest term and columns that of the largest of all: they are in
one unit, too.

All here is written for inverses, so that nothing is zero and the least unit is the largest number.
"""

import numpy as np

from regrasp.programs.blocks import Array
from regrasp.programs.judging.terms import reciprocal
from regrasp.programs.program import Program

PASSES = 4
"""Through how many rows or columns in turn a unit is passed on to what has none. To what has one, through one
only: rows that go in a circle would make units smaller and smaller."""
OWN = 2.0**-11
"""Part of the terms of a row or column that counts beside its unit, where they are not far larger."""


def weight_of_terms(program: Program) -> float:
    """The part of the terms of rows and columns that counts beside their units; all where units are given."""
    return 1.0 if program.size > 0 else OWN


def units_of_unknowns(program: Program) -> tuple[Array, Array]:
    """X (n,), and of each row (m,) the least |a_ij| X_j, or the largest where all X are given."""
    terms, cones = program.terms, program.cones
    if program.size > 0:
        return program.given_units[:2]
    sides = reciprocal(cones.units(np.abs(program.b)))
    inverse = np.maximum(terms.in_columns(sides), _of_objective(program))
    for number in range(PASSES):
        rows = np.where(sides > 0, sides, cones.largest(terms.back_in_rows(inverse)))
        inverse = _passed(inverse, terms.in_columns(rows), number)
    return reciprocal(inverse), reciprocal(terms.back_in_rows(inverse))


def _of_objective(program: Program) -> Array:
    """(n,) 1 over the least of an unknown that balances q: in its column, or where that is zero in others."""
    terms, pulls = program.terms, reciprocal(np.abs(program.q))
    own: Array = terms.diagonal * pulls
    if np.logical_and.reduce(program.q, axis=None):
        return own
    return np.where(program.q == 0, terms.in_objective(pulls), own)


def own_units_of_columns(program: Program, unknowns: Array) -> Array:
    """V (n,) of columns without the weighted terms, for X (n,)."""
    if program.size > 0:
        return program.given_units[2]
    pulls: Array = program.terms.abs_P @ unknowns + np.abs(program.q)
    return pulls + _units_of_columns(program, pulls)


def _units_of_columns(program: Program, pulls: Array) -> Array:
    """(n,) the least |a_ij| Z_i of each column; pulls (n,): the sizes of P x + q."""
    terms, cones = program.terms, program.cones
    sides = reciprocal(pulls)
    inverse = cones.largest(terms.in_rows(sides))
    for number in range(PASSES):
        columns = np.where(sides > 0, sides, terms.back_in_columns(inverse))
        inverse = _passed(inverse, cones.largest(terms.in_rows(columns)), number)
    return reciprocal(terms.back_in_columns(inverse))


def _passed(inverse: Array, coming: Array, number: int) -> Array:
    """Units after what comes in pass ``number``."""
    return np.maximum(inverse, coming) if number == 0 else np.where(inverse > 0, inverse, coming)
