"""Twists that turn with the fingers, for fingers on one part of a cubic each.

Fingers on parts of cubics turn with their places, and a twist y = (v, omega) of a load w is a polynomial of
degree 2 in the places t, from 0 to 1 along each part. What finger i does along it is at most s_i, a
polynomial of degree 2 in each place, where with the tangents T_i and normals N_i = J T_i

    s_i >= 0,    s_i |T_i| >= (v(t) + omega(t) J p_i) . g,    g = (N_i -+ mu T_i) / r, r N_i,

r the root of 1 + mu^2, by their coefficients in t^a (1 - t)^b. No placement at which

    sum_l (-w_l) . y_l(t) - limit sum_l sum_i s_il(t)

is above zero holds all loads w_l ("Twists that turn" of the documentation's page "Where to put the fingers").

Good twists are those along which edges of the cones of two fingers do no work: y is the cross product of
their wrenches, the turn about where the two lines meet. A matrix game mixes those of all loads, by weights
that change along the parts, and polynomials go near what it mixes at the 3^k places of ends and middles.
Then the s_i of the least sums of coefficients are sought, and the sum above is judged by its own.
"""

from functools import reduce
from itertools import combinations
from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS, digest
from regrasp.closed_form.compiled.places import simplex, turning_bounds
from regrasp.closed_form.compiled.places.simplex import play
from regrasp.closed_form.compiled.places.turning_bounds import (
    binomials,
    bounds_along,
    follow,
    room_to_follow,
)
from regrasp.compilation import kept

Array = np.ndarray[Any, np.dtype[np.float64]]

_SURE = 1e-9  # of the terms, more than rounding adds
_NOTHING = 1e-13  # of work, that rounding makes
_SMALL = 1e-3  # what fingers do along a twist of length 1 counts as more
_VARIED = 0.5  # of a weight, its change from the middle of a part to an end
_LEAST = 1e-9  # of the largest weight
_EDGES = 4  # of what a finger can do, besides 0: two of the cone, two at its largest normal force
_MOST = 400  # twists of loads in a game


def _bernstein(degree: int) -> Array:
    """(3, degree + 1) the values of Bernstein polynomials at both ends and the middle."""
    i, t = np.arange(degree + 1), np.array([[0.0], [0.5], [1.0]])
    return np.asarray(binomials(degree) * t**i * (1 - t) ** (degree - i), dtype=float)


_POINTS, _SLOPES = _bernstein(3), _bernstein(2)


def powers(k: int) -> np.ndarray:
    """(m, k) of the places, in each term of a polynomial: none, one, then two of them."""
    single = np.eye(k, dtype=int)
    both = [single[i] + single[j] for i in range(k) for j in range(i, k)]
    return np.vstack([np.zeros((1, k), int), single, both])


def room_to_turn(loads: int, k: int) -> tuple[Any, ...]:
    """Memory for it, and what it needs to know of polynomials."""
    nodes, pairs = 3**k, np.array(list(combinations(range(_EDGES * k), 2)))
    at = np.indices([3] * k).reshape(k, -1).T
    values = np.prod((at / 2)[:, None] ** powers(k), axis=2)
    slopes = _VARIED * (at - 1.0)
    one = np.array([[1.0, 0, 0], [-0.5, 2, -0.5], [0, 0, 1]])
    bent = reduce(np.kron, [one] * k)
    turns, most = 2 * len(pairs), min(_MOST, loads * nodes)
    rows = most * 2 * k
    return (
        pairs, at, np.ascontiguousarray(np.linalg.pinv(values)), bent, np.ascontiguousarray(bent @ values),
        np.ascontiguousarray(np.hstack([1 + slopes, 1 - slopes]).T),
        np.zeros((k, 3, 3 + _EDGES, 3)), np.zeros((turns, nodes, 3)), np.zeros((turns, nodes)),
        np.zeros((most, 2), np.int64), np.zeros((most, nodes)), np.zeros((rows, nodes)), np.zeros(rows),
        np.zeros((rows + 1, nodes + 1)), np.zeros(rows + nodes, np.int64), np.zeros(rows), np.zeros(nodes),
        np.zeros((loads, nodes, 3)), np.zeros((loads, 3, nodes)), np.zeros((loads, k, nodes)),
        room_to_follow(),
    )  # fmt: skip


