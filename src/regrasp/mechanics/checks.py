"""Validators: each converts, checks and returns the value, or raises ``InvalidInput``."""

from collections.abc import Sequence
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from regrasp.errors import InvalidInput

Array = NDArray[np.float64]


def array(value: ArrayLike, what: str, shape: tuple[int | None, ...]) -> Array:
    """A new read-only array of finite floats; None in ``shape`` stands for any size."""
    try:
        result = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{what} must be numbers of shape {_shape(shape)}, got {value!r}") from None
    if result.shape != shape and (
        result.ndim != len(shape)
        or any(want not in (None, got) for want, got in zip(shape, result.shape, strict=True))
    ):
        raise InvalidInput(f"{what} must have shape {_shape(shape)}, got {_shape(result.shape)}: {value!r}")
    if np.count_nonzero(np.isfinite(result)) < result.size:
        raise InvalidInput(f"{what} must be finite, got {value!r}")
    return read_only(result)


def read_only(values: Array) -> Array:
    """The same array, which refuses to be written to: values hand out what they keep."""
    values.setflags(write=False)
    return values


def point(value: ArrayLike, what: str) -> Array:
    """A finite vector of two or three numbers."""
    result = array(value, what, (None,))
    if result.size not in (2, 3):
        raise InvalidInput(f"{what} must be 2 or 3 numbers, got {result.size}: {value!r}")
    return result


def number(value: Any, what: str, *, least: float | None = None, above: float | None = None) -> float:
    """A finite float, at least ``least`` and greater than ``above`` where these are given."""
    try:
        if isinstance(value, (str, bytes, bool)):
            raise TypeError
        result = float(value)
    except (TypeError, ValueError):
        raise InvalidInput(f"{what} must be a number, got {value!r}") from None
    if not isfinite(result):
        raise InvalidInput(f"{what} must be finite, got {value!r}")
    if least is not None and result < least:
        raise InvalidInput(f"{what} must be at least {least:g}, got {value!r}")
    if above is not None and result <= above:
        raise InvalidInput(f"{what} must be greater than {above:g}, got {value!r}")
    return result


def rotation(value: ArrayLike, what: str) -> Array:
    """A (3, 3) rotation matrix: orthonormal, determinant 1."""
    matrix = array(value, what, (3, 3))
    if abs(matrix @ matrix.T - np.eye(3)).max() > 1e-9 or np.linalg.det(matrix) < 0:
        raise InvalidInput(f"{what} must be a rotation matrix (orthonormal, determinant 1), got {value!r}")
    return matrix


def choice(value: Any, what: str, allowed: Sequence[str]) -> str:
    """One of the ``allowed`` words."""
    if not isinstance(value, str) or value not in allowed:
        raise InvalidInput(f"{what} must be one of {', '.join(allowed)}; got {value!r}")
    return value


def _shape(shape: tuple[int | None, ...]) -> str:
    inside = ", ".join("any" if size is None else str(size) for size in shape)
    return f"({inside},)" if len(shape) == 1 else f"({inside})"
