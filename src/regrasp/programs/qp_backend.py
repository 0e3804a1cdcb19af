"""Solvers of quadratic programs, each called by its own module. Where one needs it, in proximal steps."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from time import perf_counter
from typing import Any

import numpy as np
from scipy import sparse

from regrasp.programs.answer import Answer, Claim, given_numbers
from regrasp.programs.calls.deadline import Deadline
from regrasp.programs.facts import BACKENDS
from regrasp.programs.judging.proofs import unboundedness_residual
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status

_STATUS = {
    Claim.FOUND: Status.SOLVED,
    Claim.INFEASIBLE: Status.INFEASIBLE,
    Claim.UNBOUNDED: Status.UNBOUNDED,
    Claim.FAILED: Status.STOPPED,
    Claim.REFUSED: Status.NOT_FOUND,
}
# Weights of the proximal steps beside the linear objective: near it first, then far at one stride.
_WEIGHTS = np.repeat(1 / 10.0 ** np.arange(1, 8), [2, 2, 10, 4, 3, 3, 3])
# The last step's pull on the dual equation, relative to the objective.
_PULL = 1e-10
# A last step that is nearly a direction of descent is taken for one.
_FALLING = 1e-3


def solve(program: Program, name: str, **options: Any) -> Solution:
    """Solve a program without second-order cones; ``options`` go to the solver as they are."""
    facts = BACKENDS[name]
    call = import_module(facts.module)
    started = perf_counter()
    most = options.get(facts.time_limit) or None
    limit = Deadline(most)

    def ask(given: Program) -> Answer:
        left = {} if most is None else {facts.time_limit: limit.left}
        answer: Answer = call.Session(call.layout(given), **{**facts.options, **options, **left}).solve()
        return answer

    answer = _by_steps(program, ask) if facts.strictly_convex else ask(program)
    took = perf_counter() - started
    solving = took if answer.solve_time is None else answer.solve_time
    claim = Claim(answer.status)
    x = answer.x if claim in (Claim.FOUND, Claim.UNBOUNDED, Claim.FAILED) else None
    z = answer.duals if claim in (Claim.FOUND, Claim.INFEASIBLE, Claim.FAILED) else None
    status, said = _STATUS[claim], answer.said
    if (claim is Claim.INFEASIBLE and z is None) or (claim is Claim.UNBOUNDED and x is None):
        status, said = Status.NOT_FOUND, f"{said}, without a certificate"
    elif claim is Claim.FAILED and (x is None or z is None):
        status = Status.NOT_FOUND
    return Solution(
        program, name, status, given_numbers(x, program.q.size), given_numbers(z, program.b.size),
        answer.iterations, max(took - solving, 0.0), solving, said,
    )  # fmt: skip


def _by_steps(program: Program, ask: Callable[[Program], Answer]) -> Answer:
    """The answer of a solver that needs a strictly convex objective, by steps that have one.

    The proximal point method (Rockafellar, SIAM J. Control and Optimization 14, 1976): from x_0 = 0 step k
    minimises the objective plus s w_k / 2 |x - x_k|^2, w_k of ``_WEIGHTS`` in turn and s the largest entry of
    q, or 1 if q = 0. On linear programs it ends after finitely many steps.

    Returns:
        Where P's diagonal is positive, what is answered to the program as it is. Else, of the steps, the
        first answer that is no point, or an infinite one, or that moved by so little that its duals miss
        those of the program by at most ``_PULL`` s. Where all steps move on, the last answer: it falls for
        ever along the last step where that is a direction of descent to ``_FALLING``, and is a point to be
        judged elsewhere.
    """
    P, q = program.P, program.q
    if P.diagonal().min(initial=np.inf) > 0:
        return ask(program)
    size = float(abs(q).max()) or 1.0
    identity = sparse.identity(q.size, format="csc")
    x = np.zeros(q.size)
    for weight in size * _WEIGHTS:
        answer = ask(replace(program, P=sparse.csc_matrix(P + weight * identity), q=q - weight * x))
        if answer.status != Claim.FOUND.value:
            return answer
        last, x = x, given_numbers(answer.x, q.size)
        step = x - last
        if not _PULL * size < weight * abs(step).max() < np.inf:
            return answer
    if unboundedness_residual(program, step) <= _FALLING:
        return replace(answer, status=Claim.UNBOUNDED.value, x=step, said=f"{answer.said}, falling for ever")
    return answer
