"""Measures of an answer from the data of its program, in loops compiled by Numba. Imported when needed."""

from math import nan, sqrt
from typing import NamedTuple

import numpy as np

from regrasp.compilation import kept
from regrasp.programs.program import Array, Program


class Audit(NamedTuple):
    """Absolute measures of an answer (x, z); |.| is the largest entry, ||.|| the length.

    slack_violation, ray_violation: distance of b - A x and of -A x to K. dual_violation: distance of z to K*.
    stationarity: |P x + q + A'z|. ax, px, az: |A x|, |P x|, |A'z|. xpx, qx, bz: x'P x, q'x, b'z.
    x_length, px_length, z_length, q_length, b_length: ||x||, ||P x||, ||z||, ||q||, ||b||. p, a, q, b, z: the
    largest entry of each. Everything is NaN where the answer is not finite.
    """

    slack_violation: float
    ray_violation: float
    dual_violation: float
    stationarity: float
    ax: float
    px: float
    az: float
    xpx: float
    qx: float
    bz: float
    x_length: float
    px_length: float
    z_length: float
    q_length: float
    b_length: float
    p: float
    a: float
    q: float
    b: float
    z: float


_NOTHING = (nan,) * len(Audit._fields)


def audited(program: Program, x: Array, z: Array) -> Audit:
    """The measures of an answer x (n,), z (m,)."""
    p, a = program.P, program.A
    data = p.indptr, p.indices, p.data, program.q, a.indptr, a.indices, a.data, program.b
    return Audit(*_measures(*data, program.codes, x, z))


@kept()
def _product(indptr, indices, data, x, rows):  # type: ignore[no-untyped-def]
    result = np.zeros(rows)
    for j in range(x.size):
        for k in range(indptr[j], indptr[j + 1]):
            result[indices[k]] += data[k] * x[j]
    return result


@kept()
def _largest(values):  # type: ignore[no-untyped-def]
    worst = 0.0
    for value in values:
        worst = max(worst, abs(value))
    return worst


@kept()
def _violation(codes, s, dual):  # type: ignore[no-untyped-def]
    """Distance of s to K, or to K*; the zero cone's dual is everything, the others are their own."""
    worst, row = 0.0, 0
    for kind, size, count in codes:
        for _ in range(count):
            if kind == 2:
                squares = 0.0
                for i in range(row + 1, row + size):
                    squares += s[i] * s[i]
                off = sqrt(squares) - s[row]
                worst = max(worst, off)
            else:
                for i in range(row, row + size):
                    off = -s[i] if kind == 1 else (0.0 if dual else abs(s[i]))
                    worst = max(worst, off)
            row += size
    return worst


@kept()
def _measures(pp, pi, pd, q, ap, ai, ad, b, codes, x, z):  # type: ignore[no-untyped-def]
    if not (np.isfinite(x).all() and np.isfinite(z).all()):
        return _NOTHING
    n, m = q.size, b.size
    px, ax = _product(pp, pi, pd, x, n), _product(ap, ai, ad, x, m)
    az, stationarity = 0.0, 0.0
    for j in range(n):
        total = 0.0
        for k in range(ap[j], ap[j + 1]):
            total += ad[k] * z[ai[k]]
        az = max(az, abs(total))
        stationarity = max(stationarity, abs(px[j] + q[j] + total))
    return (
        _violation(codes, b - ax, False),
        _violation(codes, -ax, False),
        _violation(codes, z, True),
        stationarity,
        _largest(ax),
        _largest(px),
        az,
        (x * px).sum(),
        (q * x).sum(),
        (b * z).sum(),
        sqrt((x * x).sum()),
        sqrt((px * px).sum()),
        sqrt((z * z).sum()),
        sqrt((q * q).sum()),
        sqrt((b * b).sum()),
        _largest(pd),
        _largest(ad),
        _largest(q),
        _largest(b),
        _largest(z),
    )
