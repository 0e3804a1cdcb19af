"""The margin of a hold written for NumPy, from the paper's conditions and nothing of the toolkit's code.

In the frame of a pair (u from the first point to the second, p across), f_1 = (x, a) and f_2 = (-x - phi, b).
A margin is what |delta| leaves of its cone's half-angle; along x the direction delta turns one way only.
"""

from collections.abc import Iterator

import numpy as np

Array = np.ndarray
CHUNK = 16384
"""Pairs at a time, the fastest of powers of two: fewer cost calls, more leave the cache."""


def margins(
    points: Array, normals: Array, mu: Array, loads: Array, ratio: float, pairs: tuple[Array, Array]
) -> Array:
    """(O, P) widest least angle margins with forces up to ``ratio`` times the least peak; -1 for none."""
    result = np.full((len(loads), pairs[0].size), -1.0, dtype=np.float32)
    for begin in range(0, pairs[0].size, CHUNK):
        i, j = (each[begin : begin + CHUNK] for each in pairs)
        line = points[j] - points[i]
        length = np.hypot(*line.T)
        u = line / length[:, None]
        first, second = (
            ((normals[k] * u).sum(axis=1), normals[k, 1] * u[:, 0] - normals[k, 0] * u[:, 1], mu[k])
            for k in (i, j)
        )
        edges1, edges2 = list(_edges(*first)), list(_edges(*second))
        lever1, lever2 = points[i] / length[:, None], points[j] / length[:, None]
        for o, (fx, fy) in enumerate(loads):
            phi = u[:, 0] * fx + u[:, 1] * fy
            a, b = lever2[:, 1] * fx - lever2[:, 0] * fy, lever1[:, 0] * fy - lever1[:, 1] * fx
            lo1, hi1 = _interval(edges1, a)
            lo2, hi2 = _interval(edges2, b)
            lo, hi = np.maximum(lo1, -phi - hi2), np.minimum(hi1, -phi - lo2)
            holds = np.flatnonzero(lo <= hi)
            if holds.size:
                sides = [tuple(v[holds] for v in side) for side in (first, second)]
                result[o, begin + holds] = _widest(
                    lo[holds], hi[holds], phi[holds], a[holds], b[holds], ratio, *sides
                )
    return result


def _edges(c: Array, s: Array, mu: Array) -> Iterator[tuple[Array, Array, Array]]:
    """(bound per a, 0 or -inf, 0 or inf) of the two sides of a cone of normal (c, s).

    A side asks slope x + offset a >= 0. No orientation changes its bound per a, nor whether that is one from
    below or from above; what it is not is infinite.
    """
    for slope, offset in ((mu * c + s, mu * s - c), (mu * c - s, mu * s + c)):
        yield -offset / slope, np.where(slope > 0, 0.0, -np.inf), np.where(slope < 0, 0.0, np.inf)


def _interval(edges: list[tuple[Array, Array, Array]], across: Array) -> tuple[Array, Array]:
    (per1, below1, above1), (per2, below2, above2) = edges
    bound1, bound2 = per1 * across, per2 * across
    return np.maximum(bound1 + below1, bound2 + below2), np.minimum(bound1 + above1, bound2 + above2)


def _widest(lo, hi, phi, a, b, ratio, first, second):
    # The least peak, and the squeezes within ratio times of it.
    x1, x2 = np.clip(0.0, lo, hi), np.clip(-phi, lo, hi)
    with np.errstate(divide="ignore", invalid="ignore"):
        equal = np.clip(0.5 * ((a - b) * (a + b) / phi - phi), np.minimum(x1, x2), np.maximum(x1, x2))
    squares = [np.maximum(x**2 + a**2, (x + phi) ** 2 + b**2) for x in (x1, x2, equal)]
    square = ratio**2 * np.fmin.reduce(squares)
    reach1, reach2 = (np.sqrt(np.maximum(square - across**2, 0.0)) for across in (a, b))
    lo, hi = np.maximum.reduce([lo, -reach1, -phi - reach2]), np.minimum.reduce([hi, reach1, reach2 - phi])
    # A force inside its cone is nearest to upright where T = 0 or, if N < 0 there, farthest from there.
    (c1, s1, mu1), (c2, s2, mu2) = first, second
    lines1 = (c1, s1 * a, -s1, c1 * a)
    lines2 = (-c2, s2 * b - c2 * phi, s2, c2 * b + s2 * phi)
    tops = []
    with np.errstate(divide="ignore", invalid="ignore"):
        for p, q, slope, offset in (lines1, lines2):
            top = -offset / slope
            away = np.where(top < lo, hi, lo)
            tops.append(np.where(np.isnan(top), lo, np.where(p * top + q < 0, away, np.clip(top, lo, hi))))

    def least(x: Array) -> Array:
        return np.minimum(
            *(
                np.arctan(mu) - np.arctan2(abs(g * x + h), p * x + q)
                for (p, q, g, h), mu in ((lines1, mu1), (lines2, mu2))
            )
        )

    # It is widest where one force is upright or, between these places, where both margins are equal: there
    # (N_1, |T_1|) is parallel to (N_2, |T_2|) turned by alpha_1 - alpha_2.
    middle = 0.5 * (tops[0] + tops[1])
    (p1, q1, g1, h1), (p2, q2, g2, h2) = (
        (p, q, sign * g, sign * h)
        for p, q, g, h in (lines1, lines2)
        for sign in (np.where(g * middle + h < 0, -1.0, 1.0),)
    )
    k, d = 1 + mu1 * mu2, mu1 - mu2
    n, n0, t, t0 = k * p2 - d * g2, k * q2 - d * h2, d * p2 + k * g2, d * q2 + k * h2
    square, linear, constant = n * g1 - t * p1, n * h1 + n0 * g1 - t * q1 - t0 * p1, n0 * h1 - t0 * q1
    root = np.sqrt(np.maximum(linear**2 - 4 * square * constant, 0.0))
    half = -0.5 * (linear + np.copysign(root, linear))
    widest = np.maximum(least(tops[0]), least(tops[1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        for x in (half / square, constant / half):
            between = np.clip(np.where(np.isnan(x), middle, x), np.minimum(*tops), np.maximum(*tops))
            widest = np.maximum(widest, least(between))
    return np.maximum(widest, 0.0)
