"""A scenario: load, contacts and task, as a person writes them in a TOML file."""

import re
import tomllib
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, TypeAdapter, model_validator

from regrasp.errors import InvalidInput, shown
from regrasp.files.scenarios.disturbance import DisturbedLoad
from regrasp.files.scenarios.grasp import GraspScenario
from regrasp.files.scenarios.keys import (
    AnyForce,
    AnyVector,
    Load,
    LoadEntry,
    Name,
    Positive,
)
from regrasp.files.scenarios.limits_entry import LimitsEntry
from regrasp.files.scenarios.motions_entry import MotionsEntry
from regrasp.files.scenarios.object_entry import ObjectEntry
from regrasp.files.scenarios.regrasp import RegraspScenario
from regrasp.files.scenarios.space_grasp import SpaceGraspScenario
from regrasp.files.scenarios.space_regrasp import SpaceRegraspScenario
from regrasp.files.scenarios.tasks import Addition, Change, Exchange, Hold, Removal, Rotation
from regrasp.files.source import text_of
from regrasp.files.strict import Strict, validated
from regrasp.mechanics.checks import file_path
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.loads.rotated import turned_load
from regrasp.mechanics.wrench import Wrench
from regrasp.plans.loads import LoadSeries

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh

_MOST_BYTES = 2**24  # of a file that people write
# Keys a.b.c of many parts: reading them takes time with the square of their number.
_DEEP = 50
_DEEP_KEY = re.compile(rf"(?<![\w\"'-])(?>[\w\"'-]+[ \t]*\.[ \t]*){{{_DEEP}}}")


class ContactEntry(Strict):
    """One finger's contact and, where they are known, its forces at both ends."""

    name: Name = Field(description="names the finger in the task, the plan and the set-points")
    position: AnyVector = Field(
        description="[m], object frame, origin at the centre of mass; of an object its nearest surface point"
    )
    normal: AnyVector | None = Field(
        None, description="points into the object; any length but zero; of an object it is the surface's"
    )
    friction: float = Field(ge=0, description="Coulomb coefficient")
    max_force: Positive | None = Field(
        None, description="largest force of this finger [N]; no limit if absent"
    )
    torsion: Positive | None = Field(
        None,
        description="of a soft finger in space: most torque about the normal per normal force [m]",
    )
    limits: LimitsEntry | None = Field(
        None, description="linear limits of this finger's force, such as its joints have"
    )
    force: AnyForce | None = Field(
        None,
        description="starting force on the object [N]: of every contact in touch at the start, or of none; "
        "of a soft finger its torque about the normal [N m] comes last",
    )
    end_force: AnyForce | None = Field(
        None, description="final force on the object: of every contact in touch at the end, or of none"
    )

    def on(self, mesh: "Mesh | None") -> Contact:
        """The contact as a value, on the surface of an object if there is one."""
        if mesh is None:
            assert self.normal is not None  # checked by the scenario, which knows whether there is an object
            contact = Contact(
                self.position,
                self.normal,
                self.friction,
                max_force=self.max_force,
                torsion=self.torsion,
                name=self.name,
            )
        else:
            contact = mesh.contact_at(
                np.array(self.position) + mesh.centre_of_mass,
                friction=self.friction,
                max_force=self.max_force,
                torsion=self.torsion,
                name=self.name,
            )
        if self.limits is None:
            return contact
        return contact.changed(limits=self.limits.value(contact.normal.tolist()))

    @model_validator(mode="after")
    def _is_a_contact(self) -> "ContactEntry":
        if self.normal is not None:
            _ = self.on(None)
        return self


