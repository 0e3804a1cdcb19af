"""Where solvers are wrong about choices of forces: every installed one is asked directly and judged.

    python benchmarks/answers/misjudgements.py [-o FILE]

Each degenerate case under a load becomes two programs over polygons: ``effort``, a QP, and ``peak``, an LP.
Solvers are called as a user would call them, at their defaults and at the settings regrasp gives them. What
one says is wrong where it

    solved      answers a program that has no answer, or misses its optimum: the residual exceeds 1e-5
    infeasible  refuses a program that has an answer, known from how the case is made

"Not found" and errors are refusals and no misjudgements.
"""

import argparse
import json
import warnings
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import qpsolvers

from degenerate import Degenerate, degenerate_cases
from regrasp.mechanics.reserve import kept_friction
from regrasp.planning.states.program import state_program
from regrasp.programs import (
    Cone,
    Program,
    Solution,
    Status,
    available_backends,
    clarabel_backend,
    cvxpy_backend,
)
from regrasp.programs.facts import BACKENDS

RESULTS = Path(__file__).parents[1] / "results" / "misjudgements.json"
FACETS = 24
WRONG = 1e-5
OBJECTIVES = ("effort", "peak")
SETTINGS = ("default", "ours")
CLARABEL = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas", "tol_infeas_abs", "tol_infeas_rel"), 1e-8)
"""Clarabel's defaults."""

# Options by the names that qpsolvers has for them, where these differ from the solver's own.
OURS = {
    "osqp": {**BACKENDS["osqp"].options, "polishing": True},
    "proxqp": {"eps_abs": 1e-10, "eps_rel": 0.0, "rho": 1e-2},
    "highs": {},
}


def program_of(case: Degenerate, objective: str) -> Program:
    """The choice of forces, scaled as regrasp scales it."""
    grasp, load = case.grasp, case.wrench
    size = grasp.size or 1.0
    unit = max(float(abs(load.force).max()), float(abs(load.torque).max()) / size) or 1.0
    frictions = [kept_friction(contact.friction, 1e-9) for contact in grasp]
    return state_program(grasp, load, objective, frictions, list(grasp.max_forces), unit, FACETS)


def asked(program: Program, solver: str, settings: str) -> Solution:
    """The solver's answer and its own word, not audited."""
    if solver == "clarabel":
        return clarabel_backend.solve(program, solver, **(CLARABEL if settings == "default" else {}))
    if solver.startswith("cvxpy"):
        return cvxpy_backend.solve(program, solver)
    options = {} if settings == "default" else OURS.get(solver, BACKENDS[solver].options)
    equal = np.zeros(program.b.size, dtype=bool)
    for block, rows in program.slices:
        equal[rows] = block.cone is Cone.ZERO
    rows = program.A.tocsr()
    data: list[Any] = [program.P, rows[~equal].tocsc(), rows[equal].tocsc()]
    if solver in qpsolvers.dense_solvers and solver not in qpsolvers.sparse_solvers:
        data = [matrix.toarray() for matrix in data]
    problem = qpsolvers.Problem(data[0], program.q, data[1], program.b[~equal], data[2], program.b[equal])
    try:
        answer = qpsolvers.solve_problem(problem, solver, **options)
    except (qpsolvers.exceptions.QPError, ValueError) as error:
        answer = qpsolvers.Solution(problem, found=False)
        answer.extras["error"] = str(error)
    x, z = np.full(program.q.size, np.nan), np.full(program.b.size, np.nan)
    if answer.found:
        x = answer.x
        z[~equal], z[equal] = answer.z, answer.y
    status = Status.SOLVED if answer.found else Status.NOT_FOUND
    return Solution(program, solver, status, x, z, None, 0.0, 0.0, "found" if answer.found else "not found")


def is_wrong(answer: Solution, answerable: bool | None) -> bool:
    """Whether the solver's own word is wrong."""
    if answer.status is Status.SOLVED:
        return answerable is False or not answer.residual <= WRONG
    refuses = answer.status is Status.INFEASIBLE or answer.said == "infeasible"
    return refuses and answerable is True


def solvers() -> list[str]:
    """Every installed back end, and Clarabel by way of cvxpy."""
    return [*available_backends(), "cvxpy:CLARABEL"]


def has_answer(case: Degenerate) -> bool | None:
    """Whether its programs have an answer; polygons inside force limits may lose one."""
    limited = any(limit is not None for _, _, _, limit in case.contacts)
    return None if case.held and limited else case.held


def misjudgements() -> Iterator[dict[str, Any]]:
    """A record of each wrong word, in the order of solvers, settings, cases and objectives."""
    for solver in solvers():
        package = "clarabel" if solver == "clarabel" else BACKENDS[solver.partition(":")[0]].needs
        for settings in SETTINGS[:1] if solver.startswith("cvxpy") else SETTINGS:
            for case in filter(lambda case: any(case.load), degenerate_cases()):
                for objective in OBJECTIVES:
                    with warnings.catch_warnings(), np.errstate(all="ignore"):
                        warnings.simplefilter("ignore")
                        answer = asked(program_of(case, objective), solver, settings)
                        if is_wrong(answer, has_answer(case)):
                            yield {
                                "solver": solver,
                                "version": version(package),
                                "settings": settings,
                                "case": case.name,
                                "objective": objective,
                                "said": answer.said,
                                "has_answer": has_answer(case),
                                "residual": rounded(answer.residual),
                            }


def rounded(residual: float) -> float | None:
    """One digit, so that machines agree; None where it is not finite."""
    return float(f"{residual:.0e}") if np.isfinite(residual) else None


def main() -> None:
    parser = argparse.ArgumentParser(description="record where solvers are wrong about choices of forces")
    parser.add_argument("-o", "--output", type=Path, default=RESULTS)
    path = parser.parse_args().output
    records = list(misjudgements())
    path.write_text(
        json.dumps({"tolerance": WRONG, "misjudgements": records}, indent=1) + "\n", encoding="utf-8"
    )
    for solver in solvers():
        print(solver, sum(record["solver"] == solver for record in records))


if __name__ == "__main__":
    main()
