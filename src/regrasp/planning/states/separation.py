"""How near the fingers come to balancing a load, as a program: the search for a motion that separates them.

    minimise 1/2 |rho|^2   subject to   rho = -w_ext - G f,   f_i in cone_i,   |f_i| <= limit_i

with torques divided by the grasp's size. Whatever is left, -rho is the twist along which the load wins.
"""

from math import inf, isfinite
from typing import NamedTuple

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
    return gap_and_duals(grasp, target, weight, frictions, limits, None)[0]


def gap_and_duals(
    grasp: Grasp,
    target: Array,
    weight: Array,
    frictions: list[float],
    limits: list[float],
    bounds: Array | None,
) -> tuple[Array, Array]:
    """rho, and the duals (m,) of the contacts' linear limits of these ``bounds``; none without any."""
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
    linear, count = grasp.limit_rows, 0
    if linear is not None and bounds is not None:
        wide, count = np.zeros((len(bounds), n + size)), len(bounds)
        for row, i, a in zip(wide, linear.contacts.tolist(), linear.rows, strict=True):
            row[w * i : w * i + w] = -a
        rows.at_least_zero(wide, bounds)
    try:
        answer = solve(rows.program(np.zeros(n + size), np.diag([0.0] * n + [1.0] * size)), "clarabel")
    except SolverFailed as failed:  # a direction short of the solver's tolerances may prove as much
        answer = failed.solution
    gap: Array = answer.value[n:]
    return gap, answer.duals[len(answer.duals) - count :]


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


def clearing(grasp: Grasp, twist: Array, frictions: list[float], limits: list[float]) -> Array | None:
    """The motion (3,) or (6,) that lets a twist clear the cones it touches soonest; None if none does.

        maximise s   subject to   n . u_i - mu_i e_i . u_i >= s        where contact i slides, along e_i,
                                  n . u_i - mu_i |u_i across n| >= s   where it stands still,   |xi| <= 1

    Of that length over s. Fingers that can squeeze each other leave none: s is zero.
    """
    from regrasp.programs import Rows, solve

    w, size, cones, weight = grasp.width, twist.size, grasp.cones, 1 / grasp.lengths
    arms = cones.matrix.T * weight  # velocities of the contacts from the twist in speeds at ``size``
    v = twist / weight
    speed = float(np.linalg.norm(v))
    rows, least = Rows(size + 1), np.eye(size + 1)[size]
    for i, (mu, limit) in enumerate(zip(frictions, limits, strict=True)):
        at, n = arms[w * i : w * i + w], cones.normals[i]
        across = at @ v - float(n @ at @ v) * n
        sideways = float(np.linalg.norm(across))
        if limit < inf or float(n @ at @ v) - mu * sideways > _TOUCHING * speed:
            continue
        wide = np.column_stack([at, np.zeros(w)])
        away = n @ wide - least
        if mu * sideways > _TOUCHING * speed:
            rows.at_least_zero(away - mu * (across / sideways) @ wide)
        elif w == 2:
            rows.at_least_zero([away + s * mu * (cones.tangents[i] @ wide)[0] for s in (1, -1)])
        else:
            rows.second_order(np.vstack([away, mu * (cones.tangents[i] @ wide)]))
    rows.second_order(np.vstack([np.zeros(size + 1), np.eye(size + 1)[:size]]), [1.0, *[0.0] * size])
    try:
        answer = solve(rows.program(-least), "clarabel").value
    except SolverFailed:
        return None
    result: Array = answer[:size] * weight / max(float(answer[size]), _TOUCHING)
    return result if answer[size] > _TOUCHING else None


class Edge(NamedTuple):
    """How far beyond the edge of what is held a load is, and the motion along which it wins there.

    beyond: the least t of ``edge_of``; negative where the load is held. twist: (3,) or (6,). forces: (n, w)
    that balance the load where it is held, to the solver's tolerance [N].
    """

    beyond: float
    twist: Array
    forces: Array


def edge_of(grasp: Grasp, load: Array, frictions: list[float], limits: list[float]) -> Edge | None:
    """The edge along the way from a load to one that the fingers hold by pushing straight; None if unknown.

        minimise t   subject to   G f = -w_ext + t (w_ext + G p),   f_i in cone_i,   |f_i| <= limit_i,   t >=
        -1

    p are pushes along the normals as large as the load, or half of a finger's limit. However near the edge
    the load is, the duals of the balance are of order one: the twist that every force in the cones works
    along.
    """
    from regrasp.programs import Rows, solve

    w, cones, weight = grasp.width, grasp.cones, 1 / grasp.lengths
    target = -load * weight
    unit = float(abs(target).max())
    limits = [limit / unit for limit in limits]
    matrix, target = cones.matrix * weight[:, None], target / unit
    pushes = np.array([min(1.0, limit / 2) for limit in limits])
    inward = matrix @ (pushes[:, None] * cones.normals).ravel()
    n = w * len(grasp)
    rows = Rows(n + 1)
    rows.equal(np.column_stack([matrix, target - inward]), -target)
    for i, (mu, limit) in enumerate(zip(frictions, limits, strict=True)):
        pick = np.zeros((w, n + 1))
        pick[:, w * i : w * i + w] = np.eye(w)
        along, across = cones.normals[i] @ pick, cones.tangents[i] @ pick
        if mu == 0:
            rows.equal(across)
            rows.at_least_zero(along)
        elif w == 2:
            rows.at_least_zero([mu * along - across[0], mu * along + across[0]])
        else:
            rows.second_order(np.vstack([mu * along, across]))
        if limit < inf:
            rows.second_order(np.vstack([np.zeros(n + 1), pick]), [limit, *[0.0] * w])
    rows.at_least_zero(np.eye(n + 1)[n:], 1.0)
    try:
        answer = solve(rows.program(np.eye(n + 1)[n]), "clarabel")
    except SolverFailed as failed:
        answer = failed.solution
    twist = -answer.duals[: target.size] * weight
    if not (np.isfinite(twist).all() and twist.any() and isfinite(answer.value[n])):
        return None
    beyond = float(answer.value[n])
    share = 1 / (1 - min(beyond, 0.0))  # between the forces at the edge and the pushes inside, w_ext
    forces = share * answer.value[:n].reshape(-1, w) + (1 - share) * pushes[:, None] * cones.normals
    return Edge(beyond, twist, unit * forces)
