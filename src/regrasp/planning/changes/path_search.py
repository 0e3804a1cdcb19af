"""Planning a path by a program: solved, moved into exact equilibrium, checked; or refused with the reason."""

from dataclasses import replace
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.balance import EQUILIBRIUM, nearest_equilibrium
from regrasp.mechanics.checks import Array
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.banded_path import least_change
from regrasp.planning.changes.path_program import PathTask, path_program
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.escape import AT_LIMIT, infeasible
from regrasp.planning.states.refusals.asking import is_asked_only
from regrasp.planning.states.solving import SLACK
from regrasp.programs import Program, Solution, Status, solve
from regrasp.programs.backends import least_room, solved_at_once

# Where an answer breaks a rate or a least normal force by rounding, twice the breach is kept back next.
_ATTEMPTS = 4
# An answer that exact equilibrium moves by more than this fraction of the forces is no path.
_MOVED = 1e-5
# A widest margin below this is no margin.
_BELOW = -1e-7


BANDED = "time-banded"
"""The method of a path of least change over many instants, in records of plans."""


class PlannedPath(NamedTuple):
    """Forces (K, n, w) [N] and who found them: ``BANDED`` or a back end."""

    forces: Array
    method: str


def planned_path(
    task: PathTask, objective: str, criteria: Criteria, backend: str, facets: int | None = None
) -> PlannedPath:
    """The best path (K, n, d) [N], in exact equilibrium inside cones and limits at every instant.

    objective: ``change``, ``effort``, ``peak`` or ``force``; of the paths with the least peak or the widest
    margin the one of least change is taken. Raises ``Infeasible``, naming the instant that cannot be held or
    the limit that stands in the way.
    """
    try:
        return _planned(task, objective, criteria, backend, facets)
    except SolverFailed as failed:
        if is_asked_only() or failed.program is None or not least_room(failed.program, backend) >= -AT_LIMIT:
            raise
        raise Infeasible(
            f"no path was found that keeps all of this together, and it is not proven that there is none: at "
            f"most {AT_LIMIT:g} of the limits is left, where rounding decides; loosen limits, allow more "
            f"time, or give other ends"
        ) from None


def _planned(
    task: PathTask, objective: str, criteria: Criteria, backend: str, facets: int | None
) -> PlannedPath:
    slack = SLACK
    if objective == "change" and backend == "clarabel":
        quick = _over_time(task, _kept(task, slack))
        if quick is not None:
            return PlannedPath(quick, BANDED)
    for _ in range(_ATTEMPTS):
        answer = _best(_kept(task, slack), objective, criteria, backend, facets)
        forces = _exact(task, answer)
        breach = _breach(task, forces)
        if breach <= 0:
            return PlannedPath(forces, backend)
        slack += 2 * breach
    raise SolverFailed(
        f"{backend}: the path breaks a rate or linear limit or a least normal force by {breach:.2g} of it",
        answer.program,
        answer,
    )


def _over_time(task: PathTask, kept: PathTask) -> Array | None:
    """The path of least change by the band of its program, if that is all there is to it."""
    inner = least_change(kept)
    if inner is None:
        return None
    whole = np.concatenate([task.start[None], inner, task.end[None]])
    every = np.arange(len(task.grasp))
    exact = whole.copy()
    exact[1:-1] = _balanced(task, inner, task.loads[1:-1], every)
    is_near = abs(exact - whole).max() <= _MOVED * max(task.unit, float(abs(whole).max()))
    return exact if is_near and _breach(task, exact) <= 0 else None


def _best(task: PathTask, objective: str, criteria: Criteria, backend: str, facets: int | None) -> Solution:
    if objective not in ("force", "peak"):
        return _solved(task, objective, criteria, backend, facets)
    margin = 0.0
    if objective == "peak" or (task.limits == inf).any():
        least = _solved(task, "peak", criteria, backend, facets)
        ratio = 1 + 1e-6 if objective == "peak" else criteria.peak_ratio
        task = replace(task, limits=np.minimum(task.limits, ratio * float(least.value[-1]) * task.unit))
    if objective == "force":
        widest = _solved(task, "force", criteria, backend, facets)
        margin = (1 - 1e-7) * float(widest.value[-1]) * task.unit
    # Many paths are as good; of these the one of least change is a matter of the problem alone.
    program = path_program(task, "change", least_margin=margin, facets=facets)
    answer = solve(program, backend)
    if answer.status is not Status.SOLVED:
        raise SolverFailed(
            f"{backend}: no path of least change among the best for {objective}", program, answer
        )
    return answer


