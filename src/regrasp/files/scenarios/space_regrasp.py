"""The scenario of a whole regrasp in space: a solid, where four fingers start and where they are to be."""

from collections.abc import Callable
from functools import cached_property
from math import radians
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from regrasp.errors import InvalidInput
from regrasp.files.scenarios.disturbance import Disturbance
from regrasp.files.scenarios.keys import SpaceVector
from regrasp.files.scenarios.motions_entry import MotionsEntry
from regrasp.files.scenarios.object_entry import ObjectEntry
from regrasp.files.scenarios.regrasp_task import CommonTask, Ended
from regrasp.files.strict import Strict
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.orientation.rotations import rotation_matrix, unit_axis
from regrasp.planning.holds.pairs import MOST_ORIENTATIONS
from regrasp.planning.holds.triples import FACETS
from regrasp.planning.regrasps.options import MOST_CANDIDATES
from regrasp.planning.regrasps.settings.spatial import MAX_TURN
from regrasp.planning.states.choosing import MOST_FACETS

# Loads that differ by less than this fraction are one.
_SAME = 1e-9


class SpaceWeight(Strict):
    """The external force on the object, through its centre of mass and fixed in the world."""

    force: SpaceVector = Field(description="[N], x, y and z in the object frame before it turns")
    disturbance: Disturbance | None = Field(
        None, description="deviations that every state and step withstands, in the object's frame"
    )


class SpacePlaces(Strict):
    """Where four fingers touch."""

    positions: Annotated[list[SpaceVector], Field(min_length=4, max_length=4)] = Field(
        description="[m], relative to the centre of mass; fingers touch at the nearest points of the surface"
    )


class SpaceRegraspTask(CommonTask):
    """How to get from the start to the goal."""

    orientations: int = Field(
        42,
        ge=1,
        le=MOST_ORIENTATIONS,
        description="directions of the load, seen from the object, that are tried; 1 forbids turning",
    )
    goal_degrees: float = Field(
        0.0, description="how far the object is turned in the end, right-handed about goal_axis"
    )
    goal_axis: SpaceVector | None = Field(
        None, description="of the turn from the start to the end; of any length, through the centre of mass"
    )
    candidates: int = Field(
        40, ge=1, le=MOST_CANDIDATES, description="points on the surface where fingers may touch"
    )
    seed: int = Field(0, ge=0, description="of these points")
    max_turn_degrees: Annotated[float, Field(gt=0, lt=180)] = Field(
        float(np.degrees(MAX_TURN)), description="largest turn in one step"
    )
    facets: int = Field(
        FACETS,
        ge=4,
        le=MOST_FACETS,
        multiple_of=2,
        description="of the inner pyramids in which holds are looked for",
    )

    @cached_property
    def goal_rotation(self) -> Array:
        """(3, 3) from the object's frame in the end to its frame at the start."""
        if self.goal_axis is None:
            return np.eye(3)
        return rotation_matrix(unit_axis(self.goal_axis), radians(self.goal_degrees))

    @model_validator(mode="after")
    def _goal_is_a_turn(self) -> "SpaceRegraspTask":
        if self.goal_degrees and self.goal_axis is None:
            raise ValueError(
                f"goal_axis: needed for a turn by goal_degrees = {self.goal_degrees:g}; give three numbers"
            )
        if self.goal_axis is not None and not self.goal_degrees:
            raise ValueError("goal_degrees: expected the turn about goal_axis, an angle other than 0")
        try:
            _ = self.goal_rotation
        except InvalidInput as error:
            raise ValueError(f"goal_{error}") from None
        return self


class SpaceRegraspScenario(Ended):
    """A solid object, four fingers on it, and where they are to be."""

    title: str | None = Field(None, description="shown above the plan")
    friction: float = Field(ge=0, description="Coulomb coefficient all over the surface")
    load: SpaceWeight
    object: ObjectEntry
    start: SpacePlaces
    goal: SpacePlaces
    motions: MotionsEntry | None = Field(None, description="ways of free fingers, asked for by --motions")
    task: SpaceRegraspTask

    @model_validator(mode="after")
    def _fits_together(self) -> "SpaceRegraspScenario":
        problems = self._end_problems(".positions")
        force = np.array(self.load.force)
        if not force.any():
            problems.append("load.force: expected a force other than zero, which says what the fingers hold")
        turned = abs(self.task.goal_rotation.T @ force - force).max()
        if self.task.orientations == 1 and turned > _SAME * abs(force).max():
            problems.append(
                "task.orientations: 1 forbids turning the load, but goal_axis and goal_degrees do; give more"
            )
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def _placed(self, end: Literal["start", "goal"]) -> tuple[str, list[Any], Callable[[Any], Contact]]:
        places: SpacePlaces = getattr(self, end)
        return "positions", places.positions, self._near

    @property
    def _from(self) -> str:
        return ", from the centre of mass"

    def _near(self, position: list[float]) -> Contact:
        mesh = self.object.value
        return mesh.contact_at(np.array(position) + mesh.centre_of_mass, friction=self.friction)
