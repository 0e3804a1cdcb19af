"""Random states of a grasp, evenly over all that hold the load: hit-and-run with exact ends of each chord.

From a point f inside, take a random direction r of internal forces and go to a point of the chord f + s r,
drawn evenly (Smith, Operations Research 32, 1984). The chord's ends are where one of some quadratics,
positive inside, is zero,

    mu^2 (f.n)^2 - |f_t|^2    friction cone        limit^2 - |f|^2    force limit        f.n    no friction

With a + 2 b s + c s^2 for one of them along the chord, a > 0, u = 1 / s solves a u^2 + 2 b u + c = 0: the
largest u > 0 of all is the end ahead, the least u < 0 the end behind. Every state ends a walk of its own;
half-way, directions are fitted to the shape that the walks have found.
"""

from math import inf

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.programs import Rows, Status, solve

# Steps of a walk for each coordinate, in each half, and walks for each coordinate to fit a shape to.
_STEPS, _WALKS = 20, 10
# A locus thinner than this fraction of the forces has no inside to walk in.
_THIN = 1e-9


def walked(
    grasp: Grasp, held: Array, limits: list[float], count: int, rng: np.random.Generator, backend: str
) -> Array:
    """(count, n, d) forces in equilibrium inside cones and limits, spread evenly; ``held`` (n, d) are some.

    Raises ``InvalidInput`` where the states fill no volume, so that no walk can leave its start.
    """
    basis = _directions(grasp)
    centre = _centre(grasp, held, basis, limits, backend)
    k = len(basis)
    walks = max(count, _WALKS * k)
    here, shape = np.zeros((walks, k)), np.eye(k)  # coordinates along basis, from the centre
    for _ in range(2):
        for _ in range(_STEPS * k):
            here = _step(grasp, centre, basis, limits, here, rng.normal(size=here.shape) @ shape, rng)
        values, vectors = np.linalg.eigh(np.atleast_2d(np.cov(here.T)))
        shape = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T
    forces: Array = centre + np.tensordot(here[:count], basis, 1)
    normal = (forces * grasp.normals).sum(axis=-1)[..., None] * grasp.normals
    return np.where((grasp.frictions > 0)[:, None], forces, normal)  # no rounding where nothing rubs


def _directions(grasp: Grasp) -> Array:
    """(k, n, d) orthonormal internal forces that are normal at contacts without friction."""
    n, d = grasp.positions.shape
    matrix = grasp.matrix.copy()
    matrix[d:] /= grasp.size or 1.0
    tangents = grasp.tangents.reshape(n, d - 1, d)
    rows = []
    for i in np.flatnonzero(grasp.frictions == 0):
        across = np.zeros((d - 1, n, d))
        across[:, i] = tangents[i]
        rows.append(across.reshape(d - 1, -1))
    _, values, vectors = np.linalg.svd(np.vstack([matrix, *rows]))
    rank = int((values > 1e-12 * values[0]).sum())
    return vectors[rank:].reshape(-1, n, d)


def _centre(grasp: Grasp, held: Array, basis: Array, limits: list[float], backend: str) -> Array:
    """Forces (n, d) farthest inside cones and limits: unknowns (y, t), f = held + y . basis, maximise t."""
    k, unit = len(basis), max(limits)
    d, mu = grasp.dimension, grasp.frictions
    rows = Rows(k + 1)
    tangents = grasp.tangents.reshape(-1, d - 1, d)

    def of(directions: Array, i: int, less: float) -> tuple[Array, Array]:
        """Rows and offsets of directions (j, d) . f_i / unit, the first less ``less`` t."""
        inside = np.column_stack([directions @ basis[:, i].T, np.zeros(len(directions))])
        inside[0, -1] = -less
        return inside, directions @ held[i] / unit

    for i in range(len(grasp)):
        normal = grasp.normals[i][None]
        if mu[i] > 0:
            rows.second_order(*of(np.vstack([mu[i] * normal, tangents[i]]), i, float(np.hypot(1, mu[i]))))
        else:
            rows.at_least_zero(*of(normal, i, 1.0))
        below, offset = of(np.vstack([np.zeros(d), np.eye(d)]), i, 1.0)
        rows.second_order(below, offset + np.eye(d + 1)[0] * limits[i] / unit)
    answer = solve(rows.program(-np.eye(k + 1)[-1]), backend, throw=False)
    if not k or answer.status is not Status.SOLVED or answer.value[-1] < _THIN:
        raise InvalidInput(
            "the states fill no volume to draw from: the load is at the limit of what the cones and force "
            "limits can hold, or they leave one state only; loosen the limits or raise peak_ratio"
        )
    centre: Array = held + unit * np.tensordot(answer.value[:-1], basis, 1)
    return centre


def _step(
    grasp: Grasp,
    centre: Array,
    basis: Array,
    limits: list[float],
    here: Array,
    towards: Array,
    rng: np.random.Generator,
) -> Array:
    """One step of all walks (w, k); a walk whose new point rounding puts outside stays where it is."""
    f, r = centre + np.tensordot(here, basis, 1), np.tensordot(towards, basis, 1)
    a, b, c = _quadratics(grasp, limits, f, r)  # (w, 2n)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(b * b - a * c, 0.0))
        real = b * b >= a * c
        ahead = np.where(real, (root - b) / a, -inf).max(axis=1)
        behind = np.where(real, (-root - b) / a, inf).min(axis=1)
        lo, hi = 1 / np.minimum(behind, 0.0), 1 / np.maximum(ahead, 0.0)
    s = lo + (hi - lo) * rng.uniform(size=len(here))
    s = np.where(np.isfinite(s), s, 0.0)
    there: Array = here + s[:, None] * towards
    f = centre + np.tensordot(there, basis, 1)
    inside = (_quadratics(grasp, limits, f, np.zeros_like(f))[0] > 0).all(axis=1)
    inside &= ((f * grasp.normals).sum(axis=-1) >= 0).all(axis=1)
    return np.where(inside[:, None], there, here)


def _quadratics(grasp: Grasp, limits: list[float], f: Array, r: Array) -> tuple[Array, Array, Array]:
    """a, b, c (w, 2n) of the quadratics along f + s r, forces (w, n, d)."""
    n, mu = grasp.normals, grasp.frictions
    fn, rn = (f * n).sum(axis=-1), (r * n).sum(axis=-1)
    ft, rt = f - fn[..., None] * n, r - rn[..., None] * n
    rough, square = mu > 0, np.array(limits) ** 2
    a = np.where(rough, mu**2 * fn * fn - (ft * ft).sum(axis=-1), fn)
    b = np.where(rough, mu**2 * fn * rn - (ft * rt).sum(axis=-1), rn / 2)
    c = np.where(rough, mu**2 * rn * rn - (rt * rt).sum(axis=-1), 0.0)
    ball = square - (f * f).sum(axis=-1), -(f * r).sum(axis=-1), -(r * r).sum(axis=-1)
    return (
        np.concatenate([a, ball[0]], axis=-1),
        np.concatenate([b, ball[1]], axis=-1),
        np.concatenate([c, ball[2]], axis=-1),
    )
