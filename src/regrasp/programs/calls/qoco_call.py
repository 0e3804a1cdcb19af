"""QOCO, called directly, for it takes second-order cones. An update keeps the symbolic factorisation."""

from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
import qoco

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Ordered, ordered
from regrasp.programs.program import Program

# It has no verdict on programs without solution; "inaccurate" is no verdict either.
_CLAIMS = {"QOCO_SOLVED": "found"}


class Data(NamedTuple):
    """Rows in the order of QOCO's cones: equalities, and the others."""

    rows: Ordered
    equalities: Any
    others: Any


def layout(program: Program) -> Data:
    """Rows in the order of QOCO's cones, equalities apart; None where there are none of a kind."""
    rows = ordered(program)
    split = rows.A.tocsr()
    equalities, others = (
        part.tocsc() if part.shape[0] else None for part in (split[: rows.zeros], split[rows.zeros :])
    )
    return Data(rows, equalities, others)


class Session:
    """A program set up in QOCO."""

    def __init__(self, data: Data, **options: Any) -> None:
        started = perf_counter()
        rows, equalities, others = data
        self._rows = rows
        p = rows.zeros
        self._solver = qoco.QOCO()
        self._solver.setup(
            rows.q.size, rows.b.size - p, p, rows.P if rows.P.nnz else None, rows.q,
            equalities, rows.b[:p], others, rows.b[p:],
            rows.non_negatives, len(rows.sizes), np.array(rows.sizes, dtype=np.int32), **options,
        )  # fmt: skip
        self._setup = perf_counter() - started

    def update(self, data: Data) -> None:
        """The same program with another right side."""
        started = perf_counter()
        self._solver.update_vector_data(b=data.rows.b[: data.rows.zeros], h=data.rows.b[data.rows.zeros :])
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        answer = self._solver.solve()
        took = perf_counter() - started
        status = _CLAIMS.get(answer.status, "failed")
        duals = self._rows.restored(np.concatenate([answer.y, answer.z]))
        return Answer(status, answer.x, duals, answer.iters, answer.status, None, self._setup, took)
