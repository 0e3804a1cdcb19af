"""The least of a support function over all directions of six dimensions, found and proven.

W is a convex set around the origin, h(u) = max over w in W of u . w, and |D u| a length with D diagonal, ones
and zeros. Sought is min h(u) / |D u|: with D = 1 the radius of the largest ball about the origin inside W.

Directions are covered by simplicial cones of unit vectors v_0 ... v_5. For any w in W and any u = sum c_k
v_k, c >= 0, h(u) >= w . u = sum c_k w . v_k, and |D u| <= sum c_k |D v_k|; so w . v_k >= b |D v_k| at the
six corners proves h >= b |D u| on the whole cone. The best w for a cone is a game between w and weights of
the corners, played a few rounds; a cone that stays open is split between the two corners that matter most,
now and then along its longest edge, so that all become small.

W is given by parts: fingers i of h_i(u) = max(0, a_i . u + |T_i u|), a circular cone cut off at its normal
limit; their sum (each finger limited) or their largest (the total limited).
"""

from math import sqrt

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import INNER
from regrasp.compilation import kept

_ROUNDS = 5
_STACK = 4000
_FLOOR = 0.02  # weight of a corner that the game does not need, for the choice of a split
_LONGEST = 16
"""Each so many splits the longest edge is halved: else a cone may become flat between two edges for ever."""
SETTLED = 1e-9


@njit(**INNER)
def _split(corners, weights, longest):  # type: ignore[no-untyped-def]
    """The edge to halve: long, and between corners that the game needed; or the longest of all."""
    a, b, most = 0, 1, -1.0
    for i in range(6):
        for j in range(i):
            square = 0.0
            for k in range(6):
                square += (corners[i, k] - corners[j, k]) ** 2
            matters = square
            if not longest:
                matters *= sqrt(square) * max(weights[i], _FLOOR) * max(weights[j], _FLOOR)
            if matters > most:
                a, b, most = i, j, matters
    return a, b


@njit(**INNER)
def _clear(w):  # type: ignore[no-untyped-def]
    for k in range(6):
        w[k] = 0.0


@njit(**INNER)
def _copy(source, target):  # type: ignore[no-untyped-def]
    for k in range(6):
        target[k] = source[k]


@njit(**INNER)
def _length(metric, u):  # type: ignore[no-untyped-def]
    square = 0.0
    for k in range(6):
        square += metric[k] * u[k] * u[k]
    return sqrt(square)


@njit(**INNER)
def _least_room(corners, w, lengths, bound):  # type: ignore[no-untyped-def]
    """Least over corners of w . v_k - bound |D v_k|, and the corner."""
    least, worst = np.inf, 0
    for k in range(6):
        value = -bound * lengths[k]
        for j in range(6):
            value += w[j] * corners[k, j]
        if value < least:
            least, worst = value, k
    return least, worst


@njit(error_model="numpy")
def support(axes, tangents, total, u, w, across):  # type: ignore[no-untyped-def]
    """h(u), and in ``w`` the point of W that reaches it. axes: (n, 6) a_i. tangents: (n, q, 6) T_i."""
    n, q = tangents.shape[0], tangents.shape[1]
    _clear(w)
    reached = 0.0
    for i in range(n):
        value = 0.0
        for k in range(6):
            value += axes[i, k] * u[k]
        square = 0.0
        for j in range(q):
            x = 0.0
            for k in range(6):
                x += tangents[i, j, k] * u[k]
            across[j] = x
            square += x * x
        length = sqrt(square)
        value += length
        if value <= 0.0 or (total and value <= reached):
            continue
        if total:
            _clear(w)
            reached = 0.0
        reached += value
        scale = 1.0 / length if length > 0.0 else 0.0
        for k in range(6):
            x = axes[i, k]
            for j in range(q):
                x += tangents[i, j, k] * across[j] * scale
            w[k] += x
    return reached


