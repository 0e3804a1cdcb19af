"""What a back end answered, and our own audit of it, computed from the program's data."""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import inf, isnan

import numpy as np

from regrasp.errors import readable
from regrasp.programs.blocks import Array
from regrasp.programs.judging.audit import Audit, audited
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.program import Program


class Status(Enum):
    """How a solve ended; the value is what to do about it."""

    SOLVED = "use value"
    INFEASIBLE = "no point satisfies the constraints: loosen them; duals hold the certificate"
    UNBOUNDED = "the objective falls without bound: add a limit; value holds the direction"
    UNBOUNDED_OR_INFEASIBLE = (
        "the objective falls along a direction, value, but no point to fall from is known: ask clarabel"
    )
    NOT_FOUND = "the back end found no solution and gave no reason: ask one that gives certificates, clarabel"
    STOPPED = "the back end stopped before its tolerances were met: rescale the data or try another back end"
    FAILED = "the solver raised an error of its own, crashed or was ended: rescale the data or try another"
    UNSOUND = "the answer fails our audit whatever the back end called it: try another back end"

    @property
    def advice(self) -> str:
        """What to do about it."""
        return self.value


@dataclass(frozen=True, eq=False)
class Solution:
    """The answer of a back end. Residuals are properties, computed here from the data and not believed.

    Args:
        program: what was asked.
        backend: who answered.
        status: how it ended.
        value: (n,) x; for UNBOUNDED the direction of descent. NaN where the back end gave none.
        duals: (m,) z, with P x + q + A'z = 0 and z in K*; for INFEASIBLE the certificate.
        iterations: as the back end counts, or None.
        build_time: making its data [s].
        solve_time: its call [s].
        said: the back end's own word for its status.
    """

    program: Program
    backend: str
    status: Status
    value: Array
    duals: Array
    iterations: int | None
    build_time: float
    solve_time: float
    said: str

    @cached_property
    def audit(self) -> Audit:
        """All measures of (value, duals) as a solution."""
        return audited(self.program, self.value, self.duals)

    @property
    def objective(self) -> float:
        """1/2 x'Px + q'x."""
        return self.audit.objective

    @property
    def primal_residual(self) -> float:
        """Largest distance of a row or cone of b - A x to K, relative to its own terms."""
        return self.audit.primal

    @property
    def dual_residual(self) -> float:
        """Largest entry of P x + q + A'z, z put inside K*, relative to its own terms."""
        return self.audit.dual

    @property
    def complementarity(self) -> float:
        """Largest product of a row's slack and its dual, relative to both."""
        return self.audit.complementarity

    @property
    def gap(self) -> float:
        """|x'Px + q'x + b'z|, relative to the sum with every term positive."""
        return self.audit.gap

    @property
    def absolute_gap(self) -> float:
        """|x'Px + q'x + b'z|, the distance of the objective from the dual's."""
        return self.audit.absolute_gap

    @cached_property
    def infeasibility_residual(self) -> float:
        """How far the duals are from proving infeasibility, A'z = 0, z in K*, b'z < 0; see ``proofs``."""
        return infeasibility_residual(self.program, self.duals)

    @cached_property
    def unboundedness_residual(self) -> float:
        """How far value is from a direction of descent, P x = 0, -A x in K, q'x < 0; see ``proofs``."""
        return unboundedness_residual(self.program, self.value)

    @property
    def residual(self) -> float:
        """The residual that decides: the worst of a solution's four, or that of the certificate."""
        if self.status is Status.INFEASIBLE:
            return self.infeasibility_residual
        if self.status in (Status.UNBOUNDED, Status.UNBOUNDED_OR_INFEASIBLE):
            return self.unboundedness_residual
        values = self.audit[:4]
        return inf if any(map(isnan, values)) else max(values)

    def __str__(self) -> str:
        return readable(
            f"{self.backend}: {self.status.name} ({self.said}), objective {self.objective:.9g}, "
            f"residuals primal {self.primal_residual:.1e}, dual {self.dual_residual:.1e}, "
            f"complementarity {self.complementarity:.1e}, gap {self.gap:.1e}"
        )


def failed(program: Program, backend: str, said: str) -> Solution:
    """No answer: what became of the solver is ``said``."""
    x, z = np.full(program.q.size, np.nan), np.full(program.b.size, np.nan)
    return Solution(program, backend, Status.FAILED, x, z, None, 0.0, 0.0, said)
