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
    WRENCH,
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
from regrasp.planning.states.objectives.withstood import WithstoodFactor

__all__ = [
    "ANGLE",
    "EFFORT",
    "FORCE",
    "FRICTION_USE",
    "OBJECTIVES",
    "PEAK",
    "PEAK_NORMAL",
    "SUM_NORMAL",
    "WRENCH",
    "Bound",
    "ConvexObjective",
    "ForceCost",
    "LevelObjective",
    "Objective",
    "ObjectiveName",
    "WithstoodFactor",
    "objective_of",
    "recorded",
]
