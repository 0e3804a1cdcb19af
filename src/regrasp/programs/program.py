"""A convex conic program in the one standard form every back end takes.

    minimise   1/2 x'Px + q'x
    subject to A x + s = b,   s in K = K_1 x K_2 x ...

Each K_i is the zero cone, the non-negative orthant or a second-order cone {(t, v): |v| <= t}. Knows
nothing of contacts.
"""

from dataclasses import dataclass
from functools import cached_property
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from regrasp.errors import InvalidInput, shown
from regrasp.programs.archive import file_path, read_arrays, write_arrays
from regrasp.programs.blocks import Array, Block, Cone, numbers
from regrasp.programs.cones import Cones
from regrasp.programs.judging.terms import Terms, floors_of, is_small
from regrasp.programs.pattern import is_placed


@dataclass(frozen=True, eq=False)
class Program:
    """The data of a conic program.

    Args:
        P: (n, n) sparse, symmetric positive semidefinite, both triangles; entries at one place are summed.
        q: (n,).
        A: (m, n) sparse.
        b: (m,).
        blocks: the cones, covering the m rows in order.
        size: of an x that matters, by which an answer near x = 0 is judged; 0 to judge by the answer itself.

    Raises:
        InvalidInput: For shapes that do not fit, and data that are not numbers or not finite.
    """

    P: sparse.csc_matrix
    q: Array
    A: sparse.csc_matrix
    b: Array
    blocks: tuple[Block, ...]
    size: float = 0.0

    def __post_init__(self) -> None:
        for name in ("q", "b"):
            self._set(name, _vector(name, getattr(self, name)))
        n, m = self.q.size, self.b.size
        for name in ("P", "A"):
            self._set(name, _matrix(name, getattr(self, name)))
        if self.P.shape != (n, n) or self.A.shape != (m, n):
            raise InvalidInput(
                f"P and A must have shapes {(n, n)} and {(m, n)}, got {self.P.shape} and {self.A.shape}"
            )
        if not isinstance(self.blocks, (tuple, list)) or not all(isinstance(b, Block) for b in self.blocks):
            raise InvalidInput(f"blocks must be a tuple of Block, got {shown(self.blocks)}")
        self._set("blocks", tuple(self.blocks))
        if sum(block.rows for block in self.blocks) != m:
            raise InvalidInput(f"the cones must cover the {m} rows of A, got {shown(self.blocks)}")
        if not isinstance(self.size, (int, float)) or not 0 <= self.size < inf:
            raise InvalidInput(f"size must be a number of 0 or more, got {shown(self.size)}")
        for name, values in (("P", self.P.data), ("q", self.q), ("A", self.A.data), ("b", self.b)):
            _check_finite(name, values)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def with_right_side(self, b: Array) -> "Program":
        """The same program with another b (m,), at little cost: what is known of the rest is kept.

        Args:
            b: (m,).
        """
        b = _vector("b", b)
        if b.shape != self.b.shape:
            raise InvalidInput(f"b must have shape {self.b.shape}, got {b.shape}")
        _check_finite("b", b)
        same = object.__new__(Program)
        same.__dict__.update(self.__dict__)
        same._set("b", b)
        return same

    def without_objective(self) -> "Program":
        """The same rows and nothing to minimise: every feasible point is an answer."""
        nothing = sparse.csc_matrix(self.P.shape)
        return Program(nothing, np.zeros(self.q.size), self.A, self.b, self.blocks, self.size)

    def __str__(self) -> str:
        words = []
        for cone in Cone:
            sizes = [block.rows for block in self.blocks if block.cone is cone]
            words += [f"{sum(sizes)} {cone.value}"] if sum(sizes) else []
        rows = f"rows {', '.join(words)}" if words else "no rows"
        return f"program of {self.q.size} unknowns, {rows}"

    def save(self, path: str | Path) -> Path:
        """Write the program to ``path``, a NumPy archive of plain arrays; returns the path.

        Args:
            path: the archive to write.

        Raises:
            InvalidInput: Where it cannot be written.
        """
        arrays = {"q": self.q, "b": self.b, "cones": self.codes, "size": np.array(self.size)}
        return write_arrays(file_path(path), arrays, {"P": self.P, "A": self.A})

    @staticmethod
    def load(path: str | Path) -> "Program":
        """The program that ``save`` wrote.

        Args:
            path: an archive of ``save``.

        Raises:
            InvalidInput: For a file that holds none.
        """
        path = file_path(path)
        arrays, matrices = read_arrays(path)
        kinds = dict(enumerate(Cone))
        try:
            blocks = [
                Block(kinds[kind], int(size), int(count)) for kind, size, count in arrays["cones"].tolist()
            ]
            size = float(arrays["size"])
        except (ValueError, TypeError, LookupError) as error:
            raise InvalidInput(f"{path}: not the cones or the size of a program: {error}") from None
        return Program(matrices["P"], arrays["q"], matrices["A"], arrays["b"], tuple(blocks), size)

    @cached_property
    def has_second_order(self) -> bool:
        """Whether any cone is of second order, so that a QP solver cannot take the program."""
        return any(block.cone is Cone.SECOND_ORDER for block in self.blocks)

    @cached_property
    def cones(self) -> Cones:
        """The product K of the cones."""
        return Cones(self.blocks)

    @cached_property
    def codes(self) -> NDArray[np.int64]:
        """(k, 3) kind, size and count of each block, the kind by its place in ``Cone``."""
        kinds = list(Cone)
        rows = [(kinds.index(block.cone), block.size, block.count) for block in self.blocks]
        return np.array(rows, dtype=np.int64).reshape(-1, 3)

    @cached_property
    def terms(self) -> Terms:
        """The matrices, for products."""
        return Terms(self.P, self.A, self.cones)

    @cached_property
    def given_units(self) -> tuple[Array, Array, Array]:
        """Units of unknowns (n,), rows (m,) and columns (n,) where ``size`` gives the first."""
        return self.terms.given_units(self.size, self.q)

    @cached_property
    def is_quick(self) -> bool:
        """Whether a kept solver may answer it: small, in one unit, of squares alone if of any."""
        is_diagonal = not np.any(np.diff(self.P.indptr) > 1)
        return self.size > 0 and is_small(self.P, self.A) and is_diagonal and not self.why_not_convex

    @cached_property
    def floors(self) -> tuple[float, float, float, float]:
        """The least units that measures of an answer are in, where ``size`` gives units; see ``quick``."""
        return floors_of(self.terms, self.cones, self.given_units, self.q)

    @cached_property
    def why_not_convex(self) -> str:
        """Why P is not symmetric and positive semidefinite, in words; empty where it is, to rounding."""
        from regrasp.programs.judging.convexity import why_not_convex

        return why_not_convex(self.P)

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


