"""All loads together, for fingers anywhere on arcs of straight sides: twists of the loads against places.

One load alone bounds a box as if fingers could be elsewhere for each load. Twists y_l of all loads exclude it
where, h(y; p) the most work of a finger at p,

    sum_l b_l . y_l - sum_i max over p of sum_l h(y_l; p) > 0:

a finger has one place for all of them. The sum in it is convex along a side, so ends of sides tell.

Against the twists stand shares of places, alike for all loads: a finger in parts, whose forces at a place
have its share of the limit. If such fingers hold all loads, no twists exclude the box. Else the best twists
against them (a dual simplex method as in ``wrench_gauge``) join a linear program, whose multipliers are the
next shares; and places where its twists let fingers do more than it knows join it, too.
"""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS, digest
from regrasp.closed_form.compiled.places import (
    cubic_arcs,
    eroded,
    placement_boxes,
    simplex,
    twist_weights,
    wrench_gauge,
)
from regrasp.closed_form.compiled.places.eroded import add_middle
from regrasp.closed_form.compiled.places.placement_boxes import too_near
from regrasp.closed_form.compiled.places.twist_weights import mix
from regrasp.closed_form.compiled.places.wrench_gauge import ERODED, row_that_leaves, solved, support_of_arc
from regrasp.compilation import kept

LEFT, GONE, NEAR = 0, 1, 2
"""A box that is not excluded; one that is; and one without fingers as far apart as they must be."""
_ROUNDS, _ROWS = 6, 96  # of twists, at most
_PLACES = 12  # of a finger
_JOINS = 12  # of places to one linear program
_MOST = 80
_ARTIFICIAL = 1e9
_CLOSE = 1e-7
_SURE = 1e-9  # of the terms, more than rounding adds
_WHOLE = 0.05  # of how far places differ, that counts where forces press alike


@njit(**VIEWS)
def _most(sides, law, level, j, u, y, out):  # type: ignore[no-untyped-def]
    """The most work of a finger at one place, and its force in ``out``."""
    support_of_arc(sides, j, j, u, u, law, y, out)
    if law[1] == ERODED:
        return out[0]
    for c in range(3, 7):
        out[c] *= level
    return level * max(out[0], 0.0)


@njit(**VIEWS)
def _against(sides, law, level, b, at, us, shares, count, pressed, x, work):  # type: ignore[no-untyped-def]
    """Whether fingers in parts do not hold a load; the best twist against them, of size 1, in ``best``.

    pressed: (4, k, S) normal forces behind rows, x_j of each of which hold it, or what can be held of it.
    """
    g, d, spare, y, new, best, middle, target, out = work
    k, lower = len(count), 0.0
    for c in range(3):
        middle[c], target[c], best[c] = 0.0, b[c], 0.0
    if law[1] == ERODED:
        for i in range(k):
            for s in range(count[i]):
                new[0] = new[1] = new[2] = 0.0
                add_middle(sides, at[i, s], at[i, s], us[i, s], us[i, s], law, new)
                for c in range(3):
                    middle[c] += shares[i, s] * new[c]
        for c in range(3):
            target[c] -= middle[c]
    for c in range(3):
        for e in range(3):
            g[c, e] = 0.0
        g[c, c] = (1.0 if target[c] >= 0.0 else -1.0) / _ARTIFICIAL
        for i in range(k):
            for s in range(count[i]):
                pressed[c, i, s] = 0.0
    for _ in range(_MOST):
        if not solved(g, target, y, x):
            break
        upper = target[0] * y[0] + target[1] * y[1] + target[2] * y[2]
        if upper <= 1.0:
            return False
        h = -(middle[0] * y[0] + middle[1] * y[1] + middle[2] * y[2])
        for c in range(3):
            new[c] = -middle[c]
        for i in range(k):
            for s in range(count[i]):
                share = shares[i, s]
                pressed[3, i, s] = 0.0
                if share > 0.0:
                    h += share * _most(sides, law, level, at[i, s], us[i, s], y, out)
                    pressed[3, i, s] = share * out[6]
                    for c in range(3):
                        new[c] += share * out[3 + c]
        if not h > 0.0 or upper > lower * h:
            lower = upper / h if h > 0.0 else np.inf
            for c in range(3):
                best[c] = y[c]
        if h <= 1.0 or lower >= upper * (1.0 - _CLOSE):
            break
        leaving = row_that_leaves(g, new, x, spare, d)
        if leaving < 0:
            break
        for c in range(3):
            g[leaving, c] = new[c]
        for i in range(k):
            for s in range(count[i]):
                pressed[leaving, i, s] = pressed[3, i, s]
    size = max(abs(best[0]), abs(best[1]), abs(best[2]))
    for c in range(3):
        best[c] /= size if size > 0.0 else 1.0
    return lower > 1.0 + _SURE


