"""The level of what set-points withstand: the factor of deviations that stiffness alone answers.

Forces f + s R d that stay within cones and limits balance the load and s d: what is withstood is answered. So
boxes of groups of edges are excluded by the loads one by one; those that are left by all loads together
(``Ties``), the one that may withstand most first.
"""

from math import inf

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
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.criteria import ChosenState

_SEEDS = 8  # placements that answer most, judged to begin with
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
        factor = first.value * (1 - _ROUNDING)
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
        judged = [(-self._factor(search, p, u), p, u) for _, p, u in search.placements()[:_SEEDS]]
        judged = sorted((p for p in judged if p[0] <= 0), key=lambda placed: placed[0])
        search.take(judged)
        found = search.anew()
        found.narrow = inf  # until one side is left of each finger
        self.put(found, self.beyond(-judged[0][0] if judged else 0.0, tolerance))
        limit = self.max_force * (1 + STRICT)
        try:
            while found.goes_on(limit, 0.0, most, only=True):
                pass
        except KeyboardInterrupt:
            return search, beyond

        def factor(places: np.ndarray, u: Array) -> float:
            return self._factor(search, places, u)

        reached = TiedSearch(self, found, factor, judged, tolerance).run(most, progress, beyond)
        search.take(found.placements())
        return (found, reached) if found.closed else (search, beyond)

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
