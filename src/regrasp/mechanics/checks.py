"""Validators: each converts, checks and returns the value, or raises ``InvalidInput``."""

import os
from collections.abc import Sequence
from errno import ENAMETOOLONG
from inspect import signature
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike as ArrayLike

    Array = NDArray[np.float64]
    Flags = NDArray[np.bool_]
else:
    # Classes that print as their short names alone in signatures and ``help``.
    Array, Flags, ArrayLike = (
        type(name, (), {"__doc__": words, "__module__": "builtins"})
        for name, words in (
            ("Array", "A NumPy array of floats."),
            ("Flags", "A NumPy array of truth values."),
            ("ArrayLike", "Whatever NumPy makes an array of: numbers, lists of numbers, arrays."),
        )
    )


LARGEST = 1e100
"""What forces, and whatever else is squared, may be at most where something is worked out from them."""
_Numbers = TypeVar("_Numbers", float, Array)
_FEW = 12
_SHORT = 12  # a range of so many is said whole
_NO_NUMBERS = (str, bytes, bytearray, bool, np.bool_, np.str_, np.datetime64, np.timedelta64)


def array(value: ArrayLike, what: str, shape: tuple[int | None, ...]) -> Array:
    """A new read-only array of finite floats; None in ``shape`` stands for any size."""
    result = _floats(value)
    if result is None:
        raise InvalidInput(f"{what} must be numbers of shape {_shape(shape)}, got {shown(value)}")
    if result.shape != shape and (
        result.ndim != len(shape)
        or any(want not in (None, got) for want, got in zip(shape, result.shape, strict=True))
    ):
        raise InvalidInput(
            f"{what} must have shape {_shape(shape)}, got {_shape(result.shape)}: {shown(value)}"
        )
    # One by one is quicker for what positions, normals and forces have.
    few = result.size <= _FEW
    if not (all(map(isfinite, result.ravel().tolist())) if few else np.isfinite(result).all()):
        raise InvalidInput(f"{what} must be finite, got {shown(value)}")
    result.setflags(write=False)
    return result


def numbers_in(value: Any, expected: str) -> Array:
    """A new array of floats, of any shape and possibly not finite; ``expected`` begins the error.

    Text, complex numbers, dates and truth values are no numbers, although NumPy would make some of them.
    """
    result = _floats(value)
    if result is None:
        raise InvalidInput(f"{expected}, got {shown(value)}")
    return result


def _floats(value: Any) -> Array | None:
    """The array of ``numbers_in``, or None: messages cost more than most arrays here."""
    try:
        given = np.asarray(value)
        if type(value) is list and given.dtype == np.float64:  # nobody else's
            return given
        if given.dtype.kind in "fiu" and given.dtype.itemsize <= 8:
            return np.array(given, dtype=np.float64)
        if given.dtype.kind in "fO":  # long doubles, whole numbers beyond 64 bits, fractions, or a mix
            each = [number(x, "each") for x in given.ravel()]
            return np.array(each, dtype=np.float64).reshape(given.shape)
    except (TypeError, ValueError, OverflowError, RecursionError):  # InvalidInput is a ValueError
        pass
    return None


def read_only(values: Array) -> Array:
    """The same array, which refuses to be written to: values hand out what they keep."""
    values.setflags(write=False)
    return values


def point(value: ArrayLike, what: str) -> Array:
    """A finite vector of two or three numbers."""
    try:
        result = array(value, what, (None,))
    except InvalidInput:
        given = _floats(value)
        if given is not None and given.ndim == 1:
            raise
        raise InvalidInput(f"{what} must be 2 or 3 numbers, got {shown(value)}") from None
    if result.size not in (2, 3):
        raise InvalidInput(f"{what} must be 2 or 3 numbers, got {result.size}: {shown(value)}")
    return result


def number(value: Any, what: str, *, least: float | None = None, above: float | None = None) -> float:
    """A finite float, at least ``least`` and greater than ``above`` where these are given."""
    try:
        if type(value) is float:  # as most are
            result = value
        elif isinstance(value, _NO_NUMBERS):
            raise TypeError
        elif isinstance(value, np.ndarray):
            if value.dtype.kind not in "fiu":
                raise TypeError
            result = float(value.item())
        else:
            result = float(value)
    except OverflowError:
        raise InvalidInput(f"{what} must be a number below 1.8e308 in size, got {shown(value)}") from None
    except (TypeError, ValueError):
        raise InvalidInput(f"{what} must be a number, got {shown(value)}") from None
    if not isfinite(result):
        raise InvalidInput(f"{what} must be finite, got {shown(value)}")
    if least is not None and result < least:
        raise InvalidInput(f"{what} must be at least {least:g}, got {shown(value)}")
    if above is not None and result <= above:
        raise InvalidInput(f"{what} must be greater than {above:g}, got {shown(value)}")
    return result


