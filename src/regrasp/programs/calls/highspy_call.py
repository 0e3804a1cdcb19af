"""HiGHS, called directly: qpsolvers drops its status. An update keeps the model.

Its QP solver is of the active-set kind.
"""

from time import perf_counter
from typing import Any, NamedTuple

import highspy
import numpy as np
from scipy import sparse

from regrasp.errors import InvalidInput
from regrasp.programs.answer import Answer
from regrasp.programs.blocks import Array
from regrasp.programs.calls.form import bounded
from regrasp.programs.program import Program

_HIGHS: Any = highspy.Highs  # ships no types of its own
_CLAIMS = {"kOptimal": "found", "kInfeasible": "infeasible", "kUnbounded": "unbounded"}
_WITHOUT = ("kInfeasible", "kUnbounded", "kUnboundedOrInfeasible")


class Data(NamedTuple):
    """A ``HighsModel``, and (m,) the bounds of its rows."""

    model: Any
    lower: Array
    upper: Array


def layout(program: Program) -> Data:
    """The program as HiGHS' model."""
    P, q, A, lower, upper, _ = bounded(program)
    n, m = q.size, upper.size
    model = highspy.HighsModel()
    lp = model.lp_
    lp.num_col_, lp.num_row_ = n, m
    lp.col_cost_ = q
    lp.col_lower_, lp.col_upper_ = np.full(n, -highspy.kHighsInf), np.full(n, highspy.kHighsInf)
    lp.row_lower_, lp.row_upper_ = lower, upper
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.num_row_, lp.a_matrix_.num_col_ = m, n
    lp.a_matrix_.start_, lp.a_matrix_.index_ = A.indptr, A.indices
    lp.a_matrix_.value_ = A.data
    if P.nnz:
        triangle = sparse.tril(P, format="csc")
        model.hessian_.dim_ = n
        model.hessian_.start_, model.hessian_.index_ = triangle.indptr, triangle.indices
        model.hessian_.value_ = triangle.data
    return Data(model, lower, upper)


class Session:
    """A program set up in HiGHS."""

    def __init__(self, data: Data, **options: Any) -> None:
        started = perf_counter()
        self._solver = _HIGHS()
        self._solver.silent()
        for key, value in {"threads": 1, **options}.items():
            if self._solver.setOptionValue(key, value) == highspy.HighsStatus.kError:
                raise InvalidInput(f"HiGHS does not take {key} = {value}")
        self._solver.passModel(data.model)
        self._setup = perf_counter() - started

    def update(self, data: Data) -> None:
        """The same program with another right side."""
        started = perf_counter()
        rows = np.arange(data.upper.size, dtype=np.int32)
        self._solver.changeRowsBounds(rows.size, rows, data.lower, data.upper)
        self._setup = perf_counter() - started

    def solve(self) -> Answer:
        """The answer for the right side set last."""
        started = perf_counter()
        self._solver.run()
        took = perf_counter() - started
        said = self._solver.getModelStatus().name
        status = _CLAIMS.get(said, "failed")
        x = duals = None
        if status == "found":
            solution = self._solver.getSolution()
            x, duals = np.array(solution.col_value), -np.array(solution.row_dual)
        elif said in _WITHOUT:
            status, x, duals = self._ray(status)
        info = self._solver.getInfo()
        counts = (info.qp_iteration_count, info.simplex_iteration_count, info.ipm_iteration_count)
        iterations = sum(max(count, 0) for count in counts)
        return Answer(status, x, duals, iterations, said, None, self._setup, took)

    def _ray(self, status: str) -> tuple[str, Array | None, Array | None]:
        """What a ray proves, and the ray; it has one where presolve is off or did not find out."""
        _, is_there, ray = self._solver.getDualRay()
        if is_there and status != "unbounded":
            return "infeasible", None, -np.array(ray)
        _, is_there, ray = self._solver.getPrimalRay()
        if is_there and status != "infeasible":
            return "unbounded", np.array(ray), None
        return status, None, None
