"""cvxpy with any of its solvers, as the reference. Imported when used: cvxpy alone costs over a second."""

import warnings
from time import perf_counter
from typing import Any

import cvxpy as cp
import numpy as np
from scipy import sparse

from regrasp.errors import SolverUnavailable, shown
from regrasp.programs.blocks import Cone
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status

_STATUS = {
    cp.OPTIMAL: Status.SOLVED,
    # cvxpy hands no certificate through, so these verdicts cannot be audited.
    cp.INFEASIBLE: Status.NOT_FOUND,
    cp.UNBOUNDED: Status.NOT_FOUND,
}


def solve(program: Program, name: str, **options: Any) -> Solution:
    """Solve with the solver named in ``cvxpy:<SOLVER>``, or cvxpy's own choice for ``cvxpy``."""
    return timed_solve(program, name, **options)[0]


def timed_solve(program: Program, name: str, **options: Any) -> tuple[Solution, float | None]:
    """The same, and the time that the solver itself tells of its work [s], or None."""
    started = perf_counter()
    _, _, solver = name.partition(":")
    if solver and solver not in cp.installed_solvers():
        known = ", ".join(cp.installed_solvers())
        raise SolverUnavailable(f"cvxpy has no solver {shown(solver)} here; it has {known}")
    x = cp.Variable(program.q.size)
    s = program.b - program.A @ x
    constraints: list[Any] = []
    if not program.b.size:  # some solvers want a row
        constraints.append(cp.Variable() == 0)
    for block, rows in program.slices:
        if block.cone is Cone.ZERO:
            constraints.append(s[rows] == 0)
        elif block.cone is Cone.NONNEGATIVE:
            constraints.append(s[rows] >= 0)
        else:
            each = cp.reshape(s[rows], (block.count, block.size), order="C")
            constraints.append(cp.SOC(each[:, 0], each[:, 1:], axis=1))
    quadratic = 0.5 * cp.quad_form(x, sparse.csc_matrix(program.P), assume_PSD=True) if program.P.nnz else 0
    problem = cp.Problem(cp.Minimize(quadratic + program.q @ x), constraints)
    built = perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what the status says
            problem.solve(solver=solver or None, **options)
        said = problem.status
    except cp.SolverError as error:
        said = f"error: {error}"
    solved = perf_counter()
    status = _STATUS.get(said, Status.STOPPED)
    found = said in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)
    duals = np.full(program.b.size, np.nan)
    if found:
        for (block, rows), constraint in zip(program.slices, constraints, strict=False):
            duals[rows] = _dual(block.cone, constraint)
    stats = problem.solver_stats
    solution = Solution(
        program,
        name,
        status,
        np.array(x.value) if found else np.full(program.q.size, np.nan),
        duals,
        None if stats is None else stats.num_iters,
        built - started,
        solved - built,
        said,
    )
    return solution, None if stats is None else stats.solve_time


def _dual(cone: Cone, constraint: Any) -> Any:
    """The dual in our sign: z with P x + q + A'z = 0."""
    value = constraint.dual_value
    if cone is Cone.ZERO:
        return -value  # cvxpy's multiplies b - A x - 0
    if cone is Cone.NONNEGATIVE:
        return value
    t, v = value
    return np.hstack([np.asarray(t).reshape(-1, 1), np.asarray(v)]).ravel()
