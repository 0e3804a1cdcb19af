"""Twists that move with the fingers, for fingers on one straight side each: a game of twists against corners.

For twists whose velocities are affine in where fingers are the gain, what loads work less what forces at most
do, is concave in all places: where it is above zero at the corners of a box, no placement in the box holds
the loads ("Twists that move" of the documentation's page "Where to put the fingers").

At one placement the best twist of a load has three extreme wrenches equally far along it, where the dual
simplex method ends (``wrench_gauge``). Moved with the fingers they are of the same forces, and only their
torques change, affinely; so with a fixed angular velocity two equations give the velocity, affine in all
places, that keeps them equally far. While these three are the extreme ones, nothing is lost by moving.

Which shares of such twists of all loads make the least gain of the corners largest is a matrix game. Against
them stand shares of corners, whose mean is a placement, and the twists of that one join, until the least gain
is above zero.
"""

from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS, digest
from regrasp.closed_form.compiled.places import cubic_arcs, eroded, simplex, wrench_gauge
from regrasp.closed_form.compiled.places.simplex import play
from regrasp.closed_form.compiled.places.wrench_gauge import (
    ERODED,
    LARGEST,
    SQUARES,
    gauge,
    support_of_arc,
    workspace,
)
from regrasp.compilation import kept

LEFT, GONE, HELD = 0, 1, 2
"""A box that is not excluded; one that is; and one with a placement that holds all loads."""
ROUNDS = 4
_SURE = 1e-9  # of the terms, more than rounding adds
_FLAT = 1e-9  # of two equations that are one
_BETTER = 1e-4  # of the largest gain, that a round has to add for another


@njit(**VIEWS)
def _gain(sides, arcs, ends, law, level, b, twist, corner, y, out):  # type: ignore[no-untyped-def]
    """What work of a load is beyond the most that forces do, fingers at a corner, and how large terms are."""
    k, work, most, size = len(arcs), 0.0, 0.0, 0.0
    for c in range(3):
        y[c] = twist[c]
    for i in range(k):
        if (corner >> i) & 1:
            y[0] += twist[3 + i]
            y[1] += twist[3 + k + i]
    for c in range(3):
        work += b[c] * y[c]
        size += abs(b[c] * y[c])
    for i in range(k):
        j, u = arcs[i, 0], ends[i, (corner >> i) & 1]
        support_of_arc(sides, j, j, u, u, law, y, out)
        if law[1] == ERODED:
            most += out[0]
            size += abs(out[0])
        elif law[2] == LARGEST:
            most += level * max(out[0], 0.0)
        elif law[2] == SQUARES:
            most = np.hypot(most, level * out[0])
        else:
            most = max(most, level * out[0])
    return work - most, size + abs(most)


@njit(**VIEWS)
def _follow(sides, arcs, ends, u, work, twist):  # type: ignore[no-untyped-def]
    """Writes the last twist of ``gauge`` at u, of size 1, and how it moves with the fingers."""
    g, forces, y = work[0], work[2], work[3]
    k, size = len(arcs), max(abs(y[0]), abs(y[1]), abs(y[2]))
    for c in range(3):
        twist[c] = y[c] / size if size > 0.0 else 0.0
    ax, ay = g[0, 0] - g[1, 0], g[0, 1] - g[1, 1]
    bx, by = g[0, 0] - g[2, 0], g[0, 1] - g[2, 1]
    across = ax * by - ay * bx
    one, two = ax * ax + ay * ay, bx * bx + by * by
    flat = not abs(across) > _FLAT * (one + two)
    for i in range(k):
        j, width = arcs[i, 0], ends[i, 1] - ends[i, 0]
        px, py = width * sides[j, 2], width * sides[j, 3]
        first = px * forces[0, i, 4] - py * forces[0, i, 3]
        a = -twist[2] * (first - px * forces[1, i, 4] + py * forces[1, i, 3])
        b = -twist[2] * (first - px * forces[2, i, 4] + py * forces[2, i, 3])
        if not flat:
            twist[3 + i], twist[3 + k + i] = (a * by - b * ay) / across, (ax * b - bx * a) / across
        elif one > two:  # one equation
            twist[3 + i], twist[3 + k + i] = a * ax / one, a * ay / one
        else:
            per = 1.0 / two if two > 0.0 else 0.0
            twist[3 + i], twist[3 + k + i] = b * bx * per, b * by * per
        twist[0] -= u[i] * twist[3 + i]
        twist[1] -= u[i] * twist[3 + k + i]


