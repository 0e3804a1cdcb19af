"""The nearest forces in exact equilibrium inside the friction cones.

Of all f with G f + w = 0 the nearest to f0 is f0 - G' y with (G G') y = G f0 + w. Where it lies inside the
cones and limits, it is the nearest there, too (``shifted``). Otherwise ``nearest_equilibrium`` asks

    minimise 1/2 |f - f0|^2   subject to   G f + w = 0,   f_i in K_i = {cone, |f_i| <= limit_i}

Its Lagrange dual has one unknown per wrench component (3 or 6) and f(y) = proj_K(f0 - G'y) as its inner
minimiser, so the equation G f(y) + w = 0 is solved by Newton's method on y. Projection onto a friction
cone cut by a ball is a closed form, so every iterate lies inside the cones and only equilibrium is left
to reach: one step when no cone is touched. (Semismooth Newton: Qi and Sun, Math. Programming 58, 1993.)
"""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.value import kept

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


# A direction in which G G' is less than this fraction of its largest entry is no direction of G.
_FLAT = 1e-13
# A force below this fraction of the largest is a solver's noise at a finger that carries none.
_IDLE = 1e-8
# Without a load, forces below this fraction of those given are the rounding of none.
_DUST = 2.0**-40
# A direction in which G is less than this fraction of its largest singular value hardly is one.
_NEARLY_FLAT = 1e-6


@np.errstate(over="ignore", invalid="ignore")
def shifted(grasp: Grasp, load: Array, forces: Array, frictions: Array, limits: Array) -> Array | None:
    """Forces (n, w) moved least into equilibrium, idle fingers left idle; None where that is no answer.

    Forces are as the cones measure them. load: (3,) or (6,), torques divided by the size. frictions, limits:
    (n,). An answer is in equilibrium, inside every cone and limit, and finite.
    """
    sizes = np.maximum.reduce(np.abs(forces), axis=1)
    used = sizes >= _IDLE * np.maximum.reduce(sizes)
    g, back = kept(grasp, used.tobytes(), _moving)
    f, normals = np.where(used[:, None], forces, 0.0).ravel(), grasp.cones.normals
    off, heaviest = g @ f + load, np.maximum.reduce(np.abs(load))
    for _ in range(3):  # the second time takes away the rounding of the first
        f = f - back @ off
        off = g @ f + load
        largest = max(np.maximum.reduce(np.abs(f)), heaviest)
        is_balanced = np.maximum.reduce(np.abs(off)) <= _ENOUGH * largest < np.inf
        if is_balanced:
            break
    if not is_balanced:
        return None
    answer: Array = f.reshape(forces.shape)
    along = np.einsum("ij,ij->i", answer, normals)
    across = answer - along[:, None] * normals
    inside = np.sqrt(np.einsum("ij,ij->i", across, across)) <= frictions * along
    inside &= (np.einsum("ij,ij->i", answer, answer) <= limits * limits) & (along >= 0)
    return answer if np.logical_and.reduce(inside) else None


def _moving(grasp: Grasp, used: bytes) -> tuple[Array, Array]:
    """G of the fingers used, and G' (G G')^-1: the least forces (n w, 3 or 6) that make a wrench."""
    g = grasp.scaled_matrix * np.repeat(np.frombuffer(used, dtype=np.bool_), grasp.width)
    return g, g.T @ _inverse(g @ g.T)


def _inverse(gram: Array) -> Array:
    """The inverse of G G' (r, r); zero in flat directions, where the pivots of L L' = G G' vanish."""
    flat = _FLAT * np.maximum.reduce(gram, axis=None)
    try:
        lower = np.linalg.cholesky(gram)
        if np.minimum.reduce(lower.diagonal()) ** 2 > flat:
            return np.asarray(np.linalg.inv(gram), dtype=float)
    except np.linalg.LinAlgError:
        pass
    keep: list[int] = []
    left = gram.copy()
    for k in range(len(gram)):  # a row whose pivot vanishes follows from those before it
        if left[k, k] > flat:
            left = left - np.outer(left[:, k], left[k] / left[k, k])
            keep.append(k)
    inverse = np.zeros_like(gram)
    inverse[np.ix_(keep, keep)] = np.linalg.inv(gram[np.ix_(keep, keep)])
    return inverse


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

    parts = np.ascontiguousarray(g.reshape(-1, n, d).transpose(1, 0, 2))  # (n, r, d)
    y, damping, stride = np.zeros(w.size), 0.0, 1.0
    f, derivative = _project(forces, normals, frictions, limits)
    residual = g @ f.ravel() + w
    for _ in range(_STEPS):
        if abs(residual).max() <= _ENOUGH * max(heaviest, float(abs(f).max())):
            return f if heaviest or abs(f).max() > _DUST * scale else np.zeros_like(f)
        if abs(residual).max() <= _ENOUGH * scale:  # as near as beside such large forces; go on from here
            if not heaviest and abs(f).max() <= _DUST * scale:
                return np.zeros_like(f)
            found = nearest_equilibrium(f, matrix, load, normals, frictions, limits, length)
            is_dust = found is not None and not heaviest and abs(found).max() <= _DUST * scale
            return np.zeros_like(f) if is_dust else found
        curvature = np.add.reduce(parts @ derivative @ parts.transpose(0, 2, 1))
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


