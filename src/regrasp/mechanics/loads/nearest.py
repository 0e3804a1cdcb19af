"""How far a point is from the hull of others (Lawson and Hanson's non-negative least squares, ch. 23)."""

import numpy as np

from regrasp.mechanics.checks import Array

_STEPS = 1000
_ROUNDING = 1e-13


def nearest_mean(points: Array, target: Array) -> Array:
    """Target - weights . points, the least gap (k,) that a weighted mean of ``points`` (m, k) leaves.

    Weights sum to 1 by a row of their own, heavy beside the others.
    """
    heavy = 1e3 * max(float(np.abs(points).max()), float(np.abs(target).max()), 1e-300)
    a = np.vstack([points.T, np.full(len(points), heavy)])
    b = np.append(target, heavy)
    weights, free = np.zeros(len(points)), np.zeros(len(points), dtype=bool)
    for _ in range(_STEPS):
        slope = a.T @ (b - a @ weights)
        slope[free] = -np.inf
        entering = int(slope.argmax())
        if slope[entering] <= _ROUNDING * heavy * heavy:
            break
        free[entering] = True
        while True:
            trial = np.zeros(len(points))
            trial[free] = np.linalg.lstsq(a[:, free], b, rcond=None)[0]
            if trial[free].min() > 0:
                break
            back = free & (trial <= 0)
            share = float((weights[back] / np.maximum(weights[back] - trial[back], 1e-300)).min())
            weights = weights + share * (trial - weights)
            free &= weights > _ROUNDING
            if not free.any():
                break
        weights = trial if free.any() else weights
    total = float(weights.sum())
    mean = weights / total if total > 0 else weights
    result: Array = target - mean @ points
    return result