@njit(**VIEWS)
def _wrenches(parts, mu, found):  # type: ignore[no-untyped-def]
    """Writes (k, 3, 7, 3) corners and edges of what fingers can do, as wrenches, at ends and middles.

    Corners are (n +- mu t) / r and r n; then the first two again, and what leads from r n to them.
    """
    slant = sqrt(1.0 + mu * mu)
    for i in range(len(parts)):
        for a in range(3):
            x, y, p, q = 0.0, 0.0, 0.0, 0.0
            for b in range(4):
                x += _POINTS[a, b] * parts[i, b, 0]
                y += _POINTS[a, b] * parts[i, b, 1]
            for b in range(3):
                p += _SLOPES[a, b] * (parts[i, b + 1, 0] - parts[i, b, 0])
                q += _SLOPES[a, b] * (parts[i, b + 1, 1] - parts[i, b, 1])
            length = sqrt(p * p + q * q)
            p, q = p / length, q / length
            f = found[i, a]
            for c in range(2):
                sign = mu if c == 0 else -mu
                f[c, 0], f[c, 1] = (-q + sign * p) / slant, (p + sign * q) / slant
                f[3 + c, 0], f[3 + c, 1] = f[c, 0], f[c, 1]
                f[5 + c, 0], f[5 + c, 1] = (f[c, 0] + slant * q) / mu, (f[c, 1] - slant * p) / mu
            f[2, 0], f[2, 1] = -slant * q, slant * p
            for c in range(7):
                f[c, 2] = x * f[c, 1] - y * f[c, 0]


@njit(**VIEWS)
def _turns(wrenches, pairs, at, twists, most):  # type: ignore[no-untyped-def]
    """Writes (2 c, 3^k, 3) twists of pairs of edges, both ways, and (2 c, 3^k) what fingers do at most."""
    count, nodes, k = len(pairs), len(at), len(wrenches)
    for c in range(count):
        i, e = pairs[c, 0] // 4, 3 + pairs[c, 0] % 4
        j, f = pairs[c, 1] // 4, 3 + pairs[c, 1] % 4
        for n in range(nodes):
            a, b, y = wrenches[i, at[n, i], e], wrenches[j, at[n, j], f], twists[c, n]
            y[0], y[1], y[2] = (
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            )
        y = twists[c, nodes // 2]
        per = 1.0 / (sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) + 1e-300)
        for n in range(nodes):
            for d in range(3):
                twists[c, n, d] *= per
                twists[count + c, n, d] = -twists[c, n, d]
            ahead, behind = 0.0, 0.0
            for m in range(k):
                most_on, most_back = 0.0, 0.0
                for d in range(3):
                    w = wrenches[m, at[n, m], d]
                    done = w[0] * twists[c, n, 0] + w[1] * twists[c, n, 1] + w[2] * twists[c, n, 2]
                    if abs(done) >= _NOTHING:
                        most_on, most_back = max(most_on, done), max(most_back, -done)
                ahead += most_on
                behind += most_back
            most[c, n], most[count + c, n] = ahead, behind


@njit(**VIEWS)
def _left(load, y, most):  # type: ignore[no-untyped-def]
    return load[0] * y[0] + load[1] * y[1] + load[2] * y[2] - most


@njit(**VIEWS)
def _best(loads, twists, most, chosen, best):  # type: ignore[no-untyped-def]
    """How many pairs of a load and a twist are written, of which each is the best at some place."""
    count, nodes = 0, twists.shape[1]
    for n in range(len(loads)):
        for a in range(nodes):
            best[0, a], best[1, a] = -1.0, -np.inf
        for c in range(len(twists)):
            some = False
            for a in range(nodes):
                some = some or _left(loads[n], twists[c, a], most[c, a]) > 0.0
            if some:
                for a in range(nodes):
                    share = _left(loads[n], twists[c, a], most[c, a]) / max(most[c, a], 1e-9)
                    if share > best[1, a]:
                        best[0, a], best[1, a] = c, share
        for a in range(nodes):
            seen = best[0, a] < 0.0
            for b in range(a):
                seen = seen or best[0, b] == best[0, a]
            if not seen and count < len(chosen):
                chosen[count, 0], chosen[count, 1] = n, int(best[0, a])
                count += 1
    return count


