"""Keys that more than one kind of scenario has."""

from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field

from regrasp.files.strict import Strict
from regrasp.mechanics.checks import choice
from regrasp.planning.timing import TimeScaling
from regrasp.programs import available_backends


def _falling(values: list[float]) -> list[float]:
    TimeScaling.spline(1.0, values)
    return values


def _known_method(value: str) -> str:
    return choice(value, "method", ("auto", "closed-form", *available_backends()))


Positive = Annotated[float, Field(gt=0)]
Vector = Annotated[list[float], Field(min_length=2, max_length=2)]
Control = Annotated[list[float], AfterValidator(_falling)]
Name = Annotated[str, Field(min_length=1)]
PeakRatio = Annotated[
    float,
    Field(
        ge=1,
        description="without max_force, forces stay below this multiple of the least peak force that holds",
    ),
]
Reserve = Annotated[float, Field(ge=0, lt=1, description="fraction of the friction that planning keeps back")]
Method = Annotated[str, AfterValidator(_known_method)]


class Load(Strict):
    """The external wrench on the object, about its centre of mass."""

    shape: ClassVar[str] = "table"

    force: Vector = Field(description="[N], x and y in the object frame")
    torque: float = Field(0.0, description="[N m], counter-clockwise")


class LoadEntry(Load):
    """The external wrench at a time; linear between entries."""

    shape: ClassVar[str] = "list"

    time: float = Field(ge=0, description="[s], from 0 to the end of the plan, rising")