class Scenario(Strict):
    """An object held by fingers under a load, in the plane or in space, and the change of grasp to plan."""

    # Kinds of task that are planned from a scenario of another shape.
    other_kinds: ClassVar[tuple[str, ...]] = ("regrasp",)

    title: str | None = Field(None, description="shown above the plan")
    load: Annotated[
        Annotated[DisturbedLoad, Tag("table")] | Annotated[list[LoadEntry], Tag("list"), Field(min_length=2)],
        Discriminator(lambda load: "list" if isinstance(load, list) else "table"),
    ] = Field(description="constant, [load]; or [[load]] at times, the last of which is the duration")
    object: ObjectEntry | None = Field(None, description="the solid that contacts in space are on")
    contacts: list[ContactEntry] = Field(min_length=2)
    motions: MotionsEntry | None = Field(None, description="ways of free fingers, asked for by --motions")
    task: Annotated[Removal | Addition | Exchange | Hold | Rotation, Field(discriminator="kind")]

    @cached_property
    def grasp(self) -> Grasp:
        """Every contact in play, in the file's order."""
        mesh = None if self.object is None else self.object.value
        return Grasp(entry.on(mesh) for entry in self.contacts)

    @property
    def disturbance(self) -> LoadSet | None:
        """Deviations that states withstand on top of a constant load."""
        return self.load.deviations if isinstance(self.load, DisturbedLoad) else None

    @cached_property
    def external(self) -> Wrench | LoadSeries:
        """The load as a value."""
        if isinstance(self.load, Load):
            return self.load.wrench
        return LoadSeries([e.time for e in self.load], [e.wrench.vector for e in self.load])

    def wrench(self, end: Literal["start", "end"]) -> Wrench:
        """The load at an end of the task.

        Args:
            end: ``start`` or ``end``.
        """
        external = self.external
        if isinstance(external, Wrench):
            if isinstance(self.task, Rotation) and end == "end":
                return turned_load(external, self.task.angle, self.task.unit_axis)
            return external
        return external(0.0 if end == "start" else external.duration)

    @model_validator(mode="after")
    def _fits_together(self) -> "Scenario":
        lacking = self._other_dimensions() or self._lacking_normals()
        if lacking:
            raise ValueError("\n".join(lacking))
        try:
            names = self.grasp.names
        except InvalidInput as error:
            raise ValueError(f"contacts: {error}") from None
        task = self.task
        if isinstance(task, Change):
            for key in ("contact", "arrival"):
                finger = getattr(task, key, None)
                if finger is not None and finger not in names:
                    raise ValueError(f"task.{key}: expected one of {', '.join(names)}, got {shown(finger)}")
        try:
            external = self.external
        except InvalidInput as error:
            raise ValueError(f"load: {error}") from None
        problems = self._unfit_load(external)
        for key in ("rate_limit", "stiffness"):
            values = getattr(task, key, None)
            if isinstance(values, list) and len(values) != len(self.contacts):
                problems.append(
                    f"task.{key}: expected a number, or {len(self.contacts)} numbers, one for each contact; "
                    f"got {len(values)}"
                )
        leaving, arriving = (task.leaving, task.arriving) if isinstance(task, Change) else ((), ())
        problems += [*self._gaps("force", arriving), *self._gaps("end_force", leaving)]
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def _other_dimensions(self) -> list[str]:
        """Vectors in the plane beside others in space; the first contact's position says which it is."""
        d = 3 if self.object is not None else len(self.contacts[0].position)
        where = "space" if d == 3 else "the plane"
        vectors: list[tuple[str, list[float] | None]] = [
            (f"contacts[{i}].{key}", getattr(entry, key))
            for i, entry in enumerate(self.contacts)
            for key in ("position", "normal")
        ]
        loads: list[tuple[str, Load]] = [("load", self.load)] if isinstance(self.load, Load) else []
        if not isinstance(self.load, Load):
            loads = [(f"load[{i}]", entry) for i, entry in enumerate(self.load)]
        vectors += [(f"{name}.force", entry.force) for name, entry in loads]
        problems = [
            f"{name}: expected {d} numbers, for this scenario is in {where}; got {len(vector)}"
            for name, vector in vectors
            if vector is not None and len(vector) != d
        ]
        for i, entry in enumerate(self.contacts):
            soft = entry.torsion is not None
            wanted, who = (d + 1, "a soft finger") if soft else (d, "this scenario is")
            problems += [
                f"contacts[{i}].{key}: expected {wanted} numbers, for {who} in {where}; got {len(force)}"
                for key, force in (("force", entry.force), ("end_force", entry.end_force))
                if force is not None and len(force) != wanted
            ]
        if isinstance(self.task, Rotation) and (self.task.axis is None) == (d == 3):
            problems.append(f"task.axis: {'needed in space' if d == 3 else 'leave it out in the plane'}")
        return problems

    def _lacking_normals(self) -> list[str]:
        if self.object is None:
            return [
                f"contacts[{i}].normal: a required key is missing"
                for i, entry in enumerate(self.contacts)
                if entry.normal is None
            ]
        return [
            f"contacts[{i}].normal: the surface of the object gives it; leave it out"
            for i, entry in enumerate(self.contacts)
            if entry.normal is not None
        ]

    def _unfit_load(self, external: Wrench | LoadSeries) -> list[str]:
        """What keeps this load from going with this task."""
        task = self.task
        if isinstance(task, Rotation):
            if isinstance(external, LoadSeries):
                return ["load: a rotation needs one load, [load], which turns as seen from the object"]
        elif isinstance(external, LoadSeries) and task.duration not in (None, external.duration):
            return [
                f"task.duration: expected {external.duration:g}, the last time of the load, or nothing; "
                f"got {task.duration:g}"
            ]
        return []

    def _gaps(self, key: Literal["force", "end_force"], idle: tuple[str, ...]) -> list[str]:
        """Forces given for some of the contacts that need one, or for the finger that has none."""
        place: dict[bool, list[int]] = {True: [], False: []}
        problems = []
        for i, entry in enumerate(self.contacts):
            given = getattr(entry, key) is not None
            if entry.name in idle:
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


