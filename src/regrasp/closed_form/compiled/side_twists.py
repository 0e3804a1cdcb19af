"""Three fingers of which one may be on many sides: twists of which one excludes each side of it.

With the other two on single short sides, or on few, an object that turns about where their lines of force
meet does hardly any work on them, and of the two ways to turn one lets a third finger do none: which of them
excludes a third side is a matter of the sign of the torque that its normal has about that point. So a few
twists exclude nearly all third sides of a pair of fingers, where none does so alone.

Twists about where normals of the two and edges of their cones meet are tried first, those that let one of the
two do no work next, and for each side that is left the best twist of the dual simplex method
(``wrench_gauge``), which excludes that side with the other two, if any twist does.
"""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS, digest
from regrasp.closed_form.compiled.places import cubic_arcs, eroded, wrench_gauge
from regrasp.closed_form.compiled.places.wrench_gauge import gauge, workspace
from regrasp.compilation import kept

OPEN, COVERED, LEFT = 0, 1, 2
"""A side not looked at; one that a twist excludes; and one that none does."""
MOST_TWISTS = 64
"""Of a box."""
_SURE = 1e-9  # of the terms, more than rounding adds
_ENOUGH = 1.05  # of the level: a twist that is better excludes a side's neighbours, too
_FLAT = 1e-4  # of a sine, below which lines do not meet


@njit(**VIEWS)
def _most(sides, j, lo, hi, mu, y):  # type: ignore[no-untyped-def]
    """The most work along y of a force of size 1 on a part of a side, 0 or more."""
    most, nx, ny, slant = 0.0, sides[j, 4], sides[j, 5], sqrt(1.0 + mu * mu)
    for end in range(2):
        along = (lo if end == 0 else hi) - sides[j, 8]
        px, py = sides[j, 0] + along * sides[j, 2], sides[j, 1] + along * sides[j, 3]
        vx, vy = y[0] - y[2] * py, y[1] + y[2] * px
        ahead, aside = nx * vx + ny * vy, abs(ny * vx - nx * vy)
        if aside < mu * ahead:
            most = max(most, sqrt(ahead * ahead + aside * aside))
        else:
            most = max(most, (ahead + mu * aside) / slant)
    return most


@njit(**VIEWS)
def _room_for(sides, loads, mu, level, arcs, ends, wide, y):  # type: ignore[no-untyped-def]
    """What a finger may do along y, at the most, where no forces hold a load; and the load."""
    work, size, load = 0.0, 0.0, -1
    for n in range(len(loads)):
        done = loads[n, 0] * y[0] + loads[n, 1] * y[1] + loads[n, 2] * y[2]
        if done > work:
            work, load = done, n
            size = abs(loads[n, 0] * y[0]) + abs(loads[n, 1] * y[1]) + abs(loads[n, 2] * y[2])
    left = (work - _SURE * size) / level
    for i in range(3):
        most = 0.0
        if i != wide and left > 0.0:
            for j in range(arcs[i, 0], arcs[i, 1] + 1):
                lo = ends[i, 0] if j == arcs[i, 0] else sides[j, 6]
                hi = ends[i, 1] if j == arcs[i, 1] else sides[j, 7]
                most = max(most, _most(sides, j, lo, hi, mu, y))
        left -= most * (1.0 + _SURE)
    return left, load


@njit(**VIEWS)
def _cover(sides, loads, mu, level, arcs, ends, wide, y, how, twists, numbers, state):  # type: ignore[no-untyped-def]
    """Marks sides that y excludes; it joins ``twists`` if there are any. state: of those, of sides left."""
    if state[0] == len(twists):
        return
    room, load = _room_for(sides, loads, mu, level, arcs, ends, wide, y)
    if not room > 0.0:
        return
    before, first, last = state[1], arcs[wide, 0], arcs[wide, 1]
    for j in range(first, last + 1):
        if how[j] != COVERED:
            lo = ends[wide, 0] if j == first else sides[j, 6]
            hi = ends[wide, 1] if j == last else sides[j, 7]
            if _most(sides, j, lo, hi, mu, y) * (1.0 + _SURE) < room:
                state[1] -= 1
                how[j] = COVERED
    if state[1] < before:
        for c in range(3):
            twists[state[0], c] = y[c]
        numbers[state[0]] = load
        state[0] += 1


@njit(**VIEWS)
def _middle(sides, arc, end, slant, line):  # type: ignore[no-untyped-def]
    """Writes force and torque of a finger in the middle of an arc; slant: share of the tangent."""
    a, b = arc
    lo, hi = end[0] - sides[a, 8], end[1] - sides[b, 8]
    nx, ny = sides[a, 4] + sides[b, 4], sides[a, 5] + sides[b, 5]
    size = sqrt(nx * nx + ny * ny)
    if size > _FLAT:
        nx, ny = nx / size, ny / size
    else:
        nx, ny = sides[a, 4], sides[a, 5]
    px = 0.5 * (sides[a, 0] + lo * sides[a, 2] + sides[b, 0] + hi * sides[b, 2])
    py = 0.5 * (sides[a, 1] + lo * sides[a, 3] + sides[b, 1] + hi * sides[b, 3])
    line[0], line[1] = nx + slant * ny, ny - slant * nx
    line[2] = px * line[1] - py * line[0]


