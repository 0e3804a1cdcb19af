"""Which pairs keep linear limits and withstand a set: all pairs and orientations of a planar graph at once.

Two planar forces have one number free, the squeeze x: f_i = x u + b v, f_j = -F - f_i, u along the line of
the contacts, v across it, b = -(r_j x F) / l. What each force keeps is g . f >= s: cone edges with the most
work of the set against them, s = sigma(-R_i' g), and linear limits -a . f >= sigma(R_i' a) - limit. Each row
bounds x from one side, so that a pair keeps all of them where the largest of the lower bounds is at most the
least of the upper ones. Limits on |f| are left out: whoever is told to hold here may not, but for these.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.reserve import kept_friction
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.regrasps.asked import Asked

_AT_ONCE = 4096
_ROUNDING = 1e-9
_ONE_PLACE = 1e-12


def kept_pairs(problem: Asked, graph: HoldGraph) -> NDArray[np.bool_]:
    """(P, O) whether pairs may keep what is asked of them besides the friction cones."""
    criteria = problem.criteria
    loads = graph.loads[:, :2]
    points = np.array([c.position for c in problem.contacts])
    rows, bounds = _rows(problem)
    known = criteria.withstands and not isinstance(criteria.stiffness, tuple)
    disturbance = criteria.disturbance if known else None
    first, second = graph.pairs
    kept = [
        _kept(points, rows, bounds, loads, disturbance, first[k : k + _AT_ONCE], second[k : k + _AT_ONCE])
        for k in range(0, len(first), _AT_ONCE)
    ]
    return np.concatenate(kept) if kept else np.zeros((0, len(loads)), dtype=bool)


def _rows(problem: Asked) -> tuple[Array, Array]:
    """(N, m, 2) rows g and (N, m) bounds s of g . f >= s, of every contact; -inf where it has fewer."""
    contacts = problem.contacts
    most = 2 + max(0 if c.limits is None else len(c.limits.rows) for c in contacts)
    rows, bounds = np.zeros((len(contacts), most, 2)), np.full((len(contacts), most), -inf)
    for i, contact in enumerate(contacts):
        mu, n = kept_friction(contact.friction, problem.reserve), contact.normal
        t = np.array([-n[1], n[0]])
        rows[i, :2], bounds[i, :2] = (mu * n - t, mu * n + t), 0.0
        if contact.limits is not None:
            count = len(contact.limits.rows)
            rows[i, 2 : 2 + count] = -contact.limits.rows[:, :2] @ np.vstack([n, t])
            bounds[i, 2 : 2 + count] = -contact.limits.bounds
    return rows, bounds


def _kept(
    points: Array,
    rows: Array,
    bounds: Array,
    loads: Array,
    disturbance: LoadSet | None,
    first: NDArray[np.int32],
    second: NDArray[np.int32],
) -> NDArray[np.bool_]:
    ends = points[first], points[second]
    apart = ends[1] - ends[0]
    length = np.linalg.norm(apart, axis=1)
    usable = length > _ONE_PLACE * np.abs(points).max()
    length = np.where(usable, length, 1.0)
    u = apart / length[:, None]
    v = np.stack([-u[:, 1], u[:, 0]], axis=1)
    across = -(ends[1][:, :1] * loads[:, 1] - ends[1][:, 1:] * loads[:, 0]) / length[:, None]  # b (P, O)
    low, high = np.full(across.shape, -inf), np.full(across.shape, inf)
    scale = float(np.abs(loads).max())
    fits = np.ones(across.shape, dtype=bool)
    for side, places, response in zip((1.0, -1.0), (first, second), _responses(*ends, usable), strict=True):
        g, s = rows[places], bounds[places]
        if disturbance is not None:
            twists = -np.einsum("pmw,pwq->pmq", g, response)
            s = s + disturbance.support(twists)
        along, turned = (np.einsum("pmw,pw->pm", g, way) for way in (u, v))
        for m in range(g.shape[1]):
            left = s[:, m, None] - side * turned[:, m, None] * across
            if side < 0:
                left = left + g[:, m] @ loads.T
            slope = side * along[:, m, None]
            size = np.abs(g[:, m]).sum(axis=1)[:, None]
            flat = np.abs(slope) <= _ROUNDING * size
            bound = left / np.where(flat, 1.0, slope)
            low = np.where(~flat & (slope > 0), np.maximum(low, bound), low)
            high = np.where(~flat & (slope < 0), np.minimum(high, bound), high)
            fits &= ~flat | (left <= _ROUNDING * size * scale)
    room = _ROUNDING * (scale + np.minimum(np.abs(low), np.abs(high)))
    fits &= low <= high + np.where(np.isfinite(room), room, 0.0)
    result: NDArray[np.bool_] = fits & usable[:, None]
    return result


def _responses(first: Array, second: Array, usable: NDArray[np.bool_]) -> tuple[Array, Array]:
    """(P, 2, 3) how each force of a pair answers a unit of deviation, of springs that are all alike."""
    maps = []
    for r in (first, second):
        G = np.zeros((len(r), 3, 2))
        G[:, 0, 0] = G[:, 1, 1] = 1.0
        G[:, 2, 0], G[:, 2, 1] = -r[:, 1], r[:, 0]
        maps.append(G)
    resisted = sum(G @ G.transpose(0, 2, 1) for G in maps)
    resisted = np.where(usable[:, None, None], resisted, np.eye(3))
    inverse = np.linalg.inv(resisted)
    a, b = (-G.transpose(0, 2, 1) @ inverse for G in maps)
    return a, b
