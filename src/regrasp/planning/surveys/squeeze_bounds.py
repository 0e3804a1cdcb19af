"""How far each squeeze can go: the ends of an equilibrium locus along its coordinates, as programs.

    minimise -+ c.f   subject to   G f + w_ext = 0,   f_i inside its cone,   |f_i| <= limit_i

with c.f the coordinate. Without limits on all forces it may have no end. Then there is a direction of
recession, found first, by a program that always has an answer, and checked in exact equilibrium:

    maximise +- c.r   subject to   G r = 0,   r_i inside its cone,   |r_i| <= 1,   r_i = 0 if f_i is limited
"""

from dataclasses import replace
from math import inf

import numpy as np
from scipy import sparse

from regrasp.errors import SolverFailed
from regrasp.mechanics.balance import nearest_equilibrium
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.objectives import EFFORT
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import force_unit
from regrasp.programs import Program, Status, solve

# A recession that gains less than this per newton is a solver's zero.
_GAINS = 1e-6


def bound_program(grasp: Grasp, load: Wrench, limits: list[float], cost: Array, unit: float) -> Program:
    """The least ``cost`` . f, cost (n, d), of forces in units of ``unit`` [N], full friction."""
    held = state_program(grasp, load, EFFORT, grasp.frictions.tolist(), limits, unit)
    return replace(held, P=sparse.csc_matrix((cost.size, cost.size)), q=np.array(cost.ravel()))


def least(grasp: Grasp, load: Wrench, limits: list[float], cost: Array, backend: str) -> float:
    """The least ``cost`` . f of forces that hold a load which can be held [N]; -inf if there is no end.

    Raises ``SolverFailed`` where the back end has neither a sound end nor a certificate that there is none.
    """
    if _recession(grasp, limits, cost, backend) is not None:
        return -inf
    unit = force_unit(grasp, load)
    if max(limits) < inf:  # forces may be as large as these
        unit = max(unit, min(limits))
    program = bound_program(grasp, load, limits, cost, unit or 1.0)
    answer = solve(program, backend)
    if answer.status is Status.UNBOUNDED:
        return -inf
    if answer.status is not Status.SOLVED:
        raise SolverFailed(f"{backend}: {answer.status.advice}", program, answer)
    return answer.objective * (unit or 1.0)


def _recession(grasp: Grasp, limits: list[float], cost: Array, backend: str) -> Array | None:
    """Internal forces (n, d) inside the cones, of unlimited contacts, along which ``cost`` falls; or None."""
    free = [i for i, limit in enumerate(limits) if limit == inf]
    size = float(np.linalg.norm(cost))
    if len(free) < 2:
        return None
    some, one, d = grasp.subset(free), [1.0] * len(free), grasp.dimension
    nothing = Wrench(np.zeros(d))
    answer = solve(bound_program(some, nothing, one, cost[free] / size, 1.0), backend)
    if answer.status is not Status.SOLVED or answer.objective > -_GAINS:
        return None
    forces = nearest_equilibrium(
        answer.value.reshape(-1, d),
        some.matrix,
        nothing.vector,
        some.normals,
        some.frictions,
        np.array(one),
        some.size or 1.0,
    )
    if forces is None or float((cost[free] * forces).sum()) > -_GAINS / 2 * size:
        return None
    whole = np.zeros(cost.shape)
    whole[free] = forces
    return whole
