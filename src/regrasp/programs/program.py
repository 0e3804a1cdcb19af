"""A convex conic program in the one standard form every back end takes.

    minimise   1/2 x'Px + q'x
    subject to A x + s = b,   s in K = K_1 x K_2 x ...

Each K_i is the zero cone, the non-negative orthant or a second-order cone {(t, v): |v| <= t}. Knows
nothing of contacts.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from regrasp.errors import InvalidInput

Array = NDArray[np.float64]


class Cone(Enum):
    """The kinds of cone a block of rows can lie in."""

    ZERO = "zero"
    NONNEGATIVE = "nonnegative"
    SECOND_ORDER = "second-order"


@dataclass(frozen=True, eq=False)
class Program:
    """P (n, n) symmetric positive semidefinite, q (n,), A (m, n), b (m,); ``cones`` split the m rows."""

    P: Array
    q: Array
    A: Array
    b: Array
    cones: tuple[tuple[Cone, int], ...]

    def __post_init__(self) -> None:
        n, m = self.q.size, self.b.size
        if self.P.shape != (n, n) or self.A.shape != (m, n):
            raise InvalidInput(
                f"P and A must have shapes {(n, n)} and {(m, n)}, got {self.P.shape} and {self.A.shape}"
            )
        if sum(size for _, size in self.cones) != m:
            raise InvalidInput(f"the cones must cover the {m} rows of A, got {self.cones}")

    def slack(self, x: Array) -> Array:
        """S = b - A x, (m,)."""
        result: Array = self.b - self.A @ x
        return result

    def objective(self, x: Array) -> float:
        """1/2 x'Px + q'x."""
        return float(0.5 * x @ self.P @ x + self.q @ x)


class Rows:
    """Collects the rows of A x + s = b, one cone at a time."""

    def __init__(self, unknowns: int) -> None:
        self._unknowns = unknowns
        self._blocks: list[tuple[Cone, Array, Array]] = []

    def add(self, cone: Cone, matrix: ArrayLike, offset: ArrayLike) -> None:
        """Demand ``matrix @ x + offset in cone``; matrix (k, n), offset (k,)."""
        m = np.atleast_2d(np.asarray(matrix, dtype=float))
        c = np.atleast_1d(np.asarray(offset, dtype=float))
        if m.shape != (c.size, self._unknowns):
            raise InvalidInput(f"rows must have shape {(c.size, self._unknowns)}, got {m.shape}")
        self._blocks.append((cone, m, c))

    def program(self, q: ArrayLike, P: ArrayLike | None = None) -> Program:
        """The program with these rows and the objective 1/2 x'Px + q'x."""
        n = self._unknowns
        return Program(
            P=np.zeros((n, n)) if P is None else np.asarray(P, dtype=float),
            q=np.asarray(q, dtype=float),
            A=-np.vstack([m for _, m, _ in self._blocks]),
            b=np.concatenate([c for _, _, c in self._blocks]),
            cones=tuple((cone, c.size) for cone, _, c in self._blocks),
        )
