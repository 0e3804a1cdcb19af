"""Forces by a back end: every answer is moved into exact equilibrium inside the cones, or refused."""

from collections.abc import Callable, Iterable
from math import cos, inf, pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from regrasp.errors import InvalidInput, SolverFailed, shown
from regrasp.mechanics.balance import nearest_equilibrium, nearest_nearly_flat, shifted
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.opposition import surely_wins
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.escape import escape_twist, limited_twist
from regrasp.planning.states.objectives import FORCE, Bound, ConvexObjective, recorded
from regrasp.planning.states.pressing import presses, pressing
from regrasp.planning.states.program import state_program
from regrasp.planning.states.withstanding.apexes import Apexes
from regrasp.planning.states.withstanding.cutting import cut_corners, left_open
from regrasp.programs import Program, Solution, Status, solve
from regrasp.programs.backends import answered_quickly, asked, solved_quickly

if TYPE_CHECKING:
    from regrasp.planning.states.withstanding.demand import Demand

# Fraction of friction and limits that programs keep back besides the reserve, so that a solver's rounding,
# 1e-10 and less, is inside the reserve and not beyond it.
SLACK = 1e-9
# Limits beyond this many loads bind nothing that minimises forces, and spoil the scale of a program.
LOOSE = 1e6
# A solver's zero; whether forces exist is decided by finding them.
FEASIBLE = 1e-7
# An answer that exact equilibrium moves by more than this fraction of the forces is not the best one.
_MOVED = 1e-5
# Forces this many times the unit are better measured by one of their own; if a solver diverged, by none.
_FAR = 4.0
_DIVERGED = 1e12


def force_unit(grasp: Grasp, load: Wrench) -> float:
    """The size of the load as a force [N], torque divided by the grasp's size; 0 without a load."""
    sizes = [abs(number) for number in load.plain]
    return max(*sizes[: grasp.dimension], max(sizes[grasp.dimension :]) / (grasp.size or 1.0))


class Found(NamedTuple):
    """Forces (n, d) in exact equilibrium [N] and how much better the best can be, at most."""

    forces: Array
    gap: float


class Polish(NamedTuple):
    """The best forces (n, w) from forces nearly the best, of an objective under frictions and limits.

    at_once: from an answer as it is; None where that is not sure. searched: from forces in equilibrium.
    """

    at_once: Callable[["Chooser", ConvexObjective, Solution, list[float], list[float]], Array | None]
    searched: Callable[["Chooser", ConvexObjective, Array, list[float], list[float]], Array]


class Depth(NamedTuple):
    """How deep inside the cones forces reach, in units.

    forces: (n, w) that reach it [N]. normals: (n,) their normal forces in units. weights: (n,) what a unit of
    depth at each contact is worth. motion: (3,) or (6,) that the duals are.
    """

    depth: float
    forces: Array
    normals: Array
    weights: Array
    motion: Array


