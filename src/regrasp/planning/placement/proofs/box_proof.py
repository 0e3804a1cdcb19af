"""What proofs by boxes of placements have in common: a digest of their numbers, and plain data."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import MISSING, fields
from hashlib import sha256
from typing import Any, Self

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import array
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue


class BoxProof(ArrayValue, ABC):
    """Boxes that cover all placements, halved until each has a load and a twist that bound its placements.

    Subclasses are dataclasses, of fields that plain data holds in their order; what has its default is left
    out, so that a new field with one changes no digest of proofs that were written before.
    """

    bound: float
    fingers: int
    children: np.ndarray

    @property
    def digest(self) -> str:
        """Of all of its numbers: one that is touched no longer fits."""
        return sha256(repr(self._plain()).encode()).hexdigest()

    @property
    def leaves(self) -> int:
        """Boxes that are not split: what is excluded one by one."""
        return int((self.children[:, 1] == 0).sum())

    def _plain(self) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for field in fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                found[field.name] = value.tolist()
            elif value != field.default:  # NumPy's numbers are written otherwise
                found[field.name] = float(value) if isinstance(value, float) else value
        return found

    def to_dict(self) -> dict[str, Any]:
        """The proof as plain data, which JSON can hold; ``from_dict`` gives back the equal proof."""
        return {**self._plain(), "digest": self.digest}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The proof of plain data; whether it proves anything ``regrasp.verify`` says.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys, shapes and types, and for numbers that the digest does not fit.
        """
        optional = [f.name for f in fields(cls) if f.default is not MISSING]  # type: ignore[arg-type]
        needed = [f.name for f in fields(cls) if f.default is MISSING]  # type: ignore[arg-type]
        given = entries(data, "a proof", [*needed, "digest"], optional)
        proof = cls._checked(given)
        if given["digest"] != proof.digest:
            raise InvalidInput("the digest of a proof does not fit its numbers: one of them was changed")
        return proof

    @classmethod
    @abstractmethod
    def _checked(cls, given: dict[str, Any]) -> Self:
        """The proof of entries whose keys are right."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}(bound {self.bound:.6g}, {self.fingers} fingers, {self.leaves} boxes)"


def integers(value: Any, what: str, shape: tuple[int | None, ...]) -> np.ndarray:
    """Whole numbers of a shape, read-only."""
    found = array(value, what, shape)
    whole_numbers = found.astype(np.int64)
    if (whole_numbers != found).any():
        raise InvalidInput(f"{what} must be whole numbers")
    whole_numbers.setflags(write=False)
    return whole_numbers
