"""Finding the escape twist of a load that a grasp cannot hold.

The finger wrenches nearest to balancing the load leave the gap rho = -w_ext - G f. Nothing the contacts can
add points along rho, or it would bring them nearer; so -rho is the twist sought (separating hyperplane).
"""

from math import inf

import numpy as np

from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.criteria import Criteria


def infeasible(grasp: Grasp, load: Wrench, criteria: Criteria) -> Infeasible:
    """The error that says why no state exists: the cones alone, the force limits, or the reserve."""
    names = ", ".join(grasp.names)
    if grasp.dimension == 3:
        return Infeasible(f"no forces of {names} inside their friction cones and limits balance {load!r}")
    full = Criteria(criteria.objective, criteria.max_force, criteria.peak_ratio, reserve=0.0)
    frictions, limits = full.frictions(grasp), full.limits(grasp)
    twist = escape_twist(grasp, load, frictions, [inf] * len(grasp))
    if twist is not None:
        return Infeasible(
            f"no forces of {names} inside their friction cones balance {load!r}: "
            f"the object escapes by {twist}",
            twist,
        )
    twist = escape_twist(grasp, load, frictions, limits) if min(limits) < inf else None
    if twist is not None:
        bounds = ", ".join(f"{n} {f:g}" for n, f in zip(grasp.names, limits, strict=True) if f < inf)
        return Infeasible(
            f"no forces of {names} inside their friction cones and force limits ({bounds}) balance {load!r}: "
            f"the object escapes by {twist}; the cones alone would hold it with larger forces",
            twist,
        )
    return Infeasible(
        f"no forces of {names} that balance {load!r} were found with {criteria.reserve:g} of the friction "
        f"kept in reserve, and no motion proves that there are none without it: the load needs more friction "
        f"than that leaves, or is at the limit of what they can hold; choose a smaller reserve"
    )


def escape_twist(
    grasp: Grasp, load: Wrench, frictions: list[float], limits: list[float]
) -> EscapeTwist | None:
    """The proven escape twist of a planar grasp, or None where none is found."""
    weight = np.array([1.0, 1.0, 1 / grasp.size if grasp.size else 1.0])  # torques as forces
    target = -load.vector * weight
    unit = float(abs(target).max())
    if unit == 0:
        return None
    if min(limits) < inf:
        gaps = [_gap_with_limits(grasp, target / unit, weight, frictions, [f / unit for f in limits])]
    else:
        gaps = _gaps(_edge_wrenches(grasp, weight, frictions), target / unit)
    twists = [
        EscapeTwist(grasp, load, -gap * weight / float(abs(gap).max()), tuple(frictions), tuple(limits))
        for gap in gaps
        if gap.any()
    ]
    best = max(twists, key=lambda twist: twist.least_force, default=None)
    return best if best is not None and best.is_proof else None


def _gaps(wrenches: Array, target: Array) -> list[Array]:
    """Target - G f at the nearest f, a non-negative combination of the edges; then the same, tilted a hair.

    The twist touches the edges of the cones next to it, where rounding lets a contact oppose by 1e-16 of its
    force. If the wrenches leave a half-space free, 2^-40 of a twist that all edges push along clears them.
    """
    from scipy.optimize import nnls

    combination, _ = nnls(wrenches, target)
    gap: Array = target - wrenches @ combination
    # Least distance programming (Lawson and Hanson 1974, ch. 23): min |v| subject to W'v >= 1.
    equations = np.vstack([wrenches, np.ones(wrenches.shape[1])])
    goal = np.append(np.zeros(len(target)), 1.0)
    combination, miss = nnls(equations, goal)
    if miss < 1e-9:
        return [gap]  # W'v >= 1 has no solution: the wrenches leave no half-space free
    residual = equations @ combination - goal
    clear = residual[:-1] / residual[-1]
    return [gap, gap + clear * (2.0**-40 * float(np.linalg.norm(gap) / np.linalg.norm(clear)))]


def _edge_wrenches(grasp: Grasp, weight: Array, frictions: list[float]) -> Array:
    """(3, 2n) wrenches of both edges of every cone, torques divided by the grasp's size."""
    edges = []
    for contact, mu in zip(grasp, frictions, strict=True):
        n = contact.normal
        t = np.array([-n[1], n[0]])
        for e in (n - mu * t, n + mu * t):
            r = contact.position
            edges.append(np.array([e[0], e[1], r[0] * e[1] - r[1] * e[0]]) * weight)
    return np.array(edges).T


def _gap_with_limits(
    grasp: Grasp, target: Array, weight: Array, frictions: list[float], limits: list[float]
) -> Array:
    """Target - G f at the nearest f inside cones and limits: a program in (f, gap)."""
    from regrasp.programs import Rows, solve

    n = 2 * len(grasp)
    rows = Rows(n + 3)
    g = np.hstack([grasp.matrix * weight[:, None], np.eye(3)])
    rows.equal(g, -target)
    for i, (contact, mu, limit) in enumerate(zip(grasp, frictions, limits, strict=True)):
        pick = np.zeros((2, n + 3))
        pick[0, 2 * i] = pick[1, 2 * i + 1] = 1
        along, across = contact.normal @ pick, np.array([-contact.normal[1], contact.normal[0]]) @ pick
        rows.at_least_zero([mu * along - across, mu * along + across, along])
        if limit < inf:
            rows.second_order(np.vstack([np.zeros(n + 3), pick]), [limit, 0, 0])
    try:
        answer = solve(rows.program(np.zeros(n + 3), np.diag([0.0] * n + [1.0] * 3)), "clarabel")
    except SolverFailed as failed:  # a direction short of the solver's tolerances may prove as much
        answer = failed.solution
    gap: Array = answer.value[n:]
    return gap
