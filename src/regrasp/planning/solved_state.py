"""Choosing forces by programs: every answer is moved into exact equilibrium and certified."""

from collections.abc import Iterable
from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.balance import EQUILIBRIUM, nearest_equilibrium
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.criteria import ChosenForces, Criteria
from regrasp.planning.escape import escape_twist, infeasible
from regrasp.planning.narrowing import LEVEL_TOLERANCE, Narrowing
from regrasp.planning.state_program import state_program
from regrasp.programs import Solution, Status, solve

# Fraction of friction and limits that programs keep back besides the reserve, so that a solver's rounding,
# 1e-10 and less, is inside the reserve and not beyond it.
_SLACK = 1e-9
# A solver's zero; whether forces exist is decided by finding them.
_FEASIBLE = 1e-7
# An answer that exact equilibrium moves by more than this fraction of the forces is not the best one.
_MOVED = 1e-5


class Found(NamedTuple):
    """Forces (n, 2) in exact equilibrium [N] and how much better the best can be, at most."""

    forces: Array
    gap: float


class Chooser:
    """Chooses forces of one grasp under one load with one back end."""

    def __init__(
        self, grasp: Grasp, load: Wrench, backend: str, facets: int | None, limits: list[float]
    ) -> None:
        self.grasp, self.load, self.backend, self.facets = grasp, load, backend, facets
        size = grasp.size or 1.0
        self.unit = max(float(abs(load.force).max()), float(abs(load.torque).max()) / size)
        if self.unit == 0:  # no load: the limits tell the size of a force; without any, all are zero
            self.unit = min(limits) if min(limits) < inf else 1.0

    def of(self, contacts: Iterable[int]) -> "Chooser":
        """The same, for some of the contacts."""
        some = Chooser(self.grasp.subset(contacts), self.load, self.backend, self.facets, [self.unit])
        some.unit = self.unit
        return some

    def solved(
        self, objective: str, frictions: list[float], limits: list[float], weights: Array | None = None
    ) -> Solution:
        """The back end's answer to one of the convex objectives, in units of ``unit``."""
        kept = 1 - _SLACK
        program = state_program(
            self.grasp,
            self.load,
            objective,
            [kept * mu for mu in frictions],
            [kept * limit for limit in limits],
            self.unit,
            self.facets,
            weights,
        )
        return solve(program, self.backend)

    def best(self, objective: str, frictions: list[float], limits: list[float]) -> Found | None:
        """The best forces for a convex objective; None where the back end says there are none."""
        answer = self.solved(objective, frictions, limits)
        if answer.status is Status.INFEASIBLE:
            return None
        if answer.status is Status.UNBOUNDED:
            raise SolverFailed(f"{self.backend}: {answer.status.advice}", answer.program, answer)
        if objective == "force" and answer.value[-1] < -_FEASIBLE:
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
        """The answer's forces (n, 2) moved into equilibrium, inside cones and limits; None if none are.

        The least change of all forces does, unless it leaves a cone.
        """
        grasp, wanted = self.grasp, self._wanted(answer)
        mu, limit = np.array(frictions), np.array(limits)
        forces = _shifted(wanted, grasp, self.load)
        if forces is not None:
            normal, tangential = (
                (forces * grasp.normals).sum(axis=1),
                abs((forces * grasp.tangents).sum(axis=1)),
            )
            if (tangential <= mu * normal).all() and ((forces**2).sum(axis=1) <= limit**2).all():
                return forces
        if not np.isfinite(wanted).all():
            return None
        return nearest_equilibrium(
            wanted, grasp.matrix, self.load.vector, grasp.normals, mu, limit, grasp.size or 1.0
        )

    def _wanted(self, answer: Solution) -> Array:
        wanted: Array = answer.value[: 2 * len(self.grasp)].reshape(-1, 2) * self.unit
        return wanted


def solved_forces(
    grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None = None
) -> ChosenForces:
    """The best forces of any number of planar contacts, by programs. Raises ``Infeasible``.

    For ``angle`` and ``friction_use`` see ``regrasp.planning.narrowing``.
    """
    criteria.demand_limit(grasp, load)
    if not criteria.unbounded and not load.vector.any():  # nothing to hold: the least of everything is zero
        return ChosenForces([[0.0, 0.0]] * len(grasp), tuple(criteria.limits(grasp)), backend, 0.0)
    try:
        return _solved(grasp, load, criteria, backend, facets)
    except SolverFailed:
        # Solvers fail at the limit of what can be held. That is no verdict; a proof is.
        reason = infeasible(grasp, load, criteria)
        if reason.certificate is None:
            raise
        raise reason from None


