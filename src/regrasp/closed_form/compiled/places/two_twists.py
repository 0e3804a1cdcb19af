"""A bound from two loads at once, each with a twist, for fingers on one straight side each.

A single twist bounds a box as if fingers could be elsewhere for each load. Where one load is hard at one end
of a stretch and another at the other, no placement is good, yet each load finds one that is: along parallel
sides a whole valley of placements would be looked at in small steps. For twists y, z of two loads b, c and
any placement s the larger gauge T of the two has

    T (H(y; s) + H(z; s)) >= b . y + c . z,    H(y; s) + H(z; s) = sum_i [ sigma_i(y; s_i) + sigma_i(z; s_i) ]

where the norm is ``LARGEST``. Each bracket is convex in s_i, so the largest is at an end of the finger's
stretch, for both twists the same end: the sum is less than that of the largest ones.
"""

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import VIEWS
from regrasp.closed_form.compiled.places.cubic_arcs import CONTROL
from regrasp.closed_form.compiled.places.wrench_gauge import (
    ERODED,
    LARGEST,
    proven,
    seen_from_middle,
    support_of_arc,
)


@njit(**VIEWS)
def bound_by_two(sides, arcs, ends, law, loads, every, best, spare):  # type: ignore[no-untyped-def]
    """The best bound of two loads by their twists ``every`` (L, 3); the twists, scaled, in ``best`` (2, 3).

    Returns bound and loads; a bound of 0 where none is. spare: (L, k, 2), of sigma at the ends, (L,) of what
    the middle of ``ERODED`` takes off, and scratch (7,), (3,), (3,), (3,).
    """
    k, found, one, two = len(arcs), 0.0, -1, -1
    values, off, out, middle, target, mixed = spare
    if law[2] != LARGEST or sides.shape[1] > CONTROL:
        return found, one, two
    for i in range(k):
        if arcs[i, 0] != arcs[i, 1]:
            return found, one, two
    per = seen_from_middle(sides, arcs, ends, law, loads[0], middle, target)
    for n in range(len(loads)):
        y = every[n]
        done = off[n] = 0.0
        for c in range(3):
            done += (loads[n, c] - middle[c]) * y[c]
            off[n] += middle[c] * y[c]
        if not done > 0.0:
            off[n] = np.inf
            continue
        for c in range(3):
            y[c] /= done
        off[n] /= done
        for i in range(k):
            for e in range(2):
                j, u = arcs[i, 0], ends[i, e]
                support_of_arc(sides, j, j, u, u, law, y, out)
                values[n, i, e] = out[0] if law[1] == ERODED else max(out[0], 0.0)
    least, share = np.inf, 0.0
    for n in range(len(loads)):
        for m in range(n):
            if off[n] == np.inf or off[m] == np.inf:
                continue
            for i in range(k):  # the share of n at which the ends of a finger weigh the same
                rise, fall = values[n, i, 1] - values[n, i, 0], values[m, i, 1] - values[m, i, 0]
                if not rise * fall < 0.0:
                    continue
                part = fall / (fall - rise)
                h = -part * off[n] - (1.0 - part) * off[m]
                for f in range(k):
                    h += max(
                        part * values[n, f, 0] + (1.0 - part) * values[m, f, 0],
                        part * values[n, f, 1] + (1.0 - part) * values[m, f, 1],
                    )
                if h < least:
                    least, share, one, two = h, part, n, m
    if one < 0:
        return found, one, two
    size = 0.0
    for c in range(3):
        best[0, c], best[1, c] = share * every[one, c], (1.0 - share) * every[two, c]
        mixed[c] = abs(best[0, c]) + abs(best[1, c])
        size = max(size, max(abs(loads[one, c]), abs(loads[two, c])))
    for c in range(3):
        target[c] = size + abs(middle[c])
    return per * proven(target, mixed, 1.0, least, law[0], k, 1e6 * size), one, two


def room_for_two(loads: int, k: int) -> tuple[np.ndarray, ...]:
    """Memory for it: ``every``, ``best`` and ``spare``."""
    return (
        np.zeros((loads, 3)), np.zeros((2, 3)), np.zeros((loads, k, 2)), np.zeros(loads), np.zeros(7),
        np.zeros(3), np.zeros(3), np.zeros(3),
    )  # fmt: skip
