"""The conic solvers of cvxpy that take second-order cones. Its compiling counts as building."""

from typing import Any

from cvxpy.reductions.solvers.defines import INSTALLED_SOLVERS, SOC, SOLVER_MAP_CONIC

from regrasp.programs import cvxpy_backend
from regrasp.programs.answer import Answer
from regrasp.programs.program import Program

_CLAIMS = {"optimal": "found", "infeasible": "infeasible", "unbounded": "unbounded"}


def installed() -> tuple[str, ...]:
    """Names of cvxpy's conic solvers here that take second-order cones."""
    return tuple(
        name
        for name, solver in SOLVER_MAP_CONIC.items()
        if name in INSTALLED_SOLVERS and SOC in solver.SUPPORTED_CONSTRAINTS
    )


def solve(program: Program, name: str, **options: Any) -> Answer:
    """The answer of one call; cvxpy hands no certificate through."""
    given, own = cvxpy_backend.timed_solve(program, f"cvxpy:{name}", **options)
    status = _CLAIMS.get(given.said, "failed")
    x, duals = (given.value, given.duals) if status == "found" else (None, None)
    build = None if own is None else given.build_time + given.solve_time - own
    return Answer(status, x, duals, given.iterations, given.said, build, None, own)