def _vector(name: str, values: Any) -> Array:
    vector = numbers(values, name)
    if vector.ndim != 1:
        raise InvalidInput(f"{name} must have one dimension, got shape {vector.shape}")
    return vector


def _matrix(name: str, given: Any) -> sparse.csc_matrix:
    """The matrix of doubles, each place named once and in order: solvers read others wrongly, or crash."""
    if not sparse.issparse(given) or given.format != "csc":
        raise InvalidInput(f"{name} must be a scipy.sparse matrix in CSC format, got {type(given).__name__}")
    if is_placed(given) and given.dtype == np.float64:
        return given
    if given.dtype.kind not in "fiub":
        raise InvalidInput(f"{name} must hold real numbers, got {given.dtype}")
    rows, ends = given.indices, given.indptr
    if rows.size and not (rows.min() >= 0 and rows.max() < given.shape[0]):
        raise InvalidInput(
            f"{name} is no matrix in CSC format: it has {given.shape[0]} rows, and entries in others"
        )
    if not (ends[0] == 0 and (np.diff(ends) >= 0).all() and ends[-1] <= rows.size == given.data.size):
        raise InvalidInput(f"{name} is no matrix in CSC format: its columns do not follow each other")
    is_kept = isinstance(given, sparse.csc_matrix) and given.dtype == np.float64 and ends[-1] == rows.size
    if is_kept and given.has_canonical_format:
        return given
    matrix = sparse.csc_matrix(given, dtype=np.float64, copy=True)
    matrix.sum_duplicates()
    return matrix