def _kept(task: PathTask, slack: float) -> PathTask:
    keep = 1 - SLACK
    return replace(
        task,
        frictions=keep * task.frictions,
        limits=keep * task.limits,
        rates=(1 - slack) * task.rates,
        least_normals=(1 + slack) * task.least_normals,
        row_bounds=_less(task, slack),
    )


def _less(task: PathTask, slack: float) -> Array | None:
    """What a share less than that of linear limits leaves."""
    rows = task.grasp.limit_rows
    if rows is None or task.row_bounds is None:
        return task.row_bounds
    left: Array = task.row_bounds - slack * rows.bounds
    return left


def _solved(task: PathTask, objective: str, criteria: Criteria, backend: str, facets: int | None) -> Solution:
    program = path_program(task, objective, facets=facets)
    if is_asked_only():
        return _at_once(program, objective, backend)
    try:
        answer = solve(program, backend)
    except SolverFailed:
        reason = _why_not(task, criteria, backend, facets, proven=False)
        if reason is None:
            raise
        raise reason from None
    below = objective == "force" and answer.status is Status.SOLVED and answer.value[-1] < _BELOW
    if answer.status is Status.SOLVED and not below:
        return answer
    proven = answer.status is Status.INFEASIBLE or below
    raise _why_not(task, criteria, backend, facets, proven=proven) or SolverFailed(
        f"{backend}: {answer.status.advice}", program, answer
    )


def _at_once(program: Program, objective: str, backend: str) -> Solution:
    answer = solved_at_once(program, backend)
    if answer is None or (objective == "force" and answer.value[-1] < _BELOW):
        raise Infeasible("no path was found at once")
    return answer


def _why_not(
    task: PathTask, criteria: Criteria, backend: str, facets: int | None, *, proven: bool
) -> Infeasible | None:
    """The reason in words: an instant that cannot be held at all, or the limit that cannot be kept.

    proven: whether a certificate says that there is no path. Without one a reason must prove itself.
    """
    for time, load, active in zip(task.times, task.loads, task.active, strict=True):
        grasp = task.grasp.subset(np.flatnonzero(active).tolist())
        wrench = Wrench.from_vector(load)
        if not _holds(task, wrench, active):
            reason = infeasible(grasp, wrench, criteria)
            if reason.certificate is None and not proven:
                return None
            return Infeasible(f"at t = {time:.6g} s: {reason}", reason.certificate)
    if (task.rates < inf).any():
        least = solve(path_program(task, "rate", facets=facets), backend, throw=False)
        if least.status is Status.SOLVED and least.value[-1] > 1 + 1e-6:  # itself a proof: a least value
            return Infeasible(
                f"the forces would have to change at {least.value[-1]:.4g} times the rate limits: allow "
                f"faster changes, a longer duration or other ends"
            )
        if least.status is Status.SOLVED and least.value[-1] > 1 - 1e-6:
            return Infeasible(
                "the rate limits are the least that any path needs, to a millionth, so that none is planned; "
                "that none exists is not proven: allow rates a millionth higher"
            )
    if proven and (task.least_normals > 0).any():
        freed = replace(task, least_normals=0 * task.least_normals)
        if solve(path_program(freed, "change", facets=facets), backend, throw=False).status is Status.SOLVED:
            return Infeasible(
                f"no path keeps every normal force at {task.least_normals.max():g} or more; without "
                f"min_normal there is one"
            )
    if proven and task.row_bounds is not None:
        freed = replace(task, row_bounds=None)
        if solve(path_program(freed, "change", facets=facets), backend, throw=False).status is Status.SOLVED:
            return Infeasible("no path keeps the contacts' linear limits; without them there is one")
    if proven:
        return Infeasible(
            "no path keeps all of this together: every instant can be held, and no single limit is to blame; "
            "loosen limits, allow more time, or give other ends"
        )
    return None


