"""Objectives that are a level at which forces below a limit exist: friction in use, margins, loads answered.

Boxes are excluded where forces at the level must exceed the limit. Whatever is excluded at a level is at
every better one, since cones are narrower or loads farther out; so the search goes on, box by box, while
placements that are found raise the level.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import suppress
from math import atan, inf, isnan, nan, sqrt, tan

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.search import Search
from regrasp.planning.states.choosing import choose_state

_STEP = 1e-6  # of a level that is zero
_HALVINGS = 50
_NEARER = 0.998  # of the tolerance: what forces for solvers give back is within it, too
_SPARED = 0.9  # and what boxes too narrow to be split are off by
_EXACT = 1e-10  # relative, of the level of a placement
SURE = 1e-6
"""Of the limit, more than norms are uncertain by."""
AT_THE_EDGE = (1e-8, 1e-6, 1e-4)
"""Parts of a load given back so that forces for it exist for solvers, too."""

Shown = tuple[Sequence[GraspState], float]
"""States and the value that they show."""


class Level(ABC):
    """A level of which more is better, from ``start`` on; the limit of every force is ``max_force`` [N]."""

    start: float
    narrow = 0.03
    """Of the tolerance: arcs of less, as a fraction of the size, are not split."""

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

    @abstractmethod
    def shown(self, grasp: Grasp, objective: str, loads: Array, level: float) -> Shown | None:
        """States of a grasp that show the value at a level, near what was found; None for none.

        loads: (L, 3) of the task.
        """

    def value(self, level: float) -> float:
        """The objective at a level."""
        return level

    def of(self, search: Search, places: np.ndarray, u: Array) -> float:
        """The objective of a placement; NaN where it does not hold at all."""
        self.put(search, self.start)
        if not search.is_within(places, u, self.max_force):
            return nan
        return self.value(self.reached(search, self.start, places, u))

    def reached(self, search: Search, known: float, places: np.ndarray, u: Array) -> float:
        """The best level at which a placement has forces below the limit, at least ``known``."""
        lo, hi = known, self.top(search)
        for _ in range(_HALVINGS):
            middle = 0.5 * (lo + hi)
            self.put(search, middle)
            if search.is_within(places, u, self.max_force * (1 - SURE)):
                lo = middle
            else:
                hi = middle
            if hi - lo <= _EXACT * max(abs(lo), abs(hi)):
                break
        return lo


class FrictionLevel(Level):
    """Cones narrowed from friction mu to nu: the level is -nu / mu for the use, or the angle margin [rad]."""

    narrow = 0.001

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
        return level + max(_SPARED * tolerance * abs(level), _STEP)

    def top(self, search: Search) -> float:
        """No friction left."""
        return atan(self.friction) if self.angle else 0.0

    def value(self, level: float) -> float:
        """The use of friction [-] or the angle margin [rad]."""
        return min(level, atan(self.friction)) if self.angle else max(0.0, -level)

    def shown(self, grasp: Grasp, objective: str, loads: Array, level: float) -> Shown | None:
        """The states of the loads."""
        limit = self.max_force
        states = [choose_state(grasp, Wrench.from_vector(w), objective, max_force=limit) for w in loads]
        values = [state.value for state in states if not isnan(state.value)]  # none where no force is
        return states, (min(values) if self.angle else max(values))


class ForceLevel(Level):
    """Forces that keep a distance from the edges of their cones: the level is the distance [N]."""

    start = 0.0
    narrow = 0.01

    def __init__(self, max_force: float, friction: float) -> None:
        super().__init__(max_force)
        self.most = max_force * friction / sqrt(1 + friction**2)

    def put(self, search: Search, level: float) -> None:
        """Move the edges of the cones inward."""
        search.limit, search.margin = self.max_force, level

    def beyond(self, level: float, tolerance: float) -> float:
        """Larger by a fraction of it."""
        return min(level + max(_SPARED * tolerance * level, _STEP * self.most), self.most)

    def top(self, search: Search) -> float:
        """Forces along the normals, of the limit."""
        return self.most

    def shown(self, grasp: Grasp, objective: str, loads: Array, level: float) -> Shown | None:
        """The states of the loads."""
        limit = self.max_force
        states = [choose_state(grasp, Wrench.from_vector(w), objective, max_force=limit) for w in loads]
        return states, min(state.value for state in states)


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
        return level + max(_NEARER * tolerance * level, _STEP)

    def top(self, search: Search) -> float:
        """So large a wrench as k forces of the limit do not make, at the largest lever."""
        reach = np.array([1.0, 1.0, search.sides.size]) * search.fingers * self.max_force
        with np.errstate(divide="ignore"):
            factors = (reach + np.abs(self.center)) / np.abs(self.deviations)
        return 2.0 * float(factors.min(axis=1).min(initial=inf))

    def shown(self, grasp: Grasp, objective: str, loads: Array, level: float) -> Shown | None:
        """The states of the load and of the deviations at the level, or a little before it."""
        nothing = (1.0,) if level <= _STEP else ()  # where the load alone is held, up to rounding
        for back in AT_THE_EDGE + nothing:
            factor = level * (1 - back)
            given = map(Wrench.from_vector, self.loads(factor))
            with suppress(Infeasible):
                return [choose_state(grasp, w, "peak", max_force=self.max_force) for w in given], factor
        return None
