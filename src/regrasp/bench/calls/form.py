"""The form of QP solvers: G x <= h and A x = b, or l <= C x <= u."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from regrasp.programs.program import Array, Cone, Program


def equalities(program: Program) -> NDArray[np.bool_]:
    """(m,) which rows are equalities."""
    equal = np.zeros(program.b.size, dtype=bool)
    for block, rows in program.slices:
        equal[rows] = block.cone is Cone.ZERO
    return equal


class Split(NamedTuple):
    """Inequalities G x <= h and equalities A x = b, and which rows of the program the latter are."""

    P: Any
    q: Array
    G: Any
    h: Array
    A: Any
    b: Array
    equal: NDArray[np.bool_]

    def joined(self, of_inequalities: Any, of_equalities: Any) -> Array:
        """(m,) duals in the order of the program's rows."""
        duals = np.full(self.equal.size, np.nan)
        for part, values in ((~self.equal, of_inequalities), (self.equal, of_equalities)):
            if part.any() and values is not None:
                duals[part] = values
        return duals


def split(program: Program, *, dense: bool = False) -> Split:
    """Copies in the form qpsolvers takes: programs share read-only arrays, which some solvers refuse."""
    equal = equalities(program)
    rows = program.A.tocsr()
    P, G, A = (
        matrix.toarray() if dense else sparse.csc_matrix(matrix, copy=True)
        for matrix in (program.P, rows[~equal], rows[equal])
    )
    return Split(P, program.q.copy(), G, program.b[~equal], A, program.b[equal], equal)


def bounds(b: Array, equal: NDArray[np.bool_], infinity: float = np.inf) -> tuple[Array, Array]:
    """(m,) l and u of l <= C x <= u with C the program's A."""
    return np.where(equal, b, -infinity), b.copy()
