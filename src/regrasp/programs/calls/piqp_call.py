"""PIQP, called directly. An update keeps the scaling and the symbolic factorisation."""

from time import perf_counter
from typing import Any

import piqp

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import FEW, Split, split
from regrasp.programs.program import Program

_CLAIMS = {
    "PIQP_SOLVED": "found",
    "PIQP_PRIMAL_INFEASIBLE": "infeasible",
    "PIQP_DUAL_INFEASIBLE": "unbounded",
}


def layout(program: Program) -> Split:
    """Equalities apart; dense for a few unknowns."""
    return split(program, dense=program.q.size <= FEW)


class Session:
    """A program set up in PIQP's dense or sparse solver."""

    def __init__(self, data: Split, **options: Any) -> None:
        started = perf_counter()
        self._data = data
        is_dense = data.q.size <= FEW
        self._solver = piqp.DenseSolver() if is_dense else piqp.SparseSolver()
        self._solver.settings.verbose = False
        for key, value in options.items():
            setattr(self._solver.settings, key, value)
        P, q, G, h, A, b, _ = data
        self._solver.setup(P, q, A, b, G, None, h, None, None)
        self._setup = perf_counter() - started

    def update(self, data: Split) -> None:
        """The same program with another right side."""
        started = perf_counter()
        self._solver.update(b=data.b, h_u=data.h)
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        said = self._solver.solve().name
        took = perf_counter() - started
        status, result = _CLAIMS.get(said, "failed"), self._solver.result
        # Of a program without solution its last iterate grows towards a certificate, and is near one.
        duals = self._data.joined(result.z_u, result.y)
        return Answer(status, result.x, duals, result.info.iter, said, None, self._setup, took)
