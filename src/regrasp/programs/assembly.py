"""A builder of programs: rows are demanded one cone at a time."""

import numpy as np
from scipy import sparse

from regrasp.errors import InvalidInput, shown
from regrasp.programs.blocks import ArrayLike, Block, Cone, numbers
from regrasp.programs.program import Program


class Rows:
    """Collects demands ``M x + c in cone`` and hands them over as A x + s = b with A = -M, b = c.

    Args:
        unknowns: n, how many x there are.
    """

    def __init__(self, unknowns: int) -> None:
        if isinstance(unknowns, bool) or not isinstance(unknowns, (int, np.integer)) or unknowns < 0:
            raise InvalidInput(f"unknowns must be a whole number of 0 or more, got {shown(unknowns)}")
        self._unknowns = unknowns
        self._matrices: list[sparse.csr_matrix | np.ndarray] = []
        self._offsets: list[np.ndarray] = []
        self._blocks: list[Block] = []

    def __len__(self) -> int:
        """Rows demanded so far."""
        return sum(len(offset) for offset in self._offsets)

    def equal(self, matrix: ArrayLike | sparse.spmatrix, offset: ArrayLike = 0.0) -> None:
        """Demand M x + c = 0, row by row; M (k, n), c (k,) or one number for all rows.

        Args:
            matrix: (k, n) M, dense or sparse.
            offset: c, (k,) or one number for all rows.
        """
        m = self._checked(matrix)
        self._add(Cone.ZERO, m, offset, m.shape[0])

    def at_least_zero(self, matrix: ArrayLike | sparse.spmatrix, offset: ArrayLike = 0.0) -> None:
        """Demand M x + c >= 0, row by row; M (k, n), c (k,) or one number for all rows.

        Args:
            matrix: (k, n) M, dense or sparse.
            offset: c, (k,) or one number for all rows.
        """
        m = self._checked(matrix)
        self._add(Cone.NONNEGATIVE, m, offset, m.shape[0])

    def second_order(
        self, matrix: ArrayLike | sparse.spmatrix, offset: ArrayLike = 0.0, *, size: int | None = None
    ) -> None:
        """Demand (t, v) = M x + c with |v| <= t; ``size`` rows to a cone, all rows in one if not given.

        Args:
            matrix: (k, n) M, dense or sparse.
            offset: c, (k,) or one number for all rows.
            size: rows of each cone; all rows in one if not given.
        """
        m = self._checked(matrix)
        size = max(m.shape[0], 1) if size is None else size
        if not isinstance(size, (int, np.integer)) or size < 1 or m.shape[0] % size:
            raise InvalidInput(f"{m.shape[0]} rows cannot be split into cones of {shown(size)}")
        self._add(Cone.SECOND_ORDER, m, offset, size)

    def program(
        self, q: ArrayLike, P: ArrayLike | sparse.spmatrix | None = None, *, size: float = 0.0
    ) -> Program:
        """The program with these rows and the objective 1/2 x'Px + q'x.

        Args:
            q: (n,).
            P: (n, n), symmetric and positive semidefinite; zero if not given.
            size: as in ``Program``.
        """
        n = self._unknowns
        squares = np.zeros((n, n)) if P is None else P
        if not sparse.issparse(squares):
            squares = numbers(squares, "P")
            if squares.ndim != 2:
                raise InvalidInput(f"P must have shape {(n, n)}, got {squares.shape}")
        return Program(
            P=sparse.csc_matrix(squares),
            q=numbers(q, "q"),
            A=-_stacked([*self._matrices, np.zeros((0, n))]),
            b=np.concatenate([*self._offsets, np.zeros(0)]),
            blocks=tuple(self._blocks),
            size=size,
        )

    def _checked(self, matrix: ArrayLike | sparse.spmatrix) -> sparse.csr_matrix | np.ndarray:
        if sparse.issparse(matrix):
            m: sparse.csr_matrix | np.ndarray = sparse.csr_matrix(matrix, dtype=float)
        else:
            m = np.atleast_2d(numbers(matrix, "rows"))
        if m.ndim != 2:
            raise InvalidInput(f"rows must have shape (k, {self._unknowns}), got {m.shape}")
        if m.shape[1] != self._unknowns:
            raise InvalidInput(f"rows must have {self._unknowns} columns, got {m.shape[1]}")
        return m

    def _add(self, cone: Cone, matrix: sparse.csr_matrix | np.ndarray, offset: ArrayLike, size: int) -> None:
        rows = matrix.shape[0]
        if not rows:
            return
        offsets = numbers(offset, "offset")
        if offsets.shape not in ((), (1,), (rows,)):
            raise InvalidInput(f"offset must be a number or have shape ({rows},), got {offsets.shape}")
        self._offsets.append(np.broadcast_to(offsets, rows))
        self._matrices.append(matrix)
        self._blocks.append(Block(cone, size, rows // size))


def _stacked(matrices: list[sparse.csr_matrix | np.ndarray]) -> sparse.csc_matrix:
    """Of dense rows at once, which takes a tenth of the time where they are many and small."""
    if all(isinstance(matrix, np.ndarray) for matrix in matrices):
        return sparse.csc_matrix(np.vstack(matrices))
    return sparse.vstack([sparse.csr_matrix(matrix) for matrix in matrices], format="csc")
