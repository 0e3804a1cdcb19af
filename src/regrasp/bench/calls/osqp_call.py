"""OSQP with a right side that changes: it keeps its factorisation and starts from its last iterate."""

from time import perf_counter
from typing import Any

import osqp

from regrasp.bench.answer import Answer
from regrasp.bench.calls.form import bounds, equalities
from regrasp.programs.program import Array, Program

_CLAIMS = {"solved": "found", "primal infeasible": "infeasible", "dual infeasible": "unbounded"}


class Session:
    """A program set up in OSQP."""

    def __init__(self, program: Program, **options: Any) -> None:
        started = perf_counter()
        self._equal = equalities(program)
        lower, upper = bounds(program.b, self._equal)
        P, A = program.P.copy(), program.A.copy()
        self._solver = osqp.OSQP()
        built = perf_counter()
        self._solver.setup(P=P, q=program.q.copy(), A=A, l=lower, u=upper, verbose=False, **options)
        self._build, self._setup = built - started, perf_counter() - built

    def update(self, b: Array) -> None:
        """Another right side (m,)."""
        started = perf_counter()
        lower, upper = bounds(b, self._equal)
        self._solver.update(l=lower, u=upper)
        self._build, self._setup = 0.0, perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        answer = self._solver.solve(raise_error=False)
        took = perf_counter() - started
        said = str(answer.info.status)
        status = _CLAIMS.get(said, "failed")
        duals = answer.prim_inf_cert if status == "infeasible" else answer.y
        x = answer.dual_inf_cert if status == "unbounded" else answer.x
        return Answer(status, x, duals, answer.info.iter, said, self._build, self._setup, took)
