"""HiGHS, called directly: qpsolvers drops its status. Its QP solver is of the active-set kind."""

from time import perf_counter
from typing import Any

import highspy
import numpy as np
from scipy import sparse

from regrasp.bench.answer import Answer
from regrasp.bench.calls.form import bounds, equalities
from regrasp.errors import InvalidInput
from regrasp.programs.program import Program

_HIGHS: Any = highspy.Highs  # ships no types of its own
_CLAIMS = {"kOptimal": "found", "kInfeasible": "infeasible", "kUnbounded": "unbounded"}


def solve(program: Program, **options: Any) -> Answer:
    """The answer of one run."""
    started = perf_counter()
    lower, upper = bounds(program.b, equalities(program))
    n, m = program.q.size, program.b.size
    model = highspy.HighsModel()
    lp = model.lp_
    lp.num_col_, lp.num_row_ = n, m
    lp.col_cost_ = program.q
    lp.col_lower_, lp.col_upper_ = np.full(n, -highspy.kHighsInf), np.full(n, highspy.kHighsInf)
    lp.row_lower_, lp.row_upper_ = lower, upper
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.num_row_, lp.a_matrix_.num_col_ = m, n
    lp.a_matrix_.start_, lp.a_matrix_.index_ = program.A.indptr, program.A.indices
    lp.a_matrix_.value_ = program.A.data
    if program.P.nnz:
        triangle = sparse.tril(program.P, format="csc")
        model.hessian_.dim_ = n
        model.hessian_.start_, model.hessian_.index_ = triangle.indptr, triangle.indices
        model.hessian_.value_ = triangle.data
    built = perf_counter()
    solver = _HIGHS()
    solver.silent()
    for key, value in {"threads": 1, **options}.items():
        if solver.setOptionValue(key, value) == highspy.HighsStatus.kError:
            raise InvalidInput(f"HiGHS does not take {key} = {value}")
    solver.passModel(model)
    ready = perf_counter()
    solver.run()
    solved = perf_counter()
    said = solver.getModelStatus().name
    status = _CLAIMS.get(said, "failed")
    x = duals = None
    if status == "found":
        solution = solver.getSolution()
        x, duals = np.array(solution.col_value), -np.array(solution.row_dual)
    info = solver.getInfo()
    counts = (info.qp_iteration_count, info.simplex_iteration_count, info.ipm_iteration_count)
    times = (built - started, ready - built, solved - ready)
    return Answer(status, x, duals, sum(max(count, 0) for count in counts), said, *times)
