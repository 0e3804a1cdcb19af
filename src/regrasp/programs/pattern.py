"""Sparse matrices of one pattern: symbolic work is done once, numbers are filled in at will."""

from copy import copy

import numpy as np
from scipy import sparse

from regrasp.errors import InvalidInput, shown
from regrasp.programs.blocks import Array, ArrayLike


class Pattern:
    """The places of the entries of a sparse matrix.

    Args:
        shape: (m, n).
        rows: (k,) place of each entry, in any order, no place twice.
        columns: (k,) place of each entry, in any order, no place twice.
    """

    def __init__(self, shape: tuple[int, int], rows: ArrayLike, columns: ArrayLike) -> None:
        try:
            rows, columns = np.asarray(rows, dtype=np.int32), np.asarray(columns, dtype=np.int32)
            count = rows.size
            self._template = sparse.csc_matrix((np.arange(count, dtype=float), (rows, columns)), shape)
        except (ValueError, TypeError, OverflowError) as error:
            raise InvalidInput(
                f"a pattern has a shape, and a row and a column within for each entry: {error}"
            ) from None
        if self._template.nnz != count:
            raise InvalidInput("a pattern must not name a place twice")
        self._order = self._template.data.astype(np.intp)
        for shared in (self._template.indices, self._template.indptr):
            shared.setflags(write=False)
        _ = self._template.has_canonical_format  # looked at once, and known of every copy
        self._template.places = self._template.indices

    def filled(self, values: Array) -> sparse.csc_matrix:
        """The matrix with ``values`` (k,) at the places, in the order the pattern was given.

        Args:
            values: (k,) at the places, in the order the pattern was given.
        """
        matrix = copy(self._template)  # shares the places
        try:
            matrix.data = values[self._order]
        except (TypeError, IndexError):
            raise InvalidInput(
                f"values must be an array of {self._order.size} numbers, got {shown(values)}"
            ) from None
        return matrix


def is_placed(matrix: sparse.csc_matrix) -> bool:
    """Whether the places of a matrix are those of a ``Pattern``, which has looked at them."""
    return getattr(matrix, "places", None) is matrix.indices
