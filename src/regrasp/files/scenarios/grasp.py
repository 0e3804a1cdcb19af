"""The scenario of a grasp to be chosen: an outline, what it has to hold, and with how many fingers."""

from functools import cached_property
from math import radians
from typing import Annotated, Literal

from pydantic import Field, model_validator

from regrasp.files.scenarios.disturbance import Disturbance
from regrasp.files.scenarios.keys import Load, Positive, Vector
from regrasp.files.scenarios.regrasp import OutlineEntry
from regrasp.files.strict import Strict
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.choosing import choose_grasp
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.planning.placement.search import Progress

_NotNegative = Annotated[float, Field(ge=0)]


def loads_of(first: Load, also: list[Load]) -> Wrench | LoadSet:
    """One load, or the hull of several."""
    return LoadSet.hull([first.wrench, *(load.wrench for load in also)]) if also else first.wrench


def check_hull(disturbance: Disturbance | None, numbers: int) -> None:
    """``ValueError`` unless deviations are a hull of forces of so many numbers."""
    if disturbance is None:
        return
    if disturbance.hull is None:
        raise ValueError("disturbance: expected a hull, which objectives that take one scale")
    if any(len(entry.force) != numbers for entry in disturbance.hull):
        raise ValueError(f"disturbance.hull: expected forces of {numbers} numbers, as the load's")


class Loads(Load):
    """What the grasp has to hold: one load, several, or one whose force turns."""

    also: list[Load] = Field([], description="other loads that it has to hold, and all between")
    tilt_degrees: Annotated[float, Field(gt=0, le=180)] | None = Field(
        None, description="the load's force turns by up to this angle, any way; 180: every orientation"
    )
    disturbance: Disturbance | None = Field(
        None, description="hull of deviations for objectives 'answered' and 'wrench', which scale it"
    )

    @cached_property
    def value(self) -> Wrench | LoadSet:
        """The load, or the set of them."""
        if self.tilt_degrees is not None:
            return LoadSet.tilted(self.wrench, radians(self.tilt_degrees))
        return loads_of(self, self.also)

    @model_validator(mode="after")
    def _is_planar(self) -> "Loads":
        if any(len(load.force) != 2 for load in (self, *self.also)):
            raise ValueError("the outline is in the plane: expected forces of two numbers")
        if self.also and self.tilt_degrees is not None:
            raise ValueError("expected also or tilt_degrees, found both")
        check_hull(self.disturbance, 2)
        return self


class GraspTask(Strict):
    """With how many fingers, and what is best."""

    kind: Literal["grasp"]
    fingers: int = Field(ge=2, le=4, description="how many")
    objective: Literal[
        "sum_normal",
        "peak_normal",
        "peak",
        "effort",
        "friction_use",
        "angle",
        "force",
        "answered",
        "wrench",
        "wrench_ball",
    ] = Field("sum_normal", description="what the grasp is chosen for; for wrench_ball the load is zero")
    max_force: Positive | None = Field(
        None,
        description="limit on every force [N], for wrench_ball on its normal part; friction_use, angle, "
        "force, answered, wrench and wrench_ball need it",
    )
    length: Positive | None = Field(None, description="[m], by which wrench_ball divides torques")
    min_normal: _NotNegative = Field(0.0, description="[N], with which every finger pushes at the least")
    removable: bool = Field(False, description="whether one finger at least must be free to leave")
    tolerance: Annotated[float, Field(gt=0, lt=1)] = Field(1e-3, description="gap at which the search ends")
    min_distance: Positive | None = Field(None, description="[m], between two fingers")
    from_corners: _NotNegative | None = Field(
        None, description="[m], of a finger from a corner, along the outline; a thousandth of it if absent"
    )
    arcs: Annotated[list[Vector], Field(min_length=1)] | None = Field(
        None,
        description="[m], the only stretches for fingers, counter-clockwise from one arc length to another",
    )
    tip_radius: _NotNegative = Field(0.0, description="[m], of round fingertips")
    in_holes: bool = Field(False, description="whether fingers may be in holes, too, of a polygon")
    load_offset: _NotNegative = Field(0.0, description="[m], by which loads may act beside their lines")
    most_boxes: int | None = Field(
        None,
        ge=64,
        le=10_000_000,
        description="boxes of places after which the search ends; 200,000, or 20,000 with constraints that "
        "bounds know nothing of",
    )


class GraspScenario(Strict):
    """A planar object with its outline, the loads that it is under, and the fingers that are to hold it."""

    title: str | None = Field(None, description="shown above the grasp")
    friction: float = Field(ge=0, description="Coulomb coefficient all along the outline")
    load: Loads
    outline: OutlineEntry
    task: GraspTask

    def chosen(self, progress: Progress | None = None) -> ChosenGrasp:
        """The grasp that is asked for.

        Args:
            progress: called with bound and best value as the search goes on, as of ``choose_grasp``.
        """
        task, disturbance = self.task, self.load.disturbance
        return choose_grasp(
            self.outline.value,
            task.fingers,
            self.load.value,
            friction=self.friction,
            objective=task.objective,
            max_force=task.max_force,
            length=task.length,
            min_normal=task.min_normal,
            removable=task.removable,
            disturbance=None if disturbance is None else disturbance.around(self.load.wrench),
            arcs=task.arcs,
            tip_radius=task.tip_radius,
            in_holes=task.in_holes,
            load_offset=task.load_offset,
            tolerance=task.tolerance,
            min_distance=task.min_distance,
            from_corners=task.from_corners,
            most_boxes=task.most_boxes,
            progress=progress,
        )