def _holds(task: PathTask, load: Wrench, active: NDArray[np.bool_]) -> bool:
    """Whether the active fingers can hold a load within cones and limits."""
    used = np.flatnonzero(active)
    grasp = task.grasp.subset(used.tolist())
    start = np.zeros((used.size, grasp.width))
    return (
        nearest_equilibrium(
            start,
            grasp.cones.matrix,
            load.vector,
            grasp.cones.normals,
            task.frictions[used],
            task.limits[used],
            grasp.size,
        )
        is not None
    )


def _exact(task: PathTask, answer: Solution) -> Array:
    """The solver's path with every instant moved into exact equilibrium inside the cones."""
    d = task.grasp.width
    forces = np.zeros((task.times.size, len(task.grasp), d))
    forces[0], forces[-1] = task.start, task.end
    inner = forces[1:-1]
    inner[:] = task.reference[1:-1]
    inner[task.active[1:-1]] += answer.value.reshape(-1, d) * task.unit
    wanted = forces.copy()
    for pattern in np.unique(task.active[1:-1], axis=0):
        rows = 1 + np.flatnonzero((task.active[1:-1] == pattern).all(axis=1))
        used = np.flatnonzero(pattern)
        forces[np.ix_(rows, used)] = _balanced(task, forces[np.ix_(rows, used)], task.loads[rows], used)
    scale = max(task.unit, float(abs(wanted).max()))
    if abs(forces - wanted).max() > _MOVED * scale:
        raise SolverFailed(
            "the answer is no equilibrium inside the cones at some instant", answer.program, answer
        )
    return forces


def _balanced(task: PathTask, forces: Array, loads: Array, used: NDArray[np.intp]) -> Array:
    """Forces (m, k, d) of some fingers at m instants, shifted into equilibrium; by Newton if that fails."""
    grasp = task.grasp.subset(used.tolist())
    mu, limits = task.frictions[used], task.limits[used]
    weight = 1 / task.grasp.lengths
    g, w = grasp.cones.matrix * weight[:, None], loads * weight
    whole, forces = forces.shape[2], forces[..., : grasp.width]  # where no soft finger is left, narrower
    flat = forces.reshape(len(forces), -1)
    inverse = np.linalg.pinv(g)
    for _ in range(2):
        flat = flat - (flat @ g.T + w) @ inverse.T
    moved = flat.reshape(forces.shape)
    normal = grasp.cones.normal(moved)
    inside = grasp.cones.tangential(moved) <= mu * normal
    inside &= (moved**2).sum(axis=-1) <= limits**2
    scale = np.maximum(abs(flat).max(axis=1), abs(w).max(axis=1))
    good = inside.all(axis=1) & (abs(flat @ g.T + w).max(axis=1) <= EQUILIBRIUM / 2 * scale)
    for k in np.flatnonzero(~good):
        exact = nearest_equilibrium(
            forces[k], grasp.cones.matrix, loads[k], grasp.cones.normals, mu, limits, task.grasp.size or 1.0
        )
        moved[k] = np.inf if exact is None else exact
    return np.pad(moved, ((0, 0), (0, 0), (0, whole - grasp.width)))


def _breach(task: PathTask, forces: Array) -> float:
    """The fraction by which exact forces break a rate, a least normal force or a linear limit, if above 0."""
    speed = np.linalg.norm(np.diff(forces, axis=0), axis=-1) / np.diff(task.times)[:, None]
    normal = task.grasp.cones.normal(forces)
    needed = task.active & (task.least_normals > 0)
    short = (1 - normal / np.where(task.least_normals > 0, task.least_normals, 1.0))[needed]
    rows, over = task.grasp.limit_rows, np.zeros(0)
    if rows is not None and task.row_bounds is not None:
        used = np.einsum("mw,kmw->km", rows.rows, forces[1:-1, rows.contacts])
        over = (used - task.row_bounds) / rows.bounds
    return float(max((speed / task.rates - 1).max(), short.max(initial=-inf), over.max(initial=-inf)))