@njit(**VIEWS)
def _excludes(sides, arcs, ends, law, level, loads, twists, y, out):  # type: ignore[no-untyped-def]
    """Whether twists (L, 3 + 2 k) of all loads together do."""
    for corner in range(1 << len(arcs)):
        gain, size = 0.0, 0.0
        for n in range(len(loads)):
            one, large = _gain(sides, arcs, ends, law, level, loads[n], twists[n], corner, y, out)
            gain += one
            size += large
        if not gain > _SURE * size:
            return False
    return True


def room_to_move(loads: int, k: int) -> tuple[Any, ...]:
    """Memory for it."""
    rows = ROUNDS * loads
    return (
        workspace(k), np.zeros((k, 2), np.int64), np.zeros((k, 2)), np.zeros(3), np.zeros((rows, 3 + 2 * k)),
        np.zeros((rows, 2**k)), np.zeros((rows + 1, 2**k + 1)), np.zeros(rows + 2**k, np.int64),
        np.zeros(rows), np.zeros(2**k),
    )  # fmt: skip


def _loop(digest: str) -> Any:
    @kept("the search for places", error_model="numpy", nogil=True, _nrt=False)
    def moved(sides, loads, law, level, arcs, ends, u, twists, room):  # type: ignore[no-untyped-def]
        """Whether a box is excluded (``GONE``), by ``twists`` (L, 3 + 2 k), or holds a placement ``u``.

        A twist is that of fingers at the beginnings of their arcs, 0 for a load that does not count, and by
        how much each finger adds to the one and to the other velocity on its way to the end. sides, loads,
        law: as of ``placement_search``. level: of the norm, which forces must be above. u: (k,) parts.
        """
        _ = digest
        mu, _, size, norm, precision, limit, margin = law
        bounding = (mu, size, norm, limit, margin)
        work, at_arcs, at_ends, y, every, gains, table, names, shares, corners = room
        k, count, rows, value = len(arcs), len(loads), 0, -np.inf
        out = work[7]
        for i in range(k):
            u[i] = 0.5
        for _round in range(ROUNDS):
            for i in range(k):
                at_arcs[i, 0] = at_arcs[i, 1] = arcs[i, 0]
                at_ends[i, 0] = at_ends[i, 1] = ends[i, 0] + u[i] * (ends[i, 1] - ends[i, 0])
            holds = True
            for n in range(count):
                found, _ = gauge(sides, at_arcs, at_ends, bounding, loads[n], np.inf, precision, y, work)
                holds = holds and found <= level
                _follow(sides, arcs, ends, u, work, every[rows + n])
                largest = 0.0
                for corner in range(1 << k):
                    gain, _ = _gain(
                        sides, arcs, ends, bounding, level, loads[n], every[rows + n], corner, y, out
                    )
                    gains[rows + n, corner] = gain
                    largest = max(largest, abs(gain))
                if largest > 0.0:
                    for corner in range(1 << k):
                        gains[rows + n, corner] /= largest
                    for c in range(3 + 2 * k):
                        every[rows + n, c] /= largest
            if holds:
                return HELD
            rows += count
            before, value = value, play(gains, rows, -1.0, table, names, shares, corners)
            if value > 0.0:
                for n in range(count):
                    for c in range(3 + 2 * k):
                        twists[n, c] = 0.0
                for j in range(rows):
                    for c in range(3 + 2 * k):
                        twists[j % count, c] += shares[j] * every[j, c]
                return GONE if _excludes(sides, arcs, ends, bounding, level, loads, twists, y, out) else LEFT
            if not value > before + _BETTER:
                break
            for i in range(k):
                u[i] = 0.0
                for corner in range(1 << k):
                    if (corner >> i) & 1:
                        u[i] += corners[corner]
        return LEFT

    return moved


# Numba's cache watches this file only; the digest in the loop's closure makes it watch these, too.
moved = _loop(digest((cubic_arcs, eroded, simplex, wrench_gauge)))
