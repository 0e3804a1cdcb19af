"""The cones that rows lie in."""

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

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
    """

    cone: Cone
    size: int
    count: int = 1

    @property
    def rows(self) -> int:
        """Rows of A the block takes."""
        return self.size * self.count
