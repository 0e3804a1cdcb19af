"""The choice of a state written again from the mathematics: objective values, and cvxpy programs.

Nothing here uses regrasp's formulas or its builders of programs.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

import cvxpy as cp
import numpy as np

OBJECTIVES = ("angle", "force", "effort", "peak", "peak_normal", "friction_use")
LARGER_IS_BETTER = ("angle", "force")
LIMITED = (*LARGER_IS_BETTER, "friction_use")
"""Objectives whose best value may lie at infinite force."""
IDLE = 2.0**-40


def objective_values(
    forces: np.ndarray, normals: np.ndarray, frictions: np.ndarray, objective: str
) -> np.ndarray:
    """(m,) values of (m, n, 2) forces, larger is better; -inf for an angle or a use without any force."""
    units = normals / np.hypot(normals[:, 0], normals[:, 1])[:, None]
    normal = forces[..., 0] * units[:, 0] + forces[..., 1] * units[:, 1]
    tangent = np.abs(units[:, 0] * forces[..., 1] - units[:, 1] * forces[..., 0])
    size = np.hypot(forces[..., 0], forces[..., 1])
    if objective == "angle":
        used = size > IDLE * size.max(axis=-1, keepdims=True)
        margin = np.where(used, np.arctan(frictions) - np.arctan2(tangent, normal), np.inf).min(axis=-1)
        return np.where(np.isinf(margin), -np.inf, margin)
    if objective == "friction_use":
        used = size > IDLE * size.max(axis=-1, keepdims=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            use = np.where(normal > 0, tangent / (frictions * normal), np.inf)
        worst = -np.where(used & (frictions > 0), use, 0.0).max(axis=-1)
        return np.where(used.any(axis=-1), worst, -np.inf)
    if objective == "force":
        return ((frictions * normal - tangent) / np.sqrt(1 + frictions**2)).min(axis=-1)
    return {
        "effort": -(size**2).sum(axis=-1),
        "peak": -size.max(axis=-1),
        "peak_normal": -normal.max(axis=-1),
    }[objective]


@dataclass(frozen=True)
class ConvexChoice:
    """The best value of an objective for planar contacts, by cvxpy; forces in units of ``unit``."""

    positions: np.ndarray
    normals: np.ndarray
    frictions: np.ndarray
    load: np.ndarray
    unit: float = 1.0

    def best(self, objective: str, limits: Sequence[float]) -> float:
        """The best value, in the units of the load; the ``limits`` bound each force."""
        scaled = [limit / self.unit for limit in limits]
        if objective == "angle":
            alphas = np.arctan(self.frictions)
            return self._best_level(
                scaled, alphas.max(), lambda m: np.where(alphas >= m, np.tan(np.maximum(alphas - m, 0)), -1)
            )
        if objective == "friction_use":
            return 1 - self._best_level(scaled, 1.0, lambda m: self.frictions * (1 - m))
        f, normal, tangent = self._forces()
        held = [
            *self._equilibrium(f),
            *self._limits(f, scaled),
            cp.abs(tangent) <= cp.multiply(self.frictions, normal),
        ]
        goal = {
            "force": -cp.min(self._edge_distance(normal, tangent)),
            "effort": cp.sum_squares(f),
            "peak": cp.max(cp.norm(f, axis=1)),
            "peak_normal": cp.max(normal),
        }[objective]
        value = _solved(cp.Problem(cp.Minimize(goal), held))
        if objective == "effort":
            return value * self.unit**2
        return -value * self.unit if objective == "force" else value * self.unit

    def _best_level(self, limits: Sequence[float], top: float, cones: Callable[[float], np.ndarray]) -> float:
        """Bisection: a level is reached if cones narrowed to it hold the load; one below 0 is none."""
        f, normal, tangent = self._forces()
        narrowed, slack = cp.Parameter(len(self.frictions), nonneg=True), cp.Variable()
        open_, wide = cp.Parameter(len(self.frictions), nonneg=True), 1e3
        problem = cp.Problem(
            cp.Maximize(slack),
            [
                *self._equilibrium(f),
                *self._limits(f, limits),
                cp.abs(tangent) + cp.multiply(open_, slack) <= cp.multiply(narrowed, normal),
                normal >= 0,
                normal <= wide * open_,
                slack <= wide,
            ],
        )
        low, high = 0.0, top
        while high - low > 1e-9:
            level = (low + high) / 2
            mu = cones(level)
            narrowed.value, open_.value = np.maximum(mu, 0), (mu >= 0).astype(float)
            low, high = (level, high) if _solved(problem) >= -1e-9 else (low, level)
        return low

    def _forces(self) -> tuple[cp.Variable, cp.Expression, cp.Expression]:
        f = cp.Variable((len(self.positions), 2))
        n = self.normals / np.hypot(self.normals[:, 0], self.normals[:, 1])[:, None]
        t = np.column_stack([-n[:, 1], n[:, 0]])
        return f, cp.sum(cp.multiply(n, f), axis=1), cp.sum(cp.multiply(t, f), axis=1)

    def _equilibrium(self, f: cp.Variable) -> list[cp.Constraint]:
        r, load = self.positions, self.load / self.unit
        return [
            cp.sum(f, axis=0) + load[:2] == 0,
            r[:, 0] @ f[:, 1] - r[:, 1] @ f[:, 0] + load[2] == 0,
        ]

    def _limits(self, f: cp.Variable, limits: Sequence[float]) -> list[cp.Constraint]:
        return [cp.norm(f[i]) <= limit for i, limit in enumerate(limits) if limit < inf]

    def _edge_distance(self, normal: cp.Expression, tangent: cp.Expression) -> cp.Expression:
        return cp.multiply(
            1 / np.sqrt(1 + self.frictions**2), cp.multiply(self.frictions, normal) - cp.abs(tangent)
        )


def _solved(problem: cp.Problem) -> float:
    value = problem.solve(solver=cp.CLARABEL, tol_gap_abs=1e-11, tol_gap_rel=1e-11, tol_feas=1e-11)
    if problem.status in (cp.INFEASIBLE, cp.INFEASIBLE_INACCURATE):
        return -np.inf
    assert problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE), problem.status
    return float(value)
