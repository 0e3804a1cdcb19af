"""Products of the three cones: what lies outside, by how much of which unit, and where it is put back.

Rows of zero cones, non-negative rows and second-order cones {(t, v): |v| <= t} stand in the order of a
program's blocks. A second-order cone is one unit of its own; its excess |v| - t stands at its first row.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from regrasp.programs.blocks import Array, Block, Cone

# Squares of larger numbers may overflow.
_HUGE = 1e150


class Cones:
    """The product of the cones of ``blocks``, over (m,) rows."""

    def __init__(self, blocks: Sequence[Block]) -> None:
        kinds = [np.full(block.rows, list(Cone).index(block.cone)) for block in blocks]
        kind = np.concatenate([*kinds, np.zeros(0, dtype=int)])
        self.zero: NDArray[np.bool_] = kind == 0
        self.nonnegative: NDArray[np.bool_] = kind == 1
        self._least = np.where(self.nonnegative, 0.0, -np.inf)
        self.has_round = bool((kind == 2).any())
        self._round: list[tuple[slice, int]] = []  # rows of a run of second-order cones, and their size
        row = 0
        for block in blocks:
            if block.cone is Cone.SECOND_ORDER:
                self._round.append((slice(row, row + block.rows), block.size))
            row += block.rows

    @property
    def round(self) -> Iterator[slice]:
        """The rows of each second-order cone."""
        for rows, size in self._round:
            for first in range(rows.start, rows.stop, size):
                yield slice(first, first + size)

    def _each(self, values: Array) -> Iterator[Array]:
        """Of values (m,) those of the second-order cones, (k, size) of each run of them; they are shared."""
        for rows, size in self._round:
            yield values[rows].reshape(-1, size)

    def excess(self, s: Array) -> Array:
        """(m,) how far s (m,) lies outside: |s| of zero rows, -s of negative ones, |v| - t of a cone."""
        outside: Array = np.maximum(-s, np.where(self.zero, s, 0.0))
        for each, out in zip(self._each(s), self._each(outside), strict=True):
            out[:] = 0.0
            out[:, 0] = np.maximum(_length(each[:, 1:]) - each[:, 0], 0.0)
        return outside

    def has_dual(self, z: Array) -> bool:
        """Whether z (m,) lies in the dual cone; the zero cone's dual is everything."""
        if not np.logical_and.reduce(z >= self._least):
            return False
        return all(np.logical_and.reduce(_length(each[:, 1:]) <= each[:, 0]) for each in self._each(z))

    def units(self, sizes: Array) -> Array:
        """(m,) the unit of every row: its own of ``sizes`` (m,), of a cone the length of all of its rows'."""
        if not self.has_round:
            return sizes
        units = sizes.copy()
        for each in self._each(units):
            each[:] = _length(each)[:, None]
        return units

    def largest(self, values: Array) -> Array:
        """(m,) values, of a cone the largest of its rows' for all of them."""
        if not self.has_round:
            return values
        largest = values.copy()
        for each in self._each(largest):
            each[:] = each.max(axis=1)[:, None]
        return largest

    def products(self, s: Array, z: Array) -> Array:
        """(m,) s z of every row; of a cone s'z, at its first row."""
        product = s * z
        for each in self._each(product):
            each[:, 0] = each.sum(axis=1)
            each[:, 1:] = 0.0
        return product

    def dual(self, z: Array) -> Array:
        """The point of the dual cone nearest to z (m,); the zero cone's dual is everything."""
        if self.has_round and _HUGE < (size := float(np.abs(z).max())) < np.inf:
            return size * self.dual(z / size)
        nearest: Array = np.where(z > -np.inf, np.maximum(z, self._least), z)
        for each in self._each(nearest):
            t, length = each[:, 0], _length(each[:, 1:])
            along = np.maximum((t + length) / 2, 0.0)
            out = length > t
            if out.any():
                share = np.divide(along, length, out=np.zeros_like(along), where=length > 0)
                each[:, 1:] = np.where(out[:, None], each[:, 1:] * share[:, None], each[:, 1:])
                each[:, 0] = np.where(out, along, t)
        return nearest


def _length(rows: Array) -> Array:
    length: Array = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    return length
