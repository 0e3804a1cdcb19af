"""Equality and hash for frozen dataclasses that hold arrays, and how values read in print."""

from collections.abc import Hashable
from dataclasses import fields
from typing import Any

import numpy as np


class ArrayValue:
    """Two values are equal when they are of one class and every compared field is equal, entry by entry."""

    __slots__ = ()

    def _key(self) -> tuple[Hashable, ...]:
        compared = (getattr(self, f.name) for f in fields(self) if f.compare)  # type: ignore[arg-type]
        return tuple(_hashable(value) for value in compared)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if type(other) is not type(self):
            return NotImplemented
        return self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())


def _hashable(value: Any) -> Hashable:
    if isinstance(value, np.ndarray):
        return value.shape, (value + 0.0).tobytes()  # + 0.0: -0.0 equals 0.0
    return value  # type: ignore[no-any-return]


def numbers(values: Any) -> str:
    """A short text of a vector for printing: (1, -0.5)."""
    return "(" + ", ".join(f"{value:.6g}" for value in np.atleast_1d(values)) + ")"


def one_line(text: str) -> str:
    """``text`` with line breaks and all that cannot be printed escaped, so that no name forges a line."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
