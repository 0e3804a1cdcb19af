"""Equality, hash, copies and pickles of frozen dataclasses that hold arrays, and how values print."""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any, Self, TypeVar

import numpy as np

K = TypeVar("K", bound=Hashable)
T = TypeVar("T")
V = TypeVar("V", bound="Frozen")
_MOST_KEPT = 64

# What is undefined in two equal values is undefined in both.
_NAN = "not a number"


class Frozen:
    """A value that cannot change: it is its own copy, and comes out of a pickle as it went in.

    Only the fields are pickled, not what was computed from them, and arrays refuse to be written to again.
    """

    __slots__ = ()

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __getstate__(self) -> dict[str, Any]:
        state = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
        return {k: dict(v) if isinstance(v, MappingProxyType) else v for k, v in state.items()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            object.__setattr__(self, name, _read_only(value))


class ArrayValue(Frozen):
    """Two values are equal when they are of one class and every compared field is equal, entry by entry."""

    __slots__ = ()

    def _key(self) -> tuple[Hashable, ...]:
        compared = (getattr(self, f.name) for f in fields(self) if f.compare)  # type: ignore[arg-type]
        return tuple(hashable(value) for value in compared)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if type(other) is not type(self):
            return NotImplemented
        return self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())


def hashable(value: Any) -> Hashable:
    """What a value compares by: arrays entry by entry."""
    if isinstance(value, np.ndarray):
        return value.shape, (value + 0.0).tobytes()  # + 0.0: -0.0 equals 0.0
    if isinstance(value, (tuple, list)):
        return tuple(map(hashable, value))
    if isinstance(value, Mapping):
        return tuple((key, hashable(entry)) for key, entry in value.items())
    if isinstance(value, float) and value != value:
        return _NAN
    return value  # type: ignore[no-any-return]


def _read_only(value: Any) -> Any:
    """Arrays as they were before they were pickled, in tuples too."""
    if isinstance(value, np.ndarray):
        value.setflags(write=False)
    elif isinstance(value, dict):
        return MappingProxyType(value)
    elif isinstance(value, tuple):
        for entry in value:
            _read_only(entry)
    return value


def numbers(values: Any) -> str:
    """A short text of a vector for printing: (1, -0.5)."""
    return "(" + ", ".join(f"{value:.6g}" for value in np.atleast_1d(values) + 0.0) + ")"  # no -0


def one_line(text: str) -> str:
    """``text`` with line breaks and all that cannot be printed escaped, so that no name forges a line."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def kept(value: V, key: K, made: Callable[[V, K], T]) -> T:
    """What ``made`` makes of a value and a key, kept with the value and lost with it.

    Unlike a cache over all values, this one compares none of them.
    """
    memory: dict[Any, Any] | None = value.__dict__.get("_kept")
    if memory is None or len(memory) > _MOST_KEPT:
        memory = value.__dict__["_kept"] = {}
    found: T = memory.get((made, key), _NAN)
    if found is _NAN:
        found = memory[made, key] = made(value, key)
    return found
