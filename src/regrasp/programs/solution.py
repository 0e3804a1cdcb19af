"""What a back end answered, and our own audit of it."""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np

from regrasp.programs.program import Array, Cone, Program


class Status(Enum):
    """How a solve ended; the value is the advice that goes with it."""

    SOLVED = "solved"
    INFEASIBLE = "no point satisfies the constraints; ask for a certificate"
    UNBOUNDED = "the objective falls without bound; add a limit"
    STOPPED = "the solver stopped before its tolerances were met; rescale the data or try another back end"


@dataclass(frozen=True, eq=False)
class Solution:
    """The primal x (n,), dual z (m,) and status of a solve; residuals are computed here, not believed."""

    program: Program
    status: Status
    x: Array
    z: Array
    iterations: int
    solve_time: float
    backend: str

    @cached_property
    def cone_violation(self) -> float:
        """Distance-like violation of s in K, relative to 1 + |b|: largest over the cones."""
        worst, row, s = 0.0, 0, self.program.slack(self.x)
        for cone, size in self.program.cones:
            part = s[row : row + size]
            row += size
            if cone is Cone.ZERO:
                amount = float(abs(part).max(initial=0.0))
            elif cone is Cone.NONNEGATIVE:
                amount = float((-part).max(initial=0.0))
            else:
                amount = float(np.linalg.norm(part[1:]) - part[0])
            worst = max(worst, amount)
        return worst / (1 + float(abs(self.program.b).max(initial=0.0)))

    @cached_property
    def dual_residual(self) -> float:
        """|P x + q + A'z| largest entry, relative to 1 + |q|."""
        p = self.program
        return float(abs(p.P @ self.x + p.q + p.A.T @ self.z).max()) / (1 + float(abs(p.q).max()))

    @cached_property
    def gap(self) -> float:
        """|x'Px + q'x + b'z|, relative to 1 + |objective|."""
        p = self.program
        value = float(self.x @ p.P @ self.x + p.q @ self.x + p.b @ self.z)
        return abs(value) / (1 + abs(p.objective(self.x)))

    def is_sound(self, tolerance: float) -> bool:
        """Solved, and all three residuals within ``tolerance``."""
        return self.status is Status.SOLVED and bool(
            max(self.cone_violation, self.dual_residual, self.gap) <= tolerance
        )
