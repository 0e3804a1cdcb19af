"""The level of what set-points withstand: the factor of deviations that stiffness alone answers.

Forces f + s R d that stay within cones and limits balance the load and s d: what is withstood is answered, so
no placement withstands more than the most that any answers. That is the bound; how much of it set-points
reach is searched for, from the placements that answer most, and not proven.
"""

from itertools import product
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
from regrasp.planning.placement.results import grasp_at
from regrasp.planning.placement.search import Search
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.criteria import ChosenState

_SEEDS, _CLIMBED = 24, 3  # placements judged to begin with, and those from which fingers slide
_BATCHES = 8  # of boxes whose placements may be seeds
_DIFFERENT = 0.02  # of the size, between seeds
_FIRST, _LAST = 0.2, 2e-3  # steps of sliding, as parts of an edge
_GAIN = 1e-9  # of a factor, the least that counts
_ROUNDING = 1e-9

Placed = tuple[float, np.ndarray, Array]


class WithstoodLevel(AnsweredLevel):
    """Loads center + factor deviation: the level bounds by what is answered, and shows what is withstood."""

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

    def improve(self, search: Search, tolerance: float) -> None:
        """Of a search that ended at what is answered: put those placements first that withstand most."""
        judged = [(-self._factor(search, places, u), places, u) for places, u in self._seeds(search)]
        judged.sort(key=lambda placed: placed[0])
        climbed = [self._climbed(search, placed, tolerance) for placed in judged[:_CLIMBED]]
        search.take([placed for placed in climbed + judged if placed[0] <= 0])

    def _seeds(self, search: Search) -> list[tuple[np.ndarray, Array]]:
        """Placements that answer much and differ."""
        kept = search.placements()
        best = max((self._factor(search, places, u) for _, places, u in kept[:3]), default=0.0)
        other = search.anew()
        self.put(other, max(best, 0.0))
        for _ in range(_BATCHES):
            if not other.goes_on(self.max_force, 0.0, 4096, only=True):
                break
        tried = [p for p in other.tried_since(0) if p[0] <= self.max_force]
        found: list[tuple[np.ndarray, Array]] = []
        shown: list[Array] = []
        for _, places, u in kept[:3] + tried:
            points = search.sides.points(places, u)[np.argsort(u)]
            near = [np.abs(points - p).max() < _DIFFERENT * search.sides.size for p in shown]
            if len(found) < 3 or not any(near):
                found.append((places, u))
                shown.append(points)
            if len(found) == _SEEDS:
                break
        return found

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

    def _climbed(self, search: Search, placed: Placed, tolerance: float) -> Placed:
        """The best placement that fingers find by sliding, one at a time, by steps that are halved."""
        best, places, u = -placed[0], placed[1], placed[2]
        step = _FIRST
        while step > _LAST and best >= 0:
            helped = False
            for i, way in product(range(len(u)), (-step, step)):
                on, there = places.copy(), u.copy()
                on[i], there[i] = search.sides.moved(int(places[i]), float(u[i]), way)
                wanted = best * (1 + 0.1 * tolerance) + _GAIN
                self.put(search, wanted)
                if not search.are_apart(on, there) or search.norm_at(on, there) > self.max_force:
                    continue  # it does not even answer more
                factor = self._factor(search, on, there)
                if factor > wanted:
                    best, places, u, helped = factor, on, there, True
            step *= 1.0 if helped else 0.5
        return -best, places, u
