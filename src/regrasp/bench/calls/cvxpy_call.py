"""The conic solvers of cvxpy that take second-order cones. Its compiling counts as solving."""

from typing import Any

from cvxpy.reductions.solvers.defines import INSTALLED_SOLVERS, SOC, SOLVER_MAP_CONIC

from regrasp.bench.answer import Answer
from regrasp.programs import cvxpy_backend
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
    given = cvxpy_backend.solve(program, f"cvxpy:{name}", **options)
    status = _CLAIMS.get(given.said, "failed")
    found = status == "found"
    return Answer(
        status,
        given.value if found else None,
        given.duals if found else None,
        given.iterations,
        given.said,
        given.build_time,
        None,
        given.solve_time,
    )