@njit(**VIEWS)
def _rows(loads, twists, most, chosen, count, weights, bent, left, gains, sizes):  # type: ignore[no-untyped-def]
    """Writes the gains of all pairs by all weights, their coefficients, of at most 1."""
    nodes, largest = twists.shape[1], 0.0
    for p in range(count):
        n, c = chosen[p]
        for a in range(nodes):
            left[p, a] = _left(loads[n], twists[c, a], most[c, a])
        for j in range(len(weights)):
            row, done = gains[p * len(weights) + j], 0.0
            for a in range(nodes):
                done += most[c, a] * weights[j, a]
            size = max(done / nodes, _SMALL)
            sizes[p * len(weights) + j] = size
            for b in range(nodes):
                total = 0.0
                for a in range(nodes):
                    if bent[b, a] != 0.0:
                        total += bent[b, a] * left[p, a] * weights[j, a]
                row[b] = total / size
                largest = max(largest, abs(row[b]))
    if largest > 0.0:
        for r in range(count * len(weights)):
            for b in range(nodes):
                gains[r, b] /= largest


@njit(**VIEWS)
def _mixed(twists, chosen, count, weights, shares, sizes, values):  # type: ignore[no-untyped-def]
    """Writes (L, 3^k, 3) the twists of each load at the places, mixed by shares of rows."""
    top = 0.0
    for r in range(count * len(weights)):
        shares[r] /= sizes[r]
        top = max(top, shares[r])
    for p in range(count):
        n, c = chosen[p]
        for j in range(len(weights)):
            share = shares[p * len(weights) + j]
            if share >= _LEAST * top:
                for a in range(twists.shape[1]):
                    for d in range(3):
                        values[n, a, d] += share * weights[j, a] * twists[c, a, d]


def _loop(digest: str) -> Any:
    @kept("the search for places", error_model="numpy", nogil=True, _nrt=False)
    def polynomial_twists(parts, mu, loads, polynomials, room):  # type: ignore[no-untyped-def]
        """Whether a box is excluded for forces of at most 1, by ``polynomials`` (L, 3 m + k 3^k).

        Of each load, 0 for one that does not count: terms of its twist, then coefficients of what each finger
        does at most. parts: (k, 4, 2) control points. loads: (L, 3) to be made.
        """
        _ = digest
        (
            pairs, at, through, bent, coefficients, weights, wrenches, twists, most, chosen, left, gains,
            sizes, table, names, shares, corners, values, own, bounds, follows,
        ) = room  # fmt: skip
        k, nodes, terms = len(parts), len(at), len(through)
        _wrenches(parts, mu, wrenches)
        _turns(wrenches, pairs, at, twists, most)
        count = _best(loads, twists, most, chosen, table)
        if count == 0:
            return False
        _rows(loads, twists, most, chosen, count, weights, bent, left, gains, sizes)
        if not play(gains, count * len(weights), 0.0, table, names, shares, corners) > 0.0:
            return False
        for n in range(len(loads)):
            for a in range(nodes):
                for d in range(3):
                    values[n, a, d] = 0.0
        _mixed(twists, chosen, count, weights, shares, sizes, values)
        for n in range(len(loads)):
            for d in range(3):
                for m in range(terms):
                    total = 0.0
                    for a in range(nodes):
                        total += through[m, a] * values[n, a, d]
                    polynomials[n, d * terms + m] = total
                for c in range(nodes):
                    own[n, d, c] = 0.0
                    for m in range(terms):
                        own[n, d, c] += coefficients[c, m] * polynomials[n, d * terms + m]
        for i in range(k):
            length = follow(parts[i], follows)
            for n in range(len(loads)):
                if not bounds_along(own[n], i, mu, length, follows, bounds[n, i]):
                    return False
        for c in range(nodes):
            gain, large = 0.0, 0.0
            for n in range(len(loads)):
                for d in range(3):
                    gain += loads[n, d] * own[n, d, c]
                    large += abs(loads[n, d] * own[n, d, c])
                for i in range(k):
                    gain -= bounds[n, i, c]
                    large += bounds[n, i, c]
            if not gain > _SURE * large:
                return False
        for n in range(len(loads)):
            for i in range(k):
                for c in range(nodes):
                    polynomials[n, 3 * terms + i * nodes + c] = bounds[n, i, c]
        return True

    return polynomial_twists


# Numba's cache watches this file only; the digest in the loop's closure makes it watch these, too.
polynomial_twists = _loop(digest((simplex, turning_bounds)))
