"""Over which angles of the object a pair of contacts holds with so much margin.

Without limits on forces that is one arc in closed form, or two opposite angles (``load_arcs``), and arcs of
wider margins lie inside those of narrower ones. ``peak_ratio``, force limits and that both fingers push take
parts away, mostly near the ends. What is left is found on ``_GRID`` angles of the closed arc and at the
widest margin, and its ends between two of them: an arc between two of those angles can be missed.
"""

from math import pi
from typing import NamedTuple

import numpy as np

from regrasp.closed_form.pairs.load_arcs import (
    ARC,
    LINE,
    load_arcs,
    turning_sides,
    widest_load,
    widest_narrowings,
)
from regrasp.mechanics.checks import Array
from regrasp.planning.holds.turning.margins import Candidates, Pairs

TOLERANCE = 1e-6
"""The widest margin may be one that is only approached: it is kept at this fraction below it."""

PEAKS = 8
"""So many of a margin over the angles are looked at closely, where limits leave less than the bound."""
_GRID = 25
_SLACK = 1e-12  # [rad] of margins, for rounding
_SECTIONS, _ROUNDS = 16, 12  # of what is left between two angles, and how often: to 16**-12 of it
_ZOOMS = 6  # each to 2 of 49 parts
_PULLED = 1e-9  # [rad]


class Widest(NamedTuple):
    """The widest margins of pairs over all angles (m,) [rad], -1 for none, and these angles [rad].

    peaks: (m, k) other angles besides [rad], where margins may be hardly less wide; None without any.
    """

    margins: Array
    angles: Array
    peaks: Array | None = None


