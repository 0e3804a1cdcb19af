"""The level of what set-points withstand: the factor of deviations that stiffness alone answers.

Forces f + s R d that stay within cones and limits balance the load and s d: what is withstood is answered. So
boxes of groups of edges are excluded by the loads one by one; those that are left by all loads together
(``Ties``), the one that may withstand most first.
"""

from math import inf, nan

import numpy as np

from regrasp.errors import RegraspError
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.stiffness import response
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.levels.level import AnsweredLevel, Shown
from regrasp.planning.placement.levels.tied_search import STRICT, TiedSearch
from regrasp.planning.placement.results import grasp_at
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed, moved_past, one_by_one, slid
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.criteria import ChosenState

_SEEDS, _OTHERS, _CLIMBED = 8, 24, 3  # placements that answer most, others judged, those that slide
_BATCHES = 8  # of boxes whose placements are the others
_DIFFERENT = 0.02  # of the size, between others
_FIRST, _LAST = 0.2, 2e-3  # steps of sliding, as parts of an edge
_FAR, _NEAR = 0.064, 1e-4  # the same past vertices, as parts of the boundary
_GAIN = 1e-9  # of a factor, the least that counts
_ROUNDING = 1e-9


class WithstoodLevel(AnsweredLevel):
    """Loads center + factor deviation, answered by equal stiffness."""

    def state(self, grasp: Grasp) -> ChosenState:
        """Forces that withstand most."""
        about = Wrench.from_vector(np.zeros(3))
        deviations = LoadSet.hull(map(Wrench.from_vector, self.deviations), center=about)
        load = Wrench.from_vector(self.center)
        return choose_state(grasp, load, "wrench", disturbance=deviations, max_force=self.max_force)

    def shown(self, grasp: Grasp, objective: str, loads: Array, level: float) -> Shown | None:
        """The set-points, and the states that they turn into under each deviation."""
        first = self.state(grasp)
        factor = first.value * (1 - _ROUNDING) if first.value > _GAIN else 0.0  # else friction is rounding
        if not 0 <= factor < inf:
            return None
        changes = (response(grasp) @ (factor * self.deviations).T).T.reshape(-1, len(grasp), 2)
        changed = [
            GraspState(grasp, Wrench.from_vector(w), first.forces + change)
            for w, change in zip(self.loads(factor)[1:], changes, strict=True)
        ]
        return [first, *changed], factor

    def climb(
        self, search: Search, tolerance: float, most: int, progress: Progress | None, beyond: float
    ) -> tuple[Search, float]:
        """A search of what is withstood, and a level that no placement is beyond.

        search: that ended at ``beyond``, more than what is answered anywhere.
        """
        known: list[Placed] = []
        try:
            return self._searched(search, known, tolerance, most, progress, beyond)
        except KeyboardInterrupt:
            if known:
                search.take(sorted(known, key=lambda placed: placed[0]))
            return search, beyond

    def _searched(
        self,
        search: Search,
        known: list[Placed],
        tolerance: float,
        most: int,
        progress: Progress | None,
        beyond: float,
    ) -> tuple[Search, float]:
        """As ``climb``; placements are noted in ``known``."""
        for _, places, u in search.placements()[:_SEEDS]:
            if (reached := self._factor(search, places, u)) >= 0:
                known.append((-reached, places, u))
        search.take(sorted(known, key=lambda placed: placed[0]))
        found = search.anew()
        found.narrow = inf  # until one side is left of each finger
        limit, going = self.max_force * (1 + STRICT), True

        def batch() -> bool:
            if progress is not None:
                progress(beyond, max((-placed[0] for placed in known), default=nan))
            return found.goes_on(limit, 0.0, most, only=True)

        self.put(found, max((-placed[0] for placed in known), default=0.0))
        for _ in range(_BATCHES):
            going = going and batch()
        for places, u in self._others(found, known):
            known.append((-self._factor(search, places, u), places, u))
        known[:] = sorted((p for p in known if p[0] <= 0), key=lambda placed: placed[0])

        def factor(places: np.ndarray, u: Array) -> float:
            return self._factor(search, places, u)

        tied = TiedSearch(self, found, factor, known, tolerance)
        known += [self._climbed(search, placed, tolerance, tied) for placed in known[:_CLIMBED]]
        tied.begin()
        self.put(found, self.beyond(max((-placed[0] for placed in known), default=0.0), tolerance))
        while going:
            going = batch()

        level = tied.run(most, progress, beyond)
        search.take(found.placements())
        return (found, level) if found.closed else (search, beyond)

    def _others(self, search: Search, known: list[Placed]) -> list[tuple[np.ndarray, Array]]:
        """Placements that a search tried and that answer its level, some that differ."""
        found: list[tuple[np.ndarray, Array]] = []
        shown = [search.sides.points(p, u)[np.argsort(u)] for _, p, u in known]
        for norm, places, u in search.tried_since(0):
            points = search.sides.points(places, u)[np.argsort(u)]
            if norm > self.max_force or len(found) == _OTHERS:
                break
            if all(np.abs(points - p).max() >= _DIFFERENT * search.sides.size for p in shown):
                found.append((places, u))
                shown.append(points)
        return found

    def _climbed(self, search: Search, placed: Placed, tolerance: float, tied: TiedSearch) -> Placed:
        """The best placement that fingers find by sliding, one at a time."""

        def less(places: np.ndarray, u: Array, than: float) -> float:
            """The negative of what it withstands."""
            wanted = -than * (1 + 0.1 * tolerance) + _GAIN
            self.put(search, wanted)
            if not search.are_apart(places, u) or search.norm_at(places, u) > self.max_force:
                return inf  # it does not even answer more
            if (roughly := tied.answered(places, u)) is not None and roughly.factor < wanted:
                return inf
            factor = self._factor(search, places, u)
            return -factor if factor > wanted else inf

        k, random = len(placed[2]), np.random.default_rng(0)
        ways = one_by_one(k)

        def turned() -> Array:  # for ridges along no finger alone
            return np.concatenate([ways(), ways() @ np.linalg.qr(random.normal(size=(k, k)))[0]])

        # a finger that stays on its edge is stuck on a chord of a fillet
        far = slid(search, placed, less, _FAR, _NEAR, turned, moved_past)
        return slid(search, far, less, _FIRST, _LAST, ways)

    def of(self, search: Search, places: np.ndarray, u: Array) -> float:
        """What a placement withstands; NaN where it does not hold the load, or not by itself."""
        self.put(search, self.start)
        found = self._factor(search, places, u) if search.norm_at(places, u) <= self.max_force else -1.0
        return found if found >= 0 else nan

    def _factor(self, search: Search, places: np.ndarray, u: Array) -> float:
        """What a placement withstands; below zero for one that does not hold."""
        grasp = grasp_at(search.sides, places, u, search.friction)
        if grasp is None:
            return -1.0
        try:
            with np.errstate(all="ignore"):
                return self.state(grasp).value
        except RegraspError:
            return -1.0
