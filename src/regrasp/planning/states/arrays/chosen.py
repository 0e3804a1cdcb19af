"""The best forces of many grasps: pairs by the closed form, others by small conic programs."""

from dataclasses import replace
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.closed_form.conic.grasp_states import HELD, NONE, OPEN
from regrasp.mechanics.checks import Array
from regrasp.mechanics.margins import margins
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.planning.states.arrays.many_grasps import SMALL, ManyGrasps
from regrasp.planning.states.batch import best_squeezes
from regrasp.planning.states.objectives import ANGLE, LevelObjective, Objective

_IDLE = 1e-5
_CLOSE = 1e-8


class Chosen(NamedTuple):
    """Forces (m, n, d) [N], the limits (m, n) they had, verdicts (m,) and twists (m, 3 or 6)."""

    forces: Array
    limits: Array
    verdicts: NDArray[np.int64]
    twists: Array


def chosen(given: ManyGrasps, objective: Objective, peak_ratio: float, kept: float) -> Chosen:
    """The best forces of each grasp, before they are checked."""
    if given.positions.shape[1:] == (2, 2):
        return _pairs(given, objective, peak_ratio, kept)
    found = _solved(given, objective, peak_ratio, kept)
    return _with_idle(found, given, objective, kept) if isinstance(objective, LevelObjective) else found


def _pairs(given: ManyGrasps, objective: Objective, peak_ratio: float, kept: float) -> Chosen:
    """Forces, verdicts and twists of two planar contacts, by the closed form."""
    (r1, r2), (n1, n2) = given.positions.transpose(1, 0, 2), given.normals.transpose(1, 0, 2)
    mu, limits = kept * given.frictions, (1 - SMALL) * given.limits
    load = given.loads
    x = best_squeezes(
        r1, n1, mu[:, 0], r2, n2, mu[:, 1], load[:, :2], load[:, 2],
        objective=objective, max_force=(limits[:, 0], limits[:, 1]), peak_ratio=peak_ratio,
    )  # fmt: skip
    apart = r2 - r1
    length = np.hypot(*apart.T)
    u = apart / length[:, None]
    p = np.stack([-u[:, 1], u[:, 0]], axis=1)
    phi, side = (u * load[:, :2]).sum(axis=1), (p * load[:, :2]).sum(axis=1)
    arm, before = r1[:, 0] * u[:, 1] - r1[:, 1] * u[:, 0], (r1 * u).sum(axis=1)
    b = (arm * phi - load[:, 2] + before * side) / length
    forces = np.stack(
        [x[:, None] * u - (side + b)[:, None] * p, -(x + phi)[:, None] * u + b[:, None] * p], axis=1
    )
    verdicts, twists = np.full(len(x), HELD, dtype=np.int64), np.zeros_like(load)
    lost = np.isnan(x)
    if lost.any():  # the programs prove it
        _, _, found, twists[lost] = _solved(given.some(lost), objective, peak_ratio, kept)
        verdicts[lost] = np.where(found == NONE, NONE, OPEN)
    return Chosen(forces, limits, verdicts, twists)


def _solved(given: ManyGrasps, objective: Objective, peak_ratio: float, kept: float) -> Chosen:
    from regrasp.closed_form.compiled.grasp_states import best_states

    m, n, d = given.positions.shape
    loads = given.scaled_loads
    units = np.abs(loads).max(axis=1)
    idle = units == 0
    units = np.where(idle, np.where(np.isinf(given.limits), 1.0, given.limits).min(axis=1), units)
    forces, twists = np.zeros((m, n, d)), np.zeros((m, 3 * d - 3))
    verdicts = np.zeros(m, dtype=np.int64)
    tangents = tangents_of(given.normals.reshape(-1, d)).reshape(m, n, d - 1, d)
    parts = (
        given.matrices(), loads / units[:, None], given.normals, tangents, kept * given.frictions,
        given.limits / units[:, None],
    )  # fmt: skip
    plain = (np.array(part, order="C") for part in parts)  # of one type, so that they are compiled for once
    used = np.full((m, n), np.inf)
    best_states(m, objective.closed_form, float(peak_ratio), *plain, forces, used, twists, verdicts)
    forces *= units[:, None, None]
    if not objective.unbounded:  # of a load of zero nothing is the best
        forces[idle], verdicts[idle] = 0.0, HELD
    return Chosen(forces, units[:, None] * used, verdicts, twists * given.lengths)


def _with_idle(found: Chosen, given: ManyGrasps, objective: LevelObjective, kept: float) -> Chosen:
    """The same where a finger that hardly pushes, or whose cone is gone at the level, is idle."""
    n = given.frictions.shape[1]
    if n == given.dimension == 3:  # two fingers in space leave a motion free
        return found
    levels = _levels(found.forces, given, objective, kept)
    sizes = np.abs(found.forces).max(axis=2)
    tops = np.arctan(kept * given.frictions) if objective is ANGLE else np.ones(sizes.shape)
    forces = found.forces.copy()
    for i in range(n):
        gone = (sizes[:, i] <= _IDLE * sizes.max(axis=1)) | (tops[:, i] <= levels + _CLOSE)
        rows = (found.verdicts == HELD) & gone
        if not rows.any():
            continue
        limited = replace(given.some(rows), limits=found.limits[rows]).without(i)
        rest = chosen(limited, objective, 1.0, kept)
        reached = np.where(rest.verdicts == HELD, _levels(rest.forces, limited, objective, kept), -inf)
        better = reached >= levels[rows] - _CLOSE
        places = np.flatnonzero(rows)[better]
        forces[places] = np.insert(rest.forces[better], i, 0.0, axis=1)
        levels[places] = np.maximum(levels[places], reached[better])
    return found._replace(forces=forces)


def _levels(forces: Array, given: ManyGrasps, objective: LevelObjective, kept: float) -> Array:
    """(m,) the levels of forces over the fingers that push."""
    found = margins(forces, given.normals, kept * given.frictions)
    if objective is ANGLE:
        return np.asarray(np.where(np.isnan(found.angle), inf, found.angle).min(axis=1))
    return np.asarray(1 - np.where(np.isnan(found.friction_use), -inf, found.friction_use).max(axis=1))
