"""The choice of a state as a convex program: the seam where mechanics becomes rows.

Unknowns x = (f_1, ..., f_n, t), forces in units of ``unit`` [N] and torques divided by the grasp's size, so
that the data are of order one whatever the units. In the plane two half-planes are the friction cone:

    equilibrium   G f = -w_ext                                          zero cone
    friction      mu f.n -+ f.t >= 0                                    non-negative
                  f.t = 0 and f.n >= 0 without friction                 zero, non-negative
    limits        |f_i| <= limit_i                                      second order

    effort        minimise sum |f_i|^2
    peak          minimise t,  |f_i| <= t
    peak_normal   minimise t,  f_i.n_i <= t
    force         maximise t,  mu f.n -+ f.t >= t sqrt(1 + mu^2)   (contacts with friction)

``angle`` is quasi-convex: an angle margin m is reached when cones narrowed by m still hold the load.
"""

from math import atan, cos, inf, pi, sqrt, tan

import numpy as np

from regrasp.errors import InvalidInput, SolverFailed
from regrasp.mechanics.balance import nearest_equilibrium
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.criteria import ChosenForces, Criteria
from regrasp.planning.escape import infeasible
from regrasp.programs import Program, Rows, Status, solve

ANGLE_TOLERANCE = 1e-8
"""The chosen angle margin is within this of the best one [rad]."""

# A solver's zero; whether forces exist is decided by finding them.
_FEASIBLE = 1e-7


def state_program(
    grasp: Grasp,
    load: Wrench,
    objective: str,
    frictions: list[float],
    limits: list[float],
    unit: float,
    facets: int | None = None,
) -> Program:
    """The program of every objective but ``angle``; forces come out in units of ``unit`` [N].

    frictions, limits: (n,), in place of the contacts' own. facets: sides of the inner polygon that stands for
    each circle |f| <= r, or None for second-order cones. ``effort`` has no unknown t.
    """
    if grasp.dimension != 2:
        raise InvalidInput("states are chosen for planar grasps so far; this grasp is in space")
    n = 2 * len(grasp)
    width = n if objective == "effort" else n + 1
    unit_rows = np.eye(n + 1)[:, :width]
    t = unit_rows[n]
    rows = Rows(width)
    weight = np.array([1.0, 1.0, 1 / grasp.size if grasp.size else 1.0])
    rows.equal((grasp.matrix * weight[:, None]) @ unit_rows[:n], load.vector * weight / unit)
    for i, (contact, mu, limit) in enumerate(zip(grasp, frictions, limits, strict=True)):
        force = unit_rows[2 * i : 2 * i + 2]
        along, across = contact.normal @ force, np.array([-contact.normal[1], contact.normal[0]]) @ force
        if mu == 0:  # a ray, which no margin narrows; as inequalities it would leave solvers no interior
            rows.equal(across)
            rows.at_least_zero(along)
        else:
            margin = t * sqrt(1 + mu * mu) if objective == "force" else 0 * t
            rows.at_least_zero([mu * along - across - margin, mu * along + across - margin])
        if objective == "peak":
            _within(rows, force, t, 0.0, facets)
        if objective == "peak_normal":
            rows.at_least_zero(t - along)
        if limit < inf:
            _within(rows, force, 0 * t, limit / unit, facets)
    if objective == "force" and not any(frictions):
        rows.at_least_zero(-t)  # no cone bounds the margin of rays: it is zero
    if objective == "effort":
        return rows.program(np.zeros(n), 2 * np.eye(n))
    return rows.program(-t if objective == "force" else t)


def _within(rows: Rows, force: Array, slope: Array, offset: float, facets: int | None) -> None:
    """Demand |f| <= slope . x + offset, for the circle or for the polygon inside it."""
    if facets is None:
        rows.second_order(np.vstack([slope, force]), [offset, 0.0, 0.0])
        return
    angles, apothem = 2 * pi * np.arange(facets) / facets, cos(pi / facets)
    towards = np.column_stack([np.cos(angles), np.sin(angles)]) @ force
    rows.at_least_zero(apothem * slope - towards, apothem * offset)


