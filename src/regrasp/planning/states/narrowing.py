"""Objectives that are reached by narrowing the cones: a quasi-convex choice, certified from both sides.

The states whose angle margins are all m or more are those inside cones narrowed by m; the states that use at
most the fraction u of the friction are those inside cones of friction u mu. Both sets are convex and shrink
as the level (m, or 1 - u) rises, and a finger whose cone is gone may still be idle.

The search climbs from below: inside the narrowed cones, the state farthest from the edges in proportion to
the normal forces found last has a higher level, and these steps converge quadratically (the differential
correction algorithm: Barrodale, Powell and Roberts, SIAM J. Numerical Analysis 9, 1972). From
above, the duals of a level that cannot be reached are the twist along which the object would escape, which is
decided in exact arithmetic. So the best level lies between that of forces in hand and that of a proof.
"""

from dataclasses import dataclass
from functools import cached_property
from math import isnan

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import margins
from regrasp.planning.states.objectives import LevelObjective

LEVEL_TOLERANCE = 1e-7
"""The chosen angle margin [rad] or friction use [-] is within this of the best one."""


@dataclass(frozen=True)
class Narrowing:
    """Cones that narrow as the level of an objective rises.

    objective: ``angle``, whose level is the margin [rad]; ``friction_use``, whose level is 1 - use [-].
    frictions: (n,) of the whole cones.
    """

    grasp: Grasp
    objective: LevelObjective
    frictions: list[float]

    @cached_property
    def top(self) -> float:
        """A level that no forces exceed."""
        return self.objective.top(self.frictions)

    def narrowed(self, level: float) -> dict[int, float]:
        """Friction by contact at a level; contacts that have no cone left are missing."""
        left = ((i, self.objective.narrowed(mu, level)) for i, mu in enumerate(self.frictions))
        return {i: mu for i, mu in left if mu is not None}

    def level(self, forces: Array) -> float:
        """The level of forces (n, d), over the contacts that carry any."""
        level = self.objective.level(margins(forces, self.grasp.cones.normals, np.array(self.frictions)))
        return self.top if isnan(level) else level  # nothing is used of nothing
