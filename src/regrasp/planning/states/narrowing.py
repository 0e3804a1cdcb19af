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
from math import hypot, isnan, sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.opposition import parts
from regrasp.planning.states.objectives import LevelObjective

LEVEL_TOLERANCE = 1e-7
"""The chosen angle margin [rad] or friction use [-] is within this of the best one."""
_PARTS = 40


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
        level = self.objective.level_of(forces, self.grasp.cones.normals, np.array(self.frictions))
        return self.top if isnan(level) else level  # nothing is used of nothing

    def falls(self, level: float, cones: dict[int, float]) -> Array:
        """(k,) how fast the frictions of the cones of a level fall with it."""
        whole = np.array([self.frictions[i] for i in cones])
        return self.objective.slopes(whole, np.array(list(cones.values())), level)[1]

    def ceiling(
        self, load: Array, twist: Array, limits: Array, low: float, high: float, within: float
    ) -> float:
        """The least level from ``low`` up at which a motion proves that no forces balance a load.

        limits: (n,) [N]. The level is found to ``within``, never below where the proof begins; ``high`` where
        the motion proves nothing there.
        """
        cones = self.grasp.cones
        velocities = (twist @ cones.matrix).reshape(len(self.grasp), -1)
        along, across = (part.tolist() for part in parts(velocities, cones.normals))
        power, bounds = float(load @ twist), limits.tolist()

        def won(level: float) -> float:
            """Work of the load beyond what the cones of a level can oppose; it rises with the level."""
            work = power
            for i, mu in self.narrowed(level).items():
                n, t = along[i], across[i]
                if t <= -mu * n:
                    work -= bounds[i] * hypot(n, t)
                elif mu * t > n:
                    work -= bounds[i] * (mu * t - n) / sqrt(1 + mu * mu)
            return work

        below, above = won(low), won(high)
        if not above > 0:
            return high
        if below > 0:
            return low
        side = 0
        for _ in range(_PARTS):  # regula falsi (Illinois)
            if high - low <= within:
                break
            level = float(high - above * (high - low) / (above - below))
            if not low < level < high:
                level = (low + high) / 2
            value = won(level)
            if value > 0:
                high, above = level, value
                below, side = (below / 2 if side > 0 else below), 1
            else:
                low, below = level, value
                above, side = (above / 2 if side < 0 else above), -1
        return high
