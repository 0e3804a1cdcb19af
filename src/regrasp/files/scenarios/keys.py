"""Keys that more than one kind of scenario has."""

from functools import cached_property
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from regrasp.files.strict import Strict
from regrasp.mechanics.checks import choice
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.options import described
from regrasp.plans.timing import TimeScaling
from regrasp.programs import available_backends


def _falling(values: list[float]) -> list[float]:
    TimeScaling.spline(1.0, values)
    return values


def _known_method(value: str) -> str:
    return choice(value, "method", ("auto", "closed-form", *available_backends()))


Positive = Annotated[float, Field(gt=0)]
Vector = Annotated[list[float], Field(min_length=2, max_length=2)]
"""A vector in the plane."""
AnyVector = Annotated[list[float], Field(min_length=2, max_length=3)]
"""A vector in the plane or in space."""
SpaceVector = Annotated[list[float], Field(min_length=3, max_length=3)]
AnyForce = Annotated[list[float], Field(min_length=2, max_length=4)]
"""A force in the plane or in space; of a soft finger its torque about the normal comes last."""
Control = Annotated[list[float], AfterValidator(_falling)]
Name = Annotated[str, Field(min_length=1)]
PerFinger = Annotated[
    Annotated[Positive, Tag("number")] | Annotated[list[Positive], Tag("list"), Field(min_length=1)],
    Discriminator(lambda value: "list" if isinstance(value, list) else "number"),
]
"""One number for all fingers, or one for each contact of the scenario, in its order."""
Method = Annotated[str, AfterValidator(_known_method)]


def option(options: type, name: str, **constraints: Any) -> Any:
    """The key of an option that planning verbs take: its default and its words, spelled there."""
    default, words = described(options)[name][1]
    return Field(default, description=words, **constraints)


class Load(Strict):
    """The external wrench on the object, about its centre of mass."""

    shape: ClassVar[str] = "table"

    force: AnyVector = Field(description="[N], x, y and in space z, in the object frame")
    torque: Annotated[
        Annotated[float, Tag("number")]
        | Annotated[list[float], Tag("list"), Field(min_length=3, max_length=3)],
        Discriminator(lambda value: "list" if isinstance(value, list) else "number"),
    ] = Field(0.0, description="[N m], counter-clockwise; three numbers in space")

    @cached_property
    def wrench(self) -> Wrench:
        """The load as a value."""
        space = len(self.force) == 3
        return Wrench(self.force, None if space and self.torque == 0 else self.torque)

    @model_validator(mode="after")
    def _is_a_wrench(self) -> "Load":
        if (len(self.force) == 3) != isinstance(self.torque, list) and self.torque != 0:
            expected = "three numbers" if len(self.force) == 3 else "one number"
            raise ValueError(f"torque: expected {expected} beside such a force, got {self.torque}")
        return self


class LoadEntry(Load):
    """The external wrench at a time; linear between entries."""

    shape: ClassVar[str] = "list"

    time: float = Field(ge=0, description="[s], from 0 to the end of the plan, rising")
