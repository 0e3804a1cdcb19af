"""QPALM, called directly. An update starts from the last iterate."""

from time import perf_counter
from typing import Any

import qpalm

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Bounds, bounded
from regrasp.programs.program import Program

_CLAIMS = {"solved": "found", "primal infeasible": "infeasible", "dual infeasible": "unbounded"}


def layout(program: Program) -> Bounds:
    """Bounded rows."""
    return bounded(program)


class Session:
    """A program set up in QPALM."""

    def __init__(self, given: Bounds, **options: Any) -> None:
        started = perf_counter()
        data = qpalm.Data(given.q.size, given.upper.size)
        data.Q, data.q = given.P, given.q
        data.A, data.bmin, data.bmax = given.A, given.lower, given.upper
        settings = qpalm.Settings()
        settings.verbose = False
        for key, value in options.items():
            setattr(settings, key, value)
        self._solver = qpalm.Solver(data, settings)
        self._setup = perf_counter() - started

    def update(self, data: Bounds) -> None:
        """The same program with another right side."""
        started = perf_counter()
        last = self._solver.solution
        self._solver.warm_start(last.x.copy(), last.y.copy())
        self._solver.update_bounds(data.lower, data.upper)
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        self._solver.solve()
        took = perf_counter() - started
        said = self._solver.info.status
        status, last = _CLAIMS.get(said, "failed"), self._solver.solution
        duals = self._solver.prim_inf_certificate if status == "infeasible" else last.y
        x = self._solver.dual_inf_certificate if status == "unbounded" else last.x
        return Answer(status, x, duals, self._solver.info.iter, said, None, self._setup, took)
