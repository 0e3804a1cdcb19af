"""Every direction of a load that two contacts can hold, in closed form, for arrays of pairs.

A force through the origin is held by two contacts if forces along the four edges e_k of their cones, none of
them negative, sum to its opposite without torque. With the torques t_k = r x e_k these sums are the convex
cone of

    |t_l| e_k + |t_k| e_l    for edges whose torques have opposite signs,    e_k    where t_k = 0,

in the plane: nothing, a ray, a line, a wedge, a half-plane or everything. Nothing is divided by the distance
of the contacts, so edges along their line are no exception. Narrower cones hold fewer loads: the arcs are
nested.

The widest narrowing under which a pair holds any load at all: with sigma_i the sign of r_i x n_i and beta_i
the angle of n_i to the line through the origin,

    min(alpha_1, alpha_2)                                         if sigma_1 sigma_2 <= 0,
    min(alpha_1, alpha_2, max_i(alpha_i - |beta_i|))              else:

contacts that turn the object the same way hold only what one of them can hold alone.
"""

from math import pi

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Torques and sums below this fraction of their terms are zero; angles this near to pi are pi.
_ZERO = 1e-12
_CELLS = 2**15  # pairs of a block
_PAIRS = tuple((k, m) for k in range(3) for m in range(k + 1, 4))

NOTHING, ARC, LINE = 0, 1, 2
"""What a pair holds: no load; an arc of directions, from a ray to everything; two opposite rays."""


def load_arcs(
    r1: Array, n1: Array, mu1: Array, r2: Array, n2: Array, mu2: Array
) -> tuple[NDArray[np.int8], Array, Array]:
    """(kind, begin, length) of the directions of loads that pairs of contacts hold.

    r, n: (m, 2) positions from the point through which loads go, unit normals. mu: (m,). begin, length: (m,)
    [rad], counter-clockwise from the x axis; a length of 2 pi is everything, a line is begin and begin + pi.
    """
    edges, torques = _edges(r1, n1, mu1, r2, n2, mu2)
    angles, valid = _generators(edges, torques)
    kind = np.where(valid.any(axis=1), ARC, NOTHING).astype(np.int8)
    first = angles[np.arange(len(angles)), valid.argmax(axis=1)]
    around = np.sort(np.where(valid, angles, first[:, None]) % (2 * pi), axis=1)
    gaps = np.diff(around, axis=1, append=around[:, :1] + 2 * pi)
    k = gaps.argmax(axis=1)
    row = np.arange(len(k))
    gap, begin = gaps[row, k], around[row, (k + 1) % around.shape[1]]
    length = np.where(gap < pi - _ZERO, 2 * pi, 2 * pi - gap)
    inside = (around - begin[:, None] + _ZERO) % (2 * pi) - _ZERO
    ends_only = (np.minimum(inside, abs(inside - pi)) <= _ZERO).all(axis=1)
    kind[(abs(gap - pi) <= _ZERO) & ends_only & (kind == ARC)] = LINE
    return kind, begin, np.where(kind == ARC, length, 0.0)


def turning_sides(r: Array, n: Array, mu: Array) -> tuple[Array, Array]:
    """(m,) which way forces along the normals turn the object, -1, 0 or 1, and (m,) alpha - |beta| [rad]."""
    torque, along = _cross(r, n), abs((r * n).sum(axis=-1))
    size = np.hypot(r[..., 0], r[..., 1])
    side = np.where(abs(torque) <= _ZERO * size, 0.0, np.sign(torque))
    return side, np.arctan(mu) - np.arctan2(abs(torque), along)


def widest_narrowings(side: Array, alone: Array, alpha: Array) -> Array:
    """(V, V) by how much cones of every two contacts may be narrowed while they hold any load [rad].

    -1 where they hold none. side, alone: (V,) of ``turning_sides``; alpha: (V,) half-angles of cones [rad].
    Contacts are taken by their side, a block that stays in the cache at a time.
    """
    count = len(side)
    result = np.empty((count, count))
    alone = np.where(alone >= 0, alone, -1.0)
    size = max(_CELLS // count, 1)
    for sign in (-1.0, 0.0, 1.0):
        shared = np.where((side == sign) & (sign != 0), alone, np.inf)  # with the others: no condition
        places = np.flatnonzero(side == sign)
        for begin in range(0, places.size, size):
            some = places[begin : begin + size]
            block = np.maximum(shared, alone[some, None])
            np.minimum(block, alpha, out=block)
            np.minimum(block, alpha[some, None], out=block)
            result[some] = block
    return result


def widest_load(r1: Array, n1: Array, r2: Array, n2: Array) -> Array:
    """(m,) direction [rad] of the load that forces along both normals hold, their torques being opposite."""
    t1, t2 = abs(_cross(r1, n1))[..., None], abs(_cross(r2, n2))[..., None]
    total = -(t2 * n1 + t1 * n2)
    return np.arctan2(total[..., 1], total[..., 0])


def _cross(a: Array, b: Array) -> Array:
    result: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return result


def _edges(r1: Array, n1: Array, mu1: Array, r2: Array, n2: Array, mu2: Array) -> tuple[Array, Array]:
    """(m, 4, 2) edges of both cones and (m, 4) their torques, zero where rounding decides."""
    edges, torques = [], []
    for r, n, mu in ((r1, n1, mu1), (r2, n2, mu2)):
        across = mu[:, None] * np.stack([-n[:, 1], n[:, 0]], axis=-1)
        for edge in (n + across, n - across):
            torque = _cross(r, edge)
            size = np.hypot(*r.T) * np.hypot(*edge.T)
            edges.append(edge)
            torques.append(np.where(abs(torque) <= _ZERO * size, 0.0, torque))
    return np.stack(edges, axis=1), np.stack(torques, axis=1)


def _generators(edges: Array, torques: Array) -> tuple[Array, NDArray[np.bool_]]:
    """(m, 10) directions of loads whose cone is all that is held, and which of them are there."""
    angles = np.zeros((len(edges), 4 + len(_PAIRS)))
    valid = np.zeros(angles.shape, dtype=np.bool_)
    valid[:, :4] = torques == 0
    angles[:, :4] = np.arctan2(-edges[..., 1], -edges[..., 0])
    for place, (k, m) in enumerate(_PAIRS, 4):
        a, b = abs(torques[:, m, None]) * edges[:, k], abs(torques[:, k, None]) * edges[:, m]
        total = a + b
        there = torques[:, k] * torques[:, m] < 0
        valid[:, place] = there & (abs(total).sum(axis=1) > _ZERO * (abs(a) + abs(b)).sum(axis=1))
        angles[:, place] = np.arctan2(-total[:, 1], -total[:, 0])
    return angles, valid
