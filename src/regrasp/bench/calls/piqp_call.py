"""PIQP with a right side that changes: it keeps its scaling and the symbolic factorisation."""

from time import perf_counter
from typing import Any

import piqp

from regrasp.bench.answer import Answer
from regrasp.bench.calls.form import split
from regrasp.programs.program import Array, Program

_CLAIMS = {
    "PIQP_SOLVED": "found",
    "PIQP_PRIMAL_INFEASIBLE": "infeasible",
    "PIQP_DUAL_INFEASIBLE": "unbounded",
}


class Session:
    """A program set up in PIQP's sparse solver."""

    def __init__(self, program: Program, **options: Any) -> None:
        started = perf_counter()
        self._split = s = split(program)
        self._solver = piqp.SparseSolver()
        self._solver.settings.verbose = False
        for key, value in options.items():
            setattr(self._solver.settings, key, value)
        built = perf_counter()
        self._solver.setup(s.P, s.q, s.A, s.b, s.G, None, s.h, None, None)
        self._build, self._setup = built - started, perf_counter() - built

    def update(self, b: Array) -> None:
        """Another right side (m,)."""
        started = perf_counter()
        self._solver.update(b=b[self._split.equal], h_u=b[~self._split.equal])
        self._build, self._setup = 0.0, perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        said = self._solver.solve().name
        took = perf_counter() - started
        status, result = _CLAIMS.get(said, "failed"), self._solver.result
        # Of an infeasible program it hands out its last iterate, not a certificate.
        duals = self._split.joined(result.z_u, result.y) if status == "found" else None
        x = result.x if status == "found" else None
        return Answer(status, x, duals, result.info.iter, said, self._build, self._setup, took)
