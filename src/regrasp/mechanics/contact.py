"""A frictional point contact."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import atan, hypot
from typing import Any

import numpy as np

from regrasp.display import table
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, number, point, read_only
from regrasp.mechanics.limits.force_limits import ForceLimits
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue, numbers

# A normal whose length is this near to 1 is taken as it is, so that one normalised before (whose length is
# within 3 2^-53 of 1) keeps its every bit.
_UNIT = 2.0**-51
_CHANGEABLE = ("friction", "max_force", "torsion", "limits", "name")

MOST = 1e50
"""Positions [m], frictions [-] and torsions [m] up to this, and not below its inverse, may be multiplied."""


def fits(size: float) -> bool:
    """Whether a size of 0 or more is 0 or so."""
    return not size or 1 / MOST <= size <= MOST


@dataclass(frozen=True, eq=False, repr=False)
class Contact(ArrayValue):
    """A finger's point contact with Coulomb friction: it pushes along ``normal`` and never pulls.

    Args:
        position: (d,) [m], object frame, origin at the centre of mass; d is 2 or 3.
        normal: (d,), points **into** the object; any non-zero vector, stored with unit length [-].
        friction: Coulomb coefficient mu >= 0 [-]; the friction cone has half-angle atan(mu).
        max_force: largest force magnitude the finger can make [N], or None for no limit; of a soft finger the
            largest |(f, mu m / torsion)|, its torque counted as the tangential force that uses as much
            friction.
        torsion: in space, of a soft finger: the most torque about the normal per normal force [m], greater
            than 0, or None for a point contact. Together with the tangential force it stays inside the limit
            surface (|f_t| / mu)^2 + (m / torsion)^2 <= f_n^2 (Howe and Cutkosky, Int. J. Robotics Research
            15, 1996).
        limits: linear limits A f <= b of the force in the contact's frame, as ``ForceLimits`` or a pair (A,
            b), such as ``torque_limits`` makes them; None for none.
        name: how to address the contact; a ``Grasp`` names unnamed contacts P1, P2, ...

    Raises:
        InvalidInput: For anything else.
    """

    position: Array
    normal: Array
    friction: float
    max_force: float | None = field(default=None, kw_only=True)
    torsion: float | None = field(default=None, kw_only=True)
    limits: ForceLimits | None = field(default=None, kw_only=True)
    name: str | None = field(default=None, kw_only=True)

    def __init__(
        self,
        position: ArrayLike,
        normal: ArrayLike,
        friction: float,
        *,
        max_force: float | None = None,
        torsion: float | None = None,
        limits: ForceLimits | tuple[ArrayLike, ArrayLike] | None = None,
        name: str | None = None,
    ) -> None:
        _check_name(name)
        label = "contact" if name is None else f"contact {shown(name)}"
        where = point(position, f"{label}: position")
        direction = point(normal, f"{label}: normal")
        if where.size != direction.size:
            raise InvalidInput(
                f"{label}: position and normal must have the same dimension, "
                f"got {where.size} and {direction.size}"
            )
        each = direction.tolist()
        largest = max(map(abs, each))
        if largest == 0:
            raise InvalidInput(
                f"{label}: normal must not be zero; give the direction that points into the object"
            )
        if abs(hypot(*each) - 1) > _UNIT:
            direction = direction / largest  # first, so that squares neither overflow nor vanish
            direction = direction / hypot(*direction.tolist())
            direction.setflags(write=False)
        object.__setattr__(self, "position", where)
        object.__setattr__(self, "normal", direction)
        object.__setattr__(self, "friction", number(friction, f"{label}: friction", least=0))
        if max_force is not None:
            max_force = number(max_force, f"{label}: max_force", above=0)
        object.__setattr__(self, "max_force", max_force)
        if torsion is not None:
            torsion = number(torsion, f"{label}: torsion", above=0)
            if where.size == 2 or self.friction == 0:
                without = "in the plane" if where.size == 2 else "without friction"
                raise InvalidInput(
                    f"{label}: a contact {without} has no torsion; leave it out, got {torsion:g}"
                )
        object.__setattr__(self, "torsion", torsion)
        rows = None if limits is None else _limits(limits, where.size, torsion is not None, label)
        object.__setattr__(self, "limits", rows)
        object.__setattr__(self, "name", name)

    @cached_property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return int(self.position.size)

    @property
    def kind(self) -> str:
        """``frictionless``, ``point`` (with friction) or ``soft``."""
        if self.torsion is not None:
            return "soft"
        return "point" if self.friction else "frictionless"

    @property
    def half_angle(self) -> float:
        """Half-angle of the friction cone, alpha = atan(mu) [rad]."""
        return atan(self.friction)

    @cached_property
    def plain(self) -> tuple[float, ...]:
        """(position, normal, friction) as plain floats, the way the closed forms take a contact."""
        return (*self.position.tolist(), *self.normal.tolist(), self.friction)

    @cached_property
    def _is_in_range(self) -> bool:
        """Whether products of its position, friction and torsion are numbers (``Grasp.out_of_range``)."""
        d = self.dimension
        return all(map(fits, (*map(abs, self.plain[:d]), self.friction, self.torsion or 0.0)))

    @cached_property
    def limit_rows(self) -> Array | None:
        """(m, d) or (m, d + 1) rows A of ``limits`` in the object's frame: A f <= ``limits.bounds``."""
        if self.limits is None:
            return None
        d, given = self.dimension, self.limits.rows
        frame = np.vstack([self.normal, tangents_of(self.normal[None])[0]])
        return read_only(np.hstack([given[:, :d] @ frame, given[:, d:]]))

    def named(self, name: str) -> "Contact":
        """The same contact under another name.

        Args:
            name: of any letters, not empty.
        """
        _check_name(name)
        return self._under(name)

    def _under(self, name: str) -> "Contact":
        same = object.__new__(Contact)
        same.__dict__.update(self.__dict__)
        same.__dict__["name"] = name
        return same

    def changed(self, **fields: Any) -> "Contact":
        """The same contact with other ``friction``, ``max_force``, ``torsion``, ``limits`` or ``name``.

        Args:
            **fields: ``friction`` [-], ``max_force`` [N], ``torsion`` [m], ``limits`` or ``name``, as of
                ``Contact``.

        Raises:
            InvalidInput: For other fields, ``position`` and ``normal`` among them, and as ``Contact`` does.
        """
        if other := [name for name in fields if name not in _CHANGEABLE]:
            raise InvalidInput(
                f"friction, max_force, torsion, limits and name of a contact can be changed, got {other[0]}; "
                "make another Contact"
            )
        return Contact(self.position, self.normal, **{k: getattr(self, k) for k in _CHANGEABLE} | fields)

    def to_dict(self) -> dict[str, Any]:
        """The contact as plain data, which JSON can hold; ``from_dict`` gives back the equal contact."""
        return {
            "name": self.name,
            "position": self.position.tolist(),
            "normal": self.normal.tolist(),
            "friction": self.friction,
            "max_force": self.max_force,
            **({} if self.torsion is None else {"torsion": self.torsion}),
            **({} if self.limits is None else {"limits": self.limits.to_dict()}),
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Contact":
        """The contact of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``Contact`` does.
        """
        optional = ("name", "max_force", "torsion", "limits")
        given = entries(data, "a contact", ("position", "normal", "friction"), optional)
        if given.get("limits") is not None:
            given["limits"] = ForceLimits.from_dict(given["limits"])
        return cls(**given)

    def __repr__(self) -> str:
        limit = "" if self.max_force is None else f", max_force={self.max_force:g}"
        soft = "" if self.torsion is None else f", torsion={self.torsion:g}"
        rows = "" if self.limits is None else f", limits={self.limits!r}"
        name = "" if self.name is None else f", name={self.name!r}"
        return (
            f"Contact({numbers(self.position)}, normal={numbers(self.normal)}, "
            f"friction={self.friction:g}{limit}{soft}{rows}{name})"
        )


def _limits(
    given: ForceLimits | tuple[ArrayLike, ArrayLike], d: int, is_soft: bool, label: str
) -> ForceLimits:
    """Limits of rows that a force of the contact has numbers for."""
    if not isinstance(given, ForceLimits):
        if not isinstance(given, (tuple, list)) or len(given) != 2:
            raise InvalidInput(f"{label}: limits must be ForceLimits or a pair (A, b), got {shown(given)}")
        try:
            given = ForceLimits(*given)
        except InvalidInput as error:
            raise InvalidInput(f"{label}: {error}") from None
    wide = given.rows.shape[1]
    if wide != d and not (is_soft and wide == d + 1):
        soft = f" or {d + 1}" if is_soft else ""
        raise InvalidInput(f"{label}: rows of limits must have {d}{soft} numbers, got {wide}")
    return given


def _check_name(name: object) -> None:
    """Raise ``InvalidInput`` unless a name is a word or none."""
    if name is None:
        return
    if not isinstance(name, str) or not name.strip():
        raise InvalidInput(f"a contact's name must be a non-empty string, got {shown(name)}")
    if not name.isascii() and any("\ud800" <= c <= "\udfff" for c in name):
        raise InvalidInput(f"a contact's name must be Unicode text, got {shown(name)} with half a character")


def contacts_table(contacts: Iterable[Contact]) -> str:
    """Names, places, normals and limits, a row for each contact."""
    given = tuple(contacts)
    axes = "xyz"[: given[0].position.size]
    head = ["finger", *(f"{a} [m]" for a in axes), *(f"n{a}" for a in axes), "friction", "max force [N]"]
    limits = ["none" if c.max_force is None else c.max_force for c in given]
    rows = [
        [c.name, *c.position.tolist(), *c.normal.tolist(), c.friction, limit]
        for c, limit in zip(given, limits, strict=True)
    ]
    return table(head, rows)
