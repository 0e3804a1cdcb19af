"""Keys of the task of a whole regrasp that are the same in the plane and in space."""

from typing import Literal

from pydantic import Field

from regrasp.files.keys import PeakRatio, Positive, Reserve
from regrasp.files.strict import Strict
from regrasp.mechanics.reserve import RESERVE
from regrasp.planning.criteria import PEAK_RATIO, Objective


class CommonTask(Strict):
    """How states are chosen, what every hold must have, and the timing."""

    kind: Literal["regrasp"]
    objective: Objective = Field("angle", description="what the state of every hold is chosen for")
    states: Literal["each", "joint"] = Field("each", description="chosen each by itself, or all together")
    least_margin_degrees: float = Field(0.0, ge=0, description="angle margin every hold must have")
    min_distance: float = Field(0.0, ge=0, description="[m], between two fingers that hold the object")
    max_force: Positive | None = Field(None, description="limit on every force [N]")
    peak_ratio: PeakRatio = PEAK_RATIO
    reserve: Reserve = RESERVE
    step_duration: Positive = Field(1.0, description="[s] of each step")
    rate: Positive = Field(1000.0, description="set-points per second")