class Arcs:
    """Arcs of the pairs of some candidates."""

    def __init__(self, candidates: Candidates) -> None:
        self.candidates = candidates

    def bounds(self) -> Array:
        """(V, V) no pair holds with a wider margin at any angle [rad]; -1 for none."""
        c = self.candidates
        side, alone = turning_sides(c.points, c.normals, c.mu)
        widest = widest_narrowings(side, alone, np.arctan(c.mu))
        if c.one_finger:  # the cone of an idle finger does not count
            alone = np.where(alone >= 0, alone, -1.0)
            widest = np.maximum(widest, np.maximum(alone[:, None], alone))
        return widest

    def widest(self, pairs: Pairs, bounds: Array) -> Widest:
        """The widest margins of pairs, that are at most ``bounds`` (m,) [rad]."""
        c = self.candidates
        (r1, n1, _), (r2, n2, _) = (c.of(places) for places in pairs)
        angles = c.direction - widest_load(r1, n1, r2, n2)
        margins = c.margins(pairs, angles)
        if c.one_finger:
            for r, n in ((r1, n1), (r2, n2)):  # that holds alone what goes through it
                along = -np.sign((r * n).sum(axis=1))[:, None] * r
                through = c.direction - np.arctan2(along[:, 1], along[:, 0])
                alone = c.margins(pairs, through)
                angles = np.where(alone > margins, through, angles)
                margins = np.maximum(margins, alone)
        short = margins < bounds * (1 - TOLERANCE)
        if short.any():
            some = (pairs[0][short], pairs[1][short])
            begin, length = self._closed(some, np.maximum(bounds[short], 0.0) * (1 - TOLERANCE))
            middle = begin + length / 2  # of what is left of an arc that ends at one angle
            better = c.margins(some, middle)
            wider = better > margins[short]
            angles[short], margins[short] = (
                np.where(wider, middle, angles[short]), np.where(wider, better, margins[short])
            )  # fmt: skip
            short = margins < bounds * (1 - TOLERANCE)
        peaks = None
        if short.any():
            found = self._searched((pairs[0][short], pairs[1][short]))
            wider = found.margins > margins[short]
            angles[short] = np.where(wider, found.angles, angles[short])
            margins[short] = np.where(wider, found.margins, margins[short])
            assert found.peaks is not None
            peaks = np.repeat(angles[:, None], found.peaks.shape[1], axis=1)
            peaks[short] = found.peaks
        return Widest(margins, angles, peaks)

    def at(self, pairs: Pairs, level: float, widest: Widest) -> list[list[tuple[float, float]]]:
        """For each pair the arcs (lo, hi) of angles that hold with a margin of ``level`` or more [rad]."""
        begin, length = self._closed(pairs, np.full(pairs[0].shape, level))
        grid = begin[:, None] + length[:, None] * np.linspace(0, 1, _GRID)
        best = widest.angles[:, None]
        if widest.peaks is not None:
            best = np.append(best, widest.peaks, axis=1)
        best = begin[:, None] + (best - begin[:, None]) % (2 * pi)
        best = np.where(best - begin[:, None] > length[:, None], (begin + length / 2)[:, None], best)
        angles = np.sort(np.append(grid, best, axis=1), axis=1)
        held = self._margins(pairs, angles) >= level - _SLACK
        inner, outer = angles[:, :-1], angles[:, 1:]
        rises, falls = ~held[:, :-1] & held[:, 1:], held[:, :-1] & ~held[:, 1:]
        where = np.nonzero(rises | falls)
        up = rises[where]
        inside = np.where(up, outer[where], inner[where])
        outside = np.where(up, inner[where], outer[where])
        some = (pairs[0][where[0]], pairs[1][where[0]])
        share, rows = np.linspace(0, 1, _SECTIONS + 1), np.arange(inside.size)
        for _ in range(_ROUNDS if inside.size else 0):
            between = inside[:, None] + (outside - inside)[:, None] * share
            holds = self._margins(some, between) >= level - _SLACK
            holds[:, 0], holds[:, -1] = True, False
            last = holds.argmin(axis=1)  # the first that does not
            inside, outside = between[rows, last - 1], between[rows, last]
        ends = np.full(rises.shape, np.nan)
        inner = inside + np.where(up, _PULLED, -_PULLED)  # off an end that is open, and would round out
        room = (
            self.candidates.margins(some, inner) >= level - _SLACK if inside.size else np.empty(0, np.bool_)
        )
        ends[where] = np.where(room, inner, inside)
        runs = [
            _runs(angles[row], held[row], ends[row], bool(length[row] >= 2 * pi))
            for row in range(len(angles))
        ]
        if not self.candidates.one_finger:
            return runs
        # A finger holds alone at one angle, which may lie off the arc of both, and within rounding of it.
        runs = [
            run or ([(float(a), float(a))] if m >= level - _SLACK else [])
            for run, a, m in zip(runs, widest.angles, widest.margins, strict=True)
        ]
        return [
            [(lo, hi) if hi - lo > _PULLED else ((lo + hi) / 2, (lo + hi) / 2) for lo, hi in run]
            for run in runs
        ]

    def _closed(self, pairs: Pairs, levels: Array) -> tuple[Array, Array]:
        """(begin, length) of the arcs of angles, without limits; of a line the ray that is held."""
        c = self.candidates
        (r1, n1, mu1), (r2, n2, mu2) = (c.of(places) for places in pairs)
        narrowed = (np.tan(np.maximum(np.arctan(mu) - levels, 0.0)) for mu in (mu1, mu2))
        mu1, mu2 = narrowed
        kind, begin, length = load_arcs(r1, n1, mu1, r2, n2, mu2)
        first = c.direction - begin - length
        length = np.where(kind == ARC, length, 0.0)
        line = kind == LINE
        if line.any():  # two opposite angles: a grid from one to the other finds both
            length = np.where(line, pi, length)
        return first, length

    def _margins(self, pairs: Pairs, angles: Array) -> Array:
        """(m, k) margins at angles (m, k)."""
        count = angles.shape[1]
        each = (np.repeat(pairs[0], count), np.repeat(pairs[1], count))
        return self.candidates.margins(each, angles.ravel()).reshape(angles.shape)

    def _searched(self, pairs: Pairs) -> Widest:
        """The widest margins on a grid of the closed arcs, made better around the best peaks."""
        begin, length = self._closed(pairs, np.zeros(pairs[0].shape))
        share = np.linspace(0, 1, 2 * _GRID)
        angles = begin[:, None] + length[:, None] * share
        margins = self._margins(pairs, angles)
        rows = np.arange(len(margins))
        best = margins.argmax(axis=1)
        found = Widest(margins[rows, best], angles[rows, best])
        peaks = np.pad(margins, ((0, 0), (1, 1)), constant_values=-2.0)
        peak = (margins >= peaks[:, :-2]) & (margins >= peaks[:, 2:]) & (margins >= 0)
        order = np.argsort(np.where(peak, -margins, 9.0), axis=1, kind="stable")[:, :PEAKS]
        row = np.repeat(rows, order.shape[1])
        place = order.ravel()
        real = peak[row, place]
        row, place = row[real], place[real]
        reached, at = margins[row, place], angles[row, place]
        step = length[row] / (len(share) - 1)
        low, high = angles[row, place] - step, angles[row, place] + step
        some, each = (pairs[0][row], pairs[1][row]), np.arange(row.size)
        for _ in range(_ZOOMS if row.size else 0):
            between = low[:, None] + (high - low)[:, None] * share
            margins = self._margins(some, between)
            best = margins.argmax(axis=1)
            reached, at = margins[each, best], between[each, best]
            low = between[each, np.maximum(best - 1, 0)]
            high = between[each, np.minimum(best + 1, len(share) - 1)]
        peaks = np.repeat(found.angles[:, None], order.shape[1], axis=1)
        peaks[np.nonzero(real.reshape(order.shape))] = at
        for k, value, angle in zip(row.tolist(), reached.tolist(), at.tolist(), strict=True):
            if value > found.margins[k]:
                found.margins[k], found.angles[k] = value, angle
        return Widest(found.margins, found.angles, peaks)


def _runs(angles: Array, held: Array, ends: Array, whole: bool) -> list[tuple[float, float]]:
    """Arcs of consecutive angles that hold, out to the ends found between those and others."""
    result = []
    begin = None
    for k, holds in enumerate(held.tolist()):
        if holds and begin is None:
            begin = angles[k] if k == 0 else ends[k - 1]
        if begin is not None and (not holds or k == len(held) - 1):
            result.append((float(begin), float(angles[k] if holds else ends[k - 1])))
            begin = None
    if whole and len(result) > 1 and held[0] and held[-1]:  # one arc that passes the first angle
        (lo, _), (_, hi) = result[-1], result[0]
        result = [(lo, hi + 2 * pi), *result[1:-1]]
    return result
