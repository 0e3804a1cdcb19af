"""Climbing to the best level on a surface, where placements raise it and boxes are excluded at it."""

from dataclasses import dataclass, field
from math import inf, nan

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.climbing import first_that_excludes, outward
from regrasp.planning.placement.levels.level import AnsweredLevel, FrictionLevel
from regrasp.planning.placement.search import Progress
from regrasp.planning.placement.space.surface_search import SurfaceSearch

SpaceLevel = FrictionLevel | AnsweredLevel
_SURE = 1e-6  # of the limit, more than norms are uncertain by
_STEPS, _EXACT = 40, 1e-9  # to a level of a placement
_LEAST = 1e-300
_SLIDES, _SLOW = 8, 1e-4  # of a placement, while each gains so much of its level


@dataclass
class Climb:
    """A search for the best level: the placements found, the best last, and what none is beyond."""

    search: SurfaceSearch
    level: SpaceLevel
    tolerance: float
    beyond: float = inf
    kept: list[tuple[float, Array]] = field(default_factory=list)

    def put(self, level: float) -> None:
        """Search at this level from now on."""
        if isinstance(self.level, FrictionLevel):
            self.search.put(self.level.coefficient(level), self.search.loads)
        else:
            self.search.put(self.search.friction, self.level.loads(level))

    @property
    def top(self) -> float:
        """A level that no placement reaches, or the largest there is."""
        if isinstance(self.level, FrictionLevel):
            return self.level.top(self.search)  # type: ignore[arg-type]
        reach = np.repeat([1.0, self.search.size], 3) * self.search.fingers * self.level.max_force
        with np.errstate(divide="ignore"):
            factors = (reach + np.abs(self.level.center)) / np.abs(self.level.deviations)
        return 2.0 * float(factors.min(axis=1).min(initial=inf))

    @property
    def best(self) -> float | None:
        """The best level found."""
        return self.kept[-1][0] if self.kept else None

    def run(
        self, starts: list[Array], narrow: float, most: int, looks: float, progress: Progress | None
    ) -> None:
        """Until no placement can be better by ``tolerance``, or ``most`` boxes are used."""
        search, aim = self.search, self.level.start
        self.put(aim)
        search.begin_level(together=isinstance(self.level, FrictionLevel))
        try:
            for spots in starts:
                aim = self._raised(aim, spots)
            going = True
            while going and aim < self.top:
                going = search.goes_on(narrow, most, looks)
                if search.found is not None:
                    before, going = aim, True
                    aim = self._raised(aim, search.found)
                    if aim == before:  # found by rounding alone
                        search.pass_over()
                if progress is not None:
                    best = nan if self.best is None else self.level.value(self.best)
                    progress(self.level.value(self.top), best)
            self.beyond = self._settled(aim)
        except KeyboardInterrupt:
            search.closed, search.interrupted, self.beyond = False, True, self.top

    def _spared(self, level: float, spots: Array) -> float:
        """What part of the forces of a placement could come on top at a level; -1 where there are none."""
        self.put(level)
        return self.level.max_force * (1 - _SURE) / max(self.search.norm_at(spots), _LEAST) - 1

    def _raised(self, aim: float, spots: Array) -> float:
        """The level to look for next, as a placement is found at ``aim``."""
        best = -inf
        for _ in range(_SLIDES):
            reached = self._reached(aim, spots)
            if reached > best:
                best, at = reached, spots
            aim = max(aim, self.level.beyond(best, _SLOW)) if best > -inf else aim
            self.put(aim)
            norm, spots = self.search.slid(spots)
            if not norm <= self.level.max_force * (1 - _SURE):
                break
        if best > -inf and (self.best is None or best > self.best):
            self.kept.append((best, at))
        aim = self.level.start if self.best is None else self.level.beyond(self.best, self.tolerance)
        self.put(aim)
        self.search.begin_level(together=isinstance(self.level, FrictionLevel))
        return aim

    def _reached(self, known: float, spots: Array) -> float:
        """The best level at which a placement has forces below the limit; -inf for less than ``known``."""
        lo, hi = known, self.top
        below, above = self._spared(lo, spots), -self._spared(hi, spots)
        if below < -_SURE or above <= 0:
            return -inf if below < -_SURE else hi
        below, twice = max(below, 0.0), 0
        for _ in range(_STEPS):  # of false position (Illinois)
            middle = lo + (hi - lo) * below / (below + above)
            spared = self._spared(middle, spots)
            if spared >= 0:
                lo, below, twice = middle, spared, max(twice, 0) + 1
            else:
                hi, above, twice = middle, -spared, min(twice, 0) - 1
            if 0 <= spared <= _SURE or hi - lo <= _EXACT * max(abs(lo), abs(hi)):
                break
            below, above = (0.5 * below if twice < -1 else below), (0.5 * above if twice > 1 else above)
        return lo

    def _settled(self, aim: float) -> float:
        """A level at which boxes that are left, too small to be split or not looked at, are excluded, too."""
        search, top = self.search, self.top
        if aim >= top:
            search.closed = False
            return top
        levels = [aim] if self.best is None else outward(aim, top)
        reached, search.closed = first_that_excludes(levels, search.left, self.put, search.excluded)
        return reached
