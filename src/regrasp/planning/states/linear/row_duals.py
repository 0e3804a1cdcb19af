"""The proof that no forces within linear limits balance a load: a twist, and what the limits count in it.

Of all f in a cone with A f <= b the most work against a velocity v is at most b . l + max (-v - A'l) . f for
any l >= 0. Duals of a program give l to a solver's rounding; a little of a combination A'l_0 well inside the
cone that forces cannot oppose makes it good where a finger has no other limit.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import LimitRows
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.separation import cleared

_OVER = 1 + 1e-9
_LEAST = 1e-15


def escape_by_rows(
    grasp: Grasp, load: Wrench, twist: Array, duals: Array, frictions: list[float], limits: list[float]
) -> EscapeTwist | None:
    """The proof that a twist and duals (m,) of the linear limits are; None where they prove nothing.

    twist: (3,) or (6,), and duals in one scale.
    """
    rows = grasp.limit_rows
    if rows is None or not twist.any() or not (np.isfinite(twist).all() and np.isfinite(duals).all()):
        return None
    kept = [1.0 if (rows.contacts == i).any() else limit for i, limit in enumerate(limits)]
    size = float(abs(twist).max())
    for motion in (twist, cleared(grasp, twist, frictions, kept)):
        found = EscapeTwist(
            grasp, load, motion / size, tuple(frictions), tuple(limits),
            tuple(counted(grasp, rows, motion / size, duals / size, frictions, limits).tolist()),
        )  # fmt: skip
        if found.is_proof:
            return found
    return None


def counted(
    grasp: Grasp, rows: LimitRows, twist: Array, duals: Array, frictions: list[float], limits: list[float]
) -> Array:
    """(m,) duals, not negative, raised so that fingers without other limits oppose the twist no more."""
    cones = grasp.cones
    velocities = (twist @ cones.matrix).reshape(len(grasp), -1)
    result = np.maximum(duals, 0.0)
    for i in np.unique(rows.contacts).tolist():
        if limits[i] < inf:
            continue
        mine = np.flatnonzero(rows.contacts == i)
        left = velocities[i] + result[mine] @ rows.rows[mine]
        along = float(left @ cones.normals[i])
        across = float(np.linalg.norm(left - along * cones.normals[i]))
        short = frictions[i] * across - along
        if short > 0 and (inside := _inside(grasp, rows, i, mine, frictions[i])) is not None:
            speed = float(np.linalg.norm(velocities[i]))
            result[mine] += (short * _OVER + _LEAST * speed) * inside
    return result


def _inside(grasp: Grasp, rows: LimitRows, i: int, mine: NDArray[np.intp], friction: float) -> Array | None:
    """(k,) of least b . l with A'l inside the cone that no force opposes, by one; None without any."""
    from scipy.optimize import linprog

    a, cones = rows.rows[mine], grasp.cones
    along, across = a @ cones.normals[i], a @ cones.tangents[i].T  # (k,), (k, w - 1)
    k, w = across.shape
    # unknowns l, and bounds u_j >= |(A'l) . t_j|: along . l - friction sum u >= 1
    above = np.block([[across.T, -np.eye(w)], [-across.T, -np.eye(w)]])
    above = np.vstack([above, np.concatenate([-along, np.full(w, friction)])])
    right = np.append(np.zeros(2 * w), -1.0)
    answer = linprog(np.concatenate([rows.bounds[mine], np.zeros(w)]), above, right, method="highs")
    return np.asarray(answer.x[:k]) if answer.status == 0 else None
