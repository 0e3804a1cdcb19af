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
from typing import NamedTuple

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
    tangents = grasp.tangents.reshape(len(grasp), -1, grasp.dimension)
    frames = np.concatenate([grasp.normals[:, None], tangents], axis=1)
    chords = _Chords(
        np.einsum("nij,nj->ni", frames, centre).ravel(),
        np.einsum("nij,knj->kni", frames, basis).reshape(len(basis), -1),
        grasp.frictions,
        np.array(limits),
    )
    k = len(basis)
    here, shape = np.zeros((max(count, _WALKS * k), k)), np.eye(k)  # coordinates along basis, from the centre
    for _ in range(2):
        for _ in range(_STEPS * k):
            here = chords.step(here, rng.normal(size=here.shape) @ shape, rng.uniform(size=len(here)))
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
    answer = solve(rows.program(-np.eye(k + 1)[-1], size=1.0), backend, throw=False)
    if not k or answer.status is not Status.SOLVED or answer.value[-1] < _THIN:
        raise InvalidInput(
            "the states fill no volume to draw from: the load is at the limit of what the cones and force "
            "limits can hold, or they leave one state only; loosen the limits or raise peak_ratio"
        )
    centre: Array = held + unit * np.tensordot(answer.value[:-1], basis, 1)
    return centre


class _Chords(NamedTuple):
    """The set walked in: forces centre + y . basis in frames (normal, tangents) of the contacts, flat.

    centre: (n d,). basis: (k, n d). frictions, limits: (n,).
    """

    centre: Array
    basis: Array
    frictions: Array
    limits: Array

    def step(self, here: Array, towards: Array, share: Array) -> Array:
        """All walks (w, k) moved to a ``share`` (w,) of their chord along ``towards`` (w, k).

        A walk whose new point rounding puts outside stays where it is.
        """
        a, b, c = self._quadratics(self._forces(here), self._split(towards @ self.basis))  # (w, 2n)
        inner = b * b - a * c
        root = np.sqrt(np.maximum(inner, 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead = np.where(inner >= 0, (root - b) / a, -inf).max(axis=1)
            behind = np.where(inner >= 0, (-root - b) / a, inf).min(axis=1)
            lo, hi = 1 / np.minimum(behind, 0.0), 1 / np.maximum(ahead, 0.0)
            s = lo + (hi - lo) * share
        there: Array = here + np.where(np.isfinite(s), s, 0.0)[:, None] * towards
        f = self._forces(there)
        inside = np.all(self._values(f, f, self.limits**2) > 0, axis=1, keepdims=True)
        return np.where(inside & np.all(f[..., 0] >= 0, axis=1, keepdims=True), there, here)

    def _forces(self, points: Array) -> Array:
        return self._split(self.centre + points @ self.basis)

    def _split(self, flat: Array) -> Array:
        """(w, n, d) of (w, n d)."""
        return flat.reshape(len(flat), len(self.frictions), -1)

    def _quadratics(self, f: Array, r: Array) -> tuple[Array, Array, Array]:
        """a, b, c (w, 2n) of the quadratics along f + s r, forces (w, n, d)."""
        a, b, c = self._values(f, f, self.limits**2), self._values(f, r, 0.0), self._values(r, r, 0.0)
        smooth = np.flatnonzero(self.frictions == 0)
        b[:, smooth], c[:, smooth] = r[:, smooth, 0] / 2, 0.0
        return a, b, c

    def _values(self, f: Array, g: Array, bound: Array | float) -> Array:
        """(w, 2n) bilinear forms of the quadratics: ``bound`` - f.g of limits, f.n where nothing rubs."""
        normal, across = f[..., 0] * g[..., 0], (f[..., 1:] * g[..., 1:]).sum(axis=-1)
        cone = np.where(self.frictions > 0, self.frictions**2 * normal - across, f[..., 0])
        return np.concatenate([cone, bound - normal - across], axis=-1)