def _solved(grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None) -> ChosenForces:
    frictions, limits = criteria.frictions(grasp), criteria.limits(grasp)
    chooser = Chooser(grasp, load, backend, facets, limits)
    if criteria.unbounded and inf in limits:
        least = chooser.best("peak", frictions, limits)
        if least is None:
            raise infeasible(grasp, load, criteria)
        peak = float(np.sqrt((least.forces**2).sum(axis=1)).max())
        limits = [min(limit, criteria.peak_ratio * peak) for limit in limits]
    narrows = criteria.objective in ("angle", "friction_use")
    found = chooser.best("force" if narrows else criteria.objective, frictions, limits)
    if found is None:
        raise infeasible(grasp, load, criteria)
    if narrows:
        found = _narrowed(chooser, Narrowing(grasp, criteria.objective, frictions), found.forces, limits)
    return ChosenForces(found.forces, tuple(limits), backend, found.gap)


def _shifted(forces: Array, grasp: Grasp, load: Wrench) -> Array | None:
    """The forces nearest to ``forces`` with G f + w = 0, whatever the cones; None where rounding forbids."""
    g = grasp.matrix.copy()
    g[2] /= grasp.size or 1.0
    w = load.vector.copy()
    w[2] /= grasp.size or 1.0
    f = forces.ravel()
    try:
        for _ in range(2):
            f = f - g.T @ np.linalg.solve(g @ g.T, g @ f + w)
    except np.linalg.LinAlgError:
        return None
    if not abs(g @ f + w).max() <= EQUILIBRIUM / 2 * max(float(abs(f).max()), float(abs(w).max())):
        return None
    return f.reshape(forces.shape)


def _narrowed(chooser: Chooser, narrowing: Narrowing, forces: Array, limits: list[float]) -> Found:
    """The forces of the highest level, from ``forces`` upwards; the gap is to a level proven out of reach.

    Of the states within the tolerance, that of the widest force margin is taken.
    """
    held, lost = narrowing.level(forces), narrowing.top
    proven, gained, climbs = lost, inf, True
    while lost - held > LEVEL_TOLERANCE / 2 * (1 + 1e-6):
        middle = (held + lost) / 2
        level = min(held + LEVEL_TOLERANCE / 2, middle) if climbs else middle
        higher, is_proof = _at_level(chooser, narrowing.narrowed(level), limits, forces)
        if higher is None:
            lost, climbs = level, True
            proven = level if is_proof else proven
        else:
            reached = max(narrowing.level(higher), held)
            # Steps that do not shrink converge too slowly: halve what is left once, then climb on.
            climbs = not climbs or reached - held < gained / 2
            gained, held, forces = reached - held, reached, higher
    cones = narrowing.narrowed(max(held - LEVEL_TOLERANCE / 2, 0.0))
    widest, _ = _at_level(chooser, cones, limits, None)
    if widest is not None:
        forces = widest
    return Found(forces, max(proven - narrowing.level(forces), 0.0))


def _at_level(
    chooser: Chooser, cones: dict[int, float], limits: list[float], known: Array | None
) -> tuple[Array | None, bool]:
    """Forces (n, 2) inside narrowed cones, other fingers idle; or None, and whether a twist proves it.

    The least distance to the edges is widest, measured for each finger by its normal force in ``known``: so
    the level rises most. Without ``known`` forces it is the force margin.
    """
    grasp = chooser.grasp
    used = chooser if len(cones) == len(grasp) else chooser.of(cones)
    frictions, bounds = list(cones.values()), [limits[i] for i in cones]
    weights = None
    if known is not None:
        weights = np.maximum((known * grasp.normals).sum(axis=1), 0.0)[list(cones)] / chooser.unit
    try:
        answer = used.solved("force", frictions, bounds, weights)
    except SolverFailed as failed:
        answer = failed.solution  # whether it is near enough is seen below
    if answer.status is not Status.INFEASIBLE and not answer.value[-1] < -_FEASIBLE:
        forces = used.exact(answer, frictions, bounds)
        if forces is not None:
            whole = np.zeros((len(grasp), 2))
            whole[list(cones)] = forces
            return whole, False
    if np.isfinite(answer.duals[:3]).all():
        twist = -answer.duals[:3]
        twist[2] /= used.grasp.size or 1.0
        if EscapeTwist(used.grasp, used.load, twist, tuple(frictions), tuple(bounds)).is_proof:
            return None, True
    return None, escape_twist(used.grasp, used.load, frictions, bounds) is not None