class Chooser:
    """Chooses forces of one grasp under one load with one back end.

    Forces are (n, w) as the cones measure them (``regrasp.mechanics.cones``).
    """

    def __init__(
        self,
        grasp: Grasp,
        load: Wrench,
        backend: str,
        facets: int | None,
        limits: list[float],
        least: Array | None = None,
        demand: "Demand | None" = None,
    ) -> None:
        self.least, self.demand, self.apexes = least, demand, Apexes()
        self.grasp, self.load, self.backend, self.facets = grasp, load, backend, facets
        self.matrix, self.vector = grasp.scaled_matrix, load.vector / grasp.lengths
        self.unit = self.load_size = force_unit(grasp, load)
        if self.unit == 0:  # no load: the limits tell the size of a force; without any, all are zero
            self.unit = min(limits, default=1.0) if min(limits, default=inf) < inf else 1.0
        self.loose = LOOSE * self.unit

    def rescale(self, unit: float) -> None:
        """Another unit of force [N]; every limit counts."""
        self.unit, self.loose = unit, inf

    def of(self, contacts: Iterable[int]) -> "Chooser":
        """The same, for some of the contacts."""
        chosen = list(contacts)
        least = None if self.least is None else self.least[chosen]
        some = Chooser(self.grasp.subset(chosen), self.load, self.backend, self.facets, [], least)
        some.unit, some.loose = self.unit, self.loose
        return some

    def solved(
        self,
        objective: ConvexObjective,
        frictions: list[float],
        limits: list[float],
        weights: Array | None = None,
        *,
        slack: float = SLACK,
        quick: bool = True,
    ) -> Solution:
        """The back end's answer to one of the convex objectives, in units of ``unit``.

        quick: whether that of a kept solver will do. Where the back end has none and stopped at forces far
        larger than the load, it is asked again with their size as the unit.
        """
        program = self.program(objective, frictions, limits, weights, slack)
        if quick and self.backend == "clarabel":
            found = solved_quickly(program)
            if found is not None:
                return found
        try:
            return solve(program, self.backend)
        except SolverFailed as failed:
            size = float(abs(self.wanted(failed.solution)).max())
            if not _FAR * self.unit < size < _DIVERGED * self.unit:
                raise
            self.unit = size
        return solve(self.program(objective, frictions, limits, weights, slack), self.backend)

    def depth(self, frictions: list[float], limits: list[float], weights: Array | None) -> Depth | None:
        """How deep inside the cones forces reach, as the back end says it, not audited; None if it does not.

        weights: (n,) how deep a unit is at each contact; sqrt(1 + mu^2) if not given: a distance.
        """
        program = self.program(FORCE, frictions, limits, weights, SLACK)
        quick = answered_quickly(program) if self.backend == "clarabel" else None
        quick_says_none = quick is not None
        if quick is None:
            answer = asked(program, self.backend, {})
            quick = answer.value, answer.duals
        x, duals = quick
        if not np.isfinite(duals).all():
            return None
        if not np.isfinite(x).all():
            return self.out_of_reach(duals) if quick_says_none else None
        rows = program.A.indices[program.A.indptr[-2] :]  # of the cones: those that the depth stands in
        forces = self.in_newtons(x)
        normals = self.grasp.cones.normal(forces) / self.unit
        rough = np.array(frictions) > NEGLIGIBLE
        shares = np.zeros(len(self.grasp))
        if rough.any():
            shares[rough] = duals[rows].reshape(int(rough.sum()), -1).sum(axis=1)
        if self.facets is not None and self.grasp.dimension == 3:
            shares *= cos(pi / self.facets)  # the faces are nearer to the axis than the cone
        return Depth(float(x[-1]), forces, normals, shares, self.twist_of(duals))

    def out_of_reach(self, duals: Array) -> Depth:
        """What is known where no forces balance the load: the motion, and no depth."""
        n = len(self.grasp)
        none = np.zeros(n)
        return Depth(-1.0, np.zeros((n, self.grasp.width)), none, none, self.twist_of(duals))

    def program(
        self,
        objective: ConvexObjective,
        frictions: list[float],
        limits: list[float],
        weights: Array | None,
        slack: float,
        inside: bool = True,
    ) -> Program:
        """The program of a convex objective, of which a part ``slack`` of frictions and limits is kept back.

        weights: as ``state_program``. inside: as ``withstanding.rows``.
        """
        kept = 1 - slack
        program = state_program(
            self.grasp,
            self.load,
            objective,
            [kept * mu for mu in frictions],
            [kept * limit if limit < self.loose else inf for limit in limits],
            self.unit,
            self.facets,
            weights,
        )
        if self.least is None:
            return program
        demand = self.demand
        if demand is not None and (demand.is_kept or objective.bound is Bound.FACTOR):
            from regrasp.planning.states.withstanding.rows import with_rows

            mu, bounds = [kept * mu for mu in frictions], [kept * limit for limit in limits]
            by_factor = objective.bound is Bound.FACTOR
            program = with_rows(program, demand, mu, bounds, self.unit, by_factor, self.apexes, inside)
        ends = (limit for limit in limits if limit < inf) if self.loose == inf else ()
        return pressing(program, self.grasp, self.least, self.unit, max(ends, default=self.unit))

    def best(
        self,
        objective: ConvexObjective,
        frictions: list[float],
        limits: list[float],
        polish: "Polish | None" = None,
    ) -> Found | None:
        """The best forces for a convex objective; None where the back end says there are none.

        polish: takes the answer's forces to the last digits, before they are moved into equilibrium or after.
        """
        for quick in (True, False):
            answer = self._claimed(objective, frictions, limits, quick)
            if answer is None:
                return None
            if polish is not None:
                exact = polish.at_once(self, objective, answer, frictions, limits)
                if exact is not None:
                    return Found(exact, answer.absolute_gap * objective.scale(self.unit))
            wanted = self.wanted(answer)
            forces = self.settled(wanted, frictions, limits)
            moved = inf if forces is None else float(abs(forces - wanted).max())
            if forces is not None and moved <= _MOVED * max(self.unit, float(abs(forces).max())):
                break
        if forces is None or answer is None:
            return None
        if not moved <= _MOVED * max(self.unit, float(abs(forces).max())):
            raise SolverFailed(
                f"{self.backend} answered forces {moved:.2g} away from equilibrium inside the cones",
                answer.program,
                answer,
            )
        if polish is not None:
            forces = polish.searched(self, objective, forces, frictions, limits)
        gap = answer.absolute_gap * objective.scale(self.unit)
        if objective.bound is Bound.FACTOR and self.demand is not None and self.demand.is_round:
            relaxed = self.program(objective, frictions, limits, None, 0.0, inside=False)
            gap += left_open(relaxed, self.backend, float(answer.value[-1]))
        return Found(forces, gap)

    def _claimed(
        self, objective: ConvexObjective, frictions: list[float], limits: list[float], quick: bool
    ) -> Solution | None:
        """The answer with forces; None where the back end says there are none."""
        demand = self.demand if self.demand is not None and self.demand.is_round else None
        by_factor = objective.bound is Bound.FACTOR

        def laid_out() -> Program:
            return self.program(objective, frictions, limits, None, SLACK)

        if demand is not None and by_factor:
            cut_corners(self.apexes, laid_out, self.backend, by_factor)
        answer = self.solved(objective, frictions, limits, quick=quick)
        if answer.status is Status.INFEASIBLE:  # at the limit of what can be held the slack may be missed
            answer = self.solved(objective, frictions, limits, slack=0.0)
        if answer.status is Status.INFEASIBLE and demand is not None and demand.is_kept:
            cut_corners(self.apexes, laid_out, self.backend, by_factor)
            answer = self.solved(objective, frictions, limits, quick=quick)
        if answer.status is Status.INFEASIBLE:
            return None
        if answer.status is Status.UNBOUNDED:
            if recorded(objective) != objective.name:
                raise InvalidInput(
                    f"objective {shown(objective.name)} falls without bound: some squeeze costs ever "
                    "less; give "
                    f"max_force, or every finger a weight above 0"
                )
            raise SolverFailed(f"{self.backend}: {answer.status.advice}", answer.program, answer)
        if objective.bound is Bound.MARGIN and answer.value[-1] < -FEASIBLE:
            return None  # the least distance to the cones' boundaries is negative: some force is outside
        return answer

    def exact(self, answer: Solution, frictions: list[float], limits: list[float]) -> Array | None:
        """The answer's forces (n, d) moved into equilibrium, inside cones and limits; None if none are."""
        return self.settled(self.wanted(answer), frictions, limits)

    def settled(self, wanted: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """Forces (n, d) moved least into equilibrium, inside cones and limits; None if there are none.

        The least change of all forces does, idle fingers left idle, unless it leaves a cone. None, too, where
        a finger then pushes with less than its least normal force.
        """
        found = self.shifted(wanted, frictions, limits)
        if found is None and np.isfinite(wanted).all():
            found = self.nearest(wanted, frictions, limits)
            if found is None:
                mu, most = np.array(frictions), np.array(limits)
                found = nearest_nearly_flat(self.grasp, self.vector, wanted, mu, most)
        if found is None or self.least is None:
            return found
        if not presses(found, self.grasp, self.least):
            return None
        demand = self.demand
        is_kept = demand is None or not demand.is_kept or demand.spare(found, np.array(limits)) >= 0
        return found if is_kept else None

    def shifted(self, wanted: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """Forces (n, d) changed least into equilibrium, idle fingers left idle; None if they leave a cone."""
        mu, limit = np.array(frictions), np.array(limits)
        return shifted(self.grasp, self.vector, wanted, mu, limit)

    def nearest(self, forces: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """The forces nearest to ``forces`` in equilibrium, inside cones and limits; None if none are."""
        size, cones = self.grasp.size or 1.0, self.grasp.cones
        mu, limit = np.array(frictions), np.array(limits)
        return nearest_equilibrium(forces, cones.matrix, self.load.vector, cones.normals, mu, limit, size)

    def twist_of(self, duals: Array) -> Array:
        """The motion that the duals of the balance are, (3,) or (6,)."""
        twist: Array = -duals[: self.load.vector.size] / self.grasp.lengths
        return twist

    def proves(self, twist: Array, frictions: list[float], limits: list[float]) -> bool:
        """Whether no forces exist, proven by this motion."""
        if inf not in limits and surely_wins(self.grasp, self.load.vector, twist, frictions, limits):
            return True
        return EscapeTwist(self.grasp, self.load, twist, tuple(frictions), tuple(limits)).is_proof

    def is_lost(self, frictions: list[float], limits: list[float]) -> bool:
        """Whether no forces exist, proven by any motion that is found."""
        given = self.grasp, self.load, frictions, limits
        return escape_twist(*given) is not None or limited_twist(*given) is not None

    def wanted(self, answer: Solution) -> Array:
        """The answer's forces (n, w), as the cones measure them [N]."""
        return self.in_newtons(answer.value)

    def in_newtons(self, unknowns: Array) -> Array:
        """The forces (n, w) of a program's unknowns, as the cones measure them [N]."""
        w = self.grasp.width
        wanted: Array = unknowns[: w * len(self.grasp)].reshape(-1, w)
        if w == 4:  # a point contact makes no torque, whatever a solver says of a number that does nothing
            wanted = self.grasp.cones.measured(self.grasp.cones.forces(wanted))
        return wanted * self.unit
