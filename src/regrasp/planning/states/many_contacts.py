"""Choosing the state of any number of contacts by programs."""

from contextlib import suppress
from dataclasses import replace
from math import inf

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, SolverFailed, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import NEVER
from regrasp.mechanics.exact.membership import vertex_forces
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import ChosenForces, Criteria
from regrasp.planning.states.escape import AT_LIMIT, infeasible, unproven, verdict
from regrasp.planning.states.faces import ball_faces, gauge
from regrasp.planning.states.level_search import highest
from regrasp.planning.states.narrowing import Narrowing
from regrasp.planning.states.objectives import EFFORT, FORCE, PEAK, ConvexObjective, LevelObjective
from regrasp.planning.states.pressing import LARGE
from regrasp.planning.states.refusals.asking import is_asked_only
from regrasp.planning.states.separation import edge_of
from regrasp.planning.states.solving import LOOSE, Chooser, Found
from regrasp.programs.backends import least_room

_SAME = 1e-6  # of a margin [rad, N or -]
_BESIDE = 1e4  # forces so many times a load are beside it in one program
_FAR = 1e3  # forces so much larger than the load are the better unit
_OTHER_SCALES = (1e3, 10.0)  # limits in units of programs, where those of LOOSE are not solved
_BALANCED = 1e9
VANISHING = 1e-9
"""A load below this fraction of the force limits changes no margin: the best squeeze is that without."""


def solved_forces(
    grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None = None
) -> ChosenForces:
    """The best forces of any number of contacts, by programs. Raises ``Infeasible``.

    For ``angle`` and ``friction_use`` see ``regrasp.planning.states.narrowing``.
    """
    criteria.demand_limit(grasp, load)
    if grasp.limit_rows is not None and not any(load.plain) and not criteria.presses and not criteria.demands:
        return _unloaded(grasp, load, criteria, backend, facets)
    if criteria.presses or grasp.limit_rows is not None or criteria.demand(grasp) is not None:
        try:
            return _pressed(grasp, load, criteria, backend, facets)
        except SolverFailed as failed:
            if failed.program is None or not least_room(failed.program, backend) >= -AT_LIMIT:
                raise
            raise _too_weak(grasp, load, criteria) from None
    objective = criteria.objective
    if isinstance(objective, ConvexObjective) and objective.rests and not any(load.plain):
        return ChosenForces([[0.0] * grasp.width] * len(grasp), tuple(criteria.limits(grasp)), backend, 0.0)
    try:
        return _solved(grasp, load, criteria, backend, facets)
    except (SolverFailed, Infeasible) as failure:
        if is_asked_only():
            raise
        # At the limit of what can be held solvers fail or guess. That is no verdict; a proof is.
        reason = failure if isinstance(failure, Infeasible) else verdict(grasp, load, criteria)
        if reason is None or reason.certificate is None:
            if criteria.unbounded and min(criteria.limits(grasp)) < inf:
                for loose in _OTHER_SCALES:
                    with suppress(Infeasible, SolverFailed):
                        return _solved(grasp, load, criteria, backend, facets, loose=loose)
            anyway = _by_newton(grasp, load, criteria, backend, facets)
            if anyway is not None:
                return anyway
        if reason is None and (backend != "clarabel" or facets is not None):
            raise  # another back end may know better
        raise reason or unproven(grasp, load, criteria) from None


def _unloaded(
    grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None
) -> ChosenForces:
    """The best squeeze within linear limits: scaled into them where its size does not count."""
    objective = criteria.objective
    if isinstance(objective, ConvexObjective) and not objective.rests:
        return _pressed(grasp, load, criteria, backend, facets)
    found = solved_forces(Grasp(c.changed(limits=None) for c in grasp), load, criteria, backend, facets)
    forces, rows = np.array(found.forces, dtype=float), grasp.limit_rows
    assert rows is not None
    used = np.einsum("mw,mw->m", rows.rows, grasp.cones.measured(forces)[rows.contacts]) / rows.bounds
    return found._replace(forces=forces / max(1.0, float(used.max()) * (1 + 1e-12)))


