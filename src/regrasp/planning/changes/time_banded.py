"""Quadratic programs over time whose neighbours alone are coupled, by their band.

    minimise   sum_k w_k |u_k+1 - u_k|^2 + q_k . u_k   subject to   A u_k + h_k >= 0,   k = 1..K

with u_0 = u_K+1 = 0, the same A at all instants. Mehrotra's predictor-corrector method (Nocedal and Wright,
Numerical Optimization, 2006, 16.6) on all instants at once: what it eliminates, P + A' (z / s) A, is
block-tridiagonal, and LAPACK's Cholesky factorisation of bands costs as much per instant however many there
are.
"""

import numpy as np

from regrasp.mechanics.checks import Array

_STEPS = 40
# Constraints may miss by this part of the data, the objective by this part of its value and one.
_CLOSE, _GAP = 1e-11, 1e-9
_SHARE = 0.995  # of the way to the boundary


@np.errstate(all="ignore")  # where there is no point, multipliers grow without end
def solved_over_time(A: Array, h: Array, w: Array, q: Array) -> Array | None:
    """The best u (K, p); None where no answer passes the audit.

    A: (m, p). h: (K, m). w: (K + 1,) > 0. q: (K, p). All of order one, if w is of order K.
    """
    (K, p), m = q.shape, len(A)
    band = _Band(A, w, K)
    u, z, s = np.zeros((K, p)), np.full((K, m), 1.0 / K), np.maximum(h, 1.0)
    size = max(1.0, float(abs(h).max()))
    for _ in range(_STEPS):
        bent = band.times(u)
        slope, miss, both = bent + q - z @ A, s - h - u @ A.T, s * z
        gap = float(both.sum())
        if not np.isfinite(gap):
            return None
        if abs(miss).max() <= _CLOSE * size and _short_of(A, h, q, u, z, bent) <= _GAP:
            return u
        d = z / s
        if not band.factor(d):
            return None
        _, ds, dz = _step(band, A, s, z, d, miss, slope, -both)
        reach = min(_reach(s, ds), _reach(z, dz))
        after = float(((s + reach * ds) * (z + reach * dz)).sum())
        target = (after / gap) ** 3 * gap / (K * m)
        du, ds, dz = _step(band, A, s, z, d, miss, slope, target - both - ds * dz)
        step = min(1.0, _SHARE * min(_reach(s, ds), _reach(z, dz)))
        u, s, z = u + step * du, s + step * ds, z + step * dz
    return None


class _Band:
    """P of the changes, and the Cholesky factors of P + A' d A by LAPACK, the lower band of each instant."""

    def __init__(self, A: Array, w: Array, K: int) -> None:
        m, self.p = A.shape
        self.diagonal, self.beside = 2 * (w[:-1] + w[1:])[:, None], 2 * w[1:-1, None]
        self.squares = (A[:, :, None] * A[:, None, :]).reshape(m, -1)
        self.band = np.zeros((K, self.p, self.p + 1))

    def times(self, u: Array) -> Array:
        """P u."""
        bent = self.diagonal * u
        bent[:-1] -= self.beside * u[1:]
        bent[1:] -= self.beside * u[:-1]
        return bent

    def factor(self, d: Array) -> bool:
        """Whether the factors for d (K, m) are there."""
        from scipy.linalg import lapack

        band, p = self.band, self.p
        H = np.einsum("km,mj->kj", d, self.squares).reshape(
            -1, p, p
        )  # threads of BLAS cost more than they save
        band[:] = 0.0
        for b in range(p):
            band[:, b, : p - b] = H[:, b:, b]
        band[:, :, 0] += self.diagonal
        band[:-1, :, p] = -self.beside
        self.factors, bad = lapack.dpbtrf(band.reshape(-1, p + 1).T, lower=1, overwrite_ab=1)
        return not bad

    def solved(self, right: Array) -> Array:
        """The solution (K, p) of a right side."""
        from scipy.linalg import lapack

        found: Array = lapack.dpbtrs(self.factors, right.reshape(-1, 1), lower=1)[0].reshape(right.shape)
        return found


def _step(
    band: _Band, A: Array, s: Array, z: Array, d: Array, miss: Array, slope: Array, rc: Array
) -> tuple[Array, Array, Array]:
    """Newton's step towards s z + rc and everything else kept: of u, s and z."""
    du = band.solved((rc / s + d * miss) @ A - slope)
    ds = du @ A.T - miss
    return du, ds, (rc - z * ds) / s


def _reach(x: Array, dx: Array) -> float:
    """How far x > 0 may move along dx, at most 1."""
    ratio = float((-dx / x).max())
    return 1.0 if ratio <= 1.0 else 1.0 / ratio


def _short_of(A: Array, h: Array, q: Array, u: Array, z: Array, bent: Array) -> float:
    """The audit: how far (u, z) may be from the best, by weak duality and what is missing of stationarity.

    By their own numbers, whatever the method kept; relative to the value and one. Infinite outside.
    """
    slack = u @ A.T + h
    if z.min() < 0 or slack.min() < -10 * _CLOSE * max(1.0, float(abs(h).max())):
        return np.inf
    value = 0.5 * float((u * bent).sum()) + float((q * u).sum())
    left = float(abs(bent + q - z @ A).sum()) * 2 * float(abs(u).max())
    return (abs(float((slack * z).sum())) + left) / (1 + abs(value))
