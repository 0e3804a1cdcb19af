"""What a back end answered, and our own audit of it, computed from the program's data."""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import inf, isnan
from typing import TYPE_CHECKING

from regrasp.programs.program import Array, Program

if TYPE_CHECKING:
    from regrasp.programs.audit import Audit


class Status(Enum):
    """How a solve ended; the value is what to do about it."""

    SOLVED = "use value"
    INFEASIBLE = "no point satisfies the constraints: loosen them; duals hold the certificate"
    UNBOUNDED = "the objective falls without bound: add a limit; value holds the direction"
    NOT_FOUND = "the back end found no solution and gave no reason: ask one that gives certificates, clarabel"
    STOPPED = "the back end stopped before its tolerances were met: rescale the data or try another back end"
    UNSOUND = "the answer fails our audit whatever the back end called it: try another back end"

    @property
    def advice(self) -> str:
        """What to do about it."""
        return self.value


@dataclass(frozen=True, eq=False)
class Solution:
    """The answer of a back end. Residuals are properties, computed here from the data and not believed.

    value: (n,) x; for UNBOUNDED the direction of descent. NaN where the back end gave none.
    duals: (m,) z, with P x + q + A'z = 0 and z in K*; for INFEASIBLE the certificate.
    iterations: as the back end counts, or None. build_time, solve_time: [s], making its data and its call.
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
    def _audit(self) -> "Audit":
        from regrasp.programs.audit import audited

        return audited(self.program, self.value, self.duals)

    @property
    def objective(self) -> float:
        """1/2 x'Px + q'x."""
        return 0.5 * self._audit.xpx + self._audit.qx

    @property
    def primal_residual(self) -> float:
        """Distance of b - A x to K, relative to the largest entry of b and A x."""
        return _relative(self._audit.slack_violation, max(self._audit.b, self._audit.ax))

    @property
    def dual_residual(self) -> float:
        """Largest entry of P x + q + A'z, and distance of z to K*, relative to the terms.

        The terms are those at x, and P x at an x of the program's ``size``.
        """
        a = self._audit
        stationarity = _relative(a.stationarity, max(a.px, a.q, a.az, a.p * self.program.size))
        return max(stationarity, _relative(a.dual_violation, a.z))

    @property
    def gap(self) -> float:
        """|x'Px + q'x + b'z|, relative to |x||Px| + |q||x| + |b||z|, or to x'Px at the program's ``size``."""
        a = self._audit
        scale = a.x_length * a.px_length + a.q_length * a.x_length + a.b_length * a.z_length
        return _relative(self.absolute_gap, max(scale, a.p * self.program.size**2))

    @property
    def absolute_gap(self) -> float:
        """|x'Px + q'x + b'z|, the distance of the objective from the dual's."""
        return abs(self._audit.xpx + self._audit.qx + self._audit.bz)

    @property
    def infeasibility_residual(self) -> float:
        """How far the duals are from proving infeasibility, A'z = 0, z in K*, b'z < 0; infinite if b'z >= 0.

        Any feasible x would need |x| of at least 1 / residual times the size b / A of the data.
        """
        a = self._audit
        return _per(max(a.az, a.dual_violation) * _ratio(a.b, a.a), -a.bz)

    @property
    def unboundedness_residual(self) -> float:
        """How far value is from a direction of descent, P x = 0, -A x in K, q'x < 0; infinite if q'x >= 0."""
        a = self._audit
        return _per(max(a.px, a.ray_violation) * _ratio(a.q, a.a), -a.qx)

    @property
    def residual(self) -> float:
        """The residual that decides: the worst of a solution's three, or that of the certificate."""
        if self.status is Status.INFEASIBLE:
            return self.infeasibility_residual
        if self.status is Status.UNBOUNDED:
            return self.unboundedness_residual
        values = (self.primal_residual, self.dual_residual, self.gap)
        return inf if any(map(isnan, values)) else max(values)

    def __str__(self) -> str:
        return (
            f"{self.backend}: {self.status.name} ({self.said}), objective {self.objective:.9g}, "
            f"residuals primal {self.primal_residual:.1e}, dual {self.dual_residual:.1e}, gap {self.gap:.1e}"
        )


def _ratio(size: float, by: float) -> float:
    return size / (by or 1.0)


def _per(amount: float, by: float) -> float:
    return amount / by if by > 0 else inf


def _relative(amount: float, scale: float) -> float:
    return amount / scale if scale > 0 else (0.0 if amount == 0 else inf)
