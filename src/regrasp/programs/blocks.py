"""The cones that rows lie in."""

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike as ArrayLike

    Array = NDArray[np.float64]
else:  # as in ``mechanics.checks``, of which programs know nothing
    Array, ArrayLike = (type(name, (), {"__module__": "builtins"}) for name in ("Array", "ArrayLike"))


class Cone(Enum):
    """The kinds of cone a block of rows can lie in."""

    ZERO = "zero"
    NONNEGATIVE = "non-negative"
    SECOND_ORDER = "second-order"


@dataclass(frozen=True)
class Block:
    """``count`` cones of one kind and size, in consecutive rows.

    Args:
        cone: their kind.
        size: rows of each.
        count: how many of them.

    Raises:
        InvalidInput: For what is no cone, and sizes and counts that are no whole numbers of 1 and 0 or more.
    """

    cone: Cone
    size: int
    count: int = 1

    def __post_init__(self) -> None:
        if not isinstance(self.cone, Cone):
            raise InvalidInput(f"cone must be one of {', '.join(map(str, Cone))}, got {shown(self.cone)}")
        for what, value, least in (("size", self.size, 1), ("count", self.count, 0)):
            if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
                raise InvalidInput(
                    f"{what} of a block must be a whole number of {least} or more, got {shown(value)}"
                )

    @property
    def rows(self) -> int:
        """Rows of A the block takes."""
        return self.size * self.count


def numbers(value: Any, what: str) -> Array:
    """An array of floats, the same if it is one. Raises ``InvalidInput`` for what holds no real numbers."""
    try:
        given = np.asarray(value)
    except (TypeError, ValueError, RecursionError):  # lists of several lengths
        given = np.asarray(None)
    if given.dtype.kind not in "fiu":
        raise InvalidInput(f"{what} must be numbers, got {shown(value)}")
    return given.astype(np.float64, copy=False)
