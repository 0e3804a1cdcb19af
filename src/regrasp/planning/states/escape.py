"""Finding the escape twist of a load that a grasp cannot hold.

The finger wrenches nearest to balancing the load leave the gap rho = -w_ext - G f. Nothing the contacts can
add points along rho, or it would bring them nearer; so -rho is the twist sought (separating hyperplane).
"""

from dataclasses import replace
from math import inf

import numpy as np

from regrasp.errors import Infeasible, shown
from regrasp.mechanics.balance import nearest_equilibrium
from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.exact.refining import proven
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.refusals.asking import is_asked_only
from regrasp.planning.states.separation import clearing, edge_of, gap_and_duals, gap_left

AT_LIMIT = 1e-6
"""A load within this fraction of the edge of what is held is at its limit: rounding may decide it."""
# Limits beyond this many loads are left out of the search.
_LOOSE = 1e6
# Forces this many times the load, and how much nearer the larger ones must come, to call it a limit only.
_REACHES = (1e2, 1e4)
_NEARER = 0.1
_STRAIGHT = 1e-6  # of the largest speed of a contact
_STILL = 1e-12
_ROUGH = 1e4  # friction beyond which none is met
# A load that does less than this fraction of work along a free motion does none.
_WORK = 1e-9


def infeasible(grasp: Grasp, load: Wrench, criteria: Criteria) -> Infeasible:
    """The error that says why no state exists: the cones, the force limits, the reserve or the limit."""
    return verdict(grasp, load, criteria) or unproven(grasp, load, criteria)


def unproven(grasp: Grasp, load: Wrench, criteria: Criteria) -> Infeasible:
    """The error where no state was found, and nothing proves that there is none."""
    return Infeasible(
        f"no forces of {', '.join(grasp.names)} that balance {shown(load)} were found "
        f"with {criteria.reserve:g} "
        f"of the friction kept in reserve, and no motion proves that there are none without it: the load "
        f"needs more friction than that leaves, or is at the limit of what they can hold; choose a smaller "
        f"reserve"
    )


def verdict(grasp: Grasp, load: Wrench, criteria: Criteria) -> Infeasible | None:
    """Why no state exists, where that is proven or the load is at its limit; else None."""
    if is_asked_only():
        return None
    names = ", ".join(grasp.names)
    loose = loose_twist(grasp, load)
    if loose is not None:
        return Infeasible(
            f"no forces of {names} balance {shown(load)}: none resists {grasp.freedom}, about which the "
            f"load has a torque; the object escapes by {loose}; no friction helps",
            loose,
        )
    full = replace(criteria, reserve=0.0)
    frictions, limits = full.frictions(grasp), full.limits(grasp)
    twist = escape_twist(grasp, load, frictions, [inf] * len(grasp))
    if twist is not None:
        return Infeasible(
            f"no forces of {names} inside their friction cones balance {shown(load)}: "
            f"the object escapes by {twist}{'; no friction helps' if defies_friction(twist) else ''}",
            twist,
        )
    twist = escape_twist(grasp, load, frictions, limits) if min(limits) < inf else None
    if twist is not None:
        bounds = ", ".join(f"{n} {f:g}" for n, f in zip(grasp.names, limits, strict=True) if f < inf)
        return Infeasible(
            f"no forces of {names} inside their friction cones and force limits ({bounds}) "
            f"balance {shown(load)}: "
            f"the object escapes by {twist}; the cones alone would hold it with larger forces",
            twist,
        )
    twist = limited_twist(grasp, load, frictions, limits)
    if twist is not None:
        who = ", ".join(str(c.name) for c in grasp if c.limits is not None)
        return Infeasible(
            f"no forces of {names} inside their friction cones and the linear limits of {who} balance "
            f"{shown(load)}: the object escapes by {twist}; the cones alone would hold it with larger forces",
            twist,
        )
    limit = (
        _only_in_the_limit(grasp, load, frictions) if grasp.dimension == 3 and min(limits) == inf else None
    )
    larger = (
        ""
        if limit is None
        else (
            f"forces of {_REACHES[0]:g} times the load miss it by {limit[0]:.2g} of the load, of "
            f"{_REACHES[1]:g} times by {limit[1]:.2g}"
        )
    )
    kept = criteria.frictions(grasp)
    for mu in (frictions, kept):
        if any(load.plain) and _is_at_limit(grasp, load, mu, criteria.limits(grasp)):
            what = "" if mu is frictions else f" with {criteria.reserve:g} of the friction kept in reserve"
            return Infeasible(
                f"{shown(load)} is at its limit for {names}{what}: within {AT_LIMIT:g} of the "
                "edge of what forces "
                f"inside their friction cones and force limits balance, where rounding decides; none were "
                f"found, and no motion proves that there are none{larger and '; ' + larger}"
            )
    if limit is None:
        return None
    return Infeasible(
        f"no forces of {names} inside their friction cones balance {shown(load)}, but only in the limit: "
        f"{larger}, so no motion proves it; the contacts would need a little more friction"
    )


