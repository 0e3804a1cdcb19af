"""The scenario of a grasp to be chosen in space: a solid, what it has to hold, and with how many fingers."""

from functools import cached_property
from typing import Annotated, Literal

from pydantic import Field, model_validator

from regrasp.files.scenarios.disturbance import Disturbance
from regrasp.files.scenarios.grasp import check_hull, loads_of
from regrasp.files.scenarios.keys import Load, Positive
from regrasp.files.scenarios.object_entry import ObjectEntry
from regrasp.files.strict import Strict
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.choosing import choose_grasp
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.planning.placement.search import Progress


class SpaceLoads(Load):
    """What the grasp has to hold: one load or several."""

    also: list[Load] = Field([], description="other loads that it has to hold, and all between")
    disturbance: Disturbance | None = Field(
        None, description="hull of deviations for objective 'answered', which scales it"
    )

    @cached_property
    def value(self) -> Wrench | LoadSet:
        """The load, or the set of them."""
        return loads_of(self, self.also)

    @model_validator(mode="after")
    def _is_in_space(self) -> "SpaceLoads":
        if any(len(load.force) != 3 for load in (self, *self.also)):
            raise ValueError("the object is in space: expected forces of three numbers")
        check_hull(self.disturbance, 3)
        return self


class SpaceGraspTask(Strict):
    """With how many fingers, and what is best."""

    kind: Literal["grasp"]
    fingers: int = Field(ge=2, le=4, description="how many")
    objective: Literal["sum_normal", "peak_normal", "peak", "effort", "friction_use", "angle", "answered"] = (
        Field("sum_normal", description="what the grasp is chosen for")
    )
    max_force: Positive | None = Field(
        None, description="limit on every force [N]; friction_use, angle and answered need it"
    )
    tolerance: Annotated[float, Field(gt=0, lt=1)] = Field(1e-2, description="gap at which the search ends")
    min_distance: Positive | None = Field(None, description="[m], between two fingers")
    from_corners: Annotated[float, Field(ge=0)] | None = Field(
        None,
        description="[m], of a finger from a sharp edge, along the face; a thousandth of the root of the "
        "area if absent",
    )
    most_boxes: int | None = Field(
        None, ge=64, le=10_000_000, description="boxes of places after which the search ends; 200,000"
    )


class SpaceGraspScenario(Strict):
    """A solid of flat faces, the loads that it is under, and the fingers that are to hold it."""

    title: str | None = Field(None, description="shown above the grasp")
    friction: float = Field(ge=0, description="Coulomb coefficient all over the surface")
    load: SpaceLoads
    object: ObjectEntry
    task: SpaceGraspTask

    def chosen(self, progress: Progress | None = None) -> ChosenGrasp:
        """The grasp that is asked for.

        Args:
            progress: called with bound and best value as the search goes on, as of ``choose_grasp``.
        """
        task, disturbance = self.task, self.load.disturbance
        return choose_grasp(
            self.object.value,
            task.fingers,
            self.load.value,
            friction=self.friction,
            objective=task.objective,
            max_force=task.max_force,
            disturbance=None if disturbance is None else disturbance.around(self.load.wrench),
            tolerance=task.tolerance,
            min_distance=task.min_distance,
            from_corners=task.from_corners,
            most_boxes=task.most_boxes,
            progress=progress,
        )
