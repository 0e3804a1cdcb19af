"""The widest factor of a set of load deviations that is withstood."""

from dataclasses import dataclass

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.stiffness import Stiffness, response
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.objectives.objective import ConvexObjective


@dataclass(frozen=True, eq=False, repr=False)
class WithstoodFactor(ConvexObjective):
    """The widest factor of deviations with which forces stay in cones and the contacts' own limits.

    disturbance: the set, scaled about its center; None for deviations of force up to 1 and of torque up to
    the grasp's size [N, N m]. stiffness: of the fingers that answer.
    """

    disturbance: LoadSet | None = None
    stiffness: Stiffness = 1.0

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        """(..., n) the factor of each contact at forces (..., n, w), as the cones measure them [N]."""
        from regrasp.mechanics.robust.withstanding import Withstanding, around_center, measured_response

        answers = measured_response(grasp, response(grasp, self.stiffness))
        given = forces.reshape(-1, *forces.shape[-2:])
        base, loads = around_center(self.deviations(grasp))
        found = [
            Withstanding(grasp.cones, f, answers, grasp.frictions, grasp.max_forces, base, grasp.limit_rows)
            .factors(loads)
            .factors
            for f in given
        ]
        return np.array(found).reshape(forces.shape[:-1])

    def deviations(self, grasp: Grasp) -> LoadSet:
        """The set, of this grasp where none was given."""
        if self.disturbance is not None:
            if self.disturbance.dimension != grasp.dimension:
                raise InvalidInput(
                    f"disturbance must have the grasp's dimension {grasp.dimension}, got "
                    f"{self.disturbance.dimension}"
                )
            return self.disturbance
        none = Wrench.from_vector(np.zeros(len(grasp.matrix)))
        return LoadSet.ball(none, force=1.0, torque=grasp.size or 1.0)

    def value(self, state: GraspState) -> float:
        """The least factor over the contacts, within the limits that the state was chosen under."""
        grasp = state.grasp
        limits = np.array(getattr(state, "force_limits", grasp.max_forces))
        from regrasp.mechanics.robust.withstanding import Withstanding, around_center, measured_response

        answers = measured_response(grasp, response(grasp, self.stiffness))
        forces = grasp.cones.measured(state.forces)
        base, loads = around_center(self.deviations(grasp))
        found = Withstanding(grasp.cones, forces, answers, grasp.frictions, limits, base, grasp.limit_rows)
        return float(found.factors(loads).factors.min())

    def scale(self, unit: float) -> float:
        """One: a factor has no unit."""
        return 1.0
