"""DAQP, called directly: qpsolvers drops its exit flag. An update starts from the last active set."""

from time import perf_counter
from typing import Any

import daqp
import numpy as np

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Bounds, bounded
from regrasp.programs.program import Program

_SAID = {
    2: "soft optimal",
    1: "optimal",
    -1: "infeasible",
    -2: "cycling",
    -3: "unbounded",
    -4: "iteration limit",
    -5: "non-convex",
    -6: "initial set not independent",
    -7: "time limit",
}
_CLAIMS = {1: "found", -1: "infeasible", -3: "unbounded"}
_INFINITY = 1e30
_EQUALITY = 5


def layout(program: Program) -> Bounds:
    """Dense matrices and bounded rows."""
    return bounded(program, _INFINITY, dense=True)


class Session:
    """A program set up in DAQP."""

    def __init__(self, data: Bounds, **options: Any) -> None:
        self._options = options
        self._set_up(data)

    def _set_up(self, data: Bounds) -> None:
        started = perf_counter()
        sense = np.where(data.equal, _EQUALITY, 0).astype(np.intc)
        self._solver = daqp.Model()
        self._solver.settings = self._options
        self._refused, _ = self._solver.setup(data.P, data.q, data.A, data.upper, data.lower, sense)
        self._setup = perf_counter() - started

    def update(self, data: Bounds) -> None:
        """The same program with another right side; a program that was refused leaves nothing to update."""
        if self._refused < 0:
            self._set_up(data)
            return
        started = perf_counter()
        self._refused = self._solver.update(bupper=data.upper, blower=data.lower)
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        if self._refused < 0:
            flag, x, duals, iterations, took = self._refused, None, None, None, 0.0
        else:
            started = perf_counter()
            x, _, flag, info = self._solver.solve()
            took = perf_counter() - started
            duals, iterations = info["lam"], info["iterations"]
        status = _CLAIMS.get(flag, "failed")
        said = _SAID.get(flag, f"exit flag {flag}")
        proven = None if status == "infeasible" else duals  # what it leaves there is no certificate
        return Answer(status, x, proven, iterations, said, None, self._setup, took)
