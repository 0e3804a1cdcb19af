"""Boxes that grow while they hold: nested ones, one end after the other, one end for others."""

from collections.abc import Callable
from itertools import product

import numpy as np

from regrasp.mechanics.checks import Array

HALVINGS = 40
_SHORTEST, _TRADED, _BETTER = 0.005, 9, 1e-4  # least step, halvings and gain of a trade


def farthest(holds: Callable[[float], bool], most: float, halvings: int = HALVINGS) -> float:
    """The largest width that holds, of nested ones; 0 holds."""
    if holds(most):
        return most
    lo, hi = 0.0, most
    for _ in range(halvings):
        middle = 0.5 * (lo + hi)
        lo, hi = (middle, hi) if holds(middle) else (lo, middle)
    return lo


def moved_out(
    holds: Callable[[Array], bool], box: Array, i: int, end: int, last: float, halvings: int = HALVINGS
) -> float:
    """Where one end of a box may be moved towards ``last``."""
    if box[i, end] == last:
        return last

    def moved(fraction: float) -> Array:
        there = box.copy()
        there[i, end] = box[i, end] + fraction * (last - box[i, end])
        return there

    fraction = farthest(lambda part: holds(moved(part)), 1.0, halvings)
    return float(moved(fraction)[i, end])


def traded(out: Callable[[Array, int, int, int], float], box: Array, u: Array, lengths: Array) -> Array:
    """A box with a larger product of widths: one end is drawn in, others move out, while that helps.

    out: where one end of a box may be moved to, by so many halvings.
    """
    ends = list(product(range(len(u)), range(2)))

    def score(of: Array) -> float:
        wide = np.maximum((of[:, 1] - of[:, 0]) * lengths, 1e-12 * lengths.max())
        return float(np.log(wide).sum())

    best, step = score(box), 1.0
    while step > _SHORTEST:
        helped = False
        for j, first in product(range(len(ends)), range(1, len(ends))):
            i, end = ends[j]
            tried = box.copy()
            tried[i, end] += step * (u[i] - box[i, end])
            for k in range(len(ends)):
                other = ends[(j + first + k) % len(ends)]
                tried[other] = out(tried, *other, _TRADED)
            found = score(tried)
            if found > best + _BETTER:
                best, box, helped = found, tried, True
        step *= 1.0 if helped else 0.5
    return box
