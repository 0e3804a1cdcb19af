"""OSQP, called directly. An update keeps the factorisation and starts from the last iterate."""

from time import perf_counter
from typing import Any

import osqp
from scipy import sparse

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Bounds, bounded
from regrasp.programs.program import Program

_CLAIMS = {"solved": "found", "primal infeasible": "infeasible", "dual infeasible": "unbounded"}


def layout(program: Program) -> Bounds:
    """Bounded rows, and of P the upper triangle."""
    data = bounded(program)
    return data._replace(P=sparse.triu(data.P, format="csc"))


class Session:
    """A program set up in OSQP."""

    def __init__(self, data: Bounds, **options: Any) -> None:
        started = perf_counter()
        self._solver = osqp.OSQP()
        P, q, A, lower, upper, _ = data
        self._solver.setup(P=P, q=q, A=A, l=lower, u=upper, verbose=False, **options)
        self._setup = perf_counter() - started

    def update(self, data: Bounds) -> None:
        """The same program with another right side."""
        started = perf_counter()
        self._solver.update(l=data.lower, u=data.upper)
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        answer = self._solver.solve(raise_error=False)
        took = perf_counter() - started
        said = str(answer.info.status)
        status = _CLAIMS.get(said, "failed")
        duals = answer.prim_inf_cert if status == "infeasible" else answer.y
        x = answer.dual_inf_cert if status == "unbounded" else answer.x
        return Answer(status, x, duals, answer.info.iter, said, None, self._setup, took)