class _Solver:
    """Solves the programs of one choice and certifies every answer before it is used."""

    def __init__(
        self, grasp: Grasp, load: Wrench, backend: str, facets: int | None, limits: list[float]
    ) -> None:
        self.grasp, self.load, self.backend, self.facets = grasp, load, backend, facets
        size = grasp.size or 1.0
        self.unit = max(float(abs(load.force).max()), float(abs(load.torque).max()) / size)
        if self.unit == 0:  # no load: the limits tell the size of a force; without any, all are zero
            self.unit = min(limits) if min(limits) < inf else 1.0

    def forces(
        self, objective: str, frictions: list[float], limits: list[float], *, any_will_do: bool = False
    ) -> Array | None:
        """The solver's forces (n, 2), moved into exact equilibrium inside the cones; None if there are none.

        So a solver's tolerance never shows in a plan. An answer that this moves far is not the best one and
        raises ``SolverFailed``, unless any forces will do.
        """
        program = state_program(self.grasp, self.load, objective, frictions, limits, self.unit, self.facets)
        try:
            answer = solve(program, self.backend)
        except SolverFailed as failed:
            if not any_will_do:
                raise
            answer = failed.solution  # whether it is near enough is seen below
        if answer.status is Status.INFEASIBLE:
            return None
        if answer.status is Status.UNBOUNDED:
            raise SolverFailed(f"{self.backend}: {answer.status.advice}", program, answer)
        if objective == "force" and answer.status is Status.SOLVED and answer.value[-1] < -_FEASIBLE:
            return None  # the least distance to the cones' boundaries is negative: some force is outside
        wanted = answer.value[: 2 * len(self.grasp)].reshape(-1, 2) * self.unit
        if not np.isfinite(wanted).all():
            return None
        grasp = self.grasp
        forces = nearest_equilibrium(
            wanted,
            grasp.matrix,
            self.load.vector,
            grasp.normals,
            np.array(frictions),
            np.array(limits),
            grasp.size,
        )
        if forces is None:
            return None
        moved, largest = float(abs(forces - wanted).max()), max(self.unit, float(abs(forces).max()))
        if moved > 1e-5 * largest and not any_will_do:
            raise SolverFailed(
                f"{self.backend} answered forces {moved:.2g} away from equilibrium inside the cones",
                program,
                answer,
            )
        return forces


def solved_forces(
    grasp: Grasp, load: Wrench, criteria: Criteria, backend: str, facets: int | None = None
) -> ChosenForces:
    """The best forces of any number of planar contacts, by programs. Raises ``Infeasible``.

    An angle margin within ``ANGLE_TOLERANCE`` of the best is found by bisection on cones that hold the load;
    among such states the one of the widest force margin is taken.
    """
    criteria.demand_limit(grasp, load)
    if not criteria.maximises and not load.vector.any():  # nothing to hold: the least of everything is zero
        return ChosenForces([[0.0, 0.0]] * len(grasp), tuple(criteria.limits(grasp)), backend)
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
    solver = _Solver(grasp, load, backend, facets, limits)
    if criteria.maximises and inf in limits:
        least = solver.forces("peak", frictions, limits)
        if least is None:
            raise infeasible(grasp, load, criteria)
        peak = float(np.sqrt((least**2).sum(axis=1)).max())
        limits = [min(limit, criteria.peak_ratio * peak) for limit in limits]
    objective = "force" if criteria.objective == "angle" else criteria.objective
    forces = solver.forces(objective, frictions, limits)
    if forces is None:
        raise infeasible(grasp, load, criteria)
    if criteria.objective == "angle":
        held, lost = 0.0, min(atan(mu) for mu in frictions)
        while lost - held > ANGLE_TOLERANCE:
            margin = (held + lost) / 2
            cones = [tan(atan(mu) - margin) for mu in frictions]
            narrowed = solver.forces("force", cones, limits, any_will_do=True)
            if narrowed is None:
                lost = margin
            else:
                held, forces = margin, narrowed
    return ChosenForces(forces, tuple(limits), backend)
