"""QP solvers that have no module of their own here, as qpsolvers calls them, with their own defaults."""

import warnings
from typing import Any

import qpsolvers

from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Split, split
from regrasp.programs.program import Program

_DENSE = set(qpsolvers.dense_solvers) - set(qpsolvers.sparse_solvers)
_CLAIMS = {
    "primal infeasible": "infeasible",
    "infeasible": "infeasible",
    "dual infeasible": "unbounded",
    "unbounded": "unbounded",
}
_OF_ECOS = {0: "found", 1: "infeasible", 2: "unbounded"}


def installed() -> tuple[str, ...]:
    """Names of the QP solvers that qpsolvers can call here."""
    return tuple(qpsolvers.available_solvers)


def layout(program: Program, name: str) -> tuple[qpsolvers.Problem, Split]:
    """The program as qpsolvers' own, dense for solvers that take nothing else."""
    data = split(program, dense=name in _DENSE)
    some = (data.G, data.h) if data.h.size else (None, None)
    return qpsolvers.Problem(
        data.P, data.q, *some, *((data.A, data.b) if data.b.size else (None, None))
    ), data


def solve(given: tuple[qpsolvers.Problem, Split], name: str, **options: Any) -> Answer:
    """The answer of one call."""
    problem, data = given
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        try:
            answer = qpsolvers.solve_problem(problem, name, **options)
        except (qpsolvers.exceptions.QPError, ValueError) as error:
            # quadprog and ECOS take no singular P, and say so beforehand.
            return Answer("refused" if "not positive definite" in str(error) else "failed", said=str(error))
    warned = "; ".join(str(warning.message) for warning in heard)
    status, said = _claim(answer, name, warned)
    found = status == "found"
    x, duals = (answer.x, data.joined(answer.z, answer.y)) if found else (None, None)
    return Answer(status, x, duals, _iterations(answer), said, answer.build_time, None, answer.solve_time)


def _of(answer: Any, key: str) -> Any:
    """An entry of what the solver tells of its run, or None."""
    told = answer.extras.get("info", answer.extras)
    return told.get(key) if isinstance(told, dict) else getattr(told, key, None)


def _iterations(answer: Any) -> int | None:
    for key in ("iter", "iterations", "stats"):
        count = _of(answer, key)
        if count is not None:
            # quadprog counts additions and removals, QTQP keeps what it saw at each.
            return int(len(count) if key == "stats" else count[0] if hasattr(count, "__len__") else count)
    return None


def _claim(answer: Any, name: str, warned: str) -> tuple[str, str]:
    """The claim and the solver's own words. Words such as ``primal infeasible inaccurate`` claim nothing."""
    if name == "ecos":
        said = str(_of(answer, "infostring"))
        return _OF_ECOS.get(_of(answer, "exitFlag"), "failed"), said
    told = _of(answer, "status")
    said = str(getattr(told, "name", told)) if told is not None else warned
    if answer.found:
        return "found", said or "found"
    if name == "quadprog" and not warned:
        return "infeasible", "constraints are inconsistent, no solution"
    word = said.lower().replace("_", " ").removeprefix(name + " ")
    return _CLAIMS.get(word, "failed"), said or "not found"