@njit(**VIEWS)
def _see(sides, at, us, count, pressed, x, means, seen):  # type: ignore[no-untyped-def]
    """Widens ``seen`` (k, 5, 2) by where forces press: u, points and normals."""
    for i in range(len(count)):
        total = 0.0
        for c in range(5):
            means[c] = 0.0
        for s in range(count[i]):
            weight, j = 0.0, at[i, s]
            for r in range(3):
                weight += max(x[r], 0.0) * pressed[r, i, s]
            along = us[i, s] - sides[j, 8]
            total += weight
            means[0] += weight * us[i, s]
            for c in range(2):
                means[1 + c] += weight * (sides[j, c] + along * sides[j, 2 + c])
                means[3 + c] += weight * sides[j, 4 + c]
        if total > 0.0:
            for c in range(5):
                seen[i, c, 0] = min(seen[i, c, 0], means[c] / total)
                seen[i, c, 1] = max(seen[i, c, 1], means[c] / total)


@njit(**VIEWS)
def _everywhere(sides, arcs, ends, i, law, level, twists, y, out, best):  # type: ignore[no-untyped-def]
    """The most of a finger along twists of all loads at one place of its arc; side and u in ``best``."""
    most = -np.inf
    for j in range(arcs[i, 0], arcs[i, 1] + 1):
        for end in range(2):
            u = sides[j, 6 + end]
            if end == 0 and j == arcs[i, 0]:
                u = ends[i, 0]
            elif end == 1 and j == arcs[i, 1]:
                u = ends[i, 1]
            done = 0.0
            for n in range(len(twists)):
                for c in range(3):
                    y[c] = twists[n, c]
                if y[0] != 0.0 or y[1] != 0.0 or y[2] != 0.0:
                    done += _most(sides, law, level, j, u, y, out)
            if done > most:
                most, best[0], best[1] = done, j, u
    return most


def room_for_all(loads: int, k: int) -> tuple[Any, ...]:
    """Memory for it."""
    rows = min(_ROUNDS * loads, _ROWS)
    columns = rows + k + 1
    return (
        np.zeros((k, _PLACES), np.int64), np.zeros((k, _PLACES)), np.zeros((k, _PLACES)),
        np.zeros(k, np.int64), np.zeros((4, k, _PLACES)), np.zeros(3), np.zeros(5),
        np.zeros((rows, 3)), np.zeros(rows, np.int64), np.zeros(rows), np.zeros(rows),
        np.zeros((rows, k, _PLACES)), np.zeros(rows), np.zeros((k * _PLACES + 2, columns)),
        np.zeros(columns + k * _PLACES + 2, np.int64),
        (np.zeros((3, 3)), *(np.zeros(3) for _ in range(7)), np.zeros(7)),
    )  # fmt: skip


