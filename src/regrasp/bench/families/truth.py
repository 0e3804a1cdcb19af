"""What is known where no formula tells: a reference solve whose duality gap certifies it."""

from regrasp.bench.problems.problem import Known, Truth, Verdict
from regrasp.programs import Program, Status, solve

# A reference is believed to its certified relative gap, and to this at the best.
_ROUNDING = 1e-9
_SOUND = 1e-6


def certified(program: Program, scale: float = 1.0) -> Known:
    """The optimum by Clarabel at tight tolerances, with the gap that primal and dual values leave.

    scale: of ``Known``.
    """
    answer = solve(program, "clarabel", throw=False)
    if answer.status is Status.SOLVED:
        size = max(scale, abs(answer.objective))
        gap = answer.absolute_gap / size + answer.primal_residual + answer.dual_residual
        if gap <= _SOUND:
            accuracy = float(f"{max(10 * gap, _ROUNDING):.0e}")  # a digit is known of it
            return Known(Verdict.SOLVABLE, Truth.REFERENCE, answer.objective, accuracy, scale)
    return Known(Verdict.UNKNOWN, Truth.NONE)
