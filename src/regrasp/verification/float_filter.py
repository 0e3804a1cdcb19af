"""Many rows of forces at once: the instants of a course, and set-points.

Rows that are inside by more than rounding are settled in floating point; the others are decided exactly. With
u = 2^-53 and numbers between 2^-480 and 2^480, whose squares neither vanish nor overflow, computed normal and
tangential forces are within 16 u |f| of the true ones, so that

    mu f_n - |f_t| > 2^-40 (1 + mu) |f|   and   |f| <= (1 - 2^-40) max_force

prove a force inside its cone and limit (a linear one with 2^-40 of its terms and 2^-480 to spare), with 2^13
u where 16 u (1 + mu) would do. A sum of n forces, or of their torques over the largest arm l, is within
8 (n + 1)^2 u of the largest of |f_i|, |F|, |tau| / l and |m_i| / l: by that much less than
min(2^-40 s, 2^-10 w) a row must be in equilibrium.
"""

from functools import reduce
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import torque
from regrasp.verification.exact import HELD, RESOLUTION, check_forces, exact, load_size

_DOUBT, _HELD = float(RESOLUTION), float(HELD) * (1 - float(RESOLUTION))
_UNIT = 2.0**-53
_LEAST, _MOST = 2.0**-480, 2.0**480


class Checked(NamedTuple):
    """What was found of some rows; fields as in ``Verification``."""

    violations: list[str]
    worst_residual: float
    least_angle: float
    least_cone_slack: float


def check_rows(grasp: Grasp, forces: Array, loads: Array, labels: str) -> Checked:
    """Check forces (m, n, d) against loads (m, 3 or 6); ``labels`` names row k by ``labels.format(k)``."""
    broken, *found = judge_rows(grasp, forces, loads, load_size(grasp, loads), labels)
    return Checked([violation for row in broken.values() for violation in row], *found)


@np.errstate(all="ignore")
def judge_rows(
    grasp: Grasp, forces: Array, loads: Array, asked: float, labels: str, first: int = 0
) -> tuple[dict[int, list[str]], float, float, float]:
    """What is broken in each row that is not good, counted from ``first``, and the rest of ``Checked``.

    ``asked`` is the size of the plan's load [N].
    """
    d, mu, limits = grasp.dimension, grasp.frictions, grasp.max_forces
    arm = grasp.size if grasp.positions.any() else 1.0
    pushed = forces[..., :d]
    normal = np.einsum("...i,...i->...", pushed, grasp.normals)
    tangential = _length(pushed - normal[..., None] * grasp.normals)
    magnitude = _length(pushed)
    size = np.maximum(folded(np.maximum, magnitude), _length(loads[:, :d]))
    size = np.maximum(size, _length(loads[:, d:] / arm))
    torques, most = torque(grasp.positions / arm, pushed), size
    known = np.ones(magnitude.shape, dtype=bool)  # numbers that the bounds above hold for
    if grasp.torsions is not None:
        about, soft = forces[..., 3], grasp.torsions > 0
        used = np.divide(mu * about, grasp.torsions, out=0 * about, where=soft)
        known = np.where(soft, (about == 0) | (abs(mu * about) > _LEAST) & (used != 0), about == 0)
        tangential, magnitude = np.hypot(tangential, used), np.hypot(magnitude, used)
        torques = torques + (about / arm)[..., None] * grasp.normals
        most = np.maximum(size, folded(np.maximum, abs(about)) / arm)
    known &= (magnitude > _LEAST) & (magnitude < _MOST)
    inside = known & (mu * normal - tangential > _DOUBT * (1 + mu) * magnitude)
    inside &= magnitude <= limits * (1 - _DOUBT)
    inside &= _surely_within(grasp, forces)
    idle = ~folded(np.logical_or, forces != 0)
    inside |= idle  # the apex
    total = np.einsum("mni->mi", pushed) + loads[:, :d], np.einsum("mni->mi", torques) + loads[:, d:] / arm
    off = np.maximum(*map(_length, total))
    allowed = np.minimum(_DOUBT * size, _HELD * asked) if asked else _DOUBT * size
    spare = allowed - 8 * (len(grasp) + 1) ** 2 * _UNIT * most
    settled = folded(np.logical_and, inside) & (off < spare) & (size > _LEAST) & (size < _MOST)
    settled &= _LEAST < arm < _MOST
    settled |= folded(np.logical_and, idle) & ~folded(np.logical_or, loads != 0)
    slack_of = mu**2 - (tangential / normal) ** 2
    slacks = [float(slack_of[settled][magnitude[settled] > 0].min(initial=inf))]
    residuals = [float((off / size)[settled & (size > 0)].max(initial=0.0))]
    broken = {}
    for row in np.flatnonzero(~settled).tolist():
        load, label = exact(loads[row].tolist()), labels.format(first + row)
        residual, slack, violations = check_forces(grasp, forces[row], load, asked, label)
        if violations:
            broken[first + row] = violations
        slacks.append(slack)
        residuals.append(residual)
    angles = np.arctan(mu) - np.arctan2(tangential, normal)
    least = angles[magnitude > _DOUBT * size[:, None]].min(initial=inf)
    return broken, max(residuals), float(least), min(slacks)


def _surely_within(grasp: Grasp, forces: Array) -> NDArray[np.bool_]:
    """(m, n) whether forces (m, n, w) keep linear limits by more than rounding."""
    inside = np.ones(forces.shape[:-1], dtype=bool)
    for i, contact in enumerate(grasp.contacts):
        rows, limits = contact.limit_rows, contact.limits
        if rows is None or limits is None:
            continue
        terms, bounds = forces[..., i, : rows.shape[1]], limits.bounds
        room = bounds - terms @ rows.T - _DOUBT * (np.abs(terms) @ np.abs(rows).T + bounds)
        inside[..., i] = (room > _LEAST).all(axis=-1)  # products may vanish below it
    return inside


def folded(ufunc: np.ufunc, values: NDArray[Any]) -> NDArray[Any]:
    """A ufunc over the last axis, column by column: of a few columns much quicker than its ``reduce``."""
    result: NDArray[Any] = reduce(ufunc, (values[..., k] for k in range(values.shape[-1])))
    return result


def _length(vectors: Array) -> Array:
    """The Euclidean length along the last axis."""
    result: Array = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
    return result
