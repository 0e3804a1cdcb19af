"""Proofs and regions as plain data with a digest: a number that is touched in a file no longer fits."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import MISSING, fields
from hashlib import sha256
from typing import Any, Self

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue
from regrasp.mesh.mesh import Mesh
from regrasp.planning.placement.proofs.shape_data import shape_data


class Sealed(ArrayValue, ABC):
    """A dataclass of arrays, numbers and values that have plain data themselves.

    What has its default is left out, so that a new field with one changes no digest that was written before.
    """

    _what: str

    @property
    def digest(self) -> str:
        """Of all that it holds."""
        return sha256(repr(self._plain()).encode()).hexdigest()

    def _plain(self) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for field in fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray) or value != field.default:
                found[field.name] = _plain(value)
        return found

    def to_dict(self) -> dict[str, Any]:
        """All as plain data, which JSON can hold; ``from_dict`` gives back what is equal."""
        return {**self._plain(), "digest": self.digest}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """What plain data says; whether it is true ``regrasp.verify`` says.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys, shapes and types, and for numbers that the digest does not fit.
        """
        optional = [f.name for f in fields(cls) if f.default is not MISSING]  # type: ignore[arg-type]
        needed = [f.name for f in fields(cls) if f.default is MISSING]  # type: ignore[arg-type]
        given = entries(data, cls._what, [*needed, "digest"], optional)
        found = cls._checked(given)
        if given["digest"] != found.digest:
            raise InvalidInput(f"the digest of {cls._what} does not fit: something was changed")
        return found

    @classmethod
    @abstractmethod
    def _checked(cls, given: dict[str, Any]) -> Self:
        """The value of entries whose keys are right."""


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    if isinstance(value, float):
        return float(value)  # NumPy's numbers are written otherwise
    if isinstance(value, (int, str)):
        return value
    return shape_data(value) if isinstance(value, Mesh) else value.to_dict()
