"""SCS, called directly, for it takes second-order cones. An update starts from the last iterate."""

from time import perf_counter
from typing import Any

import numpy as np
import scs
from scipy import sparse

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Ordered, ordered
from regrasp.programs.program import Program

# "Inaccurate" verdicts are not verdicts.
_CLAIMS = {"solved": "found", "infeasible": "infeasible", "unbounded": "unbounded"}


def layout(program: Program) -> Ordered:
    """Rows in the order of SCS's cones."""
    return ordered(program)


class Session:
    """A program set up in SCS."""

    def __init__(self, data: Ordered, **options: Any) -> None:
        started = perf_counter()
        self._data, self._is_first = data, True
        cone: dict[str, Any] = {"z": data.zeros, "l": data.non_negatives, "q": data.sizes}
        given = {"P": data.P, "A": data.A, "b": data.b, "c": data.q}
        if not data.b.size:  # it wants a row: 0'x <= 1
            cone["l"] = 1
            given |= {"A": sparse.csc_matrix((1, data.q.size)), "b": np.ones(1)}
        self._solver = scs.SCS(given, cone, verbose=False, **options)
        self._setup = perf_counter() - started

    def update(self, data: Ordered) -> None:
        """The same program with another right side."""
        started = perf_counter()
        self._solver.update(b=data.b)
        self._setup, self._is_first = perf_counter() - started, False

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        answer = self._solver.solve(warm_start=not self._is_first)
        took = perf_counter() - started
        info = answer["info"]
        status = _CLAIMS.get(info["status"], "failed")
        duals = self._data.restored(answer["y"])  # that of the row it wanted goes nowhere
        return Answer(status, answer["x"], duals, info["iter"], info["status"], None, self._setup, took)
