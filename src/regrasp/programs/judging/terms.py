"""The matrices of a program and of the sizes of their terms, in the layout in which products are fastest."""

from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse

from regrasp.programs.blocks import Array
from regrasp.programs.cones import Cones

_SMALL = 10_000
"""Entries up to which a dense matrix is multiplied faster than a sparse one."""

ROUNDING = 1e-12
"""An entry this small beside the largest of its row was to be zero."""


class Terms:
    """P, A, the sizes |P|, |A| and their inverses 1 / |a_ij|: dense for small programs, else sparse.

    of_rows: (m,) the largest entry of each row or cone of |A|. diagonal: (n,) of P.
    """

    def __init__(self, P: sparse.csc_matrix, A: sparse.csc_matrix, cones: Cones) -> None:
        self.is_dense = is_small(P, A)
        self.P, self.A = (_dense(M) if self.is_dense else M.tocsr() for M in (P, A))
        self.abs_P, self.abs_A = abs(self.P), abs(self.A)
        self.of_rows = cones.largest(self.in_rows(np.ones(A.shape[1])))
        self.diagonal = P.diagonal()

    @cached_property
    def inverses(self) -> Any:
        """1 / |a_ij|, zero where an entry is, or is the rounding of a row's largest."""
        largest = self.of_rows
        if self.is_dense:
            return np.where(self.abs_A > ROUNDING * largest[:, None], reciprocal(self.abs_A), 0.0)
        inverse = self.abs_A.copy()
        rows = np.repeat(np.arange(largest.size), np.diff(inverse.indptr))
        inverse.data = np.where(inverse.data > ROUNDING * largest[rows], reciprocal(inverse.data), 0.0)
        return inverse

    def given_units(self, size: float, q: Array) -> tuple[Array, Array, Array]:
        """Units of unknowns (n,) where each is ``size``; with them those of rows (m,) and columns (n,)."""
        given = np.full(q.size, size)
        pulls = self.abs_P @ given + np.abs(q)
        return given, self.in_rows(given), pulls + most(pulls)

    def in_columns(self, of_rows: Array) -> Array:
        """(n,) the largest |a_ij| of_rows_i of each column; of_rows: (m,)."""
        return self._largest(self.abs_A, of_rows, 0)

    def in_rows(self, of_columns: Array) -> Array:
        """(m,) the largest |a_ij| of_columns_j of each row; of_columns: (n,)."""
        return self._largest(self.abs_A, of_columns, 1)

    def in_objective(self, of_columns: Array) -> Array:
        """(n,) the largest |p_jk| of_columns_k of each row of P; of_columns: (n,)."""
        return self._largest(self.abs_P, of_columns, 1)

    def back_in_rows(self, of_columns: Array) -> Array:
        """(m,) the largest of_columns_j / |a_ij| of each row; of_columns: (n,)."""
        return self._largest(self.inverses, of_columns, 1)

    def back_in_columns(self, of_rows: Array) -> Array:
        """(n,) the largest of_rows_i / |a_ij| of each column; of_rows: (m,)."""
        return self._largest(self.inverses, of_rows, 0)

    def _largest(self, matrix: Any, factors: Array, axis: int) -> Array:
        if 0 in matrix.shape:
            return np.zeros(matrix.shape[1 - axis])
        if self.is_dense:
            found: Array = np.maximum.reduce(matrix * (factors if axis else factors[:, None]), axis=axis)
        else:
            scaled = matrix @ sparse.diags(factors) if axis else sparse.diags(factors) @ matrix
            found = scaled.max(axis=axis).toarray().ravel()
        return found


def is_small(P: sparse.csc_matrix, A: sparse.csc_matrix) -> bool:
    """Whether products are fastest by dense matrices."""
    return bool((A.shape[0] + P.shape[0]) * A.shape[1] <= _SMALL)


def floors_of(
    terms: Terms, cones: Cones, units: tuple[Array, Array, Array], q: Array
) -> tuple[float, float, float, float]:
    """The least unit of a row, of a column, of a product s z and of the gap.

    units: of unknowns, rows and columns, as ``given_units``.
    """
    unknowns, rows, columns = units
    own = cones.units(rows)
    products = own * reciprocal(cones.units(terms.in_rows(reciprocal(columns))))
    gap = float(unknowns @ (terms.abs_P @ unknowns + np.abs(q)))
    least = [float(each.min(initial=np.inf)) for each in (own, columns, products)]
    return least[0], least[1], least[2], gap


def _dense(matrix: sparse.csc_matrix) -> Any:
    return matrix.toarray()


def largest(amounts: Array, units: Array) -> float:
    """The largest of amounts / units; nothing counts as zero of whatever unit, and NaN is passed on."""
    worst = most(amounts / units)
    if worst == worst:
        return worst
    return most(np.divide(amounts, units, out=np.zeros_like(amounts), where=amounts != 0))


def most(sizes: Array) -> float:
    """The largest of sizes, zero of none."""
    return float(np.maximum.reduce(sizes)) if sizes.size else 0.0


def reciprocal(units: Array) -> Array:
    """1 / units, and zero where a unit is: there all terms are."""
    if np.logical_and.reduce(units, axis=None):
        return 1.0 / units
    inverse: Array = np.divide(1.0, units, out=np.zeros_like(units), where=units != 0)
    return inverse