def finite(value: ArrayLike, what: str, tail: tuple[int, ...] = ()) -> Array:
    """A new array (..., *tail) of finite floats."""
    result = numbers_in(value, f"{what} must be numbers")
    if result.shape[result.ndim - len(tail) :] != tail or result.ndim < len(tail):
        expected = ", ".join(["...", *map(str, tail)])
        raise InvalidInput(f"{what} must have shape ({expected}), got {_shape(result.shape)}: {shown(value)}")
    if np.count_nonzero(np.isfinite(result)) < result.size:
        raise InvalidInput(f"{what} must be finite, got {shown(value)}")
    return result


def limits(value: ArrayLike, what: str, count: int) -> Array:
    """(count,) limits greater than 0, infinite for none, from one number for all or one for each."""
    given = numbers_in(value, f"{what} must be a number or have shape ({count},)")
    if given.shape not in ((), (1,), (count,)):
        raise InvalidInput(f"{what} must be a number or have shape ({count},), got {shown(value)}")
    if not (given > 0).all():
        raise InvalidInput(f"{what} must be greater than 0, got {shown(value)}")
    return np.broadcast_to(given, (count,))


def not_huge(values: _Numbers, what: str, most: float = LARGEST) -> _Numbers:
    """The numbers, unless they are so large that sums of their squares or products are none."""
    size = abs(values) if isinstance(values, float) else float(np.abs(values).max(initial=0.0))
    if size > most:
        raise InvalidInput(f"{what} must be at most {most:g} in size, got {shown(size)}")
    return values


def instance(value: Any, what: str, kind: type, hint: str = "") -> None:
    """Raise ``InvalidInput`` unless a value is of a kind."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIO" else "a"
        raise InvalidInput(f"{what} must be {article} {kind.__name__}, got {shown(value)}{hint}")


def items(value: Any, what: str) -> tuple[Any, ...]:
    """The entries of a list or of anything else that has some; text is one thing."""
    try:
        if isinstance(value, (str, bytes, type)):
            raise TypeError
        given = iter(value)
    except TypeError:
        raise InvalidInput(f"{what} must be a list, got {shown(value)}") from None
    return tuple(given)  # a TypeError of what makes the entries is the caller's own


def function(value: Any, what: str, kind: str, arguments: int = 1) -> None:
    """Raise ``InvalidInput`` unless a value can be called with so many arguments; ``kind`` in words."""
    words = f"{what} must be {kind}, got {shown(value)}"
    if not callable(value):
        raise InvalidInput(words)
    try:
        given = signature(value)
    except (TypeError, ValueError):  # compiled, and says nothing of its parameters
        return
    try:
        given.bind(*[None] * arguments)
    except TypeError as error:
        raise InvalidInput(f"{words}: {error} when it is called with {arguments}") from None


def whole(value: Any, what: str, *, least: int, most: int | None = None) -> int:
    """A whole number, at least ``least`` and at most ``most`` where that is given; True and 2.0 are none."""
    few = f"from {least} to {most}" if most is not None and most - least < _SHORT else ""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or value < least:
        raise InvalidInput(
            f"{what} must be a whole number {few or f'of at least {least}'}, got {shown(value)}"
        )
    if most is not None and value > most:
        raise InvalidInput(f"{what} must be a whole number {few or f'of at most {most}'}, got {shown(value)}")
    return int(value)


def file_path(path: Any) -> Path:
    """A path as text or ``os.PathLike`` that can name a file."""
    found = os.fspath(path) if isinstance(path, (str, os.PathLike)) else None
    try:
        named = isinstance(found, str) and found != "" and b"\0" not in os.fsencode(found)
    except UnicodeEncodeError:  # half of a character
        named = False
    if not named:
        raise InvalidInput(f"a path must be text or a Path that names a file, got {shown(path)}")
    try:
        os.lstat(str(found))
    except OSError as error:
        if error.errno == ENAMETOOLONG:
            raise InvalidInput(f"a path must not be too long for a file, got {shown(path)}") from None
    return Path(str(found))


def rotation(value: ArrayLike, what: str) -> Array:
    """A (3, 3) rotation matrix: orthonormal, determinant 1."""
    matrix = array(value, what, (3, 3))
    if abs(matrix @ matrix.T - np.eye(3)).max() > 1e-9 or np.linalg.det(matrix) < 0:
        raise InvalidInput(
            f"{what} must be a rotation matrix (orthonormal, determinant 1), got {shown(value)}"
        )
    return matrix


def choice(value: Any, what: str, allowed: Sequence[str]) -> str:
    """One of the ``allowed`` words."""
    if not isinstance(value, str) or value not in allowed:
        raise InvalidInput(f"{what} must be one of {', '.join(allowed)}; got {shown(value)}")
    return value


def _shape(shape: tuple[int | None, ...]) -> str:
    inside = ", ".join("any" if size is None else str(size) for size in shape)
    return f"({inside},)" if len(shape) == 1 else f"({inside})"
