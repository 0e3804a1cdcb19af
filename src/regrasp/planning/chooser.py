"""Forces by a back end: every answer is moved into exact equilibrium inside the cones, or refused."""

from collections.abc import Iterable
from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.balance import EQUILIBRIUM, nearest_equilibrium
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.state_program import state_program
from regrasp.programs import Program, Solution, Status, solve

# Fraction of friction and limits that programs keep back besides the reserve, so that a solver's rounding,
# 1e-10 and less, is inside the reserve and not beyond it.
SLACK = 1e-9
# Limits beyond this many loads bind nothing that minimises forces, and spoil the scale of a program.
LOOSE = 1e6
# A solver's zero; whether forces exist is decided by finding them.
FEASIBLE = 1e-7
# An answer that exact equilibrium moves by more than this fraction of the forces is not the best one.
_MOVED = 1e-5
# A force below this fraction of the largest is a solver's noise at a finger that carries none.
_IDLE = 1e-8
# Forces this many times the unit are better measured by a unit of their own.
_FAR = 4.0


def force_unit(grasp: Grasp, load: Wrench) -> float:
    """The size of the load as a force [N], torque divided by the grasp's size; 0 without a load."""
    return max(float(abs(load.force).max()), float(abs(load.torque).max()) / (grasp.size or 1.0))


class Found(NamedTuple):
    """Forces (n, d) in exact equilibrium [N] and how much better the best can be, at most."""

    forces: Array
    gap: float


class Chooser:
    """Chooses forces of one grasp under one load with one back end.

    Forces are (n, w) as the cones measure them (``regrasp.mechanics.cones``).
    """

    def __init__(
        self, grasp: Grasp, load: Wrench, backend: str, facets: int | None, limits: list[float]
    ) -> None:
        self.grasp, self.load, self.backend, self.facets = grasp, load, backend, facets
        size = grasp.size or 1.0
        self.matrix, self.vector = (
            grasp.cones.matrix.copy(),
            load.vector.copy(),
        )  # torques divided by the size
        self.matrix[grasp.dimension :] /= size
        self.vector[grasp.dimension :] /= size
        self.unit = force_unit(grasp, load)
        if self.unit == 0:  # no load: the limits tell the size of a force; without any, all are zero
            self.unit = min(limits, default=1.0) if min(limits, default=inf) < inf else 1.0
        self.loose = LOOSE * self.unit

    def rescale(self, unit: float) -> None:
        """Another unit of force [N]; every limit counts."""
        self.unit, self.loose = unit, inf

    def of(self, contacts: Iterable[int]) -> "Chooser":
        """The same, for some of the contacts."""
        some = Chooser(self.grasp.subset(contacts), self.load, self.backend, self.facets, [])
        some.unit, some.loose = self.unit, self.loose
        return some

    def solved(
        self,
        objective: str,
        frictions: list[float],
        limits: list[float],
        weights: Array | None = None,
        *,
        slack: float = SLACK,
    ) -> Solution:
        """The back end's answer to one of the convex objectives, in units of ``unit``.

        Where it has none and stopped at forces far larger than the load, it is asked again with their size
        as the unit.
        """
        try:
            return solve(self._program(objective, frictions, limits, weights, slack), self.backend)
        except SolverFailed as failed:
            size = float(abs(self._wanted(failed.solution)).max())
            if not _FAR * self.unit < size < inf:
                raise
            self.unit = size
        return solve(self._program(objective, frictions, limits, weights, slack), self.backend)

    def _program(
        self,
        objective: str,
        frictions: list[float],
        limits: list[float],
        weights: Array | None,
        slack: float,
    ) -> Program:
        kept = 1 - slack
        return state_program(
            self.grasp,
            self.load,
            objective,
            [kept * mu for mu in frictions],
            [kept * limit if limit < self.loose else inf for limit in limits],
            self.unit,
            self.facets,
            weights,
        )

    def best(self, objective: str, frictions: list[float], limits: list[float]) -> Found | None:
        """The best forces for a convex objective; None where the back end says there are none."""
        answer = self.solved(objective, frictions, limits)
        if answer.status is Status.INFEASIBLE:  # at the limit of what can be held the slack may be missed
            answer = self.solved(objective, frictions, limits, slack=0.0)
        if answer.status is Status.INFEASIBLE:
            return None
        if answer.status is Status.UNBOUNDED:
            raise SolverFailed(f"{self.backend}: {answer.status.advice}", answer.program, answer)
        if objective == "force" and answer.value[-1] < -FEASIBLE:
            return None  # the least distance to the cones' boundaries is negative: some force is outside
        forces = self.exact(answer, frictions, limits)
        if forces is None:
            return None
        moved = float(abs(forces - self._wanted(answer)).max())
        if moved > _MOVED * max(self.unit, float(abs(forces).max())):
            raise SolverFailed(
                f"{self.backend} answered forces {moved:.2g} away from equilibrium inside the cones",
                answer.program,
                answer,
            )
        squared = objective == "effort"
        return Found(forces, answer.absolute_gap * (self.unit**2 if squared else self.unit))

    def exact(self, answer: Solution, frictions: list[float], limits: list[float]) -> Array | None:
        """The answer's forces (n, d) moved into equilibrium, inside cones and limits; None if none are.

        The least change of all forces does, unless it leaves a cone.
        """
        return self.settled(self._wanted(answer), frictions, limits)

    def settled(self, wanted: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """Forces (n, d) moved least into equilibrium, inside cones and limits; None if there are none."""
        grasp = self.grasp
        forces = self._shifted(wanted)
        if forces is not None:
            normal, tangential = grasp.cones.normal(forces), grasp.cones.tangential(forces)
            inside = (normal >= 0) & (tangential <= np.array(frictions) * normal)
            if inside.all() and ((forces**2).sum(axis=1) <= np.array(limits) ** 2).all():
                return forces
        return self.nearest(wanted, frictions, limits) if np.isfinite(wanted).all() else None

    def nearest(self, forces: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """The forces nearest to ``forces`` in equilibrium, inside cones and limits; None if none are."""
        size, cones = self.grasp.size or 1.0, self.grasp.cones
        mu, limit = np.array(frictions), np.array(limits)
        return nearest_equilibrium(forces, cones.matrix, self.load.vector, cones.normals, mu, limit, size)

    def _wanted(self, answer: Solution) -> Array:
        w = self.grasp.width
        wanted: Array = answer.value[: w * len(self.grasp)].reshape(-1, w)
        if w == 4:  # a point contact makes no torque, whatever a solver says of a number that does nothing
            wanted = self.grasp.cones.measured(self.grasp.cones.forces(wanted))
        return wanted * self.unit

    def _shifted(self, forces: Array) -> Array | None:
        """The forces nearest to ``forces`` with G f + w = 0, whatever the cones, idle fingers left idle.

        None where rounding forbids.
        """
        sizes = abs(forces).max(axis=1)
        f, g = forces.ravel(), self.matrix
        if sizes.min() < _IDLE * sizes.max():
            used = np.repeat(sizes >= _IDLE * sizes.max(), self.grasp.width)
            f, g = np.where(used, f, 0.0), np.where(used, g, 0.0)
        try:
            gram = np.linalg.inv(g @ g.T)
        except np.linalg.LinAlgError:
            return None
        for _ in range(2):
            f = f - g.T @ (gram @ (g @ f + self.vector))
        off, largest = abs(g @ f + self.vector).max(), max(float(abs(f).max()), float(abs(self.vector).max()))
        return f.reshape(forces.shape) if off <= EQUILIBRIUM / 2 * largest else None
