"""What stands in a plan file: keys, types and ranges."""

from typing import Annotated, Any, Literal

from pydantic import Field

from regrasp.files.plans.words import Method, Objective, PathObjective
from regrasp.files.strict import Strict

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]


class _Limits(Strict):
    rows: list[list[float]]
    bounds: list[float]


class _Contact(Strict):
    name: str
    position: list[float]
    normal: list[float]
    friction: float
    max_force: float | None
    torsion: float | None = None  # of a soft finger
    limits: _Limits | None = None


class _Scaling(Strict):
    duration: float
    control: list[float]
    degree: int


class _Choice(Strict):
    end: Literal["start", "end"]
    objective: Objective
    method: Method
    force_limits: list[Positive | None]  # JSON has no infinity: None is no limit


class StoredRecord(Strict):
    """Of a ``Record``."""

    reserve: Annotated[float, Field(ge=0, lt=1)]
    choices: list[_Choice]
    balancing: NotNegative
    path: Method = "closed-form"
    path_objective: PathObjective | None = None
    rate_limits: list[Positive | None] = Field(default_factory=list)
    least_normals: list[NotNegative] = Field(default_factory=list)
    withstands: dict[str, Any] | None = None  # of a ``Withstood``, which reads it


class _Course(Strict):
    times: list[float]
    forces: list[list[list[float]]]
    loads: list[list[float]]  # force, then torque


class _Turn(Strict):
    angles: list[float]
    forces: list[list[list[float]]]
    end_load: list[float]  # force, then torque; in the object frame after the turn
    axis: list[float] | None = None  # in space
    middles: list[list[list[float]]] | None = None  # where a part of the load does not turn


class StoredTransition(Strict):
    """Of a ``Transition``, alone or as a step."""

    kind: Literal["removal", "addition", "rotation", "exchange", "hold"]
    contact: str | None  # the finger that leaves or arrives; none for a rotation or a hold
    load: list[float]  # force, then torque; at the start
    contacts: list[_Contact]
    start: list[list[float]]
    end: list[list[float]]
    scaling: _Scaling
    course: _Course | None = None  # none for the straight path
    record: StoredRecord
    arrival: str | None = None  # of an exchange
    leaving: list[str] | None = None  # where several leave or arrive
    arriving: list[str] | None = None
    turn: _Turn | None = None  # of an object that turns


class _Header(Strict):
    format: Literal["regrasp plan"]
    version: Literal[1]


class StoredPlan(StoredTransition, _Header):
    """A file of one transition."""


class StoredRegrasp(_Header):
    """A file of a whole regrasp."""

    kind: Literal["regrasp"]
    steps: list[StoredTransition] = Field(min_length=1)
    orientations: list[float]
    margin: float
    rotations: list[list[list[float]]] | None = None  # in space