def _loop(digest: str) -> Any:
    @kept("the search for places", error_model="numpy", nogil=True, _nrt=False)
    def joined(sides, loads, law, level, arcs, ends, least, twists, seen, spread, room):  # type: ignore[no-untyped-def]
        """Whether a box is excluded (``GONE``), by ``twists`` (L, 3) of all loads, or ``NEAR``.

        sides, loads, law: as of ``placement_search``, of straight sides. level: of the largest force. least:
        distance of fingers. seen: (k, 5, 2) least and largest of where forces press, under all loads: u,
        points, normals. spread: (k,) by how much that differs, and places on the arc for a little.
        """
        _ = digest
        if least > 0.0 and too_near(sides, arcs, ends, least):
            return NEAR
        mu, _, size, norm, _, limit, margin = law
        bounding = (mu, size, norm, limit, margin)
        (
            at, us, shares, count, pressed, x, means, rows, of, gains, lifted, most, weights, table, names,
            work,
        ) = room  # fmt: skip
        best, out, y = work[5], work[8], work[3]
        k, made = len(arcs), 0
        for i in range(k):
            first, last = arcs[i]
            one = first == last
            count[i] = 2 if one else 3
            at[i, 0], us[i, 0], at[i, 1], us[i, 1] = first, ends[i, 0], last, ends[i, 1]
            middle = (first + last) // 2
            at[i, 2], us[i, 2] = middle, max(sides[middle, 6], ends[i, 0])
            shares[i, 0] = shares[i, 1] = 0.5 if one else 0.25
            shares[i, 2] = 0.5
        for _round in range(_ROUNDS):
            before = made
            for i in range(k):
                for c in range(5):
                    seen[i, c, 0], seen[i, c, 1] = np.inf, -np.inf
            for n in range(len(loads)):
                lacks = _against(sides, bounding, level, loads[n], at, us, shares, count, pressed, x, work)
                _see(sides, at, us, count, pressed, x, means, seen)
                if not lacks or made == len(rows):
                    continue
                of[made], gains[made] = n, 0.0
                for c in range(3):
                    rows[made, c] = best[c]
                    gains[made] += loads[n, c] * best[c]
                for i in range(k):
                    for s in range(count[i]):
                        most[made, i, s] = _most(sides, bounding, level, at[i, s], us[i, s], rows[made], out)
                made += 1
            if made == before:
                break
            for _join in range(_JOINS):
                if mix(gains, most, made, count, lifted, weights, shares, table, names) <= _SURE:
                    break
                for n in range(len(loads)):
                    for c in range(3):
                        twists[n, c] = 0.0
                left, terms, known = 0.0, 0.0, True
                for j in range(made):
                    left += weights[j] * gains[j]
                    terms += weights[j] * abs(gains[j])
                    for c in range(3):
                        twists[of[j], c] += weights[j] * rows[j, c]
                for i in range(k):
                    done = _everywhere(sides, arcs, ends, i, bounding, level, twists, y, out, means)
                    left -= done
                    terms += abs(done)
                    s = 0
                    while s < count[i] and not (at[i, s] == int(means[0]) and us[i, s] == means[1]):
                        s += 1
                    if s < count[i]:
                        continue
                    known = False
                    if s < _PLACES:
                        count[i] += 1
                    else:  # in the place of one that weighs least
                        s = 0
                        for c in range(1, count[i]):
                            if shares[i, c] < shares[i, s]:
                                s = c
                    at[i, s], us[i, s], shares[i, s] = int(means[0]), means[1], 0.0
                    for j in range(made):
                        most[j, i, s] = _most(sides, bounding, level, at[i, s], us[i, s], rows[j], out)
                if left > _SURE * terms:
                    return GONE
                if known:
                    break
        for i in range(k):
            if seen[i, 0, 0] > seen[i, 0, 1]:  # it does nothing
                for c in range(2):
                    seen[i, 0, c] = 0.5 * (ends[i, 0] + ends[i, 1])
            spread[i] = 0.0
            for c in range(1, 5):
                low, high = np.inf, -np.inf
                for s in range(count[i]):
                    j = at[i, s]
                    value = sides[j, c + 1]
                    if c < 3:
                        value = sides[j, c - 1] + (us[i, s] - sides[j, 8]) * sides[j, c + 1]
                    low, high = min(low, value), max(high, value)
                apart = max(seen[i, c, 1] - seen[i, c, 0], 0.0) + _WHOLE * (high - low)
                spread[i] += apart * apart
            spread[i] = sqrt(spread[i])
        return LEFT

    return joined


# Numba's cache watches this file only; the digest in the loop's closure makes it watch these, too.
joined = _loop(digest((cubic_arcs, eroded, placement_boxes, simplex, twist_weights, wrench_gauge)))
