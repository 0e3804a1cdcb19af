"""What a state is chosen for: one value per objective."""

from regrasp.planning.states.objectives.force_cost import ForceCost
from regrasp.planning.states.objectives.known import (
    ANGLE,
    EFFORT,
    FORCE,
    FRICTION_USE,
    OBJECTIVES,
    PEAK,
    PEAK_NORMAL,
    SUM_NORMAL,
    ObjectiveName,
    objective_of,
    recorded,
)
from regrasp.planning.states.objectives.objective import (
    Bound,
    ConvexObjective,
    LevelObjective,
    Objective,
)

__all__ = [
    "ANGLE",
    "EFFORT",
    "FORCE",
    "FRICTION_USE",
    "OBJECTIVES",
    "PEAK",
    "PEAK_NORMAL",
    "SUM_NORMAL",
    "Bound",
    "ConvexObjective",
    "ForceCost",
    "LevelObjective",
    "Objective",
    "ObjectiveName",
    "objective_of",
    "recorded",
]
