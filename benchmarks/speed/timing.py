"""Interleaved timing: both sides take turns, so that a busy machine disturbs both alike."""

import gc
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any


def _nothing() -> None:
    return None


@dataclass(frozen=True)
class Side:
    """One side of a comparison: ``run`` does ``items`` items on what ``prepare`` made; by a ``clock``."""

    run: Callable[[Any], object]
    items: int = 1
    prepare: Callable[[], Any] = _nothing
    clock: Callable[[], float] = perf_counter

    def seconds(self, repeats: int) -> float:
        """Time of one item, over ``repeats`` runs."""
        total = 0.0
        for _ in range(repeats):
            given = self.prepare()
            began = self.clock()
            self.run(given)
            total += self.clock() - began
        return total / (repeats * self.items)


@dataclass(frozen=True)
class Comparison:
    """Seconds per item of both sides, one entry per round."""

    ours: tuple[float, ...]
    theirs: tuple[float, ...]

    @property
    def ratio(self) -> float:
        """Our time over theirs: the median of the rounds' ratios."""
        return median(a / b for a, b in zip(self.ours, self.theirs, strict=True))

    @property
    def ratio_of_best(self) -> float:
        """Our best time over their best time."""
        return min(self.ours) / min(self.theirs)


def compare(ours: Side, theirs: Side, *, rounds: int, least: float) -> Comparison:
    """Rounds of both sides in turn, each round of a side lasting ``least`` seconds or more."""
    sides = (ours, theirs)
    repeats = []
    for side in sides:
        side.seconds(1)  # caches warm
        repeats.append(max(1, round(least / (side.seconds(1) * side.items))))
    times: tuple[list[float], list[float]] = ([], [])
    enabled = gc.isenabled()
    gc.disable()
    try:
        for _ in range(rounds):
            for side, count, taken in zip(sides, repeats, times, strict=True):
                taken.append(side.seconds(count))
    finally:
        if enabled:
            gc.enable()
    return Comparison(tuple(times[0]), tuple(times[1]))
