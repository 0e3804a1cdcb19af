"""What a page asks, checked: contacts, a load, who leaves, and for what."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import isfinite
from typing import Any, get_args

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.planning.states.objectives.known import ObjectiveName

MOST_FINGERS = 6
LONGEST_NAME = 40
OBJECTIVES: tuple[str, ...] = tuple(name for name in get_args(ObjectiveName) if name != "wrench")
"""Words that need nothing besides; ``wrench`` needs a set of loads."""
_LARGEST = 1e9

Shape = Outline | Mesh


@dataclass(frozen=True)
class Question:
    """A grasp, its load, and the finger that leaves, if one does.

    Args:
        contacts: plain data of each: ``name``, ``position``, ``normal``, ``friction`` and, where there are
            any, ``max_force`` and ``torsion``.
        load: (3,) force and torque on the object, in space (6,) [N, N m].
        leaves: the name of the finger that leaves; None where all stay.
        objective: what states are chosen for.
        squeeze: of the two contacts that are left [N]; the best one where it is None.
        duration: [s].
    """

    contacts: tuple[dict[str, Any], ...]
    load: tuple[float, ...]
    leaves: str | None = None
    objective: str = "angle"
    squeeze: float | None = None
    duration: float = 1.0

    @classmethod
    def of(cls, data: Any) -> "Question":
        """The question in plain data, as JSON brings it; ``InvalidInput`` for anything else."""
        given = _table(data, "a question", cls.__dataclass_fields__.keys())
        contacts = given.get("contacts")
        if not isinstance(contacts, list) or not 2 <= len(contacts) <= MOST_FINGERS:
            raise InvalidInput(f"contacts must be a list of 2 to {MOST_FINGERS}, got {shown(contacts)}")
        load = given.get("load")
        if not isinstance(load, list) or len(load) not in (3, 6):
            raise InvalidInput(f"load must be three numbers, in space six, got {shown(load)}")
        dimension = 2 if len(load) == 3 else 3
        leaves, squeeze = given.get("leaves"), given.get("squeeze")
        word = given.get("objective", "angle")
        if word not in OBJECTIVES:
            raise InvalidInput(f"objective must be one of {', '.join(OBJECTIVES)}, got {shown(word)}")
        duration = _number(given.get("duration", 1.0), "duration")
        if not 1e-3 <= duration <= 1e6:
            raise InvalidInput(f"duration must lie between 0.001 and 1e6 s, got {duration:g}")
        question = cls(
            tuple(_contact(c, dimension) for c in contacts),
            tuple(_number(value, "load") for value in load),
            leaves=None if leaves is None else _name(leaves),
            objective=word,
            squeeze=None if squeeze is None else _number(squeeze, "squeeze"),
            duration=duration,
        )
        names = [c["name"] for c in question.contacts]
        if question.leaves is not None and question.leaves not in names:
            raise InvalidInput(f"leaves must be one of {', '.join(names)}, got {shown(leaves)}")
        return question

    def to_dict(self) -> dict[str, Any]:
        """Plain data, which JSON can hold."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__} | {
            "contacts": [dict(c) for c in self.contacts],
            "load": list(self.load),
        }

    def on(self, shape: Shape | None) -> "Question":
        """The question with every contact moved to the nearest point of a shape, if there is one."""
        if shape is None:
            return self
        if self.dimension != (2 if isinstance(shape, Outline) else 3):
            raise InvalidInput(f"contacts must be in the plane or in space as the {type(shape).__name__} is")
        moved = []
        for c in self.contacts:
            position, normal = _placed(shape, *c["position"])
            moved.append(c | {"position": list(position), "normal": list(normal)})
        return replace(self, contacts=tuple(moved))

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return 2 if len(self.load) == 3 else 3

    @cached_property
    def grasp(self) -> Grasp:
        """All contacts."""
        return Grasp(
            Contact(
                c["position"],
                c["normal"],
                c["friction"],
                max_force=c.get("max_force"),
                torsion=c.get("torsion"),
                name=c["name"],
            )
            for c in self.contacts
        )

    @cached_property
    def wrench(self) -> Wrench:
        """The load as a value."""
        return Wrench.from_vector(self.load)


@lru_cache(maxsize=256)  # of fingers, one is dragged at a time
def _placed(shape: Shape, *given: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Position and normal where a shape is nearest; relative to the centre of mass, as given."""
    point = np.array(given) + shape.centre_of_mass
    if isinstance(shape, Mesh):
        foot = shape.nearest(point)
        return tuple((foot - shape.centre_of_mass).tolist()), tuple(shape.normals(foot).tolist())
    contact = shape.contact_at(shape.nearest(point), friction=0.0)
    return tuple(contact.position.tolist()), tuple(contact.normal.tolist())


def _contact(data: Any, dimension: int) -> dict[str, Any]:
    soft = {"torsion"} if dimension == 3 else set()
    c = _table(data, "a contact", {"name", "position", "normal", "friction", "max_force"} | soft)
    result: dict[str, Any] = {"name": _name(c.get("name"))}
    for key in ("position", "normal"):
        given = c.get(key)
        if not isinstance(given, list) or len(given) != dimension:
            raise InvalidInput(f"{key} must be {dimension} numbers, got {shown(given)}")
        result[key] = [_number(value, key) for value in given]
    result["friction"] = _number(c.get("friction"), "friction")
    for key in ("max_force", "torsion"):
        if c.get(key) is not None:
            result[key] = _number(c[key], key)
    return result


def _table(data: Any, what: str, keys: Any) -> Mapping[str, Any]:
    if not isinstance(data, dict) or not data.keys() <= set(keys):
        raise InvalidInput(f"{what} must have keys {', '.join(sorted(keys))} only, got {shown(data)}")
    return data


def _name(value: Any) -> str:
    if not isinstance(value, str) or not 1 <= len(value) <= LONGEST_NAME or not value.isprintable():
        raise InvalidInput(f"a name must be 1 to {LONGEST_NAME} printable letters, got {shown(value)}")
    return value


def _number(value: Any, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= _LARGEST:
        raise InvalidInput(f"{what} must be numbers up to {_LARGEST:g}, got {shown(value)}")
    assert isfinite(value)
    return float(value)
