"""Twists along which no contact can do negative work, sought in doubles and judged in rationals."""

from collections.abc import Iterable
from fractions import Fraction
from math import inf

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.measures.rationals import Vector
from regrasp.measures.rays import ray, wrench
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.opposition import exact, oppositions
from regrasp.planning.states.separation import cleared

Family = list[tuple[int, Vector]]


def opposition(grasp: Grasp, twist: Vector) -> Fraction:
    """The most work against a twist that one newton in a cone can do, per speed at the size of the grasp."""
    size = Fraction(grasp.size) or Fraction(1)
    d = grasp.dimension
    speed = max(*(abs(v) for v in twist[:d]), *(abs(w) * size for w in twist[d:]))
    works = oppositions(grasp, grasp.frictions.tolist(), np.array(twist, dtype=object))
    return max(works) / speed if speed else Fraction(10**9)


def least_opposed(grasp: Grasp, twists: Iterable[Vector]) -> Vector:
    """The first twist that nothing opposes, else the one that is opposed least."""
    best, least = None, None
    for twist in twists:
        opposed = opposition(grasp, twist)
        if least is None or opposed < least:
            best, least = twist, opposed
        if least == 0:
            break
    if best is None:
        raise ValueError("no twist to choose from")
    return best


def cuts(grasp: Grasp, twist: Vector) -> Family:
    """Of each round cone the force that opposes the twist most, where any does, by more than rounding."""
    found: Family = []
    y = np.array([float(v) for v in twist]) * grasp.lengths
    y = y / (abs(y).max() or 1.0)
    velocities = (grasp.scaled_matrix.T @ y).reshape(len(grasp), -1)
    for i, contact in enumerate(grasp):
        v, n = velocities[i], grasp.cones.normals[i]
        across = v - (v @ n) * n
        if contact.friction == 0 or contact.dimension == 2 or not across.any():
            continue
        if contact.torsion is None:
            across = across[:3]
        force = ray(contact, (-across / np.linalg.norm(across)).tolist())
        if sum(a * b for a, b in zip(twist, wrench(contact, force), strict=True)) < 0:
            found.append((i, force))
    return found


def clearest(grasp: Grasp) -> Vector | None:
    """The twist along which all contacts open most: maximise t, v_n - mu |v_t| >= t, every speed <= 1.

    Changed least so that contacts it touches to the solver's tolerance do not oppose it.
    """
    from regrasp.programs import Rows, solve

    m, w, cones = len(grasp.matrix), grasp.width, grasp.cones
    rows = Rows(m + 1)
    for i, mu in enumerate(grasp.frictions):
        velocity = grasp.scaled_matrix.T[w * i : w * i + w]
        along = np.append(cones.normals[i] @ velocity, -1.0)
        if mu == 0:
            rows.at_least_zero(along)
            continue
        across = np.pad(mu * cones.tangents[i] @ velocity, ((0, 0), (0, 1)))
        rows.second_order(np.vstack([along, across]))
    box = np.pad(np.vstack([np.eye(m), -np.eye(m)]), ((0, 0), (0, 1)))
    rows.at_least_zero(box, 1.0)
    try:
        answer = solve(rows.program(np.append(np.zeros(m), -1.0)), "clarabel")
    except SolverFailed:
        return None
    y: Array = answer.value[:m] / grasp.lengths
    if not y.any() or not np.isfinite(y).all():
        return None
    touching = cleared(grasp, y, grasp.frictions.tolist(), [inf] * len(grasp))
    return least_opposed(grasp, [exact(y), exact(touching)] if touching.any() else [exact(y)])


def deepest(grasp: Grasp, wrenches: Array) -> list[Vector]:
    """Of wrenches (m, k), torques by the grasp's size, the twists that each side of a cube opposes least.

    They minimise max_j u . w_j over |u|_inf = 1: the least is negative or zero without closure, and where it
    is rounding, its direction separates but for rounding.
    """
    from scipy.optimize import linprog

    m, k = wrenches.shape
    found = []
    for side in range(2 * m):
        bounds: list[tuple[float | None, float | None]] = [(-1.0, 1.0)] * m + [(None, None)]
        fixed = 1.0 if side % 2 else -1.0
        bounds[side // 2] = (fixed, fixed)
        answer = linprog(
            np.append(np.zeros(m), 1.0),
            A_ub=np.hstack([wrenches.T, -np.ones((k, 1))]),
            b_ub=np.zeros(k),
            bounds=bounds,
        )
        if answer.status == 0:
            found.append((float(answer.fun), answer.x[:m]))
    return [exact(-u / grasp.lengths) for _, u in sorted(found, key=lambda pair: pair[0])]
