"""What scenarios of whole regrasps have in common, in the plane and in space."""

from collections.abc import Callable
from functools import cached_property
from typing import Any, Literal

from pydantic import Field, model_validator

from regrasp.errors import InvalidFile, InvalidInput
from regrasp.files.scenarios.keys import PerFinger, Positive, option
from regrasp.files.scenarios.limits_entry import LimitsEntry
from regrasp.files.strict import Strict
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.holds.weights import RegraspWeights
from regrasp.planning.states.objectives import ObjectiveName
from regrasp.planning.states.options import ChangeOptions, LimitOptions


class Weights(Strict):
    """What a sequence costs; the least cost is then looked for, not the fewest moves."""

    moves: float = Field(1.0, ge=0, description="for each finger move")
    turning: float = Field(0.0, ge=0, description="per radian that the object turns")
    time: float = Field(0.0, ge=0, description="per second of the plan")
    effort: float = Field(0.0, ge=0, description="for each hold times its least largest force, in loads")

    @property
    def value(self) -> RegraspWeights:
        """The weights."""
        return RegraspWeights(self.moves, self.turning, self.time, self.effort)

    @model_validator(mode="after")
    def _not_all_zero(self) -> "Weights":
        try:
            _ = self.value
        except InvalidInput as error:
            raise ValueError(str(error).removeprefix("weights: ")) from None
        return self


class CommonTask(Strict):
    """How states are chosen, what every hold must have, and the timing."""

    kind: Literal["regrasp"]
    objective: ObjectiveName = Field("angle", description="what the state of every hold is chosen for")
    states: Literal["each", "joint"] = Field("each", description="chosen each by itself, or all together")
    least_margin_degrees: float = Field(0.0, ge=0, description="angle margin every hold must have")
    min_distance: float = Field(0.0, ge=0, description="[m], between two fingers that hold the object")
    min_normal: float | None = Field(
        None,
        ge=0,
        description="least normal force of fingers that hold [N]; if absent a hundredth of the load "
        "where that needs no more moves",
    )
    stiffness: PerFinger | None = Field(
        None,
        description="of the fingers that answer a disturbance [N/m], a number or one for each finger of the "
        "start; all alike if absent",
    )
    early_loss: bool = option(ChangeOptions, "early_loss")
    limits: LimitsEntry | None = Field(None, description="rows and bounds of every contact, in its own frame")
    weights: Weights | None = None
    max_force: Positive | None = option(LimitOptions, "max_force")
    peak_ratio: float = option(LimitOptions, "peak_ratio", ge=1)
    reserve: float = option(LimitOptions, "reserve", ge=0, lt=1)
    step_duration: Positive = Field(1.0, description="[s] of each step")
    rate: Positive = Field(1000.0, description="set-points per second")

    @model_validator(mode="after")
    def _limits_are_of_no_finger(self) -> "CommonTask":
        if self.limits is not None and self.limits.rows is None:
            raise ValueError("limits: expected rows and bounds; a jacobian is of one finger and place")
        return self


class Ended(Strict):
    """A scenario with a grasp at the start and one at the goal, given by places on the object."""

    @cached_property
    def start_grasp(self) -> Grasp:
        """The contacts before the regrasp."""
        return Grasp(self._contacts("start"))

    @cached_property
    def goal_grasp(self) -> Grasp:
        """The contacts after it."""
        return Grasp(self._contacts("goal"))

    def _placed(self, end: Literal["start", "goal"]) -> tuple[str, list[Any], Callable[[Any], Contact]]:
        """The key of an end's places, the places, and what makes a contact of one."""
        raise NotImplementedError

    def _contacts(self, end: Literal["start", "goal"]) -> list[Contact]:
        key, places, made = self._placed(end)
        contacts, problems = [], []
        for i, place in enumerate(places):
            try:
                contacts.append(made(place))
            except InvalidInput as error:
                problems.append(f"{end}.{key}[{i}]{self._from}: {error}")
        if problems:
            raise InvalidFile("\n".join(problems))
        return contacts

    @property
    def _from(self) -> str:
        """Where places are counted from, if that must be said."""
        return ""

    def _end_problems(self, key: str = "") -> list[str]:
        """What is wrong with both ends, a line each; ``key`` follows the end's name where none stands."""
        problems = []
        for end in ("start", "goal"):
            try:
                _ = self.start_grasp if end == "start" else self.goal_grasp
            except InvalidInput as error:
                lines = str(error).splitlines()
                problems += [line if line.startswith(end) else f"{end}{key}: {line}" for line in lines]
        return problems
