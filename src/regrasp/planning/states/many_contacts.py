"""Choosing the state of any number of contacts by programs."""

from math import inf

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import ChosenForces, Criteria
from regrasp.planning.states.escape import infeasible
from regrasp.planning.states.faces import ball_faces, gauge
from regrasp.planning.states.level_search import highest
from regrasp.planning.states.narrowing import Narrowing
from regrasp.planning.states.objectives import FORCE, PEAK, ConvexObjective, LevelObjective
from regrasp.planning.states.solving import LOOSE, Chooser


def solved_forces(
    grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None = None
) -> ChosenForces:
    """The best forces of any number of contacts, by programs. Raises ``Infeasible``.

    For ``angle`` and ``friction_use`` see ``regrasp.planning.states.narrowing``.
    """
    criteria.demand_limit(grasp, load)
    objective = criteria.objective
    if isinstance(objective, ConvexObjective) and objective.rests and not any(load.plain):
        return ChosenForces([[0.0] * grasp.width] * len(grasp), tuple(criteria.limits(grasp)), backend, 0.0)
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
        chooser.rescale(max(chooser.unit, min(limits) / LOOSE))
    if criteria.unbounded and inf in limits:
        least = chooser.best(PEAK, frictions, limits)
        if least is None:
            raise infeasible(grasp, load, criteria)
        peak = _radius(grasp, frictions, least.forces, facets)
        limits = [min(limit, criteria.peak_ratio * peak) for limit in limits]
    objective = criteria.objective
    found = chooser.best(objective if isinstance(objective, ConvexObjective) else FORCE, frictions, limits)
    if found is None:
        raise infeasible(grasp, load, criteria)
    if isinstance(objective, LevelObjective):
        found = highest(chooser, Narrowing(grasp, objective, frictions), found.forces, limits)
    return ChosenForces(grasp.cones.forces(found.forces), tuple(limits), backend, found.gap)


def _radius(grasp: Grasp, frictions: list[float], forces: Array, facets: int | None) -> float:
    """The radius of the least ball about the origin, or the polyhedron inside it, that holds the forces.

    Many forces share the least polyhedron, so that another measure of them would depend on the back end.
    """
    if facets is None:
        return float(np.sqrt((forces**2).sum(axis=1)).max())
    return gauge(forces, *ball_faces(grasp, np.array(frictions), facets))