@kept("the radius of the wrench ball", error_model="numpy")
def descend(axes, tangents, total, metric, starts, steps):  # type: ignore[no-untyped-def]
    """The least h(u) / |D u| that descents from ``starts`` (s, 6) find, and its u. metric: (6,) of D."""
    best, found = np.inf, starts[0].copy()
    w, other, across = np.zeros(6), np.zeros(6), np.zeros(tangents.shape[1])
    for start in starts:
        u = start / sqrt((start**2).sum())
        size = _length(metric, u)
        if size == 0.0:
            continue
        value, step = support(axes, tangents, total, u, w, across) / size, 0.3
        for _ in range(steps):
            slope = w - value * metric * u / size
            slope = slope - (slope * u).sum() * u
            length = sqrt((slope**2).sum())
            if length == 0.0 or step < SETTLED:
                break
            v = u - step * slope / length
            v /= sqrt((v**2).sum())
            size_v = _length(metric, v)
            moved = support(axes, tangents, total, v, other, across) / size_v if size_v > 0.0 else np.inf
            if moved < value:
                u, value, size, step = v, moved, size_v, 1.2 * step
                w[:] = other
            else:
                step *= 0.5
        if value < best:
            best, found = value, u.copy()
    return best, found


@kept("the radius of the wrench ball", error_model="numpy")
def prove(axes, tangents, total, metric, start, gap, most):  # type: ignore[no-untyped-def]
    """(best, u, cones, done): that no direction is below (1 - gap) best, after at most ``most`` cones.

    start: the u of a known value. Depth first, from the 64 cones of the coordinates' signs.
    """
    cones, given = np.zeros((_STACK, 6, 6)), np.zeros((_STACK, 6))
    w, mixed, kept, c, across = (
        np.zeros(6),
        np.zeros(6),
        np.zeros(6),
        np.zeros(6),
        np.zeros(tangents.shape[1]),
    )
    weights, used, lengths = np.zeros(6), np.zeros(6), np.zeros(6)
    found = start.copy()
    best = support(axes, tangents, total, found, w, across) / _length(metric, found)
    depths = np.zeros(_STACK, dtype=np.int64)
    top, looked = 64, 0
    for signs in range(64):
        for k in range(6):
            cones[signs, k, k] = 1.0 if (signs >> k) & 1 else -1.0
    while top > 0:
        top -= 1
        looked += 1
        if looked > most or top > _STACK - 2:
            return best, found, looked, False
        corners = cones[top]
        for k in range(6):
            lengths[k] = _length(metric, corners[k])
        bound = best * (1.0 - gap)
        if _least_room(corners, given[top], lengths, bound)[0] >= 0.0:
            continue
        closed, deepest = False, -np.inf
        for k in range(6):
            weights[k] = 1.0 / 6.0
        for rounds in range(_ROUNDS):
            flat = 0.0
            for k in range(6):
                used[k] = weights[k]
                flat += weights[k] * lengths[k]
                c[k] = 0.0
                for j in range(6):
                    c[k] += weights[j] * corners[j, k]
            value = support(axes, tangents, total, c, w, across)
            size = _length(metric, c)
            if size > 0.0 and value < best * size:
                best, found = value / size, c / sqrt((c**2).sum())
                bound = best * (1.0 - gap)
            if value < bound * flat:
                break  # no w of W serves all corners
            least, worst = _least_room(corners, w, lengths, bound)
            if least > deepest:
                deepest = least
                _copy(w, kept)
            if rounds == 0:
                _copy(w, mixed)
            else:  # means of points of W lie in W
                for k in range(6):
                    mixed[k] += 0.5 * (w[k] - mixed[k])
                together, _ = _least_room(corners, mixed, lengths, bound)
                if together > deepest:
                    deepest = together
                    _copy(mixed, kept)
            if deepest >= 0.0:
                closed = True
                break
            for k in range(6):
                weights[k] *= 0.5
            weights[worst] += 0.5
        if closed:
            continue
        a, b = _split(corners, used, depths[top] % _LONGEST == _LONGEST - 1)
        square = 0.0
        for k in range(6):
            c[k] = corners[a, k] + corners[b, k]
            square += c[k] * c[k]
        for k in range(6):
            for j in range(6):
                cones[top + 1, j, k] = corners[j, k]
            corners[a, k] = c[k] / sqrt(square)
            cones[top + 1, b, k] = corners[a, k]
        _copy(kept, given[top])
        _copy(kept, given[top + 1])
        depths[top] += 1
        depths[top + 1] = depths[top]
        top += 2
    return best, found, looked, True
