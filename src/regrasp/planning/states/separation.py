"""How near the fingers come to balancing a load, as a program: the search for a motion that separates them.

    minimise 1/2 |rho|^2   subject to   rho = -w_ext - G f,   f_i in cone_i,   |f_i| <= limit_i

with torques divided by the grasp's size. Whatever is left, -rho is the twist along which the load wins.
"""

from math import inf

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp

# A contact that opposes a motion by less than this fraction of its speed is meant not to oppose it at all.
_TOUCHING = 1e-3
_STEPS = 8


def gap_left(
    grasp: Grasp, target: Array, weight: Array, frictions: list[float], limits: list[float]
) -> Array:
    """rho, (3,) or (6,), for ``target`` = -w_ext times ``weight``, both of order one."""
    from regrasp.programs import Rows, solve

    w, size, cones = grasp.width, target.size, grasp.cones
    n = w * len(grasp)
    rows = Rows(n + size)
    rows.equal(np.hstack([cones.matrix * weight[:, None], np.eye(size)]), -target)
    for i, (mu, limit) in enumerate(zip(frictions, limits, strict=True)):
        pick = np.zeros((w, n + size))
        pick[:, w * i : w * i + w] = np.eye(w)
        along, across = mu * cones.normals[i] @ pick, cones.tangents[i] @ pick
        if w == 2:
            rows.at_least_zero([along - across[0], along + across[0], cones.normals[i] @ pick])
        else:
            rows.second_order(np.vstack([along, across]))
            rows.at_least_zero(cones.normals[i] @ pick)
        if limit < inf:
            rows.second_order(np.vstack([np.zeros(n + size), pick]), [limit, *[0.0] * w])
    try:
        answer = solve(rows.program(np.zeros(n + size), np.diag([0.0] * n + [1.0] * size)), "clarabel")
    except SolverFailed as failed:  # a direction short of the solver's tolerances may prove as much
        answer = failed.solution
    gap: Array = answer.value[n:]
    return gap


def cleared(grasp: Grasp, twist: Array, frictions: list[float], limits: list[float]) -> Array:
    """The twist changed least so that contacts without a limit that hardly oppose it do not at all.

    A solver's answer touches their cones to its tolerance; a contact that may push without limit would oppose
    it enough. Newton's steps on v_n - mu |v_t| = 0, or on v = 0 where the contact stands still.
    """
    d, w, cones = grasp.dimension, grasp.width, grasp.cones
    length = grasp.size or 1.0
    weight = np.r_[np.ones(d), np.full(twist.size - d, length)]  # speeds at the size of the grasp
    arms = cones.matrix.T / weight  # velocities of the contacts from the weighted twist
    free = [i for i, limit in enumerate(limits) if limit == inf]
    v = twist * weight
    for _ in range(_STEPS):
        rows, misses = [], []
        speed = float(np.linalg.norm(v))
        for i in free:
            at, n, mu = arms[w * i : w * i + w], cones.normals[i], frictions[i]
            moved = at @ v
            normal = float(moved @ n)
            tangent = moved - normal * n
            tangential = float(np.linalg.norm(tangent))
            if np.hypot(normal, tangential) < _TOUCHING * speed:
                rows += list(at)
                misses += moved.tolist()
            elif 0 < mu * tangential - normal < _TOUCHING * speed:
                rows.append(at.T @ (n - mu * tangent / tangential))
                misses.append(normal - mu * tangential)
        if not rows or np.abs(misses).max() <= 2.0**-52 * speed:
            break
        v = v - np.linalg.lstsq(np.array(rows), np.array(misses), rcond=1e-12)[0]
    result: Array = v / weight
    return result
