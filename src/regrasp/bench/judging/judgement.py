"""Whether an answer is right, by our own arithmetic and by what is known of the problem.

A solver's word counts only as what it claims, and scores only what is shown: a solution by its point, a
program without one by a certificate that proves it. Whether a solution is right depends on x alone where the
optimum is known; duals are measured where they are given.
"""

from dataclasses import dataclass
from math import isfinite, nan

import numpy as np

from regrasp.bench.judging.residual import row_residual
from regrasp.bench.problems.problem import BenchProblem, Known, Verdict
from regrasp.programs.answer import Answer, Claim
from regrasp.programs.judging.cleaning import cleaned_direction, cleaned_duals
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.solution import Solution, Status

CERTIFICATE = 1e-3
"""Largest residual of a certificate: the terms of a feasible point would be a thousand times those of b."""


@dataclass(frozen=True)
class Judgement:
    """Measures of an answer; None where there is nothing to measure.

    correct: whether the answer is right; None where nothing is known to judge it by. why: in words.
    objective, and its distance from the known optimum as ``Known.distance`` has it. primal_residual: as
    ``row_residual`` has it. dual_residual, gap: relative, as ``regrasp.programs.Solution`` defines them; the
    ``absolute_`` ones as qpbenchmark does. certificate_residual: of a claim that the program is infeasible
    or unbounded.
    """

    correct: bool | None
    why: str
    objective: float | None = None
    distance: float | None = None
    primal_residual: float | None = None
    dual_residual: float | None = None
    gap: float | None = None
    absolute_primal_residual: float | None = None
    absolute_dual_residual: float | None = None
    absolute_gap: float | None = None
    certificate_residual: float | None = None


def judged(problem: BenchProblem, answer: Answer, within: float) -> Judgement:
    """The judgement of an answer that was asked for to a relative accuracy ``within``."""
    claim = Claim(answer.status)
    if claim is Claim.FAILED:
        return Judgement(False, "no answer")
    if claim is Claim.REFUSED:
        return Judgement(False, "not taken")
    if claim is Claim.FOUND:
        return _found(problem, answer, within)
    if claim is Claim.INFEASIBLE:
        return _infeasible(problem, answer)
    return _unbounded(problem, answer)


def _found(problem: BenchProblem, answer: Answer, within: float) -> Judgement:
    assert answer.x is not None
    program, known = problem.program, problem.known
    has_duals = answer.duals is not None
    solution = _solution(problem, answer, Status.SOLVED)
    audit = solution.audit
    distance, off = known.distance(solution.objective), row_residual(program, answer.x)
    measures = {
        "objective": solution.objective,
        "distance": distance,
        "primal_residual": off,
        "absolute_primal_residual": audit.slack_violation,
        "dual_residual": solution.dual_residual if has_duals else None,
        "gap": solution.gap if has_duals else None,
        "absolute_dual_residual": max(audit.stationarity, audit.dual_violation) if has_duals else None,
        "absolute_gap": solution.absolute_gap if has_duals else None,
    }
    measures = {name: _finite(value) for name, value in measures.items()}
    if known.verdict is Verdict.INFEASIBLE:
        return Judgement(False, "claims a solution of an infeasible program", **measures)
    if not off <= within:
        return Judgement(False, f"breaks the constraints by more than {within:g}", **measures)
    near = None if distance is None else is_near(distance, known, within)
    if near is not None:
        return Judgement(near, f"{_PLACE[near]} {within:g} from the known optimum", **measures)
    if not has_duals:
        return Judgement(None, "the optimum is not known and no duals prove the answer", **measures)
    right = max(audit[:4]) <= within
    if distance is not None and not right:
        return Judgement(None, "the optimum is not known well enough to tell", **measures)
    return Judgement(right, f"duals {'prove' if right else 'do not prove'} it to {within:g}", **measures)


_PLACE = {True: "within", False: "farther than"}


def is_near(distance: float, known: Known, within: float) -> bool | None:
    """Whether an objective is ``within`` its relative distance of the optimum; None where that is not known.

    The optimum may be off by ``known.accuracy``, so that what lies beyond by no more cannot be told.
    """
    if distance <= within:
        return True
    return None if distance <= within + known.accuracy else False


def is_proof(residual: float | None) -> bool:
    """Whether a certificate of this residual, or none, shows what it claims."""
    return residual is not None and residual <= CERTIFICATE


def _infeasible(problem: BenchProblem, answer: Answer) -> Judgement:
    if problem.known.verdict is Verdict.SOLVABLE:
        return Judgement(False, "claims that a solvable program is infeasible")
    if answer.duals is None:
        return Judgement(None, "claims infeasibility without a certificate")
    program = problem.program
    residual = infeasibility_residual(program, cleaned_duals(program, answer.duals, 0.0, steps=0))
    # A certificate that is a little off proves little where nothing else is known.
    right = True if is_proof(residual) and problem.known.verdict is Verdict.INFEASIBLE else None
    proves = "proves" if is_proof(residual) else "does not prove"
    return Judgement(right, f"its certificate {proves} infeasibility", certificate_residual=_finite(residual))


def _unbounded(problem: BenchProblem, answer: Answer) -> Judgement:
    if problem.known.verdict is not Verdict.UNKNOWN:
        return Judgement(
            False, f"claims that a program known to be {problem.known.verdict.value} is unbounded"
        )
    if answer.x is None:
        return Judgement(None, "claims unboundedness without a direction")
    program = problem.program
    residual = unboundedness_residual(program, cleaned_direction(program, answer.x, 0.0, steps=0))
    # A direction proves unboundedness only of a program that some point satisfies.
    correct = None if is_proof(residual) else False
    return Judgement(correct, "claims unboundedness", certificate_residual=_finite(residual))


def _solution(problem: BenchProblem, answer: Answer, status: Status) -> Solution:
    """For the audit; zeros stand where the solver gave nothing, so that the rest can be measured."""
    program = problem.program
    x = np.zeros(program.q.size) if answer.x is None else answer.x
    z = np.zeros(program.b.size) if answer.duals is None else answer.duals
    return Solution(program, "", status, x, z, answer.iterations, nan, nan, answer.said)


def _finite(value: float | None) -> float | None:
    return None if value is None or not isfinite(value) else float(value)