def room_for_sides() -> tuple[Any, ...]:
    """Memory for it."""
    return (
        workspace(3), np.zeros((3, 2), np.int64), np.zeros((3, 2)), np.zeros((2, 3)), np.zeros(3),
        np.zeros(3), np.zeros(2, np.int64),
    )  # fmt: skip


def _loop(digest: str) -> Any:
    @kept("the search for places", error_model="numpy", nogil=True, _nrt=False)
    def covered(sides, loads, law, level, arcs, ends, wide, hard, every, how, twists, numbers, room):  # type: ignore[no-untyped-def]
        """How many twists are needed, and how many sides of the finger ``wide`` none of them excludes.

        sides, loads, law: as of ``placement_search``, of straight sides, forces of the length |f|. level: of
        the largest force. hard: a side to begin with, -1 for none. every: whether to go on after one that is
        not excluded. how: (m,) of each side, ``COVERED`` or ``LEFT`` where it is on the arc. twists, numbers:
        (t, 3) and (t,) of the twists and their loads.
        """
        _ = digest
        mu, _, size, norm, precision, limit, margin = law
        bounding = (mu, size, norm, limit, margin)
        work, at_arcs, at_ends, lines, y, best, state = room
        first, last = arcs[wide]
        one, two = (1 if wide == 0 else 0), (1 if wide == 2 else 2)
        state[0], state[1] = 0, last - first + 1
        for j in range(first, last + 1):
            how[j] = OPEN
        for pair in range(9):  # normals first, then edges of cones
            slants = (pair + 4) % 9
            _middle(sides, arcs[one], ends[one], (slants % 3 - 1) * mu, lines[0])
            _middle(sides, arcs[two], ends[two], (slants // 3 - 1) * mu, lines[1])
            across = lines[0, 0] * lines[1, 1] - lines[0, 1] * lines[1, 0]
            if state[1] == 0 or not abs(across) > _FLAT:
                continue
            for turn in range(-1, 2, 2):
                y[0] = turn * (lines[1, 2] * lines[0, 1] - lines[0, 2] * lines[1, 1]) / across
                y[1] = turn * (lines[1, 2] * -lines[0, 0] + lines[0, 2] * lines[1, 0]) / across
                y[2] = turn
                _cover(sides, loads, mu, level, arcs, ends, wide, y, how, twists, numbers, state)
        for way in range(8):
            if state[1] == 0:
                break
            _middle(sides, arcs[one], ends[one], 0.0, lines[0])
            _middle(sides, arcs[two], ends[two], 0.0, lines[1])
            for c in range(3):
                y[c] = 0.0
            for i in range(2):
                nx, ny = lines[i, 0], lines[i, 1]
                if way < 2:  # against both, along both
                    y[0] += nx if way else -nx
                    y[1] += ny if way else -ny
                elif way % 2 == i:  # aside of one, to either side, or against it
                    turn = way // 2 - 2
                    y[0], y[1] = (turn * ny, -turn * nx) if turn else (-nx, -ny)
            _cover(sides, loads, mu, level, arcs, ends, wide, y, how, twists, numbers, state)
        for i in range(3):
            for c in range(2):
                at_arcs[i, c], at_ends[i, c] = arcs[i, c], ends[i, c]
        failed, start = 0, 0
        for step in range(-1, last - first + 1):
            j = first + step if step >= 0 else hard
            if state[1] == failed or (failed and not every):
                break
            if j < first or j > last or how[j] != OPEN:
                continue
            at_arcs[wide, 0] = at_arcs[wide, 1] = j
            at_ends[wide, 0] = ends[wide, 0] if j == first else sides[j, 6]
            at_ends[wide, 1] = ends[wide, 1] if j == last else sides[j, 7]
            most = 0.0
            for n in range(len(loads)):
                load = (start + n) % len(loads)
                found, _ = gauge(
                    sides, at_arcs, at_ends, bounding, loads[load], _ENOUGH * level, precision, best, work
                )
                if found > most:
                    most = found
                    for c in range(3):
                        y[c] = best[c]
                if found >= _ENOUGH * level:
                    start = load
                    break
            if most > level:
                _cover(sides, loads, mu, level, arcs, ends, wide, y, how, twists, numbers, state)
            if how[j] == OPEN:
                how[j] = LEFT
                failed += 1
        for j in range(first, last + 1):
            if how[j] == OPEN:
                how[j] = LEFT
        return state[0], state[1]

    return covered


# Numba's cache watches this file only; the digest in the loop's closure makes it watch these, too.
covered = _loop(digest((cubic_arcs, eroded, wrench_gauge)))
