"""Clarabel, called directly. Imported when used."""

import clarabel
import numpy as np
from scipy import sparse

from regrasp.programs.program import Cone, Program
from regrasp.programs.solution import Solution, Status

_CONES = {
    Cone.ZERO: clarabel.ZeroConeT,
    Cone.NONNEGATIVE: clarabel.NonnegativeConeT,
    Cone.SECOND_ORDER: clarabel.SecondOrderConeT,
}
# "Almost" verdicts are not verdicts.
_STATUS = {
    clarabel.SolverStatus.Solved: Status.SOLVED,
    clarabel.SolverStatus.PrimalInfeasible: Status.INFEASIBLE,
    clarabel.SolverStatus.DualInfeasible: Status.UNBOUNDED,
}


def solve(program: Program) -> Solution:
    """Solve at tolerances of 1e-10; at 1e-12 Clarabel stops with insufficient progress."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix(np.triu(program.P)),
        program.q,
        sparse.csc_matrix(program.A),
        program.b,
        [_CONES[cone](size) for cone, size in program.cones],
        settings,
    )
    answer = solver.solve()
    return Solution(
        program,
        _STATUS.get(answer.status, Status.STOPPED),
        np.array(answer.x),
        np.array(answer.z),
        answer.iterations,
        answer.solve_time,
        "clarabel",
    )
