"""quadprog, called directly, for strictly convex programs. It keeps nothing between two solves."""

from time import perf_counter
from typing import Any

import numpy as np
import quadprog

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Split, split
from regrasp.programs.program import Program


def layout(program: Program) -> Split:
    """Dense matrices, equalities apart."""
    return split(program, dense=True)


class Session:
    """A program laid out for quadprog."""

    def __init__(self, data: Split, **options: Any) -> None:
        self._data, self._options = data, options

    def update(self, data: Split) -> None:
        """The same program with another right side."""
        self._data = data

    def solve(self) -> Answer:
        """The answer for the right side set last; it has no certificate of a program without a point."""
        P, q, G, h, A, b, _ = self._data
        rows, sides, equalities = np.vstack([A, G]), np.concatenate([b, h]), b.size
        given = (-rows.T, -sides, equalities) if sides.size else ()
        started = perf_counter()
        try:
            x, _, _, iterations, duals, _ = quadprog.solve_qp(P, -q, *given, **self._options)
        except ValueError as error:
            status = "infeasible" if "no solution" in str(error) else "refused"
            said = str(error).replace("matrix G is not", "P is not")
            return Answer(status, said=said, solve_time=perf_counter() - started)
        took = perf_counter() - started
        joined = self._data.joined(duals[equalities:], duals[:equalities])
        return Answer("found", x, joined, int(iterations[0]), "found", None, None, took)
