"""What a back end answered, and our own audit of it, computed from the program's data."""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import inf

import numpy as np

from regrasp.programs.program import Array, Program


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
    def _px(self) -> Array:
        px: Array = self.program.P @ self.value
        return px

    @cached_property
    def objective(self) -> float:
        """1/2 x'Px + q'x."""
        return self.program.objective(self.value)

    @cached_property
    def primal_residual(self) -> float:
        """Distance of b - A x to K, relative to the largest entry of b and A x."""
        s = self.program.slack(self.value)
        scale = max(_largest(self.program.b), _largest(self.program.b - s))
        return _relative(self.program.distance_to_cones(s), scale)

    @cached_property
    def dual_residual(self) -> float:
        """Largest entry of P x + q + A'z, and distance of z to K*, relative to the terms.

        The terms are those at x, and P x at an x of the size of the data, for answers near x = 0.
        """
        p = self.program
        px, az = self._px, p.A.T @ self.duals
        usual = _largest(p.P.data) * _ratio(p.b, p.A.data)
        stationarity = _relative(
            _largest(px + p.q + az), max(_largest(px), _largest(p.q), _largest(az), usual)
        )
        return max(stationarity, _relative(p.distance_to_cones(self.duals, dual=True), _largest(self.duals)))

    @cached_property
    def gap(self) -> float:
        """|x'Px + q'x + b'z|, relative to |x||Px| + |q||x| + |b||z|, or to x'Px as in ``dual_residual``."""
        p, x, z, px, norm = self.program, self.value, self.duals, self._px, np.linalg.norm
        scale = float(norm(x) * norm(px) + norm(p.q) * norm(x) + norm(p.b) * norm(z))
        usual = _largest(p.P.data) * _ratio(p.b, p.A.data) ** 2
        return _relative(abs(float(x @ px + p.q @ x + p.b @ z)), max(scale, usual))

    @property
    def absolute_gap(self) -> float:
        """|x'Px + q'x + b'z|, the distance of the objective from the dual's."""
        p, x = self.program, self.value
        return abs(float(x @ self._px + p.q @ x + p.b @ self.duals))

    @cached_property
    def infeasibility_residual(self) -> float:
        """How far the duals are from proving infeasibility, A'z = 0, z in K*, b'z < 0; infinite if b'z >= 0.

        Any feasible x would need |x| of at least 1 / residual times the size b / A of the data.
        """
        p, z = self.program, self.duals
        off = max(_largest(p.A.T @ z), p.distance_to_cones(z, dual=True))
        return _per(off * _ratio(p.b, p.A.data), -float(p.b @ z))

    @cached_property
    def unboundedness_residual(self) -> float:
        """How far value is from a direction of descent, P x = 0, -A x in K, q'x < 0; infinite if q'x >= 0."""
        p, x = self.program, self.value
        off = max(_largest(p.P @ x), p.distance_to_cones(-(p.A @ x)))
        return _per(off * _ratio(p.q, p.A.data), -float(p.q @ x))

    @cached_property
    def residual(self) -> float:
        """The residual that decides: the worst of a solution's three, or that of the certificate."""
        if self.status is Status.INFEASIBLE:
            return self.infeasibility_residual
        if self.status is Status.UNBOUNDED:
            return self.unboundedness_residual
        values = (self.primal_residual, self.dual_residual, self.gap)
        return inf if any(np.isnan(values)) else max(values)

    def __str__(self) -> str:
        return (
            f"{self.backend}: {self.status.name} ({self.said}), objective {self.objective:.9g}, "
            f"residuals primal {self.primal_residual:.1e}, dual {self.dual_residual:.1e}, gap {self.gap:.1e}"
        )


def _largest(values: Array) -> float:
    return float(abs(values).max(initial=0.0))


def _ratio(values: Array, by: Array) -> float:
    """The size of ``values`` in units of ``by``."""
    return _largest(values) / (_largest(by) or 1.0)


def _per(amount: float, by: float) -> float:
    return amount / by if by > 0 else inf


def _relative(amount: float, scale: float) -> float:
    return amount / scale if scale > 0 else (0.0 if amount == 0 else inf)
