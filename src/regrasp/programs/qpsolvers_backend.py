"""Every QP solver that qpsolvers finds installed. Imported when used."""

import warnings
from time import perf_counter
from typing import Any

import numpy as np
import qpsolvers
from scipy import sparse

from regrasp.programs.program import Array, Cone, Program
from regrasp.programs.solution import Solution, Status

# Settings that bring each solver near the accuracy asked of it; options given override them.
_DEFAULTS: dict[str, dict[str, Any]] = {
    "osqp": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iter": 50_000, "polishing": True},
    "scs": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iters": 200_000},
    "proxqp": {"eps_abs": 1e-10, "eps_rel": 0.0, "rho": 1e-2},
    "qpalm": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iter": 20_000},
    "piqp": {"eps_abs": 1e-10, "eps_rel": 1e-10},
}
_DENSE = set(qpsolvers.dense_solvers) - set(qpsolvers.sparse_solvers)
# They refuse a linear objective, or stop short of its optimum.
_STRICTLY_CONVEX = ("daqp", "quadprog", "proxqp", "qpalm", "osqp")
# Weights of the proximal steps beside the linear objective: near it first, then far at one stride.
_WEIGHTS = np.repeat([1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7], [2, 2, 10, 4, 3, 3, 3])
# The last step's pull on the dual equation, relative to the objective.
_PULL = 1e-10


def installed() -> tuple[str, ...]:
    """Names of the QP solvers that qpsolvers can call here."""
    return tuple(qpsolvers.available_solvers)


def solve(program: Program, name: str, **options: Any) -> Solution:
    """Solve a program without second-order cones; ``options`` go to the solver as they are."""
    started = perf_counter()
    equal = np.zeros(program.b.size, dtype=bool)
    for block, rows in program.slices:
        equal[rows] = block.cone is Cone.ZERO
    rows = program.A.tocsr()
    matrices = [program.P, rows[~equal], rows[equal]]
    dense = name in _DENSE
    # Copies: programs share read-only arrays, which some solvers refuse.
    P, G, A = (m.toarray() if dense else sparse.csc_matrix(m, copy=True) for m in matrices)
    problem = qpsolvers.Problem(
        P,
        program.q.copy(),
        G if (~equal).any() else None,
        program.b[~equal] if (~equal).any() else None,
        A if equal.any() else None,
        program.b[equal] if equal.any() else None,
    )
    built = perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # solvers warn of what their status says
        try:
            answer = _answer(problem, name, {**_DEFAULTS.get(name, {}), **options})
            found, said = bool(answer.found), "found" if answer.found else "not found"
        except (qpsolvers.exceptions.QPError, ValueError) as error:  # quadprog refuses a singular P, for one
            found, said = False, f"error: {error}"
    solved = perf_counter()
    duals = np.full(program.b.size, np.nan)
    if found:
        for part, values in ((~equal, answer.z), (equal, answer.y)):
            if part.any() and values is not None:
                duals[part] = values
    return Solution(
        program,
        name,
        Status.SOLVED if found else Status.NOT_FOUND,
        # When nothing was found, several solvers still fill x with whatever they had.
        np.array(answer.x) if found else np.full(program.q.size, np.nan),
        duals,
        None,
        built - started,
        solved - built,
        said,
    )


def _answer(problem: qpsolvers.Problem, name: str, options: dict[str, Any]) -> qpsolvers.Solution:
    """The solver's answer; where it needs a strictly convex objective, by steps that have one.

    The proximal point method (Rockafellar, SIAM J. Control and Optimization 14, 1976) minimises the objective
    plus w/2 |x - x_k|^2 from x_k to x_k+1. On linear programs it ends after finitely many steps, and where it
    stands still its duals are those of the program.
    """
    P, q = problem.P, problem.q
    if name not in _STRICTLY_CONVEX or P.diagonal().min() > 0:
        return qpsolvers.solve_problem(problem, name, **options)
    size = float(abs(q).max()) or 1.0
    identity = sparse.identity(q.size, format="csc") if sparse.issparse(P) else np.eye(q.size)
    x: Array = np.zeros(q.size)
    for weight in size * _WEIGHTS:
        nearby = qpsolvers.Problem(
            P + weight * identity, q - weight * x, problem.G, problem.h, problem.A, problem.b
        )
        answer = qpsolvers.solve_problem(nearby, name, **options)
        if not answer.found or answer.x is None:
            break
        moved, x = float(abs(answer.x - x).max()), answer.x
        if weight * moved <= _PULL * size:
            break
    return answer
