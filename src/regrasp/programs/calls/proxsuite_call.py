"""ProxQP, called directly. An update keeps the scaling and starts from the last result."""

from time import perf_counter
from typing import Any

import numpy as np
from proxsuite import proxqp

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import FEW, Split, split
from regrasp.programs.program import Program

_CLAIMS = {
    "PROXQP_SOLVED": "found",
    "PROXQP_PRIMAL_INFEASIBLE": "infeasible",
    "PROXQP_DUAL_INFEASIBLE": "unbounded",
}


def layout(program: Program) -> Split:
    """Equalities apart; dense for a few unknowns."""
    return split(program, dense=program.q.size <= FEW)


class Session:
    """A program set up in ProxQP's dense or sparse solver."""

    def __init__(self, data: Split, **options: Any) -> None:
        started = perf_counter()
        self._data = data
        P, q, G, h, A, b, _ = data
        kind = proxqp.dense if q.size <= FEW else proxqp.sparse
        self._solver = kind.QP(q.size, b.size, h.size)
        for key, value in options.items():
            setattr(self._solver.settings, key, value)
        below = np.full(h.size, -np.inf)  # the sparse solver crashes without lower bounds
        self._solver.init(P, q, A, b, G, below, h)
        self._setup = perf_counter() - started

    def update(self, data: Split) -> None:
        """The same program with another right side."""
        started = perf_counter()
        self._solver.settings.initial_guess = proxqp.WARM_START_WITH_PREVIOUS_RESULT
        self._solver.update(b=data.b, u=data.h)
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        self._solver.solve()
        took = perf_counter() - started
        result = self._solver.results
        said = result.info.status.name
        status = _CLAIMS.get(said, "failed")
        # Of a program without solution its last iterate grows towards a certificate, and is near one.
        duals = self._data.joined(result.z, result.y)
        return Answer(status, result.x, duals, int(result.info.iter), said, None, self._setup, took)
