"""QOCO, called directly, for it takes second-order cones. An update keeps the symbolic factorisation."""

from time import perf_counter
from typing import Any

import numpy as np
import qoco

from regrasp.bench.answer import Answer
from regrasp.bench.calls.form import Ordered, ordered
from regrasp.programs.program import Program

# It has no verdict on programs without solution; "inaccurate" is no verdict either.
_CLAIMS = {"QOCO_SOLVED": "found"}


def layout(program: Program) -> Ordered:
    """Rows in the order of QOCO's cones."""
    return ordered(program)


class Session:
    """A program set up in QOCO."""

    def __init__(self, data: Ordered, **options: Any) -> None:
        started = perf_counter()
        self._data = data
        p, m = data.zeros, data.b.size - data.zeros
        self._solver = qoco.QOCO()
        self._solver.setup(
            data.q.size, m, p, data.P if data.P.nnz else None, data.q,
            data.A[:p] if p else None, data.b[:p], data.A[p:] if m else None, data.b[p:],
            data.non_negatives, len(data.sizes), np.array(data.sizes, dtype=np.int32), **options,
        )  # fmt: skip
        self._setup = perf_counter() - started

    def update(self, data: Ordered) -> None:
        """The same program with another right side."""
        started = perf_counter()
        self._solver.update_vector_data(b=data.b[: data.zeros], h=data.b[data.zeros :])
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        answer = self._solver.solve()
        took = perf_counter() - started
        status = _CLAIMS.get(answer.status, "failed")
        duals = self._data.restored(np.concatenate([answer.y, answer.z]))
        return Answer(status, answer.x, duals, answer.iters, answer.status, None, self._setup, took)
