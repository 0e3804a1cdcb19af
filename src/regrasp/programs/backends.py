"""The table of back ends and the one verb that calls them."""

import logging
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any, NamedTuple

from regrasp.errors import InvalidInput, SolverFailed, SolverUnavailable
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status

_log = logging.getLogger("regrasp.programs")


class Backend(NamedTuple):
    """A way to solve programs.

    needs: the package that must be installed. module: ours, which imports it. second_order: takes such cones.
    tolerance: largest residual of an answer that counts as sound.
    """

    needs: str
    module: str
    second_order: bool
    tolerance: float


_QP = "regrasp.programs.qpsolvers_backend"
# Active-set and interior-point methods answer to 1e-7 or better; first-order methods (osqp, scs) do not.
BACKENDS = {
    "clarabel": Backend("clarabel", "regrasp.programs.clarabel_backend", True, 5e-7),
    "daqp": Backend("daqp", _QP, False, 1e-7),
    "quadprog": Backend("quadprog", _QP, False, 1e-7),
    "highs": Backend("highspy", _QP, False, 1e-6),
    "piqp": Backend("piqp", _QP, False, 1e-7),
    "proxqp": Backend("proxsuite", _QP, False, 1e-6),
    "qpalm": Backend("qpalm", _QP, False, 1e-5),
    "osqp": Backend("osqp", _QP, False, 1e-5),
    "scs": Backend("scs", _QP, False, 1e-5),
    "cvxpy": Backend("cvxpy", "regrasp.programs.cvxpy_backend", True, 1e-6),
}
# Statuses that say something of the program; the others say something of the back end.
_CLAIMS = (Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED)
CERTIFICATE_TOLERANCE = 1e-6
"""Largest residual of a certificate: a feasible point would lie a million times the data's size away."""
_AUTO = ("clarabel", "daqp", "osqp", "cvxpy")


def is_available(name: str) -> bool:
    """Whether a back end is installed here, one of cvxpy's solvers if cvxpy is."""
    backend = BACKENDS.get(name.partition(":")[0])
    return backend is not None and _is_installed(backend)


def available_backends() -> tuple[str, ...]:
    """Names of the back ends installed here; ``cvxpy:<SOLVER>`` names one of cvxpy's solvers besides."""
    return tuple(name for name, backend in BACKENDS.items() if _is_installed(backend))


@cache
def _has(package: str) -> bool:
    return find_spec(package) is not None


def _is_installed(backend: Backend) -> bool:
    return _has(backend.needs) and (backend.module != _QP or _has("qpsolvers"))


def solve(program: Program, backend: str = "auto", *, throw: bool = True, **options: Any) -> Solution:
    """Solve a program and audit the answer.

    backend: a name of ``available_backends()``, ``cvxpy:<SOLVER>``, or ``auto``: the first installed one
    whose answer is sound (a warning is logged for each that was not).
    throw: raise ``SolverFailed`` for an answer that is neither sound nor a proven impossibility; without it
    such an answer is returned with its status.
    options: passed to the back end as they are.

    Raises ``SolverUnavailable`` for a back end unknown or not installed, ``InvalidInput`` for a program
    with second-order cones on a back end that takes none.
    """
    if backend == "auto":
        return _first_sound(program, throw, options)
    entry = _entry(backend)
    if program.has_second_order and not entry.second_order:
        takers = ", ".join(name for name in available_backends() if BACKENDS[name].second_order)
        raise InvalidInput(
            f"back end {backend!r} solves QPs only and the program has second-order cones; use linearised "
            f"cones (facets=...), or one of {takers}"
        )
    call: Callable[..., Solution] = import_module(entry.module).solve
    solution = call(program, backend, **options)
    if solution.status is Status.STOPPED and solution.residual <= entry.tolerance:
        # It stopped short of its own, tighter tolerances; value and duals prove each other good enough.
        solution = replace(solution, status=Status.SOLVED)
    allowed = entry.tolerance if solution.status is Status.SOLVED else CERTIFICATE_TOLERANCE
    if solution.status in _CLAIMS and not solution.residual <= allowed:
        said = f"{solution.said}, but residual {solution.residual:.1e} of {allowed:g} allowed"
        solution = replace(solution, status=Status.UNSOUND, said=said)
    if throw and solution.status not in _CLAIMS:
        raise SolverFailed(f"{solution}; {solution.status.advice}", program, solution)
    return solution


def _entry(backend: str) -> Backend:
    name = backend.partition(":")[0] if backend.startswith("cvxpy:") else backend
    if name not in BACKENDS:
        raise SolverUnavailable(
            f"no back end {backend!r}; known: auto, {', '.join(BACKENDS)}, cvxpy:<SOLVER>"
        )
    entry = BACKENDS[name]
    if not _is_installed(entry):
        raise SolverUnavailable(
            f"back end {name!r} needs the package {entry.needs}: pip install 'regrasp[solvers]'"
        )
    return entry


def _first_sound(program: Program, throw: bool, options: dict[str, Any]) -> Solution:
    if options:
        raise InvalidInput("options belong to one solver; name the back end they are for instead of 'auto'")
    solution = None
    for name in _AUTO:
        if name not in available_backends() or (program.has_second_order and not BACKENDS[name].second_order):
            continue
        solution = solve(program, name, throw=False)
        if solution.status in _CLAIMS:
            return solution
        _log.warning("%s; trying the next back end", solution)
    if solution is None:
        raise SolverUnavailable(f"none of {', '.join(_AUTO)} is installed")
    if throw:
        raise SolverFailed(f"no back end gave a sound answer; the last: {solution}", program, solution)
    return solution