def defies_friction(twist: EscapeTwist) -> bool:
    """Whether a motion is one that no friction stops: every contact leaves straight, or stands still."""
    u, n = twist.velocities, twist.grasp.normals
    away = (u * n).sum(axis=1)
    across, speed = np.linalg.norm(u - away[:, None] * n, axis=1), np.linalg.norm(u, axis=1).max()
    if speed <= _STILL * float(abs(twist.twist * twist.grasp.lengths).max()):
        return twist.is_proof  # no contact moves
    if max(across.max(), -away.min()) > _STRAIGHT * speed:
        return False
    rough = [_ROUGH] * len(twist.frictions)
    return proven(twist.grasp, twist.load, twist.twist, rough, list(twist.limits)) is not None


def _is_at_limit(grasp: Grasp, load: Wrench, frictions: list[float], limits: list[float]) -> bool:
    """Whether a load is within ``AT_LIMIT`` of the edge of what is held, or inside it but for rounding.

    Near the edge: not inside by more, and missed by no more by some forces. Rounding: a solver's forces
    balance it, and none near them do exactly.
    """
    edge = edge_of(grasp, load.vector, frictions, limits)
    if edge is None:
        return False
    if edge.beyond < -AT_LIMIT:
        cones, mu, most = grasp.cones, np.array(frictions), np.array(limits)
        given = edge.forces, cones.matrix, load.vector, cones.normals, mu, most, grasp.size or 1.0
        return nearest_equilibrium(*given) is None
    if edge.beyond <= AT_LIMIT:
        return True
    weight = 1 / grasp.lengths
    target = -load.vector * weight
    unit = float(abs(target).max())
    gap = gap_left(grasp, target / unit, weight, frictions, [limit / unit for limit in limits])
    return float(np.linalg.norm(gap)) <= AT_LIMIT


def loose_twist(grasp: Grasp, load: Wrench) -> EscapeTwist | None:
    """A motion that moves no contact and along which the load does work; two fingers in space leave one."""
    if not len(grasp.free_twists):
        return None
    power = grasp.free_twists @ load.vector
    weight = 1 / grasp.lengths
    if abs(power).max() * (grasp.size or 1.0) <= _WORK * float(abs(load.vector * weight).max()):
        return None
    infinite = [inf] * len(grasp)
    twist = EscapeTwist(
        grasp, load, power @ grasp.free_twists, tuple(grasp.frictions.tolist()), tuple(infinite)
    )
    return twist if twist.is_proof else None


def escape_twist(
    grasp: Grasp, load: Wrench, frictions: list[float], limits: list[float]
) -> EscapeTwist | None:
    """The proven escape twist of a grasp, or None where none is found."""
    d = grasp.dimension
    weight = 1 / grasp.lengths  # torques as forces
    target = -load.vector * weight
    unit = float(abs(target).max())
    if unit == 0:
        return None
    limits = [
        inf if limit > _LOOSE * unit else limit for limit in limits
    ]  # they bind no proof, and spoil scales
    if min(limits) < inf or d == 3:
        gaps = [gap_left(grasp, target / unit, weight, frictions, [f / unit for f in limits])]
    else:
        gaps = _gaps(_edge_wrenches(grasp, weight, frictions), target / unit)
    twists = [
        EscapeTwist(grasp, load, -gap * weight / float(abs(gap).max()), tuple(frictions), tuple(limits))
        for gap in gaps
        if gap.any() and np.isfinite(gap).all()
    ]
    best = max(twists, key=lambda twist: twist.least_force, default=None)
    if best is None or best.is_proof:
        return best
    near = proven(grasp, load, twists[0].twist, frictions, limits)
    if near is not None:
        return near
    edge = edge_of(grasp, load.vector, frictions, limits)  # a solver's gap is too small to show a direction
    if edge is None or edge.beyond < -AT_LIMIT:
        return None
    near = proven(grasp, load, edge.twist, frictions, limits)
    if near is not None:
        return near
    clear = clearing(grasp, edge.twist, frictions, limits)
    return None if clear is None else proven(grasp, load, edge.twist, frictions, limits, clear)


def limited_twist(
    grasp: Grasp, load: Wrench, frictions: list[float], limits: list[float]
) -> EscapeTwist | None:
    """The proof that counts the contacts' linear limits, or None where none is found."""
    rows, weight = grasp.limit_rows, 1 / grasp.lengths
    target = -load.vector * weight
    unit = float(abs(target).max())
    if rows is None or unit == 0:
        return None
    from regrasp.planning.states.linear.row_duals import escape_by_rows

    loose = [inf if limit > _LOOSE * unit else limit for limit in limits]
    gap, duals = gap_and_duals(
        grasp, target / unit, weight, frictions, [f / unit for f in loose], rows.bounds / unit
    )
    return escape_by_rows(grasp, load, -gap * weight, duals, frictions, loose)


def _only_in_the_limit(grasp: Grasp, load: Wrench, frictions: list[float]) -> tuple[float, float] | None:
    """How far forces of ``_REACHES`` times the load miss it, relative to it, if larger ones come nearer."""
    weight = 1 / grasp.lengths
    target = -load.vector * weight
    target = target / float(abs(target).max())
    near, far = (
        float(np.linalg.norm(gap_left(grasp, target, weight, frictions, [reach] * len(grasp))))
        for reach in _REACHES
    )
    return (near, far) if 0 < far < _NEARER * near else None


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
    if not residual[-1] or not residual[:-1].any():
        return [gap]
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
