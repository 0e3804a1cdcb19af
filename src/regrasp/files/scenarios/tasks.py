"""What a scenario asks for: a finger that leaves or arrives, or an object that turns in its hold."""

from functools import cached_property
from math import radians
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from regrasp.files.scenarios.keys import Control, Method, Name, PeakRatio, PerFinger, Positive, Reserve
from regrasp.files.strict import Strict
from regrasp.mechanics.checks import Array
from regrasp.mechanics.orientation.rotations import unit_axis
from regrasp.mechanics.reserve import RESERVE
from regrasp.planning.changes.given_ends import BALANCE_TOLERANCE
from regrasp.planning.changes.joining import PathObjective
from regrasp.planning.states.choosing import MOST_FACETS
from regrasp.planning.states.criteria import PEAK_RATIO, Objective
from regrasp.plans.loads import MOST_INSTANTS
from regrasp.plans.timing import PAPER_CONTROL, TimeScaling


class Task(Strict):
    """What all changes of one grasp have in common."""

    objective: Objective = Field("angle", description="what states are chosen for")
    method: Method = Field("auto", description="'auto', 'closed-form' or a back end's name")
    duration: Positive | None = Field(None, description="[s]; 1 unless something else sets it")
    rate: Positive = Field(1000.0, description="set-points per second")
    scaling: Literal["spline", "minimum_jerk", "linear"] = Field("spline", description="shape of T(t)")
    control: Control | None = Field(
        None,
        description=f"control values of the spline, falling from 1 to 0; {list(PAPER_CONTROL)} if absent",
    )
    max_force: Positive | None = Field(None, description="limit on every force [N]")
    peak_ratio: PeakRatio = PEAK_RATIO
    reserve: Reserve = RESERVE
    balance_tolerance: float = Field(
        BALANCE_TOLERANCE,
        ge=0,
        description="given forces may change by this fraction of the largest to reach exact equilibrium",
    )

    @cached_property
    def time_scaling(self) -> TimeScaling:
        """T(t) over the duration asked for."""
        return self.scaling_lasting(1.0 if self.duration is None else self.duration)

    def scaling_lasting(self, duration: float) -> TimeScaling:
        """T(t) over another duration."""
        if self.scaling == "minimum_jerk":
            return TimeScaling.minimum_jerk(duration)
        if self.scaling == "linear":
            return TimeScaling.linear(duration)
        return TimeScaling.spline(duration, PAPER_CONTROL if self.control is None else self.control)

    @model_validator(mode="after")
    def _one_way_to_say_it(self) -> "Task":
        if self.control is not None and self.scaling != "spline":
            raise ValueError(f"control belongs to scaling 'spline', got scaling {self.scaling!r}")
        return self


class Change(Task):
    """What removal and addition have in common."""

    contact: Name = Field(description="name of the finger that leaves or arrives")
    objective: Objective = Field("angle", description="what the state without the finger is chosen for")
    whole_objective: Objective = Field("force", description="what the state with it is chosen for")
    duration: Positive | None = Field(None, description="[s]; 1 unless rate_limit or the load sets it")
    rate_limit: PerFinger | None = Field(
        None,
        description="fastest change of any force [N/s], or a list of one for each contact; "
        "without a duration the shortest is used",
    )
    min_normal: Annotated[float, Field(ge=0)] | None = Field(
        None, description="least normal force of the fingers that stay [N]"
    )
    path_objective: PathObjective | None = Field(
        None, description="what the path is planned for, instant by instant; Eq. 1-3 if absent and enough"
    )
    idle_time: Positive | None = Field(
        None,
        description="time [s] from which the leaving finger, or up to which the arriving one, has no force",
    )
    instants: int = Field(101, ge=3, le=MOST_INSTANTS, description="instants of a path that is not straight")
    facets: int | None = Field(
        None, ge=3, le=MOST_FACETS, description="sides of polygons in the place of circles"
    )


class Removal(Change):
    """One finger leaves."""

    kind: Literal["removal"]


class Addition(Change):
    """One finger arrives; it is listed among the contacts."""

    kind: Literal["addition"]


def _turned(degrees: float) -> float:
    if degrees == 0:
        raise ValueError("expected an angle other than 0, there is nothing to turn")
    return degrees


class Rotation(Task):
    """The object turns in the hold of all its fingers."""

    degrees: Annotated[float, AfterValidator(_turned)] = Field(
        description="turn of the object, counter-clockwise or right-handed about the axis, of any size"
    )
    axis: Annotated[list[float], Field(min_length=3, max_length=3)] | None = Field(
        None, description="in space: the axis of the turn, through the centre of mass"
    )
    kind: Literal["rotation"]

    @property
    def angle(self) -> float:
        """The turn [rad]."""
        return radians(self.degrees)

    @cached_property
    def unit_axis(self) -> Array | None:
        """The axis in space, of length 1."""
        return None if self.axis is None else unit_axis(self.axis)

    @model_validator(mode="after")
    def _is_an_axis(self) -> "Rotation":
        _ = self.unit_axis
        return self