def _pressed(
    grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None
) -> ChosenForces:
    """The best forces where fingers keep least normal forces or linear limits, or withstand a set."""
    demand = criteria.demand(grasp)
    if demand is not None and facets is not None:
        raise InvalidInput(
            "facets stand for circles of a load that is known; leave them out with a disturbance"
        )
    frictions, limits = criteria.frictions(grasp), criteria.limits(grasp)
    least = np.array(criteria.least_normals(grasp))
    if demand is not None and criteria.withstands:
        least = np.maximum(least, demand.least_normals())
    chooser = Chooser(grasp, load, backend, facets, limits, least, demand)
    if any(load.plain) and least.max() > _BALANCED * chooser.load_size:
        raise InvalidInput(
            f"min_normal must be at most {_BALANCED:g} times the load of {chooser.load_size:.6g} N, got "
            f"{least.max():g}: rounding of such forces is as large as the load"
        )
    chooser.rescale(max(chooser.load_size, float(least.max())) or chooser.unit)
    objective = criteria.objective
    if not criteria.unbounded:
        chooser.loose = LOOSE * chooser.unit
    elif min(limits) < inf:  # forces will be as large as these limits let them
        chooser.rescale(max(chooser.unit, min(limits) / LARGE))
    smallest = None
    if criteria.unbounded and inf in limits:
        smallest = chooser.best(PEAK, frictions, limits)
        if smallest is None:
            raise _too_weak(grasp, load, criteria)
        peak = _radius(grasp, frictions, smallest.forces, facets)
        limits = [min(limit, criteria.peak_ratio * peak) for limit in limits]
        smallest = Found(smallest.forces, inf)
    try:
        found = chooser.best(
            objective if isinstance(objective, ConvexObjective) else FORCE, frictions, limits
        )
    except SolverFailed as failed:  # limits that leave next to no room, or a little less
        found = smallest or _of_least_peak(chooser, frictions, limits, failed)
    found = found or smallest
    if found is None:
        raise _too_weak(grasp, load, criteria)
    if isinstance(objective, LevelObjective):
        narrowing = Narrowing(grasp, objective, frictions)
        found = Found(found.forces, max(narrowing.top - narrowing.level(found.forces), 0.0))
        with suppress(SolverFailed):
            found = highest(chooser, narrowing, found.forces, limits)
    return ChosenForces(grasp.cones.forces(found.forces), tuple(limits), backend, found.gap)


def _of_least_peak(
    chooser: Chooser, frictions: list[float], limits: list[float], failed: SolverFailed
) -> Found | None:
    """The forces of the least peak where a solver failed within the limits; None where limits are below it.

    Where the limits differ, others may keep them: it is not known, and the failure stands.
    """
    try:
        least = chooser.best(PEAK, frictions, [inf] * len(limits))
    except SolverFailed:
        raise failed from None
    if least is None:
        return None
    sizes = np.sqrt((least.forces**2).sum(axis=1))
    if (sizes <= limits).all():
        return Found(least.forces, inf)
    if min(limits) < max(limits):
        raise failed
    return None


def _too_weak(grasp: Grasp, load: Wrench, criteria: Criteria) -> Infeasible:
    """Why no forces with these least normal forces exist."""
    alone = replace(
        criteria, min_normal=0.0, disturbance=None, early_loss=False
    )  # linear limits are the grasp's
    reason = verdict(grasp, load, alone) if any(load.plain) else None
    if reason is not None and reason.certificate is not None:
        return reason
    if criteria.withstands:
        pressing = " and push with their least normal forces" if criteria.presses else ""
        what = f"deviations in the {criteria.disturbance}"
        less = "a smaller disturbance, or objective 'wrench', says how much of it they withstand; "
        if criteria.disturbance is None:
            what, less = "the early loss of a finger that leaves or arrives", ""
        return Infeasible(
            f"no forces of {', '.join(grasp.names)} that balance {load!r}{pressing} and withstand {what} "
            f"were found, within cones and force limits; {less}higher force limits let them squeeze more"
        )
    if not criteria.presses:
        who = ", ".join(str(c.name) for c in grasp if c.limits is not None)
        return Infeasible(
            f"no forces of {', '.join(grasp.names)} that balance {shown(load)} within the linear limits of "
            f"{who} were found, within cones and force limits; without these limits no motion proves that "
            f"there are none: loosen them"
        )
    least = ", ".join(f"{n} {f:g}" for n, f in zip(grasp.names, criteria.least_normals(grasp), strict=True))
    return Infeasible(
        f"no forces of {', '.join(grasp.names)} that balance {shown(load)} and push along the normals with "
        f"{least} or more were found, within cones and force limits; without least normal forces no motion "
        f"proves that there are none: lower min_normal, or raise the force limits"
    )


def _by_newton(
    grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None
) -> ChosenForces | None:
    """Forces that hold the load where a solver gives none: of least effort by Newton's method, or any.

    Then better ones, as near to the best as slightly wider cones tell.
    """
    if backend != "clarabel" or facets is not None:
        return None
    frictions, limits = criteria.frictions(grasp), criteria.limits(grasp)
    chooser = Chooser(grasp, load, backend, facets, limits)
    none = np.zeros((len(grasp), grasp.width))
    forces = chooser.nearest(none, frictions, limits)
    is_least = forces is not None and criteria.objective is EFFORT
    forces = chooser.settled(none, frictions, limits) if forces is None else forces
    if forces is None and grasp.dimension == 2:
        vertex = vertex_forces(grasp, load, frictions)
        near = vertex is not None and abs(vertex).max() <= NEVER * chooser.load_size
        forces = chooser.settled(vertex, frictions, limits) if vertex is not None and near else None
    if forces is None:
        edge = edge_of(grasp, load.vector, frictions, limits) if any(load.plain) else None
        forces = None if edge is None else chooser.settled(edge.forces, frictions, limits)
    if forces is None:
        return None
    found, objective = Found(forces, 0.0 if is_least else inf), criteria.objective
    if criteria.unbounded and inf in limits:
        peak = _radius(grasp, frictions, forces, facets)
        limits = [min(limit, criteria.peak_ratio * peak) for limit in limits]
    if isinstance(objective, LevelObjective):
        narrowing = Narrowing(grasp, objective, frictions)
        found = Found(forces, max(narrowing.top - narrowing.level(forces), 0.0))
        with suppress(SolverFailed):
            found = highest(chooser, narrowing, forces, limits)
    elif isinstance(objective, ConvexObjective) and not is_least:
        from regrasp.planning.states.degenerate.near_the_edge import best_near_the_edge

        found = best_near_the_edge(chooser, objective, forces, frictions, limits)
    return ChosenForces(grasp.cones.forces(found.forces), tuple(limits), backend, found.gap)


