"""The forms solvers take: l <= A x <= u, or G x <= h and A x = b, or cones in a fixed order.

Each module of this folder lays a program out in its solver's own form, ``layout(program)``, which is not
timed. A ``Session(data, **options)`` is then set up, may be given another right side by ``update(data)`` and
answers by ``solve()``. Layouts are copies: programs share read-only arrays, which some solvers refuse.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from regrasp.programs.answer import Answer
from regrasp.programs.blocks import Array, Cone
from regrasp.programs.program import Program

FEW = 16
"""Unknowns up to which PIQP and ProxQP are faster with dense matrices than with sparse ones."""


class Call(NamedTuple):
    """How a solver is called: ``solve(layout(program), **options)``; only the outer call is timed."""

    layout: Callable[[Program], Any]
    solve: Callable[..., Answer]


def equalities(program: Program) -> NDArray[np.bool_]:
    """(m,) which rows are equalities."""
    equal = np.zeros(program.b.size, dtype=bool)
    for block, rows in program.slices:
        equal[rows] = block.cone is Cone.ZERO
    return equal


class Bounds(NamedTuple):
    """minimise 1/2 x'Px + q'x subject to lower <= A x <= upper; equal: (m,) where both are one."""

    P: Any
    q: Array
    A: Any
    lower: Array
    upper: Array
    equal: NDArray[np.bool_]


def bounded(program: Program, infinity: float = np.inf, *, dense: bool = False) -> Bounds:
    """The program with bounds on its rows, in their order."""
    equal = equalities(program)
    P, A = (m.toarray() if dense else m.copy() for m in (program.P, program.A))
    lower = np.where(equal, program.b, -infinity)
    return Bounds(P, program.q.copy(), A, lower, program.b.copy(), equal)


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
        """(m,) duals in the order of the program's rows; NaN for None."""
        duals = np.empty(self.equal.size)
        for part, values in ((~self.equal, of_inequalities), (self.equal, of_equalities)):
            duals[part] = values  # NumPy makes NaN of None
        return duals


def split(program: Program, *, dense: bool = False) -> Split:
    """The program with its equalities apart."""
    equal = equalities(program)
    rows = program.A.tocsr()
    P, G, A = (
        matrix.toarray() if dense else sparse.csc_matrix(matrix, copy=True)
        for matrix in (program.P, rows[~equal], rows[equal])
    )
    return Split(P, program.q.copy(), G, program.b[~equal], A, program.b[equal], equal)


class Ordered(NamedTuple):
    """A x + s = b with rows of zero cones first, then non-negative ones, then cones of second order.

    P: the objective's upper triangle. order: (m,) the program's row that each row is. zeros, non_negatives:
    how many rows. sizes: of the second-order cones.
    """

    P: Any
    q: Array
    A: Any
    b: Array
    order: NDArray[np.intp]
    zeros: int
    non_negatives: int
    sizes: list[int]

    def restored(self, of_rows: Any) -> Array:
        """(m,) duals in the order of the program's rows."""
        duals = np.empty(self.order.size)
        duals[self.order] = of_rows
        return duals


def ordered(program: Program) -> Ordered:
    """The program with its rows in the order of conic solvers."""
    kinds = (Cone.ZERO, Cone.NONNEGATIVE, Cone.SECOND_ORDER)
    rows = {
        kind: [np.arange(r.start, r.stop) for block, r in program.slices if block.cone is kind]
        for kind in kinds
    }
    order = np.concatenate([part for kind in kinds for part in rows[kind]] or [np.arange(0)])
    sizes = [block.size for block in program.blocks if block.cone is kinds[2] for _ in range(block.count)]
    zeros, non_negatives = (sum(part.size for part in rows[kind]) for kind in kinds[:2])
    return Ordered(
        sparse.triu(program.P, format="csc"), program.q.copy(), program.A.tocsr()[order].tocsc(),
        program.b[order], order, zeros, non_negatives, sizes,
    )  # fmt: skip
