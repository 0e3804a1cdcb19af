"""Convex programs and the solvers that answer them. Knows nothing of contacts."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec

from regrasp.errors import SolverFailed, SolverUnavailable
from regrasp.programs.program import Cone, Program, Rows
from regrasp.programs.solution import Solution, Status

__all__ = ["Cone", "Program", "Rows", "Solution", "Status", "available_backends", "solve"]

# name -> (module that must be installed, our module that calls it, residuals its answers must meet)
_BACKENDS = {"clarabel": ("clarabel", "regrasp.programs.clarabel_backend", 1e-7)}


def available_backends() -> tuple[str, ...]:
    """Names of the back ends whose solver is installed."""
    return tuple(name for name, (needs, _, _) in _BACKENDS.items() if find_spec(needs) is not None)


def solve(program: Program, backend: str = "clarabel") -> Solution:
    """Solve a program and audit the answer with our own residuals.

    The audit decides, not the solver's word: an answer whose residuals pass is solved, also where the
    solver stopped short of its own, tighter tolerances. One whose residuals fail raises ``SolverFailed``
    carrying both; an unknown or missing back end raises ``SolverUnavailable``.
    """
    if backend not in _BACKENDS:
        raise SolverUnavailable(f"no back end {backend!r}; known: {', '.join(_BACKENDS)}")
    needs, module, tolerance = _BACKENDS[backend]
    if find_spec(needs) is None:
        raise SolverUnavailable(f"back end {backend!r} needs the package {needs}: pip install {needs}")
    call: Callable[[Program], Solution] = import_module(module).solve
    solution = call(program)
    if solution.status not in (Status.SOLVED, Status.STOPPED):
        return solution
    if not solution.is_sound(tolerance):
        raise SolverFailed(
            f"{backend} answered {solution.status.name} with residuals: cones {solution.cone_violation:.1e}, "
            f"dual {solution.dual_residual:.1e}, gap {solution.gap:.1e}; needed {tolerance:g}. "
            f"{Status.STOPPED.value}",
            program,
            solution,
        )
    return replace(solution, status=Status.SOLVED)
