"""Choosing forces by programs: every answer is moved into exact equilibrium and certified."""

from collections.abc import Iterable
from math import cos, inf, pi
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
# Limits beyond this many loads bind nothing that minimises forces, and spoil the scale of a program.
_LOOSE = 1e6
# A solver's zero; whether forces exist is decided by finding them.
_FEASIBLE = 1e-7
# An answer that exact equilibrium moves by more than this fraction of the forces is not the best one.
_MOVED = 1e-5
# Forces miss the cones for sure by a distance to which the residual is at most this.
_SURE = 1e-2
# The best level must be known this well.
_UNSURE = 10 * LEVEL_TOLERANCE


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
            self.unit = min(limits, default=1.0) if min(limits, default=inf) < inf else 1.0
        self.loose = _LOOSE * self.unit

    def rescale(self, unit: float) -> None:
        """Another unit of force [N]; every limit counts."""
        self.unit, self.loose = unit, inf

    def of(self, contacts: Iterable[int]) -> "Chooser":
        """The same, for some of the contacts."""
        some = Chooser(self.grasp.subset(contacts), self.load, self.backend, self.facets, [])
        some.unit, some.loose = self.unit, self.loose
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
            [kept * limit if limit < self.loose else inf for limit in limits],
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
            inside = (normal >= 0) & (tangential <= mu * normal) & ((forces**2).sum(axis=1) <= limit**2)
            if inside.all():
                return forces
        return self.nearest(wanted, frictions, limits) if np.isfinite(wanted).all() else None

    def nearest(self, forces: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """The forces nearest to ``forces`` in equilibrium, inside cones and limits; None if none are."""
        g, mu, limit = self.grasp, np.array(frictions), np.array(limits)
        return nearest_equilibrium(forces, g.matrix, self.load.vector, g.normals, mu, limit, g.size or 1.0)

    def _wanted(self, answer: Solution) -> Array:
        wanted: Array = answer.value[: 2 * len(self.grasp)].reshape(-1, 2)
        return wanted * self.unit


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
    if criteria.unbounded and min(limits) < inf:  # forces will be as large as these limits let them
        chooser.rescale(max(chooser.unit, min(limits) / _LOOSE))
    if criteria.unbounded and inf in limits:
        least = chooser.best("peak", frictions, limits)
        if least is None:
            raise infeasible(grasp, load, criteria)
        peak = _radius(least.forces, facets)
        limits = [min(limit, criteria.peak_ratio * peak) for limit in limits]
    narrows = criteria.objective in ("angle", "friction_use")
    found = chooser.best("force" if narrows else criteria.objective, frictions, limits)
    if found is None:
        raise infeasible(grasp, load, criteria)
    if narrows:
        found = _narrowed(chooser, Narrowing(grasp, criteria.objective, frictions), found.forces, limits)
    return ChosenForces(found.forces, tuple(limits), backend, found.gap)


def _radius(forces: Array, facets: int | None) -> float:
    """The radius of the least circle about the origin, or the polygon inside it, that holds the forces.

    Many forces share the least polygon, so that another measure of them would depend on the back end.
    """
    if facets is None:
        return float(np.sqrt((forces**2).sum(axis=1)).max())
    angles = 2 * pi * np.arange(facets) / facets
    return float((forces @ np.array([np.cos(angles), np.sin(angles)])).max()) / cos(pi / facets)


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

    Of the states within the tolerance, that of the widest force margin is taken. Raises ``SolverFailed``
    where the back end cannot tell what the highest level is.
    """
    if narrowing.objective == "friction_use":  # four contacts and more often need none
        straight = _at_level(chooser, narrowing.narrowed(narrowing.top), limits, None).forces
        forces = forces if straight is None else straight
    held, lost = narrowing.level(forces), narrowing.top
    proven, sure, gained, climbs = lost, lost, inf, True
    while lost - held > LEVEL_TOLERANCE / 2 * (1 + 1e-6):
        middle = (held + lost) / 2
        level = min(held + LEVEL_TOLERANCE / 2, middle) if climbs else middle
        found = _at_level(chooser, narrowing.narrowed(level), limits, forces)
        if found.forces is None:
            lost, climbs = level, True
            proven = level if found.is_proof else proven
            sure = level if found.is_sure else sure
        else:
            reached = max(narrowing.level(found.forces), held)
            # Steps that do not shrink converge too slowly: halve what is left once, then climb on.
            climbs = not climbs or reached - held < gained / 2
            gained, held, forces = reached - held, reached, found.forces
    if proven > lost:
        proven = _lowest_proof(chooser, narrowing, limits, lost, proven)
    if min(sure, proven) - held > _UNSURE:
        raise SolverFailed(
            f"{chooser.backend} cannot tell the best {narrowing.objective}: a level of {held:.9g} is "
            f"reached, one of {min(sure, proven):.9g} is not, and its answers between are not sound"
        )
    cones = narrowing.narrowed(max(held - LEVEL_TOLERANCE / 2, 0.0))
    widest = _at_level(chooser, cones, limits, None).forces
    if widest is not None:
        forces = widest
    return Found(forces, max(proven - narrowing.level(forces), 0.0))


def _lowest_proof(
    chooser: Chooser, narrowing: Narrowing, limits: list[float], above: float, proven: float
) -> float:
    """A level proven out of reach, not far above ``above``: nearer the best level rounding hides proofs."""
    step = LEVEL_TOLERANCE
    while above + step < proven:
        cones = narrowing.narrowed(above + step)
        grasp, bounds = chooser.grasp.subset(cones), [limits[i] for i in cones]
        if escape_twist(grasp, chooser.load, list(cones.values()), bounds) is not None:
            return above + step
        step *= 4
    return proven


class _Level(NamedTuple):
    """Forces (n, 2) of a level, or None; then whether a twist proves it, and whether the answer was sound."""

    forces: Array | None
    is_proof: bool = False
    is_sure: bool = False


def _at_level(chooser: Chooser, cones: dict[int, float], limits: list[float], known: Array | None) -> _Level:
    """Forces inside narrowed cones, other fingers idle.

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
            return _Level(_whole(grasp, cones, forces))
    twist = -answer.duals[:3]
    twist[2] /= used.grasp.size or 1.0
    is_twist = bool(np.isfinite(twist).all() and twist.any())
    if is_twist and EscapeTwist(used.grasp, used.load, twist, tuple(frictions), tuple(bounds)).is_proof:
        return _Level(None, True, True)
    if escape_twist(used.grasp, used.load, frictions, bounds) is not None:
        return _Level(None, True, True)
    if answer.status is Status.INFEASIBLE or answer.residual <= -_SURE * answer.value[-1]:
        return _Level(None, False, True)
    forces = None if known is None else used.nearest(known[list(cones)], frictions, bounds)
    return _Level(None if forces is None else _whole(grasp, cones, forces))


def _whole(grasp: Grasp, contacts: Iterable[int], forces: Array) -> Array:
    """Forces (n, 2) of all contacts, those of ``contacts`` given and the others idle."""
    whole = np.zeros((len(grasp), 2))
    whole[list(contacts)] = forces
    return whole
