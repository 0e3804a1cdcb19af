"""The highest level of narrowed cones by Newton's method.

The depth t to which forces reach inside the cones of a level falls with it; the duals say how fast, so that
Newton's method finds the level where it is zero. Where cones are too narrow the duals are a motion that
proves so. Once the level is known well, one program just above it and one just below end with the proof and
with the forces. Only of these two anything is believed: forces are moved into equilibrium inside the cones,
and what the motion is worth is decided by itself.
"""

from math import sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.planning.states.levels.depths import Depths, of_all, of_some, of_those_that_push
from regrasp.planning.states.narrowing import LEVEL_TOLERANCE, Narrowing
from regrasp.planning.states.solving import FEASIBLE, Chooser, Depth

# Of the largest normal force: what the first step asks for at every finger at least.
_FIRST = 0.05
_STEPS = 14
# A normal force below this fraction of the largest is a solver's noise at a finger that carries none.
_IDLE = 1e-7
# From a level not known well to one known, in parts of the tolerance.
_NEAR = LEVEL_TOLERANCE / 16
# Beside the best level depths are less than this; duals of what is far out of reach know little of it.
_SHALLOW = 1e-3
# The level from which on a motion is a proof is found to this, and then a little above.
_WITHIN, _ABOVE = LEVEL_TOLERANCE / 50, 1e-10


def climbed(
    chooser: Chooser, narrowing: Narrowing, forces: Array, limits: list[float]
) -> tuple[Array, float, bool]:
    """Forces of a high level, a level proven out of reach, and whether both are near and the margin widest.

    From ``forces`` in equilibrium; where one of the two is not found, these or the highest level come back.
    """
    climb, top = _Climb(chooser, narrowing, forces, limits), narrowing.top
    level, is_near, edge = climb.low, False, None
    for _ in range(_STEPS if climb.known.any() and climb.low < top else 0):
        best = climb.step(level, is_near)
        if best is None or climb.is_done:
            break
        error = min(abs(best - level), 1.0) ** 2
        is_near = error < _NEAR and abs(climb.depth) < _SHALLOW
        edge, was_at = climb.edge(), edge
        if edge is not None:
            level, is_near = edge, True
            continue
        if was_at is not None and climb.held >= was_at:
            level, is_near = climb.held + LEVEL_TOLERANCE / 2, True
            continue
        if is_near:
            level = climb.beside(best)
        else:
            level = best + error if best <= level else best + max(error, LEVEL_TOLERANCE / 4)
        if not climb.low < level < climb.high and not (
            is_near and climb.found is None and level < climb.high
        ):
            level = (climb.low + climb.high) / 2
        level = max(level, 0.0)
    if climb.found is None:
        return forces, top, False
    return climb.found, *climb.proven()


class _Climb:
    """What the steps have shown.

    low, high: levels between which the best is, as far as answers tell. held, lost: the level of ``found``
    and one that ``motion`` proves out of reach. known: (n,) normal forces by which depths are measured.
    """

    def __init__(self, chooser: Chooser, narrowing: Narrowing, forces: Array, limits: list[float]) -> None:
        self.chooser, self.narrowing, self.limits = chooser, narrowing, limits
        self.depths, self.bounds = Depths(chooser, limits), np.array(limits)
        known = np.maximum(chooser.grasp.cones.normal(forces), 0.0) / chooser.unit
        self.known = np.maximum(known, _FIRST * known.max())  # a finger idle so far may be needed
        self.low = self.held = max(narrowing.level(forces), 0.0)
        self.high = self.lost = narrowing.top
        self.depth = np.inf
        self.found: Array | None = None
        self.motion: Array | None = None
        self._low_cones, self._high_cones = frozenset(range(len(known))), frozenset(range(len(known)))
        self._above = LEVEL_TOLERANCE / 4

    @property
    def is_done(self) -> bool:
        """Whether what is found is within the tolerance of what is proven."""
        return self.found is not None and self.lost - self.held <= LEVEL_TOLERANCE

    def step(self, level: float, is_near: bool) -> float | None:
        """Try a level; the best one by Newton's method. None where the back end fails."""
        narrowing = self.narrowing
        cones = narrowing.narrowed(level)
        step = self.depths.of(cones, None if is_near else self.known)
        if step is None:
            return None
        places, self.depth = list(cones), step.depth
        fall = narrowing.falls(level, cones) @ (step.weights * step.normals)
        best = float(level + step.depth / fall) if fall > 0 else level
        if is_near:
            if step.depth > -FEASIBLE and self._settles(cones, step, level):
                return max(best, self.held)
            if step.depth > FEASIBLE:  # rounding takes the forces out of their cones
                self.low, self._low_cones = level, frozenset(places)
                return best
        elif step.depth > 0:
            self.known = np.zeros(len(self.limits))
            self.known[places] = np.maximum(step.normals, 0.0)
            self._low_cones = frozenset(places)
            # Steps from far below are short of what their forces reach.
            at_work = (step.normals > _IDLE * step.normals.max())[:, None]
            reached = narrowing.level(of_all(self.chooser.grasp, cones, step.forces * at_work))
            self.low = min(max(level, reached), self.high)
            return max(best, self.low)
        if is_near or step.depth < -FEASIBLE:
            self.high, self._high_cones = min(self.high, level), frozenset(places)
        if is_near or (abs(best - level) < sqrt(_NEAR) and self.depth > -_SHALLOW):
            self._proves(step, level)
        return best

    def edge(self) -> float | None:
        """The least level at which the cone of a finger vanishes that is needed below the best one."""
        gone = self._low_cones - self._high_cones
        if not gone:
            return None
        edge = min(self.narrowing.objective.top([self.narrowing.frictions[i]]) for i in gone)
        return edge if self.low < edge < self.high else None

    def beside(self, best: float) -> float:
        """A level just below the best one for the forces, or just above it for the proof."""
        target = min(best, self.lost)
        if self.found is None or target - self.held > LEVEL_TOLERANCE:
            return target - 0.3 * LEVEL_TOLERANCE
        above, self._above = self._above, 0.8 * LEVEL_TOLERANCE  # the first one may still be reached
        return best + above

    def _settles(self, cones: dict[int, float], step: Depth, level: float) -> bool:
        mu, bound = list(cones.values()), [self.limits[i] for i in cones]
        some = of_some(self.chooser, cones)
        moved = some.settled if min(mu) <= NEGLIGIBLE else some.shifted  # onto normals Newton's method moves
        settled = moved(step.forces, mu, bound)
        if settled is None:
            settled = of_those_that_push(some, step.forces, mu, bound)
        if settled is None:
            return False
        self.found = of_all(self.chooser.grasp, cones, settled)
        self.held = self.low = max(self.narrowing.level(self.found), level)
        self._low_cones = frozenset(cones)
        return True

    def _proves(self, step: Depth, level: float) -> None:
        end = min(level + LEVEL_TOLERANCE / 2, self.narrowing.top)
        load = self.chooser.load.vector
        ceiling = self.narrowing.ceiling(load, step.motion, self.bounds, self.held, end, _WITHIN)
        if ceiling < min(self.lost, end):
            self.lost, self.motion = ceiling, step.motion

    def proven(self) -> tuple[float, bool]:
        """The level out of reach, proven, and whether ``found`` is near."""
        top = self.narrowing.top
        if self.motion is None:
            return top, self.is_done
        sure = min(self.lost + _ABOVE, top)
        cones = self.narrowing.narrowed(sure)
        some, mu = of_some(self.chooser, cones), list(cones.values())
        if some.proves(self.motion, mu, [self.limits[i] for i in cones]):
            return sure, self.is_done
        return top, False
