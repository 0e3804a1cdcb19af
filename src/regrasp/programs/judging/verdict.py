"""What a back end's claim is worth: measured, made right where it is nearly so, or called unsound."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from regrasp.programs.judging.audit import missed
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status

PROVEN = 1e-8
"""Largest residual of a certificate: a feasible point would have terms 1e8 times those of b."""

MISSED = 1e-6
"""Largest distance of a point, beside which a program is unbounded, from its rows in their own units."""

_HINT = 0.1
"""Residual up to which numbers that nobody called a certificate may be on their way to one."""


def judged(solution: Solution, allowed: float, feasibility: Callable[[Program], Solution]) -> Solution:
    """The claim with the status that it deserves.

    allowed: largest measure of a solution. feasibility: finds a point of a program, or proves that none is.
    """
    if solution.status is Status.STOPPED and not _is_point(solution):
        allowed = min(allowed, PROVEN)
    if solution.status is Status.SOLVED or solution.status is Status.STOPPED:
        if solution.residual <= allowed:
            # It may have stopped short of its own, tighter tolerances; value and duals prove each other.
            return solution if solution.status is Status.SOLVED else replace(solution, status=Status.SOLVED)
        return _made_right(solution, allowed, feasibility)
    if solution.status is Status.INFEASIBLE:
        return _infeasible(solution)
    if solution.status is Status.UNBOUNDED:
        return _unbounded(solution, feasibility)
    return solution


def _is_point(solution: Solution) -> bool:
    """Whether rows and duals are kept as proofs are: near rows that contradict each other many seem to be."""
    return max(solution.primal_residual, solution.dual_residual) <= PROVEN


def _made_right(solution: Solution, allowed: float, feasibility: Callable[[Program], Solution]) -> Solution:
    """What an answer that is not sound is near to: a solution, or a proof that there is none."""
    from regrasp.programs.judging.polish import polished

    if solution.status is Status.SOLVED:
        better = polished(solution.program, solution.value, solution.duals, allowed)
        if better is not None:
            return replace(solution, value=better[0], duals=better[1], said=f"{solution.said}, polished")
    claim = _hint(solution, feasibility)
    if claim is not None:
        return claim
    if solution.status is Status.SOLVED:
        return _unsound(solution, solution.residual, allowed)
    better = polished(solution.program, solution.value, solution.duals, allowed)
    if better is None:
        return solution
    said = f"{solution.said}, polished"
    return replace(solution, status=Status.SOLVED, value=better[0], duals=better[1], said=said)


def _hint(solution: Solution, feasibility: Callable[[Program], Solution]) -> Solution | None:
    """What the last iterate proves where it was on its way to a certificate, or None."""
    from regrasp.programs.judging.cleaning import cleaned_direction, cleaned_duals

    program, x, z = solution.program, solution.value, solution.duals
    nothing = x * np.nan, z * np.nan
    if infeasibility_residual(program, cleaned_duals(program, z, 0.0, steps=0)) <= _HINT:
        claim = _infeasible(replace(solution, status=Status.INFEASIBLE, value=nothing[0]))
        if claim.status is Status.INFEASIBLE:
            return claim
    if unboundedness_residual(program, cleaned_direction(program, x, 0.0, steps=0)) <= _HINT:
        claim = _unbounded(replace(solution, status=Status.UNBOUNDED, duals=nothing[1]), feasibility)
        if claim.status in (Status.UNBOUNDED, Status.INFEASIBLE):
            return claim
    return None


def _infeasible(solution: Solution) -> Solution:
    if not solution.infeasibility_residual <= PROVEN:
        from regrasp.programs.judging.cleaning import cleaned_duals

        z = cleaned_duals(solution.program, solution.duals, PROVEN)
        solution = replace(solution, duals=z)
    residual = solution.infeasibility_residual
    return solution if residual <= PROVEN else _unsound(solution, residual, PROVEN)


def _unbounded(solution: Solution, feasibility: Callable[[Program], Solution]) -> Solution:
    if not solution.unboundedness_residual <= PROVEN:
        from regrasp.programs.judging.cleaning import cleaned_direction

        d = cleaned_direction(solution.program, solution.value, PROVEN)
        solution = replace(solution, value=d)
    residual = solution.unboundedness_residual
    if not residual <= PROVEN:
        return _unsound(solution, residual, PROVEN)
    program = solution.program
    if not program.cones.excess(program.b).any():
        return solution  # zero is a point
    point = feasibility(program)
    if point.status is Status.SOLVED and missed(program, point.value) <= MISSED:
        return solution
    if point.status is Status.INFEASIBLE:
        said = f"{solution.said}, but no point satisfies the constraints"
        nothing = np.full(program.q.size, np.nan)
        return replace(solution, status=Status.INFEASIBLE, value=nothing, duals=point.duals, said=said)
    return replace(solution, status=Status.UNBOUNDED_OR_INFEASIBLE)


def _unsound(solution: Solution, residual: float, allowed: float) -> Solution:
    said = f"{solution.said}, but residual {residual:.1e} of {allowed:g} allowed"
    return replace(solution, status=Status.UNSOUND, said=said)