def _solved(
    grasp: Grasp,
    load: Wrench,
    criteria: Criteria,
    backend: str,
    facets: int | None,
    *,
    loose: float = LOOSE,
) -> ChosenForces:
    """The best forces; force limits are at most ``loose`` units of the programs, where they bind."""
    frictions, limits = criteria.frictions(grasp), criteria.limits(grasp)
    chooser = Chooser(grasp, load, backend, facets, limits)
    if criteria.unbounded and chooser.load_size <= VANISHING * min(limits) and max(limits) < inf:
        from regrasp.planning.states.degenerate.no_load import best_squeeze

        squeezed = best_squeeze(grasp, criteria, backend, facets, frictions, limits)
        if not any(load.plain):  # nothing to hold, and where nothing squeezes nothing to hold it with
            forces, gap = squeezed or Found(np.zeros((len(grasp), grasp.width)), 0.0)
            return ChosenForces(grasp.cones.forces(forces), tuple(limits), backend, gap)
        room = 1 - 4 * len(grasp) * chooser.load_size / min(limits)  # for what the load adds
        loaded = None if squeezed is None else chooser.settled(room * squeezed.forces, frictions, limits)
        if (
            squeezed is not None
            and loaded is not None
            and _changes_nothing(grasp, criteria, squeezed.forces, loaded)
        ):
            return ChosenForces(grasp.cones.forces(loaded), tuple(limits), backend, squeezed.gap)
        # Fingers that take no part in the squeeze must hold the load, with forces of its size.
        capped = replace(criteria, max_force=_BESIDE * chooser.load_size)
        with suppress(Infeasible, SolverFailed):  # what the cap forbids is no verdict
            return _solved(grasp, load, capped, backend, facets)._replace(force_limits=tuple(limits))
    if criteria.unbounded and min(limits) < inf:  # forces will be as large as these limits let them
        chooser.rescale(max(chooser.unit, min(limits) / loose))
    least = None
    if criteria.unbounded and inf in limits:
        least = chooser.best(PEAK, frictions, limits)
        if least is None:
            raise infeasible(grasp, load, criteria)
        peak = _radius(grasp, frictions, least.forces, facets)
        if peak > _FAR * chooser.unit:
            chooser.rescale(peak)
        limits = [min(limit, criteria.peak_ratio * peak) for limit in limits]
    objective = criteria.objective
    found = least  # from which a search for levels goes on
    if isinstance(objective, ConvexObjective):
        from regrasp.planning.states.degenerate.flat_minima import POLISH

        found = chooser.best(objective, frictions, limits, POLISH if facets is None else None)
    elif least is None:
        found = chooser.best(FORCE, frictions, limits)
    if found is None:
        raise infeasible(grasp, load, criteria)
    forces, gap = found
    if isinstance(objective, LevelObjective):
        forces, gap = highest(chooser, Narrowing(grasp, objective, frictions), forces, limits)
    return ChosenForces(grasp.cones.forces(forces), tuple(limits), backend, gap)


def _changes_nothing(grasp: Grasp, criteria: Criteria, squeezed: Array, loaded: Array) -> bool:
    """Whether a squeeze that holds a load, too, is as good as before."""
    none = Wrench.from_vector(np.zeros(len(grasp.matrix)))
    before, after = (
        criteria.objective.value(GraspState(grasp, none, grasp.cones.forces(forces)))
        for forces in (squeezed, loaded)
    )
    return abs(after - before) <= _SAME * max(1.0, abs(before))


def _radius(grasp: Grasp, frictions: list[float], forces: Array, facets: int | None) -> float:
    """The radius of the least ball about the origin, or the polyhedron inside it, that holds the forces.

    Many forces share the least polyhedron, so that another measure of them would depend on the back end.
    """
    if facets is None:
        return float(np.sqrt((forces**2).sum(axis=1)).max())
    return gauge(forces, *ball_faces(grasp, np.array(frictions), facets))
