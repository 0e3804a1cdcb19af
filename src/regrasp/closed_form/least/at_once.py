"""The least of a cost of forces where the constraints that are nearly touched are those that are touched.

The system of ``face_newton`` for the fingers that push, in NumPy's arrays, so that it need not be compiled.
Constraints are homogeneous, c(x) = R(x) x - d. None is dropped or added: where a sign is wrong, or Newton's
steps do not end, there is no answer.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from regrasp.closed_form.least.face_newton import BALANCED, INSIDE
from regrasp.closed_form.least.faces import MARGIN, NEAR, NONE, OVER, PEAK, SIGN, TRACE
from regrasp.closed_form.least.in_plane import least_in_plane

_Array = NDArray[np.float64]
# As in ``face_newton``: the e of forces, that of multipliers, and what steps may move.
_OF_FORCES, _OF_MULTIPLIERS = 1e-6, 1e-8
_STEPS, _FAR, _LAST = 6, 1e-2, 1e-10


def refined(
    forces: _Array,
    unit: float,
    matrix: _Array,
    load: _Array,
    normals: _Array,
    frictions: _Array,
    negligible: float,
    limits: _Array,
    squares: _Array,
    linear: _Array,
    kind: int,
) -> tuple[_Array, bool] | None:
    """The best forces (n, w) near ``forces`` and whether they fit; None where they are not found at once.

    The arguments are those of ``face_newton.refined``.
    """
    if kind == MARGIN:  # its best forces are seldom the only ones
        return None
    x, bounds = forces / unit, INSIDE / unit * limits
    mu = np.where(frictions > negligible, INSIDE * frictions, 0.0)
    cost = max(abs(squares).max(), abs(linear).max())
    a, c = (squares / cost, linear / cost) if 0 < cost < np.inf else (squares, linear)
    if x.shape[1] == 2 and kind != PEAK and (a.min() > 0 or not a.any()):
        plain = least_in_plane(
            x.tolist(), matrix.tolist(), (load / unit).tolist(), normals.tolist(), mu.tolist(),
            bounds.tolist(), a.tolist(), c.tolist(), kind,
        )  # fmt: skip
        if plain is not None:
            best = unit * np.array(plain)
            return best, _fits(best, matrix, load, normals, frictions, limits)
    busy = (x * x).sum(axis=1) >= TRACE * TRACE
    every = bool(busy.all())
    columns = busy.repeat(x.shape[1])
    if every:
        face = _Face(x, matrix, load / unit, normals, mu, bounds, a, c, kind)
    else:
        face = _Face(
            x[busy], matrix[:, columns], load / unit, normals[busy], mu[busy], bounds[busy], a[busy], c[busy],
            kind,
        )  # fmt: skip
    if not face.solved():
        return None
    if every:
        best = unit * face.x
    else:
        # What pulls at an idle finger, u = -c - G'y, must not move it: u.n + mu |u across n| <= 0.
        pull = -c[~busy] - (face.z[: load.size] @ matrix[:, ~columns]).reshape(-1, x.shape[1])
        along = (pull * normals[~busy]).sum(axis=1)
        across = pull - along[:, None] * normals[~busy]
        moved = along + mu[~busy] * np.sqrt((across * across).sum(axis=1))
        if not moved.max() <= SIGN * max(1.0, abs(face.z).max()):
            return None
        best = np.zeros(x.shape)
        best[busy] = unit * face.x
    return best, _fits(best, matrix, load, normals, frictions, limits)


def _fits(
    forces: _Array, matrix: _Array, load: _Array, normals: _Array, frictions: _Array, limits: _Array
) -> bool:
    """Whether forces are in equilibrium to rounding, inside their cones and limits."""
    largest = max(abs(forces).max(), abs(load).max())
    if not abs(matrix @ forces.ravel() + load).max() <= BALANCED * largest:
        return False
    along = (forces * normals).sum(axis=1)
    across = forces - along[:, None] * normals
    inside = np.sqrt((across * across).sum(axis=1)) <= frictions * along
    return bool(inside.all() and (np.sqrt((forces * forces).sum(axis=1)) <= limits).all())


class _Face:
    """The touched constraints of fingers that push, and Newton's method on them."""

    def __init__(
        self,
        x: _Array,
        matrix: _Array,
        load: _Array,
        normals: _Array,
        frictions: _Array,
        limits: _Array,
        squares: _Array,
        linear: _Array,
        kind: int,
    ) -> None:
        self.x, self.normals, self.frictions, self.limits = x, normals, frictions, limits
        self.kind, (n, w), r = kind, x.shape, load.size
        self._measure()
        rough = frictions > 0
        self.t = 0.0 if kind == NONE else float((self.sizes if kind == PEAK else self.along).max())
        over, beyond, above = self._over()
        self.on_cone = np.flatnonzero(rough & (abs(over) < NEAR))
        self.at_limit = np.flatnonzero(abs(beyond) < NEAR)
        self.at_t = np.flatnonzero(above > -NEAR) if kind != NONE else self.at_limit[:0]
        smooth = np.flatnonzero(~rough)
        ends = np.cumsum([r, w * smooth.size, self.on_cone.size, self.at_limit.size, self.at_t.size]).tolist()
        self.rows = [np.arange(*pair) for pair in pairwise(ends)]
        self.size = n * w + (kind != NONE)
        self.R = np.zeros((ends[-1], self.size))
        self.R[:r, : n * w] = matrix
        self.blocks = self.R[:, : n * w].reshape(-1, n, w)  # a view
        for k, i in enumerate(smooth.tolist()):
            rows = slice(r + w * k, r + w * k + w)
            self.blocks[rows, i] = np.eye(w) - np.outer(normals[i], normals[i])
        self.d = np.zeros(ends[-1])
        self.d[:r] = -load
        self.d[self.rows[2]] = limits[self.at_limit]
        self.squares, self.z = 2 * squares.repeat(w), np.zeros(ends[-1])
        self.g = np.zeros(self.size)
        self.g[: n * w] = linear.ravel()
        if kind != NONE:
            self.R[self.rows[3], -1], self.g[-1] = -1.0, 1.0
        self.is_flat = w == 2 and kind != PEAK and not self.at_limit.size

    def _measure(self) -> None:
        x, normals = self.x, self.normals
        self.along = (x * normals).sum(axis=1)
        self.beside = x - self.along[:, None] * normals
        self.across = np.sqrt((self.beside * self.beside).sum(axis=1))
        self.sizes = np.sqrt((x * x).sum(axis=1))

    def _over(self) -> tuple[_Array, _Array, _Array]:
        """How far forces are outside cones, limits and t."""
        above = (self.sizes if self.kind == PEAK else self.along) - self.t
        return self.across - self.frictions * self.along, self.sizes - self.limits, above

    def _differentiate(self) -> None:
        """R at x."""
        c, m, t = self.on_cone, self.at_limit, self.at_t
        _, cones, limits, peaks = self.rows
        self.directions = self.beside[c] / self.across[c, None]
        self.blocks[cones, c] = self.directions - self.frictions[c, None] * self.normals[c]
        if m.size:
            self.blocks[limits, m] = self.x[m] / self.sizes[m, None]
        if t.size:
            peak = self.kind == PEAK
            self.blocks[peaks, t] = self.x[t] / self.sizes[t, None] if peak else self.normals[t]

    def _bent(self, K: _Array) -> None:
        """Add how the touched constraints curve to the upper left of ``K``."""
        n, w = self.x.shape
        H, one = K[: n * w, : n * w].reshape(n, w, n, w), np.eye(w)
        _, cones, limits, peaks = self.rows
        c = self.on_cone
        if c.size and w > 2:
            u, v = self.directions, self.normals[c]
            around = one - u[:, :, None] * u[:, None, :] - v[:, :, None] * v[:, None, :]
            H[c, :, c, :] += (np.maximum(self.z[cones], 0.0) / self.across[c])[:, None, None] * around
        for rows, i in ((limits, self.at_limit), (peaks, self.at_t)):
            if i.size and (rows is limits or self.kind == PEAK):
                u = self.x[i] / self.sizes[i, None]
                bent = np.maximum(self.z[rows], 0.0) / self.sizes[i]
                H[i, :, i, :] += bent[:, None, None] * (one - u[:, :, None] * u[:, None, :])

    def solved(self) -> bool:
        """Whether ``x`` and ``z`` became the solution."""
        n, w = self.x.shape
        N, rows = self.size, self.z.size
        X = np.append(self.x, self.t) if self.kind != NONE else self.x.ravel().copy()
        K, missing = np.zeros((N + rows, N + rows)), np.zeros(N + rows)
        inverse = None
        slope = np.zeros(N)
        slope[: n * w] = self.squares
        softness = np.full(N + rows, -_OF_MULTIPLIERS)
        softness[:N] = _OF_FORCES
        for step in range(_STEPS):
            if inverse is None or not self.is_flat:
                self._differentiate()
                R = self.R
                if step == 0 and not self.is_flat:  # those multipliers that leave least of the gradient
                    G = R @ R.T
                    G.flat[:: rows + 1] += _OF_MULTIPLIERS
                    try:
                        self.z = np.linalg.solve(G, -R @ (slope * X + self.g))
                    except np.linalg.LinAlgError:
                        return False
                K[:] = 0.0
                K[N:, :N] = R
                K[:N, N:] = R.T
                K.flat[:: N + rows + 1] = softness
                K.flat[: N * (N + rows) : N + rows + 1] += slope
                if not self.is_flat:
                    self._bent(K)
                try:
                    inverse = np.linalg.inv(K)
                except np.linalg.LinAlgError:
                    return False
            missing[:N] = -slope * X - self.g - self.z @ R
            missing[N:] = self.d - R @ X
            change = inverse @ missing
            moved = float(abs(change[:N]).max())
            if not moved < _FAR:
                return False
            X += change[:N]
            self.z += change[N:]
            self.x = X[: n * w].reshape(n, w)
            if self.kind != NONE:
                self.t = float(X[-1])
            if moved < _LAST:
                return self._is_best()
            if not self.is_flat:
                self._measure()
        return False

    def _is_best(self) -> bool:
        """Whether forces and multipliers have the right signs."""
        self._measure()
        first = self.z.size - sum(part.size for part in self.rows[1:])
        if self.z[first:].min(initial=0.0) < -SIGN * max(1.0, float(abs(self.z).max())):
            return False
        over, beyond, above = self._over()
        rough = self.frictions > 0
        return bool(
            over[rough].max(initial=0.0) <= OVER
            and beyond.max() <= OVER
            and (self.kind == NONE or above.max() <= OVER)
            and self.along.min() >= 0
        )
