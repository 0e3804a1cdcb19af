"""What a scenario asks for: a finger that leaves or arrives, or an object that turns in its hold."""

from functools import cached_property
from math import radians
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from regrasp.errors import shown
from regrasp.files.scenarios.keys import Control, Method, Name, PerFinger, Positive, option
from regrasp.files.strict import Strict
from regrasp.mechanics.checks import Array
from regrasp.mechanics.orientation.rotations import unit_axis
from regrasp.planning.changes.joining import PathObjective
from regrasp.planning.states.objectives import ObjectiveName
from regrasp.planning.states.options import ChangeOptions, PlanOptions
from regrasp.plans.timing import PAPER_CONTROL, TimeScaling


class Task(Strict):
    """What all changes of one grasp have in common."""

    objective: ObjectiveName = Field("angle", description="what states are chosen for")
    method: Method = option(PlanOptions, "method")
    facets: int | None = option(PlanOptions, "facets", ge=3)
    duration: Positive | None = option(PlanOptions, "duration")
    rate: Positive = Field(1000.0, description="set-points per second")
    scaling: Literal["spline", "minimum_jerk", "linear"] = Field("spline", description="shape of T(t)")
    control: Control | None = Field(
        None,
        description=f"control values of the spline, falling from 1 to 0; {list(PAPER_CONTROL)} if absent",
    )
    max_force: Positive | None = option(PlanOptions, "max_force")
    peak_ratio: float = option(PlanOptions, "peak_ratio", ge=1)
    reserve: float = option(PlanOptions, "reserve", ge=0, lt=1)
    balance_tolerance: float = option(PlanOptions, "balance_tolerance", ge=0)
    min_normal: Annotated[float, Field(ge=0)] | None = option(PlanOptions, "min_normal")

    stiffness: PerFinger | None = option(PlanOptions, "stiffness")

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
            raise ValueError(f"control belongs to scaling 'spline', got scaling {shown(self.scaling)}")
        return self


class Timed(Task):
    """What tasks have in common whose path may go through instants."""

    rate_limit: PerFinger | None = option(ChangeOptions, "rate_limit")
    path_objective: PathObjective | None = option(ChangeOptions, "path_objective")
    instants: int = option(ChangeOptions, "instants", ge=3)


class Hold(Timed):
    """No finger moves: forces follow a load that changes, or go from one state to another."""

    objective: ObjectiveName = Field("angle", description="what the state at the end is chosen for")
    start_objective: ObjectiveName | None = Field(
        None, description="what the state at the start is chosen for; the same if absent"
    )
    kind: Literal["hold"]


class Change(Timed):
    """What changes of the fingers in use have in common."""

    contact: Name = Field(description="name of the finger that leaves or arrives")
    objective: ObjectiveName = Field("angle", description="what the state without the finger is chosen for")
    early_loss: bool = option(ChangeOptions, "early_loss")

    @property
    def leaving(self) -> tuple[str, ...]:
        """Names of the fingers that leave."""
        return ()

    @property
    def arriving(self) -> tuple[str, ...]:
        """Names of the fingers that arrive; they are listed among the contacts."""
        return ()


class OneFinger(Change):
    """What removal and addition have in common."""

    whole_objective: ObjectiveName = Field("force", description="what the state with it is chosen for")
    idle_time: Positive | None = Field(
        None,
        description="time [s] from which the leaving finger, or up to which the arriving one, has no force",
    )


class Removal(OneFinger):
    """One finger leaves."""

    kind: Literal["removal"]

    @property
    def leaving(self) -> tuple[str, ...]:
        """The finger that leaves."""
        return (self.contact,)


class Addition(OneFinger):
    """One finger arrives; it is listed among the contacts."""

    kind: Literal["addition"]

    @property
    def arriving(self) -> tuple[str, ...]:
        """The finger that arrives."""
        return (self.contact,)


class Exchange(Change):
    """One finger takes over from another; both are listed among the contacts."""

    contact: Name = Field(description="name of the finger that leaves")
    arrival: Name = Field(description="name of the finger that arrives")
    objective: ObjectiveName = Field("angle", description="what the state at the end is chosen for")
    start_objective: ObjectiveName | None = Field(
        None, description="what the state at the start is chosen for; the same if absent"
    )
    idle_from: Positive | None = Field(
        None, description="time from which the leaving finger has no force [s]"
    )
    idle_until: Positive | None = Field(
        None, description="time up to which the arriving finger has no force [s]"
    )
    kind: Literal["exchange"]

    @property
    def leaving(self) -> tuple[str, ...]:
        """The finger that leaves."""
        return (self.contact,)

    @property
    def arriving(self) -> tuple[str, ...]:
        """The finger that arrives."""
        return (self.arrival,)

    @model_validator(mode="after")
    def _is_an_exchange(self) -> "Exchange":
        if self.contact == self.arrival:
            raise ValueError(
                f"arrival: expected another finger than the one that leaves, got {shown(self.arrival)}"
            )
        return self


def _turned(degrees: float) -> float:
    if degrees == 0:
        raise ValueError("expected an angle other than 0, there is nothing to turn")
    return degrees


class Rotation(Task):
    """The object turns in the hold of all its fingers."""

    degrees: Annotated[float, AfterValidator(_turned)] = Field(
        description="turn of the object, counter-clockwise or right-handed about the axis, up to 1000 rad"
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
