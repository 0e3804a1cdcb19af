"""A convex conic program in the one standard form every back end takes.

    minimise   1/2 x'Px + q'x
    subject to A x + s = b,   s in K = K_1 x K_2 x ...

Each K_i is the zero cone, the non-negative orthant or a second-order cone {(t, v): |v| <= t}. Knows
nothing of contacts.
"""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from regrasp.errors import InvalidInput

Array = NDArray[np.float64]


class Cone(Enum):
    """The kinds of cone a block of rows can lie in."""

    ZERO = "zero"
    NONNEGATIVE = "non-negative"
    SECOND_ORDER = "second-order"


@dataclass(frozen=True)
class Block:
    """``count`` cones of one kind and size, in consecutive rows."""

    cone: Cone
    size: int
    count: int = 1

    @property
    def rows(self) -> int:
        """Rows of A the block takes."""
        return self.size * self.count


@dataclass(frozen=True, eq=False)
class Program:
    """The data of a conic program.

    P: (n, n) sparse, symmetric positive semidefinite, both triangles. q: (n,).
    A: (m, n) sparse. b: (m,). blocks: the cones, covering the m rows in order.
    size: of an x that matters, by which an answer near x = 0 is judged; 0 to judge by the answer itself.
    Raises ``InvalidInput`` for shapes that do not fit and data that are not finite.
    """

    P: sparse.csc_matrix
    q: Array
    A: sparse.csc_matrix
    b: Array
    blocks: tuple[Block, ...]
    size: float = 0.0

    def __post_init__(self) -> None:
        n, m = self.q.size, self.b.size
        for name, matrix in (("P", self.P), ("A", self.A)):
            if getattr(matrix, "format", None) != "csc":
                raise InvalidInput(
                    f"{name} must be a scipy.sparse matrix in CSC format, got {type(matrix).__name__}"
                )
        if self.P.shape != (n, n) or self.A.shape != (m, n):
            raise InvalidInput(
                f"P and A must have shapes {(n, n)} and {(m, n)}, got {self.P.shape} and {self.A.shape}"
            )
        if sum(block.rows for block in self.blocks) != m:
            raise InvalidInput(f"the cones must cover the {m} rows of A, got {self.blocks}")
        for name, values in (("P", self.P.data), ("q", self.q), ("A", self.A.data), ("b", self.b)):
            _check_finite(name, values)

    def with_right_side(self, b: Array) -> "Program":
        """The same program with another b (m,), at little cost: nothing but b is looked at again."""
        if b.shape != self.b.shape:
            raise InvalidInput(f"b must have shape {self.b.shape}, got {b.shape}")
        _check_finite("b", b)
        _ = self.has_second_order, self.codes  # known of every program with these rows
        same = object.__new__(Program)
        same.__dict__.update(self.__dict__)
        object.__setattr__(same, "b", b)
        return same

    @cached_property
    def has_second_order(self) -> bool:
        """Whether any cone is of second order, so that a QP solver cannot take the program."""
        return any(block.cone is Cone.SECOND_ORDER for block in self.blocks)

    @cached_property
    def codes(self) -> NDArray[np.int64]:
        """(k, 3) kind, size and count of each block, the kind by its place in ``Cone``."""
        kinds = list(Cone)
        return np.array([(kinds.index(block.cone), block.size, block.count) for block in self.blocks])

    @cached_property
    def slices(self) -> tuple[tuple[Block, slice], ...]:
        """Each block with its rows."""
        ends = np.cumsum([block.rows for block in self.blocks])
        return tuple(
            (block, slice(int(end) - block.rows, int(end)))
            for block, end in zip(self.blocks, ends, strict=True)
        )


def _check_finite(name: str, values: Array) -> None:
    if not np.isfinite(values).all():
        raise InvalidInput(f"{name} must be finite")
