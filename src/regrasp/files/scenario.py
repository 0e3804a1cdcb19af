"""A scenario: load, contacts and task, as a person writes them in a TOML file."""

import tomllib
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from regrasp.errors import InvalidInput
from regrasp.files.source import text_of
from regrasp.files.strict import Strict, validated
from regrasp.mechanics.checks import choice
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.balancing import BALANCE_TOLERANCE
from regrasp.planning.criteria import PEAK_RATIO, Objective
from regrasp.planning.joined import PathObjective
from regrasp.planning.loads import LoadSeries
from regrasp.planning.timing import PAPER_CONTROL, TimeScaling
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


class ContactEntry(Strict):
    """One finger's contact and, where they are known, its forces at both ends."""

    name: Name = Field(description="names the finger in the task, the plan and the set-points")
    position: Vector = Field(description="[m], object frame, origin at the centre of mass")
    normal: Vector = Field(description="points into the object; any length but zero")
    friction: float = Field(ge=0, description="Coulomb coefficient")
    max_force: Positive | None = Field(
        None, description="largest force of this finger [N]; no limit if absent"
    )
    force: Vector | None = Field(
        None,
        description="starting force on the object [N]: of every contact in touch at the start, or of none",
    )
    end_force: Vector | None = Field(
        None, description="final force on the object [N]: of every contact in touch at the end, or of none"
    )

    @cached_property
    def contact(self) -> Contact:
        """The contact as a value."""
        return Contact(self.position, self.normal, self.friction, max_force=self.max_force, name=self.name)

    @model_validator(mode="after")
    def _is_a_contact(self) -> "ContactEntry":
        _ = self.contact
        return self


class Change(Strict):
    """What removal and addition have in common."""

    contact: Name = Field(description="name of the finger that leaves or arrives")
    objective: Objective = Field("angle", description="what the state without the finger is chosen for")
    whole_objective: Objective = Field("force", description="what the state with it is chosen for")
    method: Method = Field("auto", description="'auto', 'closed-form' or a back end's name")
    duration: Positive | None = Field(None, description="[s]; 1 unless rate_limit sets it")
    rate_limit: Positive | None = Field(
        None,
        description="fastest change of any force [N/s]; without a duration the shortest is used",
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
    instants: int = Field(101, ge=3, description="instants of a path that is not straight")
    facets: int | None = Field(None, ge=3, description="sides of polygons in the place of circles")
    rate: Positive = Field(1000.0, description="set-points per second")
    scaling: Literal["spline", "minimum_jerk", "linear"] = Field("spline", description="shape of T(t)")
    control: Control | None = Field(
        None,
        description=f"control values of the spline, falling from 1 to 0; {list(PAPER_CONTROL)} if absent",
    )
    max_force: Positive | None = Field(None, description="limit on every force [N]")
    peak_ratio: float = Field(
        PEAK_RATIO,
        ge=1,
        description="without max_force, forces stay below this multiple of the least peak force that holds",
    )
    reserve: float = Field(
        RESERVE, ge=0, lt=1, description="fraction of the friction that planning keeps back"
    )
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
    def _one_way_to_say_it(self) -> "Change":
        if self.control is not None and self.scaling != "spline":
            raise ValueError(f"control belongs to scaling 'spline', got scaling {self.scaling!r}")
        return self


class Removal(Change):
    """One finger leaves."""

    kind: Literal["removal"]


class Addition(Change):
    """One finger arrives; it is listed among the contacts."""

    kind: Literal["addition"]


class Scenario(Strict):
    """A planar object held by fingers under a load, and the change of grasp to plan."""

    title: str | None = Field(None, description="shown above the plan")
    load: Annotated[
        Annotated[Load, Tag("table")] | Annotated[list[LoadEntry], Tag("list"), Field(min_length=2)],
        Discriminator(lambda load: "list" if isinstance(load, list) else "table"),
    ] = Field(description="constant, [load]; or [[load]] at times, the last of which is the duration")
    contacts: list[ContactEntry] = Field(min_length=2)
    task: Annotated[Removal | Addition, Field(discriminator="kind")]

    @cached_property
    def grasp(self) -> Grasp:
        """Every contact in play, in the file's order."""
        return Grasp(entry.contact for entry in self.contacts)

    @cached_property
    def external(self) -> Wrench | LoadSeries:
        """The load as a value."""
        if isinstance(self.load, Load):
            return Wrench(self.load.force, self.load.torque)
        return LoadSeries([e.time for e in self.load], [[*e.force, e.torque] for e in self.load])

    def wrench(self, end: Literal["start", "end"]) -> Wrench:
        """The load at an end of the task."""
        external = self.external
        if isinstance(external, Wrench):
            return external
        return external(0.0 if end == "start" else external.duration)

    @model_validator(mode="after")
    def _fits_together(self) -> "Scenario":
        try:
            names = self.grasp.names
        except InvalidInput as error:
            raise ValueError(f"contacts: {error}") from None
        if self.task.contact not in names:
            raise ValueError(f"task.contact: expected one of {', '.join(names)}, got {self.task.contact!r}")
        idle = "end_force" if self.task.kind == "removal" else "force"
        try:
            external = self.external
        except InvalidInput as error:
            raise ValueError(f"load: {error}") from None
        if isinstance(external, LoadSeries) and self.task.duration not in (None, external.duration):
            raise ValueError(
                f"task.duration: expected {external.duration:g}, the last time of the load, or nothing; "
                f"got {self.task.duration:g}"
            )
        problems = [*self._gaps("force", idle), *self._gaps("end_force", idle)]
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def _gaps(self, key: Literal["force", "end_force"], idle: str) -> list[str]:
        """Forces given for some of the contacts that need one, or for the finger that has none."""
        place: dict[bool, list[int]] = {True: [], False: []}
        problems = []
        for i, entry in enumerate(self.contacts):
            given = getattr(entry, key) is not None
            if key == idle and entry.name == self.task.contact:
                if given:
                    verb = "leaves, so it ends" if key == "end_force" else "arrives, so it starts"
                    problems.append(f"contacts[{i}].{key}: {entry.name} {verb} without force; leave it out")
            else:
                place[given].append(i)
        if place[True]:
            problems += [
                f"contacts[{i}].{key}: a required key is missing; others have it, so give it to all or none"
                for i in place[False]
            ]
        return problems


def read_scenario(path: str | Path) -> Scenario:
    """The scenario of a TOML file.

    Raises one ``InvalidInput`` that names the file and lists every problem, each with its key, what was
    expected and what came.
    """
    path = Path(path)
    return parse_scenario(text_of(path, "a scenario in TOML"), path)


def parse_scenario(text: str, file: str | Path = "scenario") -> Scenario:
    """The scenario of a text in TOML; ``file`` is the name that errors give. Raises as ``read_scenario``."""
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"{file}: not TOML: {error}") from None
    return validated(Scenario, data, file)
