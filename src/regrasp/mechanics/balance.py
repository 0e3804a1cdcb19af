"""The nearest forces in exact equilibrium inside the friction cones.

    minimise 1/2 |f - f0|^2   subject to   G f + w = 0,   f_i in K_i = {cone, |f_i| <= limit_i}

Its Lagrange dual has one unknown per wrench component (3 or 6) and f(y) = proj_K(f0 - G'y) as its inner
minimiser, so the equation G f(y) + w = 0 is solved by Newton's method on y. Projection onto a friction
cone cut by a ball is a closed form, so every iterate lies inside the cones and only equilibrium is left
to reach: one step when no cone is touched. (Semismooth Newton: Qi and Sun, Math. Programming 58, 1993.)
"""

from math import sqrt

import numpy as np

from regrasp.mechanics.checks import Array

_STEPS = 60
# Equilibrium counts as reached at this residual relative to the largest force; a few times rounding.
EQUILIBRIUM = 1e-13


def nearest_equilibrium(
    forces: Array, matrix: Array, load: Array, normals: Array, frictions: Array, limits: Array, length: float
) -> Array | None:
    """The (n, d) forces nearest to ``forces`` with G f + load = 0, inside cones and ``limits`` (n,), or None.

    ``length`` [m] makes torques comparable with forces. None means that no equilibrium was found.
    """
    n, d = forces.shape
    weight = np.ones(matrix.shape[0])
    weight[d:] = 1 / length
    g, w = matrix * weight[:, None], load * weight
    scale = max(float(abs(forces).max()), float(abs(w).max()))
    if scale == 0:
        return np.zeros_like(forces)

    y = np.zeros(w.size)
    f, derivative = _project(forces, normals, frictions, limits)
    residual = g @ f.ravel() + w
    for _ in range(_STEPS):
        if abs(residual).max() <= EQUILIBRIUM * max(scale, float(abs(f).max())):
            return f
        curvature = sum(
            (g[:, i * d : i * d + d] @ derivative[i] @ g[:, i * d : i * d + d].T for i in range(n)),
            start=np.zeros((w.size, w.size)),
        )
        # A contact that pushes nothing adds no curvature; the shift keeps the step finite there.
        shift = 1e-12 * n + 1e-3 * min(1.0, float(abs(residual).max()) / scale) ** 2
        step = np.linalg.solve(curvature + shift * np.eye(w.size), residual)
        value, slope, length_of_step = _dual(f, forces, residual, y), float(residual @ step), 1.0
        while True:  # the dual is concave and smooth: backtrack until it rises
            trial = y + length_of_step * step
            f_trial, derivative_trial = _project(
                forces - (g.T @ trial).reshape(n, d), normals, frictions, limits
            )
            residual_trial = g @ f_trial.ravel() + w
            rise = _dual(f_trial, forces, residual_trial, trial) - value
            if rise >= 1e-4 * length_of_step * slope or length_of_step < 1e-3:
                break
            length_of_step /= 2
        y, f, derivative, residual = trial, f_trial, derivative_trial, residual_trial
    return None


def _dual(f: Array, wanted: Array, residual: Array, y: Array) -> float:
    return float(0.5 * ((f - wanted) ** 2).sum() + y @ residual)


def _project(forces: Array, normals: Array, frictions: Array, limits: Array) -> tuple[Array, Array]:
    """Nearest points of K to (n, d) forces and the derivatives (n, d, d) of that map."""
    n, d = forces.shape
    points, derivatives = np.zeros((n, d)), np.zeros((n, d, d))
    for i in range(n):
        p, dp = _onto_cone(forces[i], normals[i], float(frictions[i]))
        magnitude = sqrt(float(p @ p))
        if magnitude > limits[i]:  # onto the ball: the composition is the projection onto cone and ball
            direction = p / magnitude
            dp = (limits[i] / magnitude) * (dp - np.outer(direction, direction @ dp))
            p = limits[i] * direction
        points[i], derivatives[i] = p, dp
    return points, derivatives


def _onto_cone(f: Array, n: Array, mu: float) -> tuple[Array, Array]:
    normal = float(f @ n)
    tangent = f - normal * n
    tangential = sqrt(float(tangent @ tangent))
    identity = np.eye(f.size)
    if tangential <= mu * normal:
        return f, identity
    if mu * tangential <= -normal:
        return np.zeros_like(f), np.zeros_like(identity)
    t = tangent / tangential
    edge = (n + mu * t) / sqrt(1 + mu * mu)
    along = max(float(f @ edge), 0.0)
    around = identity - np.outer(n, n) - np.outer(t, t)  # the rim of the cone; nothing in the plane
    rim = along * mu / sqrt(1 + mu * mu) / tangential
    return along * edge, np.outer(edge, edge) + rim * around
