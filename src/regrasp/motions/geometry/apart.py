"""How far two capsules' axes are apart."""

import numpy as np

from regrasp.mechanics.checks import Array


def apart(p: Array, u: Array, q: Array, v: Array) -> Array:
    """How far segments p + s u and q + t v, 0 <= s, t <= 1, are apart (...) [m]; all (..., d) broadcast.

    The least of |w + s u - t v|^2, w = p - q, is inside or on one of four sides; u and v may be zero.
    """
    w = p - q
    uu, vv, uv = _dot(u, u), _dot(v, v), _dot(u, v)
    uw, vw = _dot(u, w), _dot(v, w)
    det = uu * vv - uv * uv
    flat = det <= 1e-14 * uu * vv  # parallel, or a point: a side is as near
    s = np.where(flat, 0.0, (uv * vw - vv * uw) / np.where(flat, 1.0, det))
    t = np.where(flat, 0.0, (uu * vw - uv * uw) / np.where(flat, 1.0, det))
    inside = ~flat & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    found = [np.where(inside, _length(w, s, u, t, v), np.inf)]
    for end in (0.0, 1.0):
        e = np.full(np.shape(uu * vv * uw), end)
        found.append(_length(w, e, u, _clipped(vw + end * uv, vv), v))
        found.append(_length(w, _clipped(end * uv - uw, uu), u, e, v))
    result: Array = np.minimum.reduce(found)
    return result


def _dot(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=-1))


def _clipped(top: Array, square: Array) -> Array:
    return np.asarray(np.clip(top / np.where(square == 0, 1.0, square), 0.0, 1.0) * (square != 0))


def _length(w: Array, s: Array, u: Array, t: Array, v: Array) -> Array:
    result: Array = np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)
    return result
