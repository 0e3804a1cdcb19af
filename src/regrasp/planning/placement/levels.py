"""Objectives that are a level at which forces below a limit exist: friction in use, loads answered.

Boxes are excluded where forces at the level must exceed the limit. Whatever is excluded at a level is at
every better one, since cones are narrower or loads farther out; so the search goes on, box by box, while
placements that are found raise the level.
"""

from abc import ABC, abstractmethod
from math import atan, inf, tan

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.search import Progress, Search

_STRICT = 1e-9  # of the limit, by which excluded boxes must be above it
_STEP = 1e-6  # of a level that is zero
_SETTLING = 10
_SLIDES, _SLOW, _SHORTEST = 8, 1e-4, 1e-4  # rounds, least gain of one, shortest step as a part of an edge
_SURE = 1e-6  # of the limit, more than norms are uncertain by
_HALVINGS = 50
_EXACT = 1e-10  # relative, of the level of a placement


class Level(ABC):
    """A level of which more is better, from ``start`` on; the limit of every force is ``max_force`` [N]."""

    start: float

    def __init__(self, max_force: float) -> None:
        self.max_force = max_force

    @abstractmethod
    def put(self, search: Search, level: float) -> None:
        """Search at this level from now on."""

    @abstractmethod
    def beyond(self, level: float, tolerance: float) -> float:
        """The level that has to be excluded for a gap of ``tolerance``."""

    @abstractmethod
    def top(self, search: Search) -> float:
        """A level that no placement reaches, or the largest there is."""


class FrictionLevel(Level):
    """Cones narrowed from friction mu to nu: the level is -nu / mu for the use, or the angle margin [rad]."""

    def __init__(self, max_force: float, friction: float, *, angle: bool) -> None:
        super().__init__(max_force)
        self.friction, self.angle = friction, angle
        self.start = 0.0 if angle else -1.0

    def coefficient(self, level: float) -> float:
        """The friction coefficient that a level leaves [-]."""
        if self.angle:
            return max(tan(atan(self.friction) - level), 0.0)
        return max(-level * self.friction, 0.0)

    def put(self, search: Search, level: float) -> None:
        """Narrow the cones."""
        search.friction = self.coefficient(level)

    def beyond(self, level: float, tolerance: float) -> float:
        """Better by a fraction of it."""
        return level + max(tolerance * abs(level), _STEP)

    def top(self, search: Search) -> float:
        """No friction left."""
        return atan(self.friction) if self.angle else 0.0


class AnsweredLevel(Level):
    """Loads center + factor deviation: the level is the factor."""

    start = 0.0

    def __init__(self, max_force: float, center: Array, deviations: Array) -> None:
        super().__init__(max_force)
        self.center, self.deviations = center, deviations

    def loads(self, level: float) -> Array:
        """(1 + m, 3) the center, then those with deviations scaled."""
        return np.vstack([self.center, self.center + level * self.deviations])

    def put(self, search: Search, level: float) -> None:
        """Scale the deviations."""
        search.under(self.loads(level))

    def beyond(self, level: float, tolerance: float) -> float:
        """Larger by a fraction of it."""
        return level * (1 + tolerance) + _STEP

    def top(self, search: Search) -> float:
        """So large a wrench as k forces of the limit do not make, at the largest lever."""
        reach = np.array([1.0, 1.0, search.sides.size]) * search.fingers * self.max_force
        with np.errstate(divide="ignore"):
            factors = (reach + np.abs(self.center)) / np.abs(self.deviations)
        return 2.0 * float(factors.min(axis=1).min(initial=inf))


def run_level(
    search: Search, level: Level, tolerance: float, most: int, progress: Progress | None
) -> tuple[float | None, float]:
    """The best level found, None where no placement was, and a level that no placement is beyond.

    ``search`` is left at that level, which its boxes exclude where it is ``closed``; where it was cut short
    it is the largest there is.
    """
    best: float | None = None
    aim = level.start
    fixed = level.max_force * (1 + _STRICT)
    level.put(search, aim)
    try:
        while search.goes_on(fixed, 0.0, most) or search.best <= level.max_force:
            if search.best <= level.max_force:
                reached, places, u = _improved(search, level, aim, *search.found)
                best = reached if best is None else max(best, reached)
                aim = level.beyond(best, tolerance)
                level.put(search, aim)
                search.forget(reached, places, u)
                if aim >= level.top(search):
                    break
            if progress is not None:
                progress(aim, inf if best is None else best)
    except KeyboardInterrupt:
        if best is None:
            raise
        search.closed = False
    if best is None:
        search.closed = search.closed and search.excludes(search.left, fixed)
        return best, aim
    return best, _settled(search, level, aim, fixed)


def _settled(search: Search, level: Level, aim: float, fixed: float) -> float:
    """A level at which boxes that are left, too small to be split or not looked at, are excluded, too."""
    left, lo, hi = search.left, aim, level.top(search)
    if aim >= hi:
        return aim
    level.put(search, aim)
    search.closed = search.excludes(left, fixed)
    if search.closed:
        return aim
    for _ in range(_SETTLING):
        middle = 0.5 * (lo + hi)
        level.put(search, middle)
        if search.excludes(left, fixed):
            hi = middle
        else:
            lo = middle
    level.put(search, hi)
    search.closed = search.excludes(left, fixed)
    return hi


def _improved(
    search: Search, level: Level, known: float, places: np.ndarray, u: Array
) -> tuple[float, np.ndarray, Array]:
    """The best level of a placement and of those that fingers find by sliding along the boundary."""
    reached = _reached(search, level, known, places, u)
    for _ in range(_SLIDES):
        level.put(search, reached)
        places, u = _slid(search, places, u)
        further = _reached(search, level, reached, places, u)
        gained, reached = further - reached, further
        if gained <= _SLOW * abs(reached):
            break
    return reached, places, u


def _slid(search: Search, places: np.ndarray, u: Array) -> tuple[np.ndarray, Array]:
    """Places of less norm, one finger at a time, by steps that are halved where none helps."""
    norm, step = search.norm_at(places, u), 0.125
    while step > _SHORTEST:
        helped = False
        for i in range(len(u)):
            for way in (-step, step):
                on, there = places.copy(), u.copy()
                on[i], there[i] = search.sides.moved(int(places[i]), float(u[i]), way)
                found = search.norm_at(on, there) if search.are_apart(on, there) else inf
                if found < norm:
                    norm, places, u, helped = found, on, there, True
        step *= 1.0 if helped else 0.5
    return places, u


def _reached(search: Search, level: Level, known: float, places: np.ndarray, u: Array) -> float:
    """The best level at which a placement has forces below the limit, at least ``known``."""
    lo, hi = known, level.top(search)
    for _ in range(_HALVINGS):
        middle = 0.5 * (lo + hi)
        level.put(search, middle)
        if search.norm_at(places, u) <= level.max_force * (1 - _SURE):
            lo = middle
        else:
            hi = middle
        if hi - lo <= _EXACT * max(abs(lo), abs(hi)):
            break
    return lo
