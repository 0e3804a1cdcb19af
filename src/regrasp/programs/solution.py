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
        p = self.program
        worst = _outside(p.slack(self.x), p.cones, dual=False)
        return worst / (1 + float(abs(p.b).max(initial=0.0)))

    @cached_property
    def dual_residual(self) -> float:
        """Largest entry of |P x + q + A'z|, or violation of z in K*, relative to 1 + |q|."""
        p = self.program
        gradient = float(abs(p.P @ self.x + p.q + p.A.T @ self.z).max())
        return max(gradient, _outside(self.z, p.cones, dual=True)) / (1 + float(abs(p.q).max()))

    @cached_property
    def gap(self) -> float:
        """|x'Px + q'x + b'z|, relative to 1 + |objective|."""
        p = self.program
        value = float(self.x @ p.P @ self.x + p.q @ self.x + p.b @ self.z)
        return abs(value) / (1 + abs(p.objective(self.x)))

    def is_sound(self, tolerance: float) -> bool:
        """Whether all three residuals are within ``tolerance``: then x and z prove each other optimal."""
        return bool(max(self.cone_violation, self.dual_residual, self.gap) <= tolerance)


def _outside(vector: Array, cones: tuple[tuple[Cone, int], ...], *, dual: bool) -> float:
    """How far a vector is outside K, or outside K*: the zero cone's dual is everything."""
    worst, row = 0.0, 0
    for cone, size in cones:
        part = vector[row : row + size]
        row += size
        if cone is Cone.ZERO:
            amount = 0.0 if dual else float(abs(part).max(initial=0.0))
        elif cone is Cone.NONNEGATIVE:
            amount = float((-part).max(initial=0.0))
        else:
            amount = float(np.linalg.norm(part[1:]) - part[0])
        worst = max(worst, amount)
    return worst