def nearest_nearly_flat(
    grasp: Grasp, load: Array, forces: Array, frictions: Array, limits: Array
) -> Array | None:
    """``nearest_equilibrium`` where G is nearly singular, as of contacts next to one another; None elsewhere.

    G G' squares what is small and loses it. With G = U S V' the rows of V' f = -S^-1 U' w are as steep as
    one another. What a nearly flat direction lacks is made up by large changes, or left if it is rounding:
    as many of them are used as it takes. load: (3,) or (6,), torques divided by the size.
    """
    out, sizes, into = kept(grasp, None, _directions)
    steep = int(np.count_nonzero(sizes > _NEARLY_FLAT * sizes[0]))
    heaviest, normals = float(abs(load).max()), grasp.cones.normals
    for used in range(steep, len(sizes) + 1 if steep < len(out) else 0):
        wanted = (out[:, :used].T @ load) / sizes[:used]
        f = nearest_equilibrium(forces, into[:used], wanted, normals, frictions, limits, 1.0)
        if f is None:
            continue
        off = float(abs(grasp.scaled_matrix @ f.ravel() + load).max())
        if off <= _ENOUGH * max(heaviest, float(abs(f).max())):
            return f
    return None


def _directions(grasp: Grasp, _: None) -> tuple[Array, Array, Array]:
    """The singular value decomposition of G (3 or 6, n w), without what is rounding."""
    out, sizes, into = np.linalg.svd(grasp.scaled_matrix, full_matrices=False)
    real = sizes > 2.0**-50 * sizes[0]
    return out[:, real], sizes[real], into[real]


def _dual(f: Array, wanted: Array, residual: Array, y: Array) -> float:
    return float(0.5 * ((f - wanted) ** 2).sum() + y @ residual)


def _project(forces: Array, normals: Array, frictions: Array, limits: Array) -> tuple[Array, Array]:
    """Nearest points of K to (n, d) forces and the derivatives (n, d, d) of that map."""
    identity = np.eye(forces.shape[1])
    normal = np.einsum("ij,ij->i", forces, normals)
    tangent = forces - normal[:, None] * normals
    tangential = np.hypot.reduce(tangent, axis=1)  # squares of tiny forces would vanish
    # Without friction, a pull along the normal is no push.
    inside = (normal >= 0) & (tangential <= frictions * normal)
    apex = ~inside & (frictions * tangential <= -normal)
    t = tangent / np.where(tangential > 0, tangential, 1.0)[:, None]
    root = np.sqrt(1 + frictions * frictions)
    edge = (normals + frictions[:, None] * t) / root[:, None]
    along = np.maximum(np.einsum("ij,ij->i", forces, edge), 0.0)
    share = np.where(inside, 0.0, along * frictions / root / np.where(tangential > 0, tangential, 1.0))
    # The rim of the cone; nothing in the plane.
    around = identity - _squares(normals) - _squares(t)
    flat = inside[:, None]
    points = np.where(flat, forces, along[:, None] * edge)
    derivatives = np.where(flat[:, None], identity, _squares(edge) + share[:, None, None] * around)
    points[apex], derivatives[apex] = 0.0, 0.0
    size = np.sqrt(np.einsum("ij,ij->i", points, points))
    for i in np.flatnonzero(size > limits):  # the composition is the projection onto cone and ball
        direction = points[i] / size[i]
        derivatives[i] = (limits[i] / size[i]) * (
            derivatives[i] - np.outer(direction, direction @ derivatives[i])
        )
        points[i] = limits[i] * direction
    return points, derivatives


def _squares(vectors: Array) -> Array:
    """(n, d, d) each of the (n, d) vectors times itself."""
    result: Array = vectors[:, :, None] * vectors[:, None]
    return result