PlannedScenario = Scenario | RegraspScenario | SpaceRegraspScenario
"""Of forces over time."""
AnyScenario = PlannedScenario | GraspScenario | SpaceGraspScenario


def read_scenario(path: str | Path) -> AnyScenario:
    """The scenario of a TOML file.

    Args:
        path: a file in TOML.

    Raises:
        InvalidInput: In one message, which names the file and lists every problem, each with its key, what
            was expected and what came.
    """
    path = file_path(path)
    return parse_scenario(text_of(path, "a scenario in TOML", most=_MOST_BYTES), path)


def parse_scenario(text: str, file: str | Path = "scenario") -> AnyScenario:
    """The scenario of a text in TOML; ``file`` is the name that errors give. Raises as ``read_scenario``.

    Files that the text names are relative to the folder of ``file``.

    Args:
        text: in TOML.
        file: the name that errors give; files that the text names are relative to its folder.
    """
    if not isinstance(text, str):
        raise InvalidInput(f"a scenario is parsed from text in TOML, got {shown(text)}")
    file = file_path(file)
    if _DEEP_KEY.search(text):
        raise InvalidInput(f"{file}: not a scenario: a key of more than {_DEEP} parts")
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise InvalidInput(f"{file}: not a scenario: lists within lists, hundreds deep") from None
    except ValueError as error:
        raise InvalidInput(f"{file}: not TOML: {error}") from None
    return scenario_of(data, file)


def scenario_of(data: dict[str, Any], file: str | Path = "scenario") -> AnyScenario:
    """The scenario of what a TOML file holds. Raises as ``read_scenario``.

    Args:
        data: tables and values.
        file: the name that errors give; files that the data names are relative to its folder.
    """
    task = data.get("task")
    if isinstance(task, dict) and task.get("kind") == "grasp":
        if "object" in data:
            return validated(SpaceGraspScenario, data, file)
        return validated(GraspScenario, data, file)
    if isinstance(task, dict) and task.get("kind") == "regrasp":
        if "object" in data:
            return validated(SpaceRegraspScenario, data, file)
        return validated(RegraspScenario, data, file)
    if "task" not in data and "contacts" not in data:
        raise InvalidInput(
            f"{file}: task: a required key is missing: a table with a kind, as grasp or regrasp"
        )
    return validated(Scenario, data, file)


def scenario_schema() -> dict[str, Any]:
    """The JSON Schema of scenarios of every kind."""
    return TypeAdapter(AnyScenario).json_schema()
