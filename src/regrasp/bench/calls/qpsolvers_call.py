"""The other QP solvers, as qpsolvers calls them, with their own defaults."""

import warnings
from time import perf_counter
from typing import Any

import qpsolvers

from regrasp.bench.answer import Answer
from regrasp.bench.calls.form import Split, split
from regrasp.programs.program import Program

_DENSE = set(qpsolvers.dense_solvers) - set(qpsolvers.sparse_solvers)
# What qpsolvers calls building is the solver's own set-up for these; for the others it lays out data.
_SETS_UP = ("osqp", "piqp", "qpalm")
# Units in which these report a set-up that happens within the call.
_OWN_SETUP = {"scs": 1e-3, "proxqp": 1e-6}


def installed() -> tuple[str, ...]:
    """Names of the QP solvers that qpsolvers can call here."""
    return tuple(qpsolvers.available_solvers)


def solve(program: Program, name: str, **options: Any) -> Answer:
    """The answer of one call."""
    started = perf_counter()
    data = split(program, dense=name in _DENSE)
    some = (data.G, data.h) if data.h.size else (None, None)
    problem = qpsolvers.Problem(data.P, data.q, *some, *((data.A, data.b) if data.b.size else (None, None)))
    laid_out = perf_counter()
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        try:
            answer = qpsolvers.solve_problem(problem, name, **options)
        except (qpsolvers.exceptions.QPError, ValueError) as error:  # quadprog refuses a singular P, for one
            return Answer("failed", said=f"refused: {error}")
    warned = "; ".join(str(warning.message) for warning in heard)
    build, solve = laid_out - started, float(answer.solve_time or 0.0)
    setup: float | None = None
    if name in _SETS_UP:
        setup = float(answer.build_time or 0.0)
    else:
        build += float(answer.build_time or 0.0)
    if name in _OWN_SETUP and (told := _of(answer, "setup_time")):
        setup = _OWN_SETUP[name] * told
        solve -= setup
    status, said = _claim(answer, name, warned)
    x, duals = _values(answer, data, status, name)
    count = _of(answer, "iterations" if name == "quadprog" else "iter")
    if hasattr(count, "__len__"):
        count = count[0]  # quadprog counts additions and removals
    return Answer(status, x, duals, None if count is None else int(count), said, build, setup, solve)


def _of(answer: Any, key: str) -> Any:
    """An entry of what the solver tells of its run, or None."""
    told = answer.extras.get("info", answer.extras)
    return told.get(key) if isinstance(told, dict) else getattr(told, key, None)


def _claim(answer: Any, name: str, warned: str) -> tuple[str, str]:
    """The claim and the solver's own words. Words such as ``primal infeasible inaccurate`` claim nothing."""
    told = _of(answer, "status")
    said = str(getattr(told, "name", told)) if told is not None else warned
    if answer.found:
        return "found", said or "found"
    if name == "quadprog" and not warned:
        return "infeasible", "constraints are inconsistent, no solution"
    word = said.lower().replace("_", " ").removeprefix(name + " ")
    if word in ("primal infeasible", "infeasible"):
        return "infeasible", said
    if word in ("dual infeasible", "unbounded"):
        return "unbounded", said
    return "failed", said or "not found"


def _values(answer: Any, data: Split, status: str, name: str) -> tuple[Any, Any]:
    """The primal and dual values, or the certificate of those that hand one out."""
    if status == "found":
        return answer.x, data.joined(answer.z, answer.y)
    if status == "infeasible" and name == "osqp":
        certificate = answer.extras["prim_inf_cert"]
        return None, data.joined(certificate[: data.h.size], certificate[data.h.size :])
    if status == "infeasible" and name == "scs":
        return None, data.joined(answer.z, answer.y)
    return None, None
