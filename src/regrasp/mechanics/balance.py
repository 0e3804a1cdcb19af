"""The nearest forces in exact equilibrium inside the friction cones.

    minimise 1/2 |f - f0|^2   subject to   G f + w = 0,   f_i in K_i = {cone, |f_i| <= limit_i}

Its Lagrange dual has one unknown per wrench component (3 or 6) and f(y) = proj_K(f0 - G'y) as its inner
minimiser, so the equation G f(y) + w = 0 is solved by Newton's method on y. Projection onto a friction
cone cut by a ball is a closed form, so every iterate lies inside the cones and only equilibrium is left
to reach: one step when no cone is touched. (Semismooth Newton: Qi and Sun, Math. Programming 58, 1993.)
"""

from math import hypot, sqrt

import numpy as np

from regrasp.mechanics.checks import Array

_STEPS = 200
# Equilibrium counts as reached at this residual relative to the largest force; a few times rounding.
EQUILIBRIUM = 1e-13
# What is aimed at: every component of the residual below this, so that its length passes, too.
_ENOUGH = EQUILIBRIUM / 2
# The dual function of what cannot be balanced rises for ever. At a y this large f(y) is mostly rounding.
_UNBOUNDED = 1e6
# Residuals of two steps that differ by less than this fraction.
_RAY = 0.05
# Steps damped by so much move nothing.
_STUCK = 1e14
# A rise of the dual function below this fraction of its value is lost in rounding.
_ROUNDING = 1e-11


def nearest_equilibrium(
    forces: Array, matrix: Array, load: Array, normals: Array, frictions: Array, limits: Array, length: float
) -> Array | None:
    """The (n, d) forces nearest to ``forces`` with G f + load = 0, inside cones and ``limits`` (n,), or None.

    ``length`` [m] makes torques comparable with forces. None means that no equilibrium was found.
    """
    n, d = forces.shape
    weight = np.ones(matrix.shape[0])
    weight[2 if matrix.shape[0] == 3 else 3 :] = 1 / length
    g, w = matrix * weight[:, None], load * weight
    heaviest = float(abs(w).max())
    scale = max(float(abs(forces).max()), heaviest)
    if scale == 0:
        return np.zeros_like(forces)

    y, damping, stride = np.zeros(w.size), 0.0, 1.0
    f, derivative = _project(forces, normals, frictions, limits)
    residual = g @ f.ravel() + w
    for _ in range(_STEPS):
        if abs(residual).max() <= _ENOUGH * max(heaviest, float(abs(f).max())):
            return f
        if abs(residual).max() <= _ENOUGH * scale:  # as near as beside such large forces; go on from here
            return nearest_equilibrium(f, matrix, load, normals, frictions, limits, length)
        curvature = sum(
            (g[:, i * d : i * d + d] @ derivative[i] @ g[:, i * d : i * d + d].T for i in range(n)),
            start=np.zeros((w.size, w.size)),
        )
        # A contact that pushes nothing adds no curvature; the shift keeps the step finite there.
        step = stride * np.linalg.solve(curvature + (1e-12 * n + damping) * np.eye(w.size), residual)
        trial = y + step
        f_trial, derivative_trial = _project(forces - (g.T @ trial).reshape(n, d), normals, frictions, limits)
        residual_trial = g @ f_trial.ravel() + w
        value = _dual(f, forces, residual, y)
        rise, expected = _dual(f_trial, forces, residual_trial, trial) - value, float(residual @ step)
        if expected < _ROUNDING * abs(value):  # too near the top to see it rise: the slope must fall
            better = abs(residual_trial).max() < abs(residual).max()
        else:
            better = rise >= 1e-4 * expected
        # The dual is concave and smooth, so that a step that is damped enough always rises.
        if better or stride == 1:
            damping = damping / 16 if better else max(16 * damping, 1e-4)
        # What cannot be balanced is missed by the same all along a ray of y: follow it in growing strides.
        is_ray = better and abs(residual_trial - residual).max() <= _RAY * abs(residual).max()
        stride = 4 * stride if is_ray else 1.0
        if damping > _STUCK:
            return None
        if better:
            y, f, derivative, residual = trial, f_trial, derivative_trial, residual_trial
            if abs(y).max() > _UNBOUNDED * scale:
                return None
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
    tangential = hypot(*tangent)  # squares of tiny forces would vanish
    identity = np.eye(f.size)
    if normal >= 0 and tangential <= mu * normal:  # without friction, a pull along the normal is no push
        return f, identity
    if mu * tangential <= -normal:
        return np.zeros_like(f), np.zeros_like(identity)
    t = tangent / tangential
    edge = (n + mu * t) / sqrt(1 + mu * mu)
    along = max(float(f @ edge), 0.0)
    around = identity - np.outer(n, n) - np.outer(t, t)  # the rim of the cone; nothing in the plane
    rim = along * mu / sqrt(1 + mu * mu) / tangential
    return along * edge, np.outer(edge, edge) + rim * around
